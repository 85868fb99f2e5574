// silt - BSD-3-Clause, see LICENSE
// The program of docs/cells.md, Cemented samples.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material grain{
      .youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.1};
  const double d = 1e-3, density = 2500, preload = 1e4, lateral = 5e4;  // [m], [kg/m3], [Pa]
  const double t = d * std::sqrt(density / preload);                    // [s]
  const silt::Box space{{0, 0, 0}, {9 * d, 9 * d, 9 * d}};
  silt::Particles<silt::Sphere> sand;
  sand.fill(space, {.radius = silt::uniform(0.4 * d, 0.6 * d),
                    .density = density,
                    .count = 300,
                    .arrangement = silt::Arrangement::Random});

  silt::Simulation sim{std::move(sand), silt::Contacts<silt::HertzMindlin>{grain},
                       silt::DeformingBox{space},
                       silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e8,
                                                      .tensile_strength = 3e5,
                                                      .shear_strength = 3e5,
                                                      .friction_angle = 0.5,
                                                      .damping = 0.2,
                                                      .weibull_modulus = 5}}};
  const auto held_at = [&](double stress) {
    return silt::BoxDrive{.stress = stress, .most_rate = 0.05 / t};
  };
  sim.deform({.x = held_at(preload), .y = held_at(preload), .z = held_at(preload)});
  sim.run(60 * t);
  silt::bond_near(sim, 0.05 * d);  // [m] between surfaces
  sim.deform({.x = held_at(lateral), .y = held_at(lateral), .z = held_at(lateral)});
  sim.run(20 * t);

  const double rate = 2e-3 / t;  // [1/s]
  const std::size_t made = sim.bonds();
  double peak = 0, sides = 0, samples = 0;
  sim.deform({.x = held_at(lateral), .y = held_at(lateral), .z = {.rate = -rate}});
  sim.run(0.025 / rate, silt::at(silt::every(5e-5 / rate), [&](const auto& now) {
            const silt::BoxStress& s = now.domain().stress();
            peak = std::max(peak, s.z - (s.x + s.y) / 2);
            sides += (s.x + s.y) / 2, samples += 1;
          }));
  const double broken = double(sim.broken_bonds()) / double(made);
  std::printf("lateral %.0f Pa, peak of the difference %.0f kPa, %.0f %% of %zu bonds broken\n",
              sides / samples, peak / 1e3, 100 * broken, made);

  // Fails for a servo that loses the sample as it breaks, and for bonds without strength (about
  // 60 kPa) or without a limit (nothing broken).
  if (std::abs(sides / samples / lateral - 1) < 0.03 && peak > 3e5 && broken > 0.2) return 0;
  std::printf("wrong: 50000 Pa, more than 300 kPa and a fifth of the bonds were expected\n");
  return 1;
}
