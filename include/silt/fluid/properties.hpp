// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <limits>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// An incompressible Newtonian fluid.
struct FluidProperties {
  double density = 0;                                           // [kg/m3] must be given
  double viscosity = std::numeric_limits<double>::quiet_NaN();  // [Pa s] must be given
};

/// Volume-averaged momentum equations, with the pressure p and the force f of the particles:
///   A           d(eps rho u)/dt + div(eps rho u u) = -eps grad p + eps div tau + f
///   B                                              =     -grad p +     div tau + f
///   Simplified  fluid alone (eps = 1); for dilute flow, solids below 1 %
enum class MomentumModel { A, B, Simplified };

}  // namespace silt
