// silt - BSD-3-Clause, see LICENSE
// A user-defined drag law, and one calibrated by a bed's minimum fluidisation: docs/fluid.md.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <silt/fluid.hpp>

/// Stokes' drag of a single sphere, and in suspensions Richardson and Zaki's slow settling: the
/// flux eps W = v_t eps^n. F_d/eps = V (rho_p - rho) g, so Fhat = v_t/W = eps^(1 - n).
struct OwnDrag {
  double exponent = 4.65;  // [-] n

  template <class Real>
  Real normalised(const Real& eps, const Real&) const {
    return silt::power(eps, Real(1 - exponent));
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

  // Suspensions of such grains settle in a closed vessel with v_t eps^4.65 (Richardson and Zaki).
  const double Ar = silt::archimedes_number(1e-4, 2500, 900, 0.05);
  double worst = 0;
  for (const double eps : {0.9, 0.7, 0.5}) {
    const double flux = silt::balance_reynolds(OwnDrag{}, eps, Ar) / (Ar / 18);  // [-] over v_t
    std::printf("eps = %.1f: settles with %.4f of that (eps^4.65 = %.4f)\n", eps, flux,
                std::pow(eps, 4.65));
    worst = std::max(worst, std::abs(flux / std::pow(eps, 4.65) - 1));
  }

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
  // sign or is 2 - n (flux v_t eps^3.65: 11 % too fast at eps = 0.9, twice at 0.5), or if the
  // calibration does not reproduce the bed.
  const bool right = std::abs(-sim.velocity(0).z / stokes - 1) < 0.01 && worst < 1e-6 &&
                     std::abs(borne - 1) < 1e-9;
  if (!right)
    std::printf(
        "wrong: Stokes' velocity to 1 %%, Richardson and Zaki's power to 1e-6, and all of "
        "the bed must be borne\n");
  return right ? 0 : 1;
}
