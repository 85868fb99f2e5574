#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# A short program as ./run example runs it: short.sh SOURCE PROGRAM [RUNNER...]. It must end with status 0, say something,
# and leave the files that its lines "// picture: " draw; where numpy and matplotlib are found they are drawn, too.
# Of a SOURCE in Python, PROGRAM is the one that it reads from.
set -u
source=$1 program=$2
shift 2
silt=$(cd "$(dirname "$0")/../python/silt" && pwd)
failed=0
fail() { echo "$*"; failed=1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

"$@" "$program" >log 2>&1 || fail "$program ended with status $?: $(tail -n 20 log)"
[ -s log ] || fail "$program printed nothing"

python=/usr/bin/python3
"$python" -c 'import numpy, matplotlib' 2>/dev/null || python=
case $source in *.py)
  [ -n "$python" ] || exit $failed
  PYTHONPATH=$(dirname "$silt") "$python" -B "$source" >log 2>&1 || fail "$source ended with status $?: $(tail -n 20 log)"
  [ -s log ] || fail "$source printed nothing" ;;
esac
pictures=0
while read -r command words; do
  pictures=$((pictures + 1))
  if [ -z "$words" ]; then  # a picture that the program has drawn itself
    [ -z "$python" ] || [ -s "$command" ] || fail "$program left no picture $command"
    continue
  fi
  for word in $words; do
    case $word in -*) break ;; esac
    [ -s "$word" ] || fail "$program left no $word, which its line '// picture: ' draws"
  done
  out=${words##* }
  [ -z "$python" ] || [ $failed = 1 ] || {
    # shellcheck disable=SC2086  # words, as in ./run example
    "$python" -B "$silt" "$command" $words >drawn 2>&1 && [ -s "$out" ] || fail "no picture $out: $(cat drawn)"
  }
done < <(sed -n 's,^\(//\|#\) picture: ,,p' "$source")
[ $pictures -gt 0 ] || fail "$source has no line '// picture: '"
exit $failed
