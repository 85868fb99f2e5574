// silt - BSD-3-Clause, see LICENSE
//
// silt/declare_simulation.hpp: every part that it declares is there and can be compiled apart. Wrong
// result caught: a member that has moved, after which no program with silt::precompiled compiles.

#include <doctest/doctest.h>

#include <silt/declare_simulation.hpp>

SILT_DECLARE_SIMULATION(silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin>)
SILT_INSTANTIATE_SIMULATION(silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin>)

TEST_CASE("A simulation that is declared and compiled apart runs") {
  using namespace silt;
  const HertzMindlin::Material glass{
      .youngs_modulus = 5e7, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};
  Particles<Sphere> beads;
  for (const double z : {4e-3, 5.9e-3})  // overlap 0.1 mm
    beads.add({.position = {5e-3, 5e-3, z}, .radius = 1e-3, .density = 2500});
  Simulation sim{std::move(beads), Contacts<HertzMindlin>{glass}};
  sim.add_wall(box({0, 0, 0}, {0.01, 0.01, 0.02}), glass);
  sim.gravity = {0, 0, -10};
  CHECK(scene_warnings(sim).empty());
  sim.run(1e-5);
  CHECK(sim.touching_pairs() == 1);
  // Equal masses: their centre falls freely. 1e-6: 5e-10 m are the difference of two 5e-3, exact to 1e-18.
  const double fallen = 4.95e-3 - (sim.position(0).z + sim.position(1).z) / 2;
  CHECK(fallen == doctest::Approx(0.5 * 10 * sim.time() * sim.time()).epsilon(1e-6));
}
