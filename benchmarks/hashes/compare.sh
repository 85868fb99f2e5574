#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# Whether results are the same bits as in another version, and what a step costs beside it: runs the
# scenes of this folder with the headers as they are and with those of REVISION.
#   benchmarks/hashes/compare.sh REVISION [FOLDER]            hashes; ends with 1 where one differs
#   benchmarks/hashes/compare.sh --times N REVISION [FOLDER]  N runs of each, taken in turns: the
#                                                             median of their ratios, its quartiles
# CXX and CXXFLAGS choose the compiler (g++) and its options (-O2 -march=native; with --times -O3).
# FOLDER (build/hashes) keeps the programs and hashes of each revision for the next time.
set -eu
cd "$(dirname "$0")/../.."
usage() { sed -n '3,10s/^# //p' "$0"; exit 2; }
times=0
if [ "${1:-}" = --times ]; then
  [ $# -ge 3 ] || usage
  times=$2
  shift 2
fi
[ $# -ge 1 ] || usage
revision=$(git rev-parse --verify --short "$1^{commit}")
folder=${2:-build/hashes}
kind=hashes
[ "$times" = 0 ] || kind=times
flags=${CXXFLAGS:-$([ "$times" = 0 ] && echo -O2 || echo -O3) -march=native}
mkdir -p "$folder"

# build INCLUDE NAME: compiles the scenes with these headers to NAME/hashes or NAME/times.
build() {
  mkdir -p "$folder/$2/$kind.o"
  for source in benchmarks/hashes/*.cpp; do
    # shellcheck disable=SC2086  # several words
    echo "${CXX:-g++} -std=c++20 $flags -I$1 -c $source -o $folder/$2/$kind.o/$(basename "$source" .cpp).o"
  done | xargs -P "$(nproc)" -I{} sh -c '{}'
  ${CXX:-g++} "$folder/$2/$kind.o"/*.o -o "$folder/$2/$kind" -pthread
}
# run NAME FILE [OPTION]
run() { (cd "$folder/$1" && "./$kind" ${3:-} >"../$2"); }

if [ ! -x "$folder/$revision/$kind" ]; then
  rm -rf "$folder/headers"
  mkdir "$folder/headers"
  git archive "$revision" include | tar x -C "$folder/headers"
  build "$folder/headers/include" "$revision"
fi
build include now

if [ "$times" != 0 ]; then
  for ((k = 0; k < times; ++k)); do
    run "$revision" "times_$revision.$k" --times
    run now "times_now.$k" --times
  done
  python3 benchmarks/hashes/ratios.py "$revision" "$times" "$folder"
  exit
fi
[ -e "$folder/$revision.txt" ] || run "$revision" "$revision.txt"
run now now.txt
if diff "$folder/$revision.txt" "$folder/now.txt"; then
  echo "$(wc -l <"$folder/now.txt") scenes, the same bits as $revision"
else
  echo "not the same bits as $revision (<)"
  exit 1
fi
