#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# The studies as a user runs them, in their quick forms: they keep their own checks, leave their files,
# and refuse what makes no sense.
set -u
study=$1
# shellcheck source=tests/program.sh
source "$(dirname "$0")/program.sh" "$study"

refused "no study 'nonsense'" nonsense
refused "nonsense" skin --nonsense
refused "threads" skin --threads 2
refused "not in range" skin --repeats 0
refused "not in range" decomposition --particles 10
refused "repeats" decomposition --repeats 2
refused "particles" skin --particles 2000
touch "$work/file"
refused "$work/file" stiffness --quick --out "$work/file/out"

names=$("$study" --help | sed -n 's/^  \([a-z-]*\)  *.*/\1/p')
[ "$(echo "$names" | wc -w)" -ge 7 ] || fail "study --help lists only: $names"
for name in $names; do
  [ "$name" != shape ] || continue  # most of a minute even if quick
  out=$work/$name
  if "$study" "$name" --quick --out "$out" >"$work/log" 2>&1; then
    [ -s "$out/summary.json" ] || fail "study $name left no summary.json"
    grep -q '"holds": true' "$out/summary.json" || fail "study $name checks nothing"
    grep -q '"holds": false' "$out/summary.json" && fail "study $name: a check fails, status 0"
    for table in "$out"/*/table.csv; do
      folder=$(dirname "$table")
      for file in table.csv table.txt summary.json pareto.png; do
        [ -s "$folder/$file" ] || fail "study $name left no $folder/$file"
      done
      /usr/bin/python3 -m json.tool "$folder/summary.json" >"$work/json" ||
        fail "study $name: $folder/summary.json is no JSON"
    done
  else
    fail "study $name ended with status $?: $(tail -n 30 "$work/log")"
  fi
done
exit $failed
