// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <numbers>

#include <silt/coupling/heat_exchange.hpp>
#include <silt/module/heat/surroundings.hpp>

namespace silt::inline SILT_TARGET {

/// Part of Heat: two-way heat exchange between particles and the fluid of a CoupledFlow.
///
///   flow.set_heat({.heat_capacity = 1005, .conductivity = 0.026});
///   silt::Simulation sim{std::move(grains), contacts,
///                        silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow},
///                        silt::Heat{silt::HeatConduction{...},
///                        silt::FluidConvection<silt::Gunn>{}}};
///
///   h = Nu k/d,  Q = h pi d^2 (T_fluid - T),  Re = e |u - v| d rho/mu,  Pr = mu c/k            (1)
///
/// Temperature, void fraction e and velocity u at the particle are interpolated by the coupling's
/// averaging mode, and the heat is taken from the same cells with the same weights. ParticleHeat
/// describes the method and why no step is too long. Temperatures of particles advance by a whole
/// fluid step at once; the fluid is ahead of the particles by up to one of its steps. For bodies d
/// and the surface are those of the sphere of equal volume.
///
/// Source: as RanzMarshall and Gunn. Tests: tests/coupling/heat.cpp, heat_simulation.cpp.
/// Valid:  as its Nusselt number.
/// Units:  SI.
/// Errors: does not compile without a CoupledFlow; InputError if its flow has no heat.
template <class Nusselt = Gunn>
struct FluidConvection {
  /// [W/K]
  double conductance(const Seen&, const HeatedFluid& f) const {
    const double Nu = Nusselt::nusselt(f.voidage * f.reynolds(), f.prandtl(), f.voidage);
    return Nu * f.conductivity * std::numbers::pi * f.diameter;
  }
  // No other heat.
  double watts(const Seen&, double, double, double) const { return 0; }
  double slope(const Seen&, double) const { return 0; }
  void check() const {}
};

}  // namespace silt
