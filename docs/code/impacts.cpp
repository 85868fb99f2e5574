// silt - BSD-3-Clause, see LICENSE
// The program of docs/contact_events.md: beads fall on a plate.

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

  const auto lift = [&sim] {  // [J]
    double sum = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k) sum += 9.81 * sim.mass(k) * sim.position(k).z;
    return sum;
  };
  const double before = lift();
  double hardest = 0;           // [N]
  double lost = 0;              // [J]
  std::map<int, int> spectrum;  // contacts by the decade of the energy that they lost [J]
  sim.run(0.1, silt::on_contact_end([&](const silt::ContactEvent& c) {
            hardest = std::max(hardest, c.largest_force);
            lost += c.lost_energy;
            if (c.lost_energy > 0)
              ++spectrum[static_cast<int>(std::floor(std::log10(c.lost_energy)))];
          }));

  double moving = 0;  // [J] without rotation
  for (std::size_t k = 0; k < sim.rows(); ++k)
    moving += 0.5 * sim.mass(k) * dot(sim.velocity(k), sim.velocity(k));
  const double missing = before - lift() - moving;  // what the beads fell and have no longer
  std::printf("largest force %.3g N, %.3g J lost\n", hardest, lost);
  for (const auto& [decade, count] : spectrum) std::printf("1e%d J and more: %d\n", decade, count);

  std::size_t hits = 0;  // of beads on walls
  sim.run(0.01, silt::on_contact_begin([&](const silt::ContactEvent& c) {
            if (c.wall != silt::no_wall) ++hits;
          }));
  std::printf("%zu contacts with walls began in the last 10 ms\n", hits);

  // Fails if losses are counted twice or not at all, or forces have another size: the missing
  // energy is dissipated, except for rotation and the losses of lasting contacts; the largest bead
  // hits a wall with 1 m/s after 5 cm, with 0.37 N by Hertz's law.
  const bool right = lost < missing && lost > 0.8 * missing && hardest > 0.05 && hardest < 0.37;
  if (!right)
    std::printf("wrong: expected were 80 to 100 %% of %.3g J and 0.05 to 0.37 N\n", missing);
  return right ? 0 : 1;
}
