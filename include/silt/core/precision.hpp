// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// The precision axis of a Simulation and of an Sph: everything in double.
/// Source: none.
/// Valid:  every scene.
/// Units:  none.
/// Errors: none.
/// Tests:  tests/engine/precision.cpp.
struct Double {
  using PairScalar = double;
};

/// Positions, integration, walls and lists in double; the work on pairs of particles in float:
/// twice the lanes, half the bytes. Overlaps are formed from squares in double, without
/// cancellation; what follows from them has an error of some 1e-7. Forces on a particle are sums of
/// floats. Limits: a tangential spring that grows by less than 6e-8 of itself a step stays as it
/// is; forces below 1e-19 N count as zero where their direction matters. Tests:
/// tests/engine/precision.cpp.
/// Source: none.
/// Valid:  spheres and bodies of spheres, and Sph; convex bodies take Double.
/// Units:  none.
/// Errors: none.
struct Mixed {
  using PairScalar = float;
};

}  // namespace silt
