#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# Calibrations as a user runs them, in their quick forms: they keep their own checks, leave their files, make no
# run twice, and refuse what makes no sense. What the checks of a run catch:
#   chi2                               values that do not give what was measured
#   ... off planted, in half intervals a posterior beside the truth, or far too narrow
set -u
calibrate=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$calibrate"

refused "no calibration 'nonsense'" nonsense
refused "nonsense" bounce --nonsense
refused "budget = 5 \[-\] is less than the" bounce --budget 5 --out "$work/budget"
touch "$work/file"
refused "$work/file" bounce --quick --out "$work/file/out"

names=$("$calibrate" --help | sed -n 's/^  \([a-z_-]*\)  *.*/\1/p')
[ "$(echo "$names" | wc -w)" -ge 3 ] || fail "calibrate --help lists only: $names"
for name in bounce heap ball_mill; do
  out=$work/$name
  if "$calibrate" "$name" --quick --out "$out" >"$work/log" 2>&1; then
    for file in summary.json table.txt calibration.csv calibration.json posterior.csv calibration.png settings.txt; do
      [ -s "$out/$file" ] || fail "calibrate $name left no $file"
    done
    grep -q '"holds": true' "$out/summary.json" || fail "calibrate $name checks nothing"
    /usr/bin/python3 -m json.tool "$out/calibration.json" >"$work/json" || fail "calibrate $name: calibration.json is no JSON"
  else
    fail "calibrate $name ended with status $?: $(tail -n 30 "$work/log")"
  fi
done
# A killed one, with its last row cut off, goes on and comes to the same.
cp -r "$work/bounce" "$work/again"
head -n 16 "$work/bounce/calibration.csv" >"$work/again/calibration.csv"
printf '15,15,0,prop' >>"$work/again/calibration.csv"
"$calibrate" bounce --quick --out "$work/again" >"$work/log" 2>&1 || fail "the run that goes on: $(tail -n 20 "$work/log")"
grep -q "15 of them of an earlier program" "$work/log" || fail "it did not go on: $(cat "$work/log")"
for folder in bounce again; do cut -d, -f1-12 "$work/$folder/calibration.csv" >"$work/$folder.rows"; done
cmp -s "$work/bounce.rows" "$work/again.rows" || fail "other runs: $(diff "$work/bounce.rows" "$work/again.rows")"
refused "has runs of another calibration" bounce --quick --seed 2 --out "$work/again"
exit $failed
