#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The bladed mixer as a user runs it: a quick run that keeps its own checks, and what it refuses.
# The run's checks, and a wrong result that each would catch:
#   index at the start                      samples that hold both kinds of a bed that is not mixed
#   index of random mixtures                a variance of random samples that is wrong: 1/n left out is 7 % off
#   torque times angle over energy          torque about another point, an angle that loses turns, lost energy
#   work of the blades over energy          work of blades whose mesh moves that the ledger misses
#   torque over that of the servo           a servo that lags behind (gain 0.25: 13 % off)
#   speed over that with more torque        a servo that does not hold a bed that bears its torque
#   grains outside, mass, mean overlap      grains that pass walls or blades
set -u
mixer=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$mixer"

refused "not in range" --gain 2
refused "not in range" --turns 0
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$mixer" --quick --out "$work/quick" >"$work/log" 2>&1; then
  for file in summary.json blade_speed.csv blade_torque.csv index_speed.csv index_torque.csv end.vtp end_walls.vtp \
    mixer.png bed.png; do
    [ -s "$work/quick/$file" ] || fail "mixer --quick left no $file"
  done
  grep -q '"holds": false' "$work/quick/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "mixer --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
