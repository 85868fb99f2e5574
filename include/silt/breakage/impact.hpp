// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// What a strength is compared with: one contact of one particle.
struct Impact {
  double diameter;       // [m] of the particle; of a body: of the sphere of equal volume
  double mass;           // [kg] of the particle
  double speed;          // [m/s] >= 0, of approach along the normal, at first touch
  double m_eff, R_eff;   // [kg], [m] of the contact
  double elastic_force;  // [N] largest force of the contact's spring in this impact, damping
                         // included, with its physical modulus; NaN if the law has no closed form
  double contact_force;  // [N] largest normal force so far, where breakage goes by force; else NaN
  bool at_wall;
};

/// What strength and load are measured in.
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
