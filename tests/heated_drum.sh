#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The heated drum as a user runs it: a quick run that keeps its own checks, and what it refuses.
set -u
drum=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$drum"

refused "not in range" --particles 5
refused "not in range" --wall 200

if "$drum" --quick --out "$work/drum" >"$work/log" 2>&1; then
  for file in summary.json temperatures.csv end.vtp drum.png temperatures.png; do
    [ -s "$work/drum/$file" ] || fail "heated_drum --quick left no $file"
  done
  grep -q '"holds": false' "$work/drum/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "heated_drum --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
