#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# Whether results are the same bits as in another version: runs the scenes of this folder with the
# headers as they are and with those of REVISION, and shows what differs.
#   benchmarks/hashes/compare.sh REVISION [FOLDER]
# Ends with 1 where a hash differs. CXX and CXXFLAGS choose the compiler (g++) and its options
# (-O2 -march=native). FOLDER (build/hashes) keeps the hashes of each revision for the next time.
set -eu
cd "$(dirname "$0")/../.."
[ $# -ge 1 ] || { sed -n '3,7s/^# //p' "$0"; exit 2; }
revision=$(git rev-parse --verify --short "$1^{commit}")
folder=${2:-build/hashes}
flags=${CXXFLAGS:--O2 -march=native}
mkdir -p "$folder"

# hashes INCLUDE NAME: compiles the scenes with these headers and writes NAME.txt.
hashes() {
  mkdir -p "$folder/$2"
  for source in benchmarks/hashes/*.cpp; do
    # shellcheck disable=SC2086  # several words
    echo "${CXX:-g++} -std=c++20 $flags -I$1 -c $source -o $folder/$2/$(basename "$source" .cpp).o"
  done | xargs -P "$(nproc)" -I{} sh -c '{}'
  ${CXX:-g++} "$folder/$2"/*.o -o "$folder/$2/hashes" -pthread
  (cd "$folder/$2" && ./hashes >../"$2.txt")
}

if [ ! -e "$folder/$revision.txt" ]; then
  rm -rf "$folder/headers"
  mkdir "$folder/headers"
  git archive "$revision" include | tar x -C "$folder/headers"
  hashes "$folder/headers/include" "$revision"
fi
hashes include now
if diff "$folder/$revision.txt" "$folder/now.txt"; then
  echo "$(wc -l <"$folder/now.txt") scenes, the same bits as $revision"
else
  echo "not the same bits as $revision (<)"
  exit 1
fi
