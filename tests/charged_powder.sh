#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The charged powder as a user runs it: a quick run that keeps its own checks, and what it refuses.
set -u
powder=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$powder"

refused "not in range" --particles 5
refused "not in range" --area-factor 0
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$powder" --quick --out "$work/powder" >"$work/log" 2>&1; then
  for file in summary.json charge.csv sticking.csv vtk/particles.pvd turned.vtp powder.png charge.png sticking.png; do
    [ -s "$work/powder/$file" ] || fail "charged_powder --quick left no $file"
  done
  grep -q '"holds": false' "$work/powder/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "charged_powder --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
