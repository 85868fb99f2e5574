#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# A column of water collapses as a user runs it: quick runs that keep their own checks, in 2D and 3D,
# and what is refused. The run's checks, and a wrong result that each would catch:
#   front_off_..._after_shift_in_time  a speed of sound that holds the front back
#   height_off_martin_moyce            a wall that sticks; gravity or times in other units
#   front_speed_over_ritters           pressure that pushes a surface which has none
#   energy_over_that_at_the_start      viscosity or diffusion that is too large by some factors
#   energy_that_came_from_nothing      a step that is too long; forces that are not those of one energy
#   rms_change_of_pressure_to_T_0_1    a start with the pressure of a column at rest, or a wrong series
#   largest_change_of_density          an equation of state that is too soft
#   particles_that_left                a wall that leaks
set -u
dam_break=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$dam_break"

refused "not in range" --spacing 0.1
refused "not in range" --alpha -1
refused "not in range" --end 1

run() {
  local name=$1; shift
  if "$dam_break" --quick "$@" --out "$work/$name" >"$work/log" 2>&1; then
    for file in summary.json dam_break.csv vtk/liquid.pvd dam_break.png curves.png; do
      [ -s "$work/$name/$file" ] || fail "dam_break --quick $* left no $file"
    done
    grep -q '"holds": false' "$work/$name/summary.json" && fail "a check does not hold but the status is 0"
  else
    fail "dam_break --quick $* ended with status $?: $(tail -n 20 "$work/log")"
  fi
}
run plane
run space --three-dimensional
run sticking --sticking
exit $failed
