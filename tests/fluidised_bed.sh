#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The fluidised bed as a user runs it: a quick run that keeps its own checks, and what it refuses.
set -u
bed=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$bed"

refused "not in range" --particles 5
refused "not in range" --bubbling 1
refused "shape" --shape rocks
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$bed" --quick --out "$work/quick" >"$work/log" 2>&1; then
  for file in summary.json pressure_drop.csv vtk/particles.pvd pressure_drop.png bed.png voidage.png; do
    [ -s "$work/quick/$file" ] || fail "fluidised_bed --quick left no $file"
  done
  grep -q '"holds": false' "$work/quick/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "fluidised_bed --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
