#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The heap as a user runs it: a quick run of all shapes that keeps its own checks, and what it refuses.
set -u
heap=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$heap"

refused "not in range" --particles 5
refused "shapes" --shapes rocks
refused "rough-spheres alone" --quick --shapes cubes --rolling-friction 0.2
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$heap" --quick --shapes mix --out "$work/mix" >"$work/log" 2>&1; then
  for file in summary.json surface.csv vtk/surfaces.pvd heap.png; do
    [ -s "$work/mix/$file" ] || fail "heap --quick left no $file"
  done
  grep -q '"holds": false' "$work/mix/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "heap --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
"$heap" --quick --shapes rough-spheres --out "$work/rough" >"$work/log" 2>&1 ||
  fail "heap of rough spheres ended with status $?: $(tail -n 20 "$work/log")"
exit $failed
