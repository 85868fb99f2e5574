#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# Triaxial compression as a user runs it: a quick run that keeps its own checks, and what it refuses.
# The checks of the fabric, and a wrong result that each would catch:
#   anisotropy after the compression     contacts of some directions that are left out, or counted twice (those
#                                        through the sides of the box)
#   largest anisotropy over the scatter of random directions   axes that are mixed up: contacts are lost along
#                                        the axes that get longer
#   loose and dense: critical anisotropy   contacts that are not those of the step
set -u
triaxial=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$triaxial"

refused "nonsense" --nonsense
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$triaxial" --quick --out "$work/quick" >"$work/log" 2>&1; then
  for file in summary.json dense.csv loose.csv triaxial.png; do
    [ -s "$work/quick/$file" ] || fail "triaxial --quick left no $file"
  done
  grep -q '"holds": false' "$work/quick/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "triaxial --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
