// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Load of one contact on one particle, to compare with a strength.
struct Impact {
  double diameter;       // [m] of the particle; body: sphere of equal volume
  double mass;           // [kg] of the particle
  double speed;          // [m/s] >= 0, approach along the normal at first touch
  double m_eff, R_eff;   // [kg], [m] of the contact
  double elastic_force;  // [N] largest spring force of this impact, with damping and the physical
                         // modulus; NaN if the law has no closed form
  double contact_force;  // [N] largest normal force so far, for loads by force; else NaN
  bool at_wall;
};

/// Unit of strength and load.
enum class LoadUnit { Force /* [N] */, Energy /* [J] */ };

/// A particle that breaks; strength and load in their unit.
struct Broken {
  double diameter;  // [m]
  double mass;      // [kg]
  double strength;  // [N] or [J]
  double load;      // [N] or [J], >= strength
  double speed;     // [m/s] of approach
};

}  // namespace silt
