#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The chute as a user runs it: a quick run that keeps its own checks, and what it refuses.
set -u
chute=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$chute"

refused "not in range" --rate 100
refused "not in range" --steep 10
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$chute" --quick --out "$work/chute" >"$work/log" 2>&1; then
  for file in summary.json worn.csv profile.csv angles.csv sliding.vtp impacts.vtp vtk/particles.pvd wear.png \
    profile.png; do
    [ -s "$work/chute/$file" ] || fail "chute --quick left no $file"
  done
  grep -q '"holds": false' "$work/chute/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "chute --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
