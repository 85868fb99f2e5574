#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The direct shear test as a user runs it: a quick run that keeps its own checks, and what it refuses.
# The run's checks, and a wrong result that each would catch:
#   force of the lid over its weight        a lid that lags behind a sample which dilates (servos did: 6 to 22 % off)
#   shear forces below and above            a load of one wall that is not read: a flange, the lid
#   ... less the momentum                   loads of other steps than those of the grains
#   work ... over dissipated energy         forces of moving walls on other ways; losses that the ledger misses
#   grains outside                          holes at the split or beside the flanges
#   peak over residual, the lid rises       friction of the preparation that stays; a dense sample that is none
#   cohesion over its standard error        weights or areas that are left out of the normal stress
#   loose against dense, without dilation   a stretch that is not residual yet; dilatancy of the wrong sign
set -u
shear_box=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$shear_box"

refused "not in range" --travel 0
refused "not in range" --inertial-number 1
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$shear_box" --quick --out "$work/quick" >"$work/log" 2>&1; then
  for file in summary.json tests.csv dense_25kPa.csv loose_100kPa.csv end.vtp contacts.vtp shear_box.png box.png; do
    [ -s "$work/quick/$file" ] || fail "shear_box --quick left no $file"
  done
  grep -q '"holds": false' "$work/quick/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "shear_box --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
