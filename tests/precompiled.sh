#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# precompiled.sh SOURCE COMPILER CMAKE_OPTION...: a scene that is linked to silt::precompiled compiles no step of its
# own and no function that is no template, and writes the same files as one that compiles all. Scenes with a law of
# their own, meshes, polyhedra or a liquid, which are not in the library, compile and run as well.
set -eu
source=$1 compiler=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake -S "$source/tests/precompiled" -B "$work/build" -DSILT_SOURCE_DIR="$source" -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE="-O1" -DSILT_MARCH=native -DSILT_MPI=OFF "$@" >"$work/log" ||
  { cat "$work/log"; exit 1; }
cmake --build "$work/build" --parallel 2 >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
object=$(find "$work/build/CMakeFiles/scene.dir" -name 'first_steps*.o')
[ -n "$object" ]
# What a step is made of stands in the library; nm writes U where a name is taken from elsewhere.
if ! nm -C "$object" | grep -q ' U .*::advance(bool)$'; then
  echo "the scene compiles Simulation::advance itself: its type is none of silt::precompiled"
  exit 1
fi
if nm -C "$object" | grep -q ' [TW] .*NearLists<.*>::renew'; then
  echo "the scene compiles neighbour lists, which silt::precompiled has"
  exit 1
fi
if nm -C "$object" | grep -q ' [TW] .*write_vtp_points'; then
  echo "the scene compiles write_vtp_points, which silt::precompiled has"
  exit 1
fi
for program in own_law walls polyhedron_cells sph files; do
  mkdir "$work/$program"
  (cd "$work/$program" && "$work/build/$program" >/dev/null)
done
for program in scene plain; do
  mkdir "$work/$program"
  (cd "$work/$program" && "$work/build/$program" >/dev/null)
done
diff -r "$work/scene/out" "$work/plain/out"
[ "$(find "$work/scene/out" -name '*.vtp' | wc -l)" -ge 20 ]
