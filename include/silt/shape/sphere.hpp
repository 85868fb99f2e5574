// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <numbers>

#include <silt/shape/concept.hpp>

namespace silt::inline SILT_TARGET {

/// A solid sphere.
/// Source: geometry; I = 2/5 m r^2.
/// Valid:  solid spheres of any radii.
/// Units:  [m], [m3].
/// Errors: Particles::add and fill throw InputError for a radius that is not positive.
/// Tests:  tests/fill/packing.cpp, tests/physics/impact.cpp, tests/physics/conservation.cpp.
struct Sphere {
  static constexpr double volume(double radius) {
    return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  }
  static constexpr double inertia_factor() { return 0.4; }
  bool operator==(const Sphere&) const = default;
};

static_assert(Shape<Sphere>);

}  // namespace silt
