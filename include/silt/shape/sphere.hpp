// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <numbers>

#include <silt/shape/concept.hpp>

namespace silt::inline SILT_TARGET {

/// A solid sphere.
struct Sphere {
  static constexpr double volume(double radius) {
    return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  }
  static constexpr double inertia_factor() { return 0.4; }
  bool operator==(const Sphere&) const = default;
};

static_assert(Shape<Sphere>);

}  // namespace silt
