// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <span>

#include <silt/core/vec3.hpp>
#include <silt/fluid/properties.hpp>

namespace silt::inline SILT_TARGET {

/// The fluid around a particle, as its heat is concerned.
struct HeatedFluid {
  Vec3d slip;            // [m/s] of the fluid against the particle
  double voidage;        // [-]
  double density;        // [kg/m3]
  double viscosity;      // [Pa s]
  double heat_capacity;  // [J/(kg K)]
  double conductivity;   // [W/(m K)]
  double diameter;       // [m] of the particle; of bodies that of a sphere of their volume
  double prandtl() const { return viscosity * heat_capacity / conductivity; }
  double reynolds() const { return density * norm(slip) * diameter / viscosity; }
};

/// The heat that particles exchange with a fluid in its step. Over the step dt each follows its
/// exponential in the fluid's temperature T_f at the step's end, averaged as its force is:
///
///   q = b (T_f - T),  b = C/dt (1 - exp(-h A dt/C)),  T' = T + q dt/C                          (1)
///
/// and the fluid's cells get sum w b (T - T_f) with the same weights, T_f implicit: what particles
/// gain the fluid loses, to rounding, and no step is too long, however small C is. For a T_f that
/// stays what it is, (1) is exact; the fluid's part is of first order in dt, and exact where it
/// is steady. A fixed particle with an infinite C keeps its temperature: b = h A.
/// Tests: tests/coupling/heat.cpp.
struct ParticleHeat {
  std::span<double> temperature;     // [K] changed by the step
  std::span<const double> capacity;  // [J/K] C > 0; infinite: the temperature is held
  /// h A [W/K] of particle p; called by several threads at once.
  std::function<double(std::size_t p, const HeatedFluid&)> conductance;
  /// b [W/K].
  static double coefficient(double conductance, double capacity, double dt) {
    const double X = dt * conductance / capacity;
    return X > 0 ? capacity / dt * -std::expm1(-X) : conductance;
  }
};

}  // namespace silt
