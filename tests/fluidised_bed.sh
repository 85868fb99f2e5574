#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The fluidised bed as a user runs it: a quick run that keeps its own checks, and what it refuses.
# The run's checks, and a wrong result that each would catch:
#   volume_of_solids_off, momentum_of_exchange_off, continuity_off
#                     solids, momentum or gas that is lost between grains and cells: rounding; the
#                     pressure's tolerance
#   balance_of_forces_over_weight, 1 %
#                     a load that is not read (of the walls alone: up to 60 %), slugs that leave the gas
#                     at the top of the box (2.4 % at twice the minimum fluidisation velocity), pressure not
#                     that on the floor (extrapolated: 1.7 %)
#   minimum_fluidisation_over_the_law, 2 % (ellipsoids, --drag syamlal 3 %; --quick, whose bed is half as
#   high, 3 and 4.5 %)
#                     drag that is not the law's; a kernel of 3 diameters instead of 1.5; a voidage
#                     with a height of the bed that is off by 1 %. The law is taken at the voidage that the
#                     bed has at each velocity, as the pressure drops are
#   minimum_fluidisation_m_s, pressure_drop_at_rest_over_law_by_layers_less_1, 1.5 % and 2 % (--drag
#   syamlal, own 2.3 and 3 %)
#                     layers that feel another flow than cells and kernel make: those at a floor that
#                     counts as clear of grains
#   pressure_drop_of_the_dense_bed_over_the_loose_one
#                     a bed that is as dense before it was fluidised as after: a rising branch below the
#                     falling one
#   largest_pressure_drop_at_rest_over_weight
#                     walls that do not hold the dense bed back: no overshoot
#   mean_pressure_at_the_floor_less_weight_over_weight, 2 %
#                     a mean of the flow over another time than that of the loads; a mean voidage that is not
#                     the grains'; walls that bear what the gas does
#   (--hot) heat_balance_over_heat_in_grains, heat_from_gas_less_heat_in_grains_over_it
#                     heat that only one side gets, or that grains get twice; inflow without its heat
#   (--hot) mean_rise_of_grains_over_that_of_a_mixed_bed, 5 %
#                     a heat capacity or a gas flow that is wrong; no exchange
#   plateau_over_weight, 1 % (not with --quick, which is too short for a mean)
#                     weight that neither gas nor floor nor walls bear
set -u
bed=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$bed"

refused "not in range" --particles 5
refused "not in range" --bubbling 1
refused "shape" --shape rocks
refused "not in range" --hot --gas 900
refused "leave --shape ellipsoid out" --hot --shape ellipsoid
refused "drag" --drag stokes
refused "leave --hot and --shape out" --drag own --hot
touch "$work/file"
refused "$work/file" --quick --out "$work/file/out"

# leaves FOLDER "FILES" OPTION...: a quick run that ends well, has these files and no check that fails.
leaves() {
  local folder=$work/$1 files=$2 file
  shift 2
  "$bed" --quick "$@" --out "$folder" >"$work/log" 2>&1 ||
    { fail "fluidised_bed --quick $* ended with status $?: $(tail -n 20 "$work/log")"; return; }
  for file in $files; do
    [ -s "$folder/$file" ] || fail "fluidised_bed --quick $* left no $file"
  done
  grep -q '"holds": false' "$folder/summary.json" && fail "a check of --quick $* does not hold but the status is 0"
  true
}
leaves quick "summary.json pressure_drop.csv vtk/particles.pvd pressure_drop.png bed.png voidage.png \
  taps.csv mean_flow.vti taps.png mean_voidage.png heights.csv heights.png probes.csv probes.png axis"
# Their drag is the law that the bed's velocity is compared with, so that another law fails.
leaves syamlal "summary.json pressure_drop.png" --drag syamlal
leaves own "summary.json pressure_drop.png" --drag own
leaves hot "summary.json temperatures.csv vtk/particles.pvd temperatures.png hot_bed.png hot_gas.png" --hot
exit $failed
