#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# Settling as a user runs it: a quick run that keeps its own checks, and what it refuses.
set -u
settling=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$settling"

refused "nonsense" --nonsense
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$settling" --quick --out "$work/quick" >"$work/log" 2>&1; then
  for file in summary.json settling.csv settling.png column.png; do
    [ -s "$work/quick/$file" ] || fail "settling --quick left no $file"
  done
  grep -q '"holds": false' "$work/quick/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "settling --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
