// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Smallest possible fragment, for the time step. For spheres: diameter dust_below. For polyhedra:
/// a cell of the same volume, with a shape that is unknown before it is cut.
///
/// Source: computed from 24 000 cells cut from six bodies (stones of 8 to 20 corners, a plate, a
///         cube, a brick 4:2:1), dust_below of 0.05 to 0.45 diameters. Lightness: median 6.7, 1 %
///         above 12, largest 15, with a contact by Hertz' law that is 9 % shorter. Inner: median
///         0.55, 1 % below 0.3, smallest 0.16.
/// Tests:  tests/breakage/polyhedra_step.cpp.
struct SmallestCell {
  static constexpr double lightness = 12;  // [-] BodyForm::Spot, the largest of a cell
  static constexpr double inner = 0.3;     // [-] inscribed sphere over sphere of equal volume

  /// Mass over effective mass at the tips [-].
  template <class Sim>
  static constexpr double lightness_of() {
    return Sim::of_bodies ? lightness : 1;
  }
  /// Radius of the largest inscribed sphere over dust_below [-].
  template <class Sim>
  static constexpr double inner_of() {
    return 0.5 * (Sim::of_bodies ? inner : 1);
  }
};

}  // namespace silt::detail
