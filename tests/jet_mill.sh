#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The jet mill as a user runs it: a quick run that keeps its own checks, one that goes on from its
# checkpoint, and what it refuses. The run's checks, and a wrong result that each would catch:
#   mass_unexplained_over_fed        dust that is counted as grains too; feed that is not booked
#   broken                           loads of softened grains; grains that never meet a wall
#   momentum_of_gas_and_grains_off   gas that does not feel fragments
#   volume_of_solids_off             fragments that the gas does not see, or grains it still sees
#   fastest_grain_over_fastest_gas   fragments that throw each other apart
set -u
jet_mill=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$jet_mill"

refused "not in range" --jets 300
refused "not in range" --dust 1

if "$jet_mill" --quick --duration 0.003 --out "$work/mill" >"$work/log" 2>&1; then
  for file in summary.json breakage.csv sizes_over_time.csv product.csv grains.csv impacts.csv gas.csv end.vtp \
    mill.png milling.png vtk/flow.pvd last.silt; do
    [ -s "$work/mill/$file" ] || fail "jet_mill --quick left no $file"
  done
  grep -q '"holds": false' "$work/mill/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "jet_mill --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
"$jet_mill" --quick --duration 0.0032 --restart "$work/mill/last.silt" --out "$work/on" >"$work/log" 2>&1 ||
  fail "jet_mill --restart ended with status $?: $(tail -n 20 "$work/log")"
exit $failed
