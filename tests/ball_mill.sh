#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The ball mill as a user runs it: quick runs that keep their own checks, dry, without end walls, as
# a scan, wet; and what is refused. The checks of a run, and a wrong result that each would catch:
#   turns_a_minute                      a mean ball by number, or a drum's outer radius
#   balls_over_those_of_bonds_charge    balls that found no place, or left
#   work_of_the_drum_over_energy        torque about another point, or of another wall; lost energy
#   torque_over_moment_of_the_weight    contacts with lifters that count twice or not at all
#   lost_in_contacts_over_power         a spectrum that misses contacts
#   balls_outside                       balls that pass shell, lifters or ends
#   mean_overlap_over_mean_diameter     a modulus in other units
#   angle_of_repose                     a line through the shoulder, or of the other side
# and of a wet one:
#   slurry_over_volume_of_the_drum      slurry in balls or walls, or a level that is off
#   share_that_left_or_was_displaced    slurry that passes the drum, or is deleted where balls are
#   share_inside_balls                  balls that the slurry does not see
#   share_whose_density_is_off          pores that blow up; a speed of sound that is too small
#   speed_of_999_in_1000_over_sound     slurry that is shot out between balls
set -u
ball_mill=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$ball_mill"

refused "350 not in" --case 350
refused "not in range" --restitution 0
refused "at least 105 mm" --periodic --quick
refused "leave out --periodic" --wet --periodic --length 120

run() {
  local name=$1 files=$2; shift 2
  if "$ball_mill" --quick "$@" --out "$work/$name" >"$work/log" 2>&1; then
    for file in summary.json $files; do
      [ -s "$work/$name/$file" ] || fail "ball_mill --quick $* left no $file"
    done
    grep -q '"holds": false' "$work/$name/summary.json" && fail "a check does not hold but the status is 0"
  else
    fail "ball_mill --quick $* ended with status $?: $(tail -n 20 "$work/log")"
  fi
}
dry="torque.csv impacts.csv surface.csv heat.pgm end.vtp mill.png curves.png"
run dry "$dry" --case 300
run ends "$dry" --case 400 --periodic --length 120
run scan scan.csv --scan
run wet "torque.csv surface.csv highest.csv slurry.vtp end.vtp wet.png" --wet
exit $failed
