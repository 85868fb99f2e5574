#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# headers_alone.sh COMPILER INCLUDE_DIR [OPTION...]: compiles all headers below INCLUDE_DIR/silt, each as
# a program of its own, as many at a time as there are processors; names those that do not compile, and
# those with something of silt outside of the namespace of its instruction set (core/target.hpp).
set -u
export compiler=$1 dir=$2
shift 2
export options="$*"

alone() {
  local out
  # shellcheck disable=SC2086
  if ! out=$(printf '#include <%s>\n%s\n#include <%s>\nint main() {}\n' "$1" "$target" "$1" |
      $compiler -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Wshadow -Werror -I"$dir" $options \
        -x c++ - 2>&1); then
    printf '%s does not compile alone:\n%s\n' "$1" "$out"
    return 1
  fi
}
export -f alone

export target='#ifndef SILT_TARGET
#error "its namespace needs silt/core/target.hpp"
#endif'
# What is thrown must have a plain name, which a terminated program shows; units_apart.py looks at it.
if grep -rn '^ *namespace silt' "$dir/silt" | grep -v 'namespace silt::inline SILT_TARGET\b' |
  grep -v '/core/error_types.hpp:[0-9]*:namespace silt {$'; then
  echo "these must stand in 'namespace silt::inline SILT_TARGET'"
  exit 1
fi

headers=$(cd "$dir" && find silt -name '*.hpp' | sort)
# Those that need what is optional: where it is missing they say so.
has() { printf '#if !__has_include(<%s>)\n#error\n#endif\n' "$1" | $compiler -fsyntax-only $options -x c++ - 2>/dev/null; }
has mpi.h || headers=$(grep -v -E "silt/mpi.hpp|parallel/(mpi_comm|zoltan|decomposition/(rcb|hypergraph))" <<<"$headers")
has zoltan.h || headers=$(grep -v -E "parallel/(zoltan|decomposition/(rcb|hypergraph))" <<<"$headers")
has Eigen/Dense || has eigen3/Eigen/Dense ||
  headers=$(grep -v -E "silt/eigen.hpp|core/eigen|study/(calibrat|gaussian_process|minimise)" <<<"$headers")
[ "$(printf '%s\n' "$headers" | wc -l)" -ge 50 ] || { echo "only few headers found in $dir"; exit 1; }
printf '%s\n' "$headers" | xargs -P "$(nproc)" -I{} bash -c 'alone {}'
