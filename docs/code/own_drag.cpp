// silt - BSD-3-Clause, see LICENSE
// A user-defined drag law, and one calibrated by a bed's minimum fluidisation: docs/fluid.md.

#include <cmath>
#include <cstdio>
#include <utility>

#include <silt/fluid.hpp>

/// Stokes' drag of a lone sphere with Richardson and Zaki's exponent of slow settling.
struct OwnDrag {
  double exponent = 4.65;  // [-]

  template <class Real>
  Real normalised(const Real& eps, const Real&) const {
    return silt::power(eps, Real(2 - exponent));
  }
};

int main() {
  // A grain falls through a liquid at rest: alone, its voidage is 1 but for its own cells.
  silt::Particles<silt::Sphere> grain;
  grain.add({.position = {0.01, 0.01, 0.018}, .radius = 50e-6, .density = 2500});
  silt::FlowSolver oil(silt::Grid({{0, 0, 0}, {0.02, 0.02, 0.02}}, {8, 8, 8}, {true, true, true}),
                       {.density = 900, .viscosity = 0.05});
  silt::Simulation sim{
      std::move(grain),
      silt::Contacts<silt::HertzMindlin>{{.youngs_modulus = 1e6, .poisson_ratio = 0.3}},
      silt::CoupledFlow{OwnDrag{}, silt::Kernel{}, oil}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 2e-6;
  sim.run(2e-3);
  const double stokes = (2500 - 900) * 9.81 * 1e-4 * 1e-4 / (18 * 0.05);
  std::printf("settles at %.4e m/s (Stokes: %.4e m/s)\n", -sim.velocity(0).z, stokes);

  // A measured bed: grains of 0.3 mm begin to move at 0.09 m/s, with a voidage of 0.43.
  const silt::MinimumFluidisation bed{.velocity = 0.09,
                                      .voidage = 0.43,
                                      .diameter = 0.3e-3,
                                      .particle_density = 2500,
                                      .fluid = {.density = 1.2, .viscosity = 1.8e-5}};
  const auto law = silt::SyamlalOBrien::calibrated(bed);
  const double Re = 1.2 * 0.09 * 0.3e-3 / 1.8e-5;
  const double borne = law.normalised(0.43, Re) / bed.normalised_drag(),
               as_printed = silt::SyamlalOBrien{}.normalised(0.43, Re) / bed.normalised_drag();
  std::printf("c1 = %.3f, d1 = %.2f: bears %.4f of the bed; c1 = 0.8 bears %.2f\n", law.c1, law.d1,
              borne, as_printed);

  // Fails if the law is not used (no drag: 0.0196 m/s after 2 ms), if the exponent has the wrong
  // sign, or if the calibration does not reproduce the bed.
  const bool right = std::abs(-sim.velocity(0).z / stokes - 1) < 0.01 && std::abs(borne - 1) < 1e-9;
  if (!right) std::printf("wrong: Stokes' velocity to 1 %%, and all of the bed must be borne\n");
  return right ? 0 : 1;
}
