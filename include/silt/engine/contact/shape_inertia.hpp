// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/lanes.hpp>
#include <silt/shape/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A Contacts type of spheres that are not solid, with their inertia_factor().
template <class ContactsType, Shape ShapeType>
struct OfShape : ContactsType {
  static double inertia_factor() { return ShapeType::inertia_factor(); }
};

/// Quantities that depend on f = I/(m r^2) of the touching spheres. Both partners have the same f,
/// so each is the same for pairs and for walls. Parts of bodies count as solid spheres.
template <class ContactsType>
struct InertiaOf {
  /// [-] f
  static SILT_INLINE double factor() {
    if constexpr (requires { ContactsType::inertia_factor(); })
      return ContactsType::inertia_factor();
    else
      return 0.4;
  }
  /// [-] (I + m r^2)/(m r^2)
  static SILT_INLINE double rolling() { return 1 + factor(); }
  /// [-] m* over the effective mass against slip at the contact point, 1 + m r^2/I
  static SILT_INLINE double slip_mobility() { return 1 + 1 / factor(); }
  /// [-] I/(I + m r^2)
  static SILT_INLINE double share_of_rolling() { return 1 / slip_mobility(); }
};

/// Refuses an inertia_factor() that no sphere can have: a thin shell has the largest.
template <class ShapeType>
void check_inertia() {
  if constexpr (requires { ShapeType::inertia_factor(); }) {
    const double f = ShapeType::inertia_factor();
    require(f > 0 && f <= 0.667, "the shape's inertia_factor() = ", f,
            " [-] must be in (0, 2/3]: I/(m r^2) of a solid sphere is 2/5, of a thin shell 2/3");
  }
}

}  // namespace silt::detail
