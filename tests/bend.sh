#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The bend as a user runs it: a quick run of both models that keeps its own checks, and what it refuses.
set -u
bend=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$bend"

refused "case" --case up
refused "closure" --closure none
refused "not in range" --cells 2
refused "take one" --quick --full
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

if "$bend" --quick --case hv --out "$work/hv" >"$work/log" 2>&1; then
  for file in summary.json along.csv across.csv points.csv simplified.vtp traditional.vtp bend.png; do
    [ -s "$work/hv/$file" ] || fail "bend --quick left no $file"
  done
  grep -q '"holds": false' "$work/hv/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "bend --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
"$bend" --quick --case hv --closure k-epsilon --out "$work/k" >"$work/log" 2>&1 ||
  fail "bend --closure k-epsilon ended with status $?: $(tail -n 20 "$work/log")"
grep -q '"closure": "k-epsilon"' "$work/k/summary.json" || fail "the summary does not name the closure"
exit $failed
