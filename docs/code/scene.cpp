// silt - BSD-3-Clause, see LICENSE
//
// The scene of the tutorial (docs/tutorial.md), in the same order.

#include <silt/silt.hpp>

int main() {
  // 1. Materials: values without set_pair are for contacts with the same material.
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};
  const silt::HertzMindlin::Material steel{
      .youngs_modulus = 5e7, .poisson_ratio = 0.29, .restitution = 0.6, .friction = 0.3};
  silt::Contacts<silt::HertzMindlin, silt::RollingEpsd> contacts{glass, {.rolling_friction = 0.05}};
  contacts.set_pair(glass, steel, {.restitution = 0.7, .friction = 0.35});

  // 2. Particles: a lattice that falls, and one large grain.
  silt::Particles<silt::Sphere> grains;
  grains.fill(
      silt::CylinderRegion{{0, 0, 0.03}, {0, 0, 0.06}, 0.02},
      {.radius = silt::normal(1.5e-3, 0.2e-3, 1.0e-3, 2.0e-3), .density = 2500, .count = 300});
  grains.add({.position = {0, 0, 0.07}, .radius = 5e-3, .density = 2500});

  // 3. The simulation: policies in any order, defaults for the rest.
  silt::Simulation sim{contacts, std::move(grains)};
  sim.gravity = {0, 0, -9.81};

  // 4. Walls: a steel drum that rotates about its axis, closed by a plane below.
  sim.add_wall(silt::Cylinder{{0, 0, 0}, {0, 0, 0.1}, 0.02, silt::Side::Inside}, steel,
               silt::rotation({0, 0, 0}, {0, 0, 1}, 5.0));
  const auto floor = sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, steel);

  // 5. Openings: grains that leave through the top are counted; new ones are added at a rate.
  const auto top = sim.add_outlet({{-1, -1, 0.11}, {1, 1, 1}});
  sim.add_inlet(silt::CylinderRegion{{0, 0, 0.08}, {0, 0, 0.095}, 0.015},
                {.radius = 1.2e-3, .density = 2500, .rate = 500, .total = 20});

  // 6. Limits: a run that exceeds one is stopped with a message.
  sim.guard.max_overlap = 0.2;
  sim.guard.domain = silt::Box{{-0.03, -0.03, -0.01}, {0.03, 0.03, 1}};

  // 7. The run, and its output.
  std::vector<std::string> odd;  // what silt finds odd about the scene: nothing
  sim.run(
      0.1, silt::vtk_series("drum", silt::every(0.02)),
      silt::table("drum/energy.csv", {"time [s]", "kinetic energy [J]", "force on the floor [N]"},
                  silt::every(0.005),
                  [floor](const auto& s) {
                    return std::array{s.time(), s.kinetic_energy(), s.wall(floor).force.z};
                  }),
      silt::checkpoints("drum/checkpoint.silt", silt::every(0.05)),
      silt::on_warnings([&odd](const std::string& sentence) { odd.push_back(sentence); }));

  // 8. Reading results.
  return sim.outlet(top).count == 0 && sim.size() == 321 && odd.empty() ? 0 : 1;
}
