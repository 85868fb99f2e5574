#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The roofline as a user runs it: a quick run that keeps its own checks, and what it refuses.
set -u
roofline=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/../program.sh" "$roofline"

refused "nonsense" --nonsense
refused "not in range" 5
refused "many" many
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$roofline" --quick --out "$work/quick" >"$work/log" 2>&1; then
  for part in inputs versions processor results checks; do
    grep -q "\"$part\"" "$work/quick/summary.json" || fail "no $part in summary.json"
  done
  grep -q '"holds": true' "$work/quick/summary.json" || fail "roofline checks nothing"
  grep -q '"holds": false' "$work/quick/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "roofline --quick ended with status $?: $(tail -n 40 "$work/log")"
fi
exit $failed
