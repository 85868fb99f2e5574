#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# parsed.sh COMPILER SOURCE [OPTION...]: SOURCE must be free of errors as far as the compiler gets before it instantiates
# the time loop and generic lambdas, which costs ten seconds a program: names, arguments, members and types of what main()
# calls. The compiler is stopped at the end of the source by an error, which must be the first one.
set -u
compiler=$1 source=$2
shift 2
out=$(printf '#include "%s"\nstatic_assert(false, "parsed to its end");\n' "$source" |
  $compiler -std=c++20 -fsyntax-only -Wfatal-errors "$@" -x c++ - 2>&1)
first=$(grep -m 1 'error:' <<<"$out")
case $first in *'parsed to its end'*) exit 0 ;; esac
printf '%s\n' "$source does not compile:" "$out"
exit 1
