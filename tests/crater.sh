#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The ball that falls onto a bed as a user runs it: a quick run that keeps its own checks, and what it
# refuses. The run's checks, and a wrong result that each would catch:
#   grains_not_as_in_the_checkpoint   a checkpoint that loses a bit, or a bed that a drop has changed
#   momentum_off_the_loads        a free body without gravity, or pushed by other loads than it tells
#   spin_off_the_loads            torques about another point; a turn that loses angular momentum
#   energy_off_the_books          work of the body that the ledger does not see
#   load_at_rest_off_the_weight   a body that still sinks, or stands on the floor and the pot
#   bed_under_the_ball_over_ball  a ball that falls through the bed
#   exponent_of_height, exponent_of_density   a force that is constant, of inertia or of depth alone
#   depth_over_that_by_uehara     friction that does not act
set -u
crater=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$crater"

refused "not in range" --wide 1
refused "not in range" --friction 0

if "$crater" --quick --out "$work/crater" >"$work/log" 2>&1; then
  for file in summary.json depths.csv bed.silt early.vtp tilted.vtp crater.png depth.png; do
    [ -s "$work/crater/$file" ] || fail "crater --quick left no $file"
  done
  grep -q '"holds": false' "$work/crater/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "crater --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
