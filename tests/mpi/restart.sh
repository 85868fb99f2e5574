#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# restart.sh MPIRUN PROGRAM [KILLS]: a run on 3 ranks of which one is killed again and again, at any moment,
# goes on from its last checkpoint and ends with the bits of a run without kills; then on 2 ranks and
# without Ranks.
set -u
mpirun=$1 program=$2 kills=${3:-5}
export OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAIL: $*"; cat "$work"/*.log; exit 1; }
mkdir "$work/whole" "$work/killed" "$work/two" "$work/one"

timeout 100 "$mpirun" -np 3 "$program" "$work/whole" 0.02 >"$work/whole.log" 2>&1 || fail "the run without kills"
RANDOM=1
for k in $(seq "$kills"); do
  rm -f "$work"/killed/pid.*
  timeout 100 "$mpirun" -np 3 "$program" "$work/killed" 0.02 >"$work/killed.log" 2>&1 &
  run=$!
  for _ in $(seq 500); do [ -s "$work/killed/pid.2" ] && [ -s "$work/killed/pid.0" ] && break; sleep 0.02; done
  sleep "0.0$((RANDOM % 10))$((RANDOM % 10))"
  kill -9 "$(cat "$work/killed/pid.$((RANDOM % 3))" 2>/dev/null)" 2>/dev/null
  wait "$run"; status=$?
  [ "$status" -ne 124 ] || fail "kill $k: the other ranks hang"
  [ "$status" -ne 0 ] || grep -q "to 2000" "$work/killed.log" || fail "kill $k: status 0"
done
timeout 100 "$mpirun" -np 3 "$program" "$work/killed" 0.02 >"$work/killed.log" 2>&1 || fail "after $kills kills"
cmp "$work/whole/end.csv" "$work/killed/end.csv" || fail "other particles after $kills kills"

cp -r "$work/killed/run" "$work/killed/run.blocks" "$work/two"
cp -r "$work/killed/run" "$work/killed/run.blocks" "$work/one"
timeout 100 "$mpirun" -np 2 "$program" "$work/two" 0.0201 >"$work/two.log" 2>&1 || fail "3 ranks to 2"
timeout 100 "$program" "$work/one" 0.0201 one >"$work/one.log" 2>&1 || fail "3 ranks to one process"
for run in two one; do grep -q "from step 2000 to 2010" "$work/$run.log" || fail "$run: $(cat "$work/$run.log")"; done
# Equal but for rounding, which ten steps after the restart is in the last digits.
paste -d, "$work/two/end.csv" "$work/one/end.csv" | awk -F, 'NR > 1 { rows++
  for (k = 1; k <= NF / 2; k++) { d = $k - $(k + NF / 2); m = $k < 0 ? -$k : $k; if (d < 0) d = -d
    if (d > 1e-9 * (1 + m)) { print "line " NR ": " $k " and " $(k + NF / 2); exit 1 } } }
  END { if (rows != 54) { print rows + 0 " particles"; exit 1 } }' || fail "2 ranks and one process differ"
echo "fine"
