// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The smallest fragment that there may be, for the time step: of spheres one of the diameter
/// dust_below, of polyhedra a cell of the same volume, whose shape is not known before it is cut.
/// Source: computed, of 24 000 cells cut from six bodies (stones of 8 to 20 corners, a plate, a
///         cube, a brick 4:2:1), dust_below of 0.05 to 0.45 diameters. Lightness: median 6.7, 1 %
///         above 12, largest 15, whose contact by Hertz' law is 9 % shorter. Inner: median 0.55,
///         1 % below 0.3, least 0.16.
/// Tests:  tests/breakage/polyhedra_step.cpp.
struct SmallestCell {
  static constexpr double lightness = 12;  // [-] BodyForm::Spot, the largest of a cell
  static constexpr double inner = 0.3;     // [-] sphere inside over that of equal volume

  /// What the mass is over the mass that a push at its tips meets [-].
  template <class Sim>
  static constexpr double lightness_of() {
    return Sim::of_bodies ? lightness : 1;
  }
  /// The radius of the largest sphere inside over dust_below [-].
  template <class Sim>
  static constexpr double inner_of() {
    return 0.5 * (Sim::of_bodies ? inner : 1);
  }
};

}  // namespace silt::detail
