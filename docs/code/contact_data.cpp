// silt - BSD-3-Clause, see LICENSE
// The program of docs/contact_data.md: grains in a small silo.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.3, .friction = 0.4};
  silt::Particles<silt::Sphere> beads;
  beads.fill({{-7e-3, -7e-3, 0}, {7e-3, 7e-3, 0.08}},
             {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500, .count = 1500});
  const std::size_t mantle = 0, floor = 1;
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cylinder{{0, 0, -5e-3}, {0, 0, 0.095}, 10e-3, silt::Side::Inside}, glass);
  // The floor sinks by 1 mm/s, so that friction at the mantle holds the grains.
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass, silt::translation({0, 0, -1e-3}));

  sim.run(0.4, silt::contact_series("contact_data", silt::every(0.1)));

  double strongest = 0, on_floor = 0;  // [N]
  sim.for_each_contact([&](const silt::ContactSeen& c) {
    strongest = std::max(strongest, c.normal_force);
    if (c.wall == floor) on_floor += c.force.z;
  });

  const auto z = silt::coordination(sim);
  const auto fabric = silt::fabric(sim, silt::Box{{-6e-3, -6e-3, 3e-3}, {6e-3, 6e-3, 15e-3}});
  const auto stress = silt::stress(sim, {{-5e-3, -5e-3, 4e-3}, {5e-3, 5e-3, 12e-3}});
  const auto rings = silt::ring_loads(sim, mantle, 10);  // from the floor up
  const auto loads = silt::contact_loads(sim);

  double weight = 0, borne = 0, by_contacts = 0;  // [N]
  for (std::size_t k = 0; k < sim.rows(); ++k)
    weight += 9.81 * sim.mass(k), by_contacts += loads[k].force.z;
  for (const silt::WallPart& ring : rings) borne -= ring.force.z;
  std::printf("floor %.3g N, mantle %.3g N, weight %.3g N; strongest contact %.3g N\n", on_floor,
              borne, weight, strongest);
  std::printf("%.2f partners a grain, %.2f without %zu rattlers; fabric zz %.3f\n", z.mean,
              z.without_rattlers, z.rattlers, fabric.zz);
  std::printf("stress zz %.3g Pa, pressure on the lowest ring %.3g Pa\n", stress.contact.zz,
              rings[0].pressure());

  // Fails if forces are of another step, or contacts are left out or counted twice: the loads on
  // floor and mantle are the sums over contacts, and together the weight.
  const bool right = std::abs(on_floor + borne - by_contacts) < 1e-9 * weight &&
                     std::abs(by_contacts / weight - 1) < 0.01 &&
                     std::abs(fabric.trace() - 1) < 1e-9 && z.without_rattlers >= z.mean;
  if (!right) std::printf("wrong: expected were %.5g N on floor and mantle\n", weight);
  return right ? 0 : 1;
}
