#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# Triaxial compression as a user runs it: a quick run that keeps its own checks, and what it refuses.
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
