#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# ranks.sh MPIRUN PROGRAM: the checks of communicators on 1 to 5 ranks; what a rank that fails does to the
# others: one sentence, a status that is not 0, and no rank that waits for ever.
# ranks.sh MPIRUN PROGRAM RANKS...: runs a program that ends with the word fine, on so many ranks.
set -u
mpirun=$1 program=$2
shift 2
# Open MPI: more ranks than cores, idle ones give their core away; containers run as root. It forgets
# some memory, which is not silt's.
export OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 ASAN_OPTIONS=detect_leaks=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
fail() { echo "FAIL: $*"; cat "$work/out" "$work/err"; failed=1; }

# on RANKS WORD: runs a case; $status, $work/out, $work/err.
on() {
  timeout 100 "$mpirun" -np "$1" "$program" ${2:+"$2"} >"$work/out" 2>"$work/err"; status=$?
  [ "$status" -ne 124 ] || fail "${2:-$program} on $1 ranks hangs"
}
# ends_with RANKS WORD TIMES SENTENCE: fails, and says the sentence so many times (some: at least once).
ends_with() {
  on "$1" "$2"
  [ "$status" -ne 0 ] || fail "$2 on $1 ranks: status 0"
  local times; times=$(grep -c -- "$4" "$work/err")
  [ "$3" = some ] && [ "$times" -ge 1 ] || [ "$3" = "$times" ] || fail "$2 on $1 ranks: not $3 times '$4'"
  grep -q fine "$work/out" && fail "$2 on $1 ranks: all is fine"
  return 0
}

if [ $# -gt 0 ]; then
  for ranks in "$@"; do
    on "$ranks" ""
    [ "$status" -eq 0 ] && grep -q fine "$work/out" || fail "$program on $ranks ranks: status $status"
  done
  exit "$failed"
fi

for ranks in 1 2 3 5; do
  on "$ranks" communicators
  [ "$status" -eq 0 ] && grep -q fine "$work/out" || fail "communicators on $ranks ranks: status $status"
done
for ranks in 2 3; do
  on "$ranks" sizes
  [ "$status" -eq 0 ] || fail "messages of wrong sizes on $ranks ranks: status $status"
done
on 1 before; grep -q "MPI has not begun: make a silt::Mpi" "$work/out" || fail "no MPI_Init"
on 1 one_thread; grep -q "call MPI_Init_thread with MPI_THREAD_FUNNELED" "$work/out" || fail "MPI_Init"

disk="silt: rank 2 of 3: this rank has no disk"
ends_with 3 one 1 "$disk"
ends_with 3 all 1 "$disk"
ends_with 3 failed_one 1 "$disk"
ends_with 3 failed_all 1 "$disk"
ends_with 3 caught_all some "main: rank 2 of 3: this rank has no disk"
ends_with 3 caught_again_all some "$disk"
ends_with 3 caught_one 1 "silt: rank 2 of 3 leaves by an exception, and other ranks do not"
ends_with 3 abort 1 "silt: rank 2 of 3: enough"
ends_with 3 by_itself 1 "rank 0 is at 'a sum that rank 0 wants', rank 1 is at 'the end of a simulation or communicator'"
ends_with 3 kill 0 "silt:"
ends_with 3 exit 0 "silt:"
exit "$failed"
