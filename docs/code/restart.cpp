// silt - BSD-3-Clause, see LICENSE
// A settled bed is continued with changes: docs/restart.md.

#include <cmath>
#include <cstdio>
#include <utility>

#include <silt/silt.hpp>

const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e6, .poisson_ratio = 0.3, .friction = 0.5};

/// The scene; `lid`: with a wall that was not in the first run.
auto scene(const silt::HertzMindlin::Material& grains, bool lid) {
  silt::Particles<silt::Sphere> beads;
  beads.fill({.min = {0, 0, 0}, .max = {0.01, 0.01, 0.04}},
             {.radius = 1e-3, .density = 2500, .count = 120});
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{grains}};
  sim.add_wall(silt::box({0, 0, 0}, {0.01, 0.01, 0.2}), grains);
  if (lid) sim.add_wall(silt::Plane{{0, 0, 0.06}, {0, 0, -1}}, grains);
  sim.gravity = {0, 0, -9.81};
  return sim;
}

int main() {
  auto settled = scene(glass, false);
  settled.run(0.4);
  silt::save_checkpoint(settled, "settled.silt");

  // Smoother grains, a lid, half of the gravity, another time step, and three more grains.
  auto smooth = glass;
  smooth.friction = 0.1;
  auto sim = scene(smooth, true);
  silt::load_checkpoint(sim, "settled.silt", {.materials = true, .walls = true});
  sim.gravity = {0, 0, -9.81 / 2};
  sim.time_step = 0.5 * settled.step_length();
  silt::Particles<silt::Sphere> more;
  for (int k = 0; k < 3; ++k)
    more.add({.position = {2e-3 + 3e-3 * k, 5e-3, 0.05}, .radius = 1e-3, .density = 2500});
  sim.add(more);  // ids 120, 121, 122
  sim.run(0.8);

  double weight = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) weight += 0.5 * 9.81 * sim.mass(k);
  std::printf("t = %.1f s, %zu grains, the floor bears %.4f of their weight\n", sim.time(),
              sim.size(), -sim.wall(0).force.z / weight);
  // Fails if changes have no effect: gravity (the floor would carry twice as much), added grains
  // (2.5 % less) or their ids.
  const bool right = std::abs(-sim.wall(0).force.z / weight - 1) < 0.01 && sim.size() == 123 &&
                     sim.find(122) < sim.rows() && sim.step_length() == 0.5 * settled.step_length();
  if (!right) std::printf("wrong: the floor must bear the weight, to 1 %%, of 123 grains\n");
  return right ? 0 : 1;
}
