#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# Grains thrown against a plate as a user runs it: a quick run that keeps its own checks, and what it
# refuses. The run's checks, and a wrong result that each would catch:
#   loads_off_hertz               loads lowered twice by the damping, or not at all; another contact's modulus
#   chi_square_of_shares          strengths of another scatter; below: ranks that are not drawn
#   all_broken_off_the_law        strengths of another size
#   sizes_off_the_breakage_function   dust in wrong classes; fragments of another parent's load
#   mean number of impacts, share broken in the end   fatigue that acts in each step, or never
#   mass_unexplained              dust that is counted as mass of fragments too
#   momentum_unexplained          fragments that are born at rest; dust that leaves its momentum
#   energy_unexplained            fragments that push each other apart at birth
set -u
drop_test=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$drop_test"

refused "not in range" --grains 0
refused "not in range" --restitution 1.5
refused "not in range" --speeds 1

if "$drop_test" --quick --out "$work/drop_test" >"$work/log" 2>&1; then
  for file in summary.json drop_test.csv sizes.csv fatigue.csv after.vtp drop_test.png sizes.png; do
    [ -s "$work/drop_test/$file" ] || fail "drop_test --quick left no $file"
  done
  grep -q '"holds": false' "$work/drop_test/summary.json" && fail "a check does not hold but the status is 0"
else
  fail "drop_test --quick ended with status $?: $(tail -n 20 "$work/log")"
fi
exit $failed
