// silt - BSD-3-Clause, see LICENSE
// Spheres: precision, materials, domain, search, integrator, walls, openings.

#include "scene_hash.hpp"

namespace {

using Law = silt::HertzMindlin;
const Law::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.7, .friction = 0.4};
const Law::Material steel{
    .youngs_modulus = 5e7, .poisson_ratio = 0.29, .restitution = 0.6, .friction = 0.3};

silt::Particles<silt::Sphere> grains(std::size_t count) {
  silt::Particles<silt::Sphere> all;
  all.fill({{0, 0, 0}, {0.02, 0.02, 0.03}},
           {.radius = silt::uniform(0.8e-3, 1.2e-3), .density = 2500, .count = count});
  return all;
}

template <class... Policies>
auto in_box(std::size_t count, const Policies&... policies) {
  silt::Simulation sim{grains(count), policies...};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.05}), glass);
  return sim;
}

auto several_materials() {
  silt::Contacts<Law, silt::SeveralMaterials> contacts{{glass, steel}};
  contacts.set_pair(glass, steel, {.restitution = 0.7, .friction = 0.35});
  silt::Particles<silt::Sphere> all;
  all.fill({{0, 0, 0.002}, {0.02, 0.02, 0.02}},
           {.radius = 0.8e-3, .density = 2500, .count = 500, .material = contacts.add(glass)});
  all.add({.position = {0.01, 0.01, 0.03},
           .radius = 3e-3,
           .density = 7800,
           .velocity = {0, 0, -1},
           .material = contacts.add(steel)});
  all.add({.position = {0.01, 0.01, 0},
           .radius = 1.5e-3,
           .density = 7800,
           .material = 1,
           .fixed = true});
  silt::Simulation sim{std::move(all), contacts,
                       silt::PeriodicBox{{{0, 0, -0.01}, {0.02, 0.02, 0.05}}, {true, true, false}}};
  sim.gravity = {1, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, steel);
  return sim;
}

/// A rotating cylinder, a cone, an oscillating mesh, an inlet and an outlet.
auto openings() {
  silt::Simulation sim{grains(200),
                       silt::Contacts<Law, silt::RollingEpsd>{glass, {.rolling_friction = 0.05}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cylinder{{0.01, 0.01, -0.1}, {0.01, 0.01, 0.2}, 0.016, silt::Side::Inside},
               glass, silt::rotation({0.01, 0.01, 0}, {0, 0, 1}, 5.0));
  std::vector<std::array<silt::Vec3d, 3>> plate;
  for (int k = 0; k < 4; ++k) {
    const auto corner = [](int n) {
      return silt::Vec3d{0.01 + 0.02 * (n % 4 == 0 || n % 4 == 3 ? -1 : 1),
                         0.01 + 0.02 * (n % 4 < 2 ? -1 : 1), -0.002};
    };
    plate.push_back({corner(k), corner(k + 1), silt::Vec3d{0.01, 0.01, -0.004}});
  }
  sim.add_wall(silt::TriangleMesh(plate), glass, silt::vibration({0, 0, 1}, 0.5e-3, 30));
  sim.add_outlet({{0.014, -1, -1}, {1, 1, 0.0005}});
  sim.add_inlet(
      silt::Box{{0.005, 0.005, 0.035}, {0.015, 0.015, 0.045}},
      {.radius = 1e-3, .density = 2500, .rate = 2000, .velocity = {0, 0, -0.5}, .total = 60});
  return sim;
}

}  // namespace

void hashes::spheres() {
  using silt::Contacts;
  print("spheres", 0.05, [] { return in_box(600, Contacts<Law>{glass}); });
  print("spheres, ledger", 0.05,
        [] { return in_box(600, Contacts<Law>{glass}, silt::EnergyLedger{}); });
  print("spheres, mixed", 0.05, [] { return in_box(600, Contacts<Law>{glass}, silt::Mixed{}); });
  print("spheres, one lane", 0.03,
        [] { return in_box(400, Contacts<Law>{glass}, silt::KernelsFor<silt::OneLane>{}); });
  print("spheres, rolling, mixed", 0.05, [] {
    return in_box(600, Contacts<Law, silt::RollingEpsd>{glass, {.rolling_friction = 0.05}},
                  silt::Mixed{});
  });
  print("spheres, Gear", 0.03, [] { return in_box(400, Contacts<Law>{glass}, silt::Gear{}); });
  print("spheres, NBS", 0.02, [] { return in_box(400, Contacts<Law>{glass}, silt::Nbs{}); });
  print("spheres, hashed lists", 0.03, [] {
    return in_box(400, Contacts<Law>{glass}, silt::VerletList<silt::HashedGrid>{.skin = 0.1e-3});
  });
  print("materials, periodic, fixed", 0.05, several_materials);
  print("openings, moving walls", 0.1, openings);
}
