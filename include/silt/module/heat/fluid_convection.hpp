// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <numbers>

#include <silt/coupling/heat_exchange.hpp>
#include <silt/module/heat/surroundings.hpp>

namespace silt::inline SILT_TARGET {

/// Part of Heat: particles exchange heat with the fluid of a CoupledFlow, which they heat or cool.
///
///   flow.set_heat({.heat_capacity = 1005, .conductivity = 0.026});
///   silt::Simulation sim{std::move(grains), contacts,
///                        silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow},
///                        silt::Heat{silt::HeatConduction{...},
///                        silt::FluidConvection<silt::Gunn>{}}};
///
///   h = Nu k/d,  Q = h pi d^2 (T_fluid - T),  Re = e |u - v| d rho/mu,  Pr = mu c/k            (1)
///
/// Temperature, voidage e and velocity u are those at the particle, found by the coupling's
/// averaging mode, and what the particle gains is taken from the same cells with the same weights:
/// ParticleHeat says how, and why no step is too long. In each fluid step temperatures of particles
/// come to its end at once; the fluid is ahead of the particles by up to one of its steps. Of
/// bodies d is the diameter of a sphere of their volume, and the surface that of this sphere.
///
/// Source: as RanzMarshall and Gunn. Tests: tests/coupling/heat.cpp, heat_simulation.cpp.
/// Valid:  as its Nusselt number.
/// Units:  SI.
/// Errors: does not compile without a CoupledFlow; InputError where its flow has no heat.
template <class Nusselt = Gunn>
struct FluidConvection {
  /// [W/K]
  double conductance(const Seen&, const HeatedFluid& f) const {
    const double Nu = Nusselt::nusselt(f.voidage * f.reynolds(), f.prandtl(), f.voidage);
    return Nu * f.conductivity * std::numbers::pi * f.diameter;
  }
  // Nothing besides.
  double watts(const Seen&, double, double, double) const { return 0; }
  double slope(const Seen&, double) const { return 0; }
  void check() const {}
};

}  // namespace silt
