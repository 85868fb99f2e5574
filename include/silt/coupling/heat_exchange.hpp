// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <span>

#include <silt/core/vec3.hpp>
#include <silt/fluid/properties.hpp>

namespace silt::inline SILT_TARGET {

/// Fluid around a particle, for heat exchange.
struct HeatedFluid {
  Vec3d slip;            // [m/s] of the fluid relative to the particle
  double voidage;        // [-]
  double density;        // [kg/m3]
  double viscosity;      // [Pa s]
  double heat_capacity;  // [J/(kg K)]
  double conductivity;   // [W/(m K)]
  double diameter;       // [m] of the particle; bodies: sphere of equal volume
  double prandtl() const { return viscosity * heat_capacity / conductivity; }
  double reynolds() const { return density * norm(slip) * diameter / viscosity; }
};

/// Heat exchange of particles with a fluid in its step. Over the step dt the temperature of each
/// particle follows its exponential with the fluid's temperature T_f at the end of the step,
/// averaged as its force:
///
///   q = b (T_f - T),  b = C/dt (1 - exp(-h A dt/C)),  T' = T + q dt/C                          (1)
///
/// The fluid's cells get sum w b (T - T_f) with the same weights, T_f implicit: heat is conserved
/// to rounding, and no step is too long, for any C. (1) is exact for constant T_f. The fluid's part
/// is first order in dt, and exact in steady state. A fixed particle with infinite C keeps its
/// temperature: b = h A.
/// Tests: tests/coupling/heat.cpp.
struct ParticleHeat {
  std::span<double> temperature;     // [K] changed by the step
  std::span<const double> capacity;  // [J/K] C > 0; infinite: constant temperature
  /// h A [W/K] of particle p; called by several threads at once.
  std::function<double(std::size_t p, const HeatedFluid&)> conductance;
  /// b [W/K].
  static double coefficient(double conductance, double capacity, double dt) {
    const double X = dt * conductance / capacity;
    return X > 0 ? capacity / dt * -std::expm1(-X) : conductance;
  }
};

}  // namespace silt
