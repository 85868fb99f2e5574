#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The verification gallery as a user runs it, in its quick form: its own checks, the pictures that the
# page of the docs shows, and what it refuses.
set -u
page=$2
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$1"

refused "nonsense" --nonsense --out "$work/refused"
refused "restart" --restart "$work/state.silt" --out "$work/refused"
refused "threads" --threads 0 --out "$work/refused"

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
