#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The hopper as a user runs it: a quick run that keeps its own checks, a restart, and what it refuses.
# The checks of --silo, and a wrong result that each would catch:
#   borne_by_walls_at_rest_over_weight   a wall whose force is not counted, or counted twice
#   facets_against_force_of_the_cone     contacts at edges that count for two facets or for none
#   shear_over_pressure_over_friction    above 1: another friction than the wall's; below 0.6: a bed that does
#                                        not slide down, of which Janssen's law says nothing
#   pressure_while_emptied_off_janssen_rms   rings in the wrong order, with the area of others, or beside
#                                        grains of another depth
set -u
hopper=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$hopper"

refused "nonsense" --nonsense
refused "not in range" --particles 5
refused "particles" --particles many
refused "density" --density -1
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"
refused "leave --flat out" --silo --flat
refused "not in range" --silo --wall-friction 2
refused "nowhere.silt" --quick --out "$work/r" --restart "$work/nowhere.silt"

if "$hopper" --quick --out "$work/quick" >"$work/log" 2>&1; then
  for file in summary.json discharge.csv checkpoint.silt vtk/particles.pvd snapshots.png discharge.png flow.csv flow.png \
    contacts_at_rest.vtp chains.png; do
    [ -s "$work/quick/$file" ] || fail "hopper --quick left no $file"
  done
  grep -q '"holds": false' "$work/quick/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "hopper --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
cp "$work/quick/checkpoint.silt" "$work/later.silt"
"$hopper" --quick --out "$work/again" --restart "$work/later.silt" >"$work/log" 2>&1 ||
  fail "hopper --restart ended with status $?: $(tail -n 20 "$work/log")"

refused "precision silt::Mixed" --quick --mixed --out "$work/mixed" --restart "$work/later.silt"
"$hopper" --quick --mixed --out "$work/mixed" >"$work/log" 2>&1 ||
  fail "hopper --mixed ended with status $?: $(tail -n 20 "$work/log")"
grep -q '"precision": "mixed"' "$work/mixed/summary.json" || fail "hopper --mixed: not in summary.json"
grep -q '"precision": "double"' "$work/quick/summary.json" || fail "hopper: not in double by default"
if "$hopper" --silo --quick --out "$work/silo" >"$work/log" 2>&1; then
  for file in summary.json walls.csv walls.png cone_at_rest.vtp; do
    [ -s "$work/silo/$file" ] || fail "hopper --silo --quick left no $file"
  done
  grep -q '"holds": false' "$work/silo/summary.json" && fail "a check of --silo does not hold but the status is 0"
else
  fail "hopper --silo --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
