#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# refused.sh COMPILER SOURCE [OPTION...]: SOURCE must be refused, and the compiler's output must hold
# each sentence that stands in a line "// refused: ..." of it. mended.cpp shows that it compiles mended. With a
# line "// in at most N lines of g++" that compiler may say no more, so that the sentence is seen.
set -u
compiler=$1 source=$2
shift 2
sentences=$(sed -n 's|^// refused: ||p' "$source")
[ -n "$sentences" ] || { echo "$source has no line '// refused: ...'"; exit 1; }
most=$(sed -n 's|^// in at most \([0-9]*\) lines of g++$|\1|p' "$source")
holds_all() {
  while read -r sentence; do
    grep -qF "$sentence" <<<"$1" || return 1
  done <<<"$sentences"
}
# clang 14 may crash after the sentence if it has read a header beforehand; no report of it in /tmp then.
if $compiler --version | grep -qi clang; then set -- -fno-crash-diagnostics "$@"; fi
# Most are in the first error, with which the compiler may stop; else all that it says is looked at.
if [ -z "$most" ]; then
  if out=$($compiler -std=c++20 -fsyntax-only -Wfatal-errors "$@" "$source" 2>&1); then
    echo "$source compiles, and should be refused with '$sentences'"
    exit 1
  fi
  holds_all "$out" && exit 0
fi
if out=$($compiler -std=c++20 -fsyntax-only "$@" "$source" 2>&1); then
  echo "$source compiles, and should be refused with '$sentences'"
  exit 1
fi
while read -r sentence; do
  grep -qF "$sentence" <<<"$out" && continue
  printf '%s\n' "'$sentence' is missing in what the compiler says:" "$out"
  exit 1
done <<<"$sentences"
if [ -n "$most" ] && ! $compiler --version | grep -qi clang && [ "$(wc -l <<<"$out")" -gt "$most" ]; then
  printf '%s\n' "more than $most lines of the compiler for one mistake:" "$out"
  exit 1
fi
