// silt - BSD-3-Clause, see LICENSE
// The program of docs/energy.md.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e7, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};
  silt::Particles<silt::Sphere> beads;
  beads.fill({{0, 0, 0}, {0.02, 0.02, 0.04}},
             {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500, .count = 500});

  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::EnergyLedger{}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.05}), glass);
  const auto lift = [&sim] {  // [J]
    double sum = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k) sum += 9.81 * sim.mass(k) * sim.position(k).z;
    return sum;
  };
  const double before = lift();
  sim.run(0.1);

  const silt::EnergyBalance e = sim.energy();
  std::printf("kinetic %.3g, in contacts %.3g, dissipated %.3g J: dashpots %.3g, friction %.3g\n",
              e.kinetic(), e.elastic(), e.dissipated(), e.normal_damping + e.tangential_damping,
              e.friction);
  std::printf("unexplained: %.1e of what contacts turned over\n", e.residual() / e.turned_over);

  // Fails if a loss is booked twice or not at all (the potential energy lost by the beads, computed
  // here from their heights, must equal what they store and have dissipated), or if a gain is
  // booked as a loss.
  const double fell = before - lift(), found = e.kinetic() + e.elastic() + e.dissipated();
  if (std::abs(e.residual() / e.turned_over) < 2e-3 && std::abs(found / fell - 1) < 0.01 &&
      e.normal_damping > 0 && e.tangential_damping > 0 && e.friction > 0)
    return 0;
  std::printf(
      "wrong: the beads fell by %.4g J and hold and lost %.4g J (1 %% apart at most), with at "
      "most 2e-3 unexplained, each loss above 0\n",
      fell, found);
  return 1;
}
