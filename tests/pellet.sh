#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# Pellets in a drum as a user runs them: quick runs that keep their own checks, glue that never breaks,
# and what is refused.
set -u
pellet=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$pellet"

refused "not in range" --pellets 0
refused "not in range" --strength -1

if "$pellet" --quick --out "$work/broken" >"$work/log" 2>&1; then
  for file in summary.json pieces.csv sizes.csv end.vtp walls.vtp drum.png pieces.png vtk/bonds.pvd; do
    [ -s "$work/broken/$file" ] || fail "pellet --quick left no $file"
  done
  grep -q '"holds": false' "$work/broken/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "pellet --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
"$pellet" --quick --strength 0 --turns 0.1 --out "$work/whole" >"$work/log" 2>&1 ||
  fail "pellet --strength 0 ended with status $?: $(tail -n 20 "$work/log")"
exit $failed
