#!/usr/bin/env bash
# silt - BSD-3-Clause, see LICENSE
# Compiles LAMMPS, LIGGGHTS and LIGGGHTS with superquadrics for this machine, from the sources of
# Debian's packages: what Debian compiles runs on any machine of its kind and leaves speed behind.
#   native.sh OUT        OUT/lmp, OUT/liggghts, OUT/liggghts_superquadrics; OUT/*.flags says how
# LAMMPS_FLAGS and LIGGGHTS_FLAGS change the compiler's options. What is there already is kept.
# Needs g++, CMake, Ninja, Open MPI with its headers, Boost, and the network once.
set -eu
out=$(mkdir -p "$1" && cd "$1" && pwd)
lammps_flags=${LAMMPS_FLAGS:--O3 -march=native -ffast-math -DNDEBUG}
liggghts_flags=${LIGGGHTS_FLAGS:--O3 -march=native -DNDEBUG}
jobs=$(nproc)

# sources NAME: unpacks the package's upstream sources to OUT/src_NAME. Its own list of sources, so that
# the machine's settings stay as they are and no root is needed.
sources() {
  [ ! -d "$out/src_$1" ] || return 0
  local apt=$out/apt key=/usr/share/keyrings/debian-archive-keyring.gpg signed=
  mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial"
  [ ! -e "$key" ] || signed="[signed-by=$key] "
  # shellcheck disable=SC2016  # apt-get fills these in
  apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' \
    'Origin: Debian' | sort -u | sed "s|^|deb-src $signed|" >"$apt/sources.list"
  local options=(-qq -o "Dir::Etc::sourcelist=$apt/sources.list" -o Dir::Etc::sourceparts=/dev/null
    -o "Dir::State::lists=$apt/lists" -o "Dir::Cache=$apt/cache" -o APT::Sandbox::User=)
  apt-get "${options[@]}" update
  # Debian's own patches may be missing on a mirror; they are not needed.
  (cd "$out" && apt-get "${options[@]}" source --download-only "$1") || true
  local archive
  archive=$(find "$out" -maxdepth 1 -name "$1_*.orig.tar.*" | head -n 1)
  [ -n "$archive" ] || { echo "native.sh: apt-get found no sources of $1" >&2; exit 2; }
  rm -rf "$out/new"
  mkdir "$out/new"
  tar xf "$archive" -C "$out/new" --strip-components=1
  mv "$out/new" "$out/src_$1"
}

if [ ! -x "$out/lmp" ]; then
  sources lammps
  cmake -S "$out/src_lammps/cmake" -B "$out/src_lammps/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_CXX_FLAGS_RELEASE="$lammps_flags" -DPKG_GRANULAR=on -DPKG_SPH=on -DBUILD_MPI=on -DBUILD_OMP=off \
    -DWITH_JPEG=off -DWITH_PNG=off -DWITH_GZIP=off -DWITH_FFMPEG=off
  cmake --build "$out/src_lammps/build" --target lmp
  cp "$out/src_lammps/build/lmp" "$out/lmp"
  echo "$lammps_flags" >"$out/lmp.flags"
fi

# liggghts NAME SURFACES FLAGS: a program with the contact models of these surfaces alone.
liggghts() {
  local name=$1 surfaces=$2 flags=$3 surface build=$out/build_$1
  [ ! -x "$out/$name" ] || return 0
  sources liggghts
  rm -rf "$build"
  cp -r "$out/src_liggghts/src" "$build"
  cd "$build"
  rm -f dump_mesh_vtk.*                                # the one file that needs VTK
  sed -i 's/numneigh > 0/numneigh != 0/' finish.cpp    # compares a pointer
  sh Make.sh style
  for surface in $surfaces; do
    echo "GRAN_MODEL(HERTZ, TANGENTIAL_HISTORY, COHESION_OFF, ROLLING_OFF, SURFACE_$surface)"
  done >style_contact_model.h
  # shellcheck disable=SC2086  # several words
  printf '%s\n' *.cpp | xargs -P "$jobs" -n 1 mpic++ $flags -std=c++98 -w -c
  # shellcheck disable=SC2086
  mpic++ $flags ./*.o -o "$out/$name"
  echo "$flags" >"$out/$name.flags"
  cd "$out"
}
liggghts liggghts DEFAULT "$liggghts_flags"
liggghts liggghts_superquadrics "DEFAULT SUPERQUADRIC" \
  "$liggghts_flags -DSUPERQUADRIC_ACTIVE_FLAG -DNONSPHERICAL_ACTIVE_FLAG"
echo "compiled: $out/lmp, $out/liggghts, $out/liggghts_superquadrics"
