#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The shear cell as a user runs it: a quick run that keeps its own checks, and what it refuses.
set -u
shear_cell=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$shear_cell"

refused "nonsense" --nonsense
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$shear_cell" --quick --out "$work/quick" >"$work/log" 2>&1; then
  for file in summary.json shear_cell.csv shear_cell.png; do
    [ -s "$work/quick/$file" ] || fail "shear_cell --quick left no $file"
  done
  grep -q '"holds": false' "$work/quick/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "shear_cell --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
