# shellcheck shell=bash
# silt - BSD-3-Clause, see LICENSE
# For tests of a program as a user runs it: `source program.sh PROGRAM`. Gives a folder $work that is
# removed at the end, fail, which sets $failed, and refused.
program=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
fail() { echo "FAIL: $*"; failed=1; }

# refused WORDS ARGUMENT...: status 2, one sentence with these words on stderr.
refused() {
  local words=$1 status; shift
  local call="${program##*/} $*"
  "$program" "$@" >"$work/out" 2>"$work/err"; status=$?
  [ "$status" -eq 2 ] || fail "$call: status $status instead of 2"
  grep -q -- "$words" "$work/err" || fail "$call: no '$words' in: $(cat "$work/err")"
  [ "$(grep -c . "$work/err")" -eq 1 ] || fail "$call: not one sentence: $(cat "$work/err")"
}
