#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The drum of shapes as a user runs it: a quick run that keeps its own checks, and what it refuses.
set -u
drum=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$drum"

refused "not in range" --particles 5
refused "shapes" --shapes rocks
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$drum" --quick --particles 60 --rpm 100 --out "$work/mix" >"$work/log" 2>&1; then
  for file in summary.json drum.csv surface.csv impacts.csv vtk/surfaces.pvd drum.png impacts.png; do
    [ -s "$work/mix/$file" ] || fail "drum_of_shapes --quick left no $file"
  done
  grep -q '"holds": false' "$work/mix/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "drum_of_shapes --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
