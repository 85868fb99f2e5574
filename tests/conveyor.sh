#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The transfer between two belts as a user runs it: a quick run that keeps its own checks, and what it
# refuses. The run's checks, and a wrong result that each would catch:
#   fed_kg_s                      a mass rate that counts the kinds of a recipe wrongly
#   carried_off_over_fed          grains that a belt does not carry
#   grains_held_and_gone_over_placed   grains that are lost, or leave twice
#   torque_on_plate_over_weight   a hinge that turns the wrong way, about another line, without gravity
#   push_of_walls_over_momentum_carried_off   a belt whose force is not that of its surface; loads of
#                                 other steps than those of the grains
#   push_of_upper_belt_and_skirts_over_feed_times_speed   a belt that drags the ore with another force than
#                                 brings it to its speed; forces with the wrong sign
#   spilled_over_fed              holes between belts, skirts and plate
set -u
conveyor=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$conveyor"

refused "not in range" --rate 0
refused "not in range" --plate 1000

if "$conveyor" --quick --out "$work/transfer" >"$work/log" 2>&1; then
  for file in summary.json transfer.csv end.vtp walls.vtp transfer.png mass.png plate.png \
    upper_belt.csv lower_belt.csv belts.png chains.png vtk/contacts.pvd; do
    [ -s "$work/transfer/$file" ] || fail "conveyor --quick left no $file"
  done
  grep -q '"holds": false' "$work/transfer/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "conveyor --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
