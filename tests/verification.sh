#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The verification gallery as a user runs it, in its quick form: its own checks, the pictures that the
# page of the docs shows, and what it refuses.
set -u
program=$1 page=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
fail() { echo "FAIL: $*"; failed=1; }

for words in "--nonsense" "--restart $work/state.silt" "--threads 0"; do
  # shellcheck disable=SC2086
  "$program" $words --out "$work/refused" >"$work/out" 2>"$work/err"; status=$?
  [ "$status" -eq 2 ] || fail "verification $words: status $status instead of 2"
  [ "$(grep -c . "$work/err")" -eq 1 ] || fail "verification $words: not one sentence: $(cat "$work/err")"
done

if "$program" --quick --out "$work/quick" >"$work/log" 2>&1; then
  grep -q '"holds": false' "$work/quick/summary.json" && fail "a check does not hold but the status is 0"
  for picture in $(grep -o 'verification/[a-z_0-9]*\.png' "$page" | sort -u); do
    [ -s "$work/quick/${picture#verification/}" ] || fail "no ${picture#verification/} was drawn"
    [ -s "$(dirname "$page")/$picture" ] || fail "the docs have no $picture"
  done
else
  fail "verification --quick ended with status $?: $(grep -v '^  ok' "$work/log" | tail -n 30)"
fi
exit $failed
