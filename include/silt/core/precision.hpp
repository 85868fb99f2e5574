// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Precision of a Simulation or an Sph: everything in double (default).
/// Source: none.
/// Valid:  every scene.
/// Units:  none.
/// Errors: none.
/// Tests:  tests/engine/precision.cpp.
struct Double {
  using PairScalar = double;
};

/// Mixed precision: positions, integration, walls and lists in double; forces between pairs of
/// particles in float, with twice as many lanes and half the memory. Overlaps are computed from
/// squares in double, without cancellation; quantities derived from them have an error of some
/// 1e-7. Forces on a particle are sums of floats. Limits: a tangential spring that grows by less
/// than 6e-8 of itself per step does not change; forces below 1e-19 N count as zero where their
/// direction is needed.
/// Tests:  tests/engine/precision.cpp.
/// Source: none.
/// Valid:  spheres and bodies of spheres, and Sph; convex bodies need Double.
/// Units:  none.
/// Errors: none.
struct Mixed {
  using PairScalar = float;
};

}  // namespace silt
