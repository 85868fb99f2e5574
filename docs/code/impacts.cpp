// silt - BSD-3-Clause, see LICENSE
// The program of docs/contact_events.md: beads rain on a plate.

#include <cmath>
#include <cstdio>
#include <map>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e7, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};
  silt::Particles<silt::Sphere> beads;
  beads.fill({{0, 0, 0.01}, {0.02, 0.02, 0.05}},
             {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500, .count = 200});

  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::ContactEvents{}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.05}), glass);

  double hardest = 0;           // [N]
  double lost = 0;              // [J]
  std::map<int, int> spectrum;  // contacts by the decade of the energy that they lost [J]
  sim.run(0.1, silt::on_contact_end([&](const silt::ContactEvent& c) {
            hardest = std::max(hardest, c.largest_force);
            lost += c.lost_energy;
            if (c.lost_energy > 0)
              ++spectrum[static_cast<int>(std::floor(std::log10(c.lost_energy)))];
          }));

  std::printf("largest force %.3g N, %.3g J lost\n", hardest, lost);
  for (const auto& [decade, count] : spectrum) std::printf("1e%d J and more: %d\n", decade, count);

  std::size_t hits = 0;  // of beads on walls
  sim.run(0.01, silt::on_contact_begin([&](const silt::ContactEvent& c) {
            if (c.wall != silt::no_wall) ++hits;
          }));
  std::printf("%zu contacts with walls began in the last 10 ms\n", hits);

  // A bead of 1 mm that falls 5 cm hits with some 1 m/s and 1e-5 J: catches forces and energies of
  // another magnitude, and events that never come.
  const bool right =
      hardest > 0.05 && hardest < 5 && lost > 1e-5 && lost < 5e-3 && !spectrum.empty();
  if (!right) std::printf("wrong: a force of 0.05 to 5 N and 1e-5 to 5e-3 J were expected\n");
  return right ? 0 : 1;
}
