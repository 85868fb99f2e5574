// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// A shape gives mass properties and a bounding radius for a particle of it; contact geometry of
/// pairs of shapes stands in shape/narrow/. Needs
///   static double volume(double radius)          [m3]
///   static double inertia_factor()               [-] I / (m r^2), isotropic
template <class S>
concept Shape = requires(double radius) {
  { S::volume(radius) } -> std::same_as<double>;
  { S::inertia_factor() } -> std::same_as<double>;
};

}  // namespace silt
