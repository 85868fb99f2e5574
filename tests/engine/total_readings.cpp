// silt - BSD-3-Clause, see LICENSE
// Sums and means over all particles, against values by hand and the energy ledger.
#include <cmath>
#include <cstddef>
#include <utility>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/module/heat/surroundings.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/sphere.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace total_readings_test {

using silt_test::has, silt_test::refusal;

const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};
const double pi = 3.14159265358979323846;

/// Of masses m and 8 m, and a fixed one.
silt::Particles<silt::Sphere> three() {
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 0},
         .radius = 1e-3,
         .density = 3 / (4 * pi) * 1e9,
         .velocity = {3, 0, 4},
         .angular_velocity = {0, 100, 0}});
  p.add({.position = {0.09, 0, 0},
         .radius = 2e-3,
         .density = 3 / (4 * pi) * 1e9,
         .velocity = {0, 1, 0}});
  p.add({.position = {0, 0.05, 0},
         .radius = 2e-3,
         .density = 1000,
         .velocity = {9, 0, 0},
         .fixed = true});
  return p;
}

// Catches a factor 1/2, an inertia of 2/3 m r^2, a fixed particle's infinite mass, and means that
// count it.
TEST_CASE("total readings: by hand") {
  silt::Simulation sim{three(), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::HeatConduction{.conductivity = 1, .heat_capacity = 800}};
  const double turning = 0.5 * 0.4 * 1e-6 * 1e4;  // [J]
  CHECK(sim.total_mass() == near(9));             // [kg]
  CHECK(sim.rotational_energy() == near(turning));
  CHECK(sim.kinetic_energy() == near(0.5 * 25 + 0.5 * 8 + turning));
  CHECK(sim.kinetic_energy(0) == near(0.5 * 25 + turning));
  CHECK(sim.kinetic_energy(2) == 0);
  CHECK(norm(sim.centre_of_mass() - silt::Vec3d{0.08, 0, 0}) < 1e-15);
  CHECK(norm(sim.mean_velocity() - silt::Vec3d{3.0 / 9, 8.0 / 9, 4.0 / 9}) < 1e-15);
  CHECK(sim.mean_speed() == near(3));
  CHECK(sim.largest_speed() == near(5));
  sim.field<silt::Temperature>(0) = 390, sim.field<silt::Temperature>(1) = 300;
  CHECK(sim.mean_temperature() == near(310));  // by capacity, not (390 + 300)/2
  sim.remove(0);
  CHECK(sim.total_mass() == near(8));
  CHECK(sim.largest_speed() == near(1));
  sim.remove(1);
  CHECK(sim.kinetic_energy() == 0);
  CHECK(sim.largest_speed() == 0);
  CHECK(has(refusal([&] { sim.centre_of_mass(); }), "Simulation::centre_of_mass: there is no "));
  CHECK(has(refusal([&] { sim.mean_temperature(); }), "Simulation::mean_temperature: there is no"));
  CHECK(has(refusal([&] { sim.mean_speed(); }), "Simulation::mean_speed"));
}

// Catches velocities of half a step ago.
TEST_CASE("total readings: of the present instant, as the ledger has them") {
  const silt::MultiSphere pair{.balls = {{{-1e-3, 0, 0}, 1e-3}, {{1e-3, 0, 0}, 1e-3}}};
  silt::Particles<silt::MultiSphere> p;
  const auto form = p.add_form(pair);
  for (int k = 0; k < 4; ++k)
    p.add({.form = form,
           .position = {0, 0, 2.1e-3 + 2.5e-3 * k},
           .radius = 2e-3,
           .density = 2500,
           .velocity = {0.1 * k, 0, 0},
           .angular_velocity = {50.0 * k, 20, 0}});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::EnergyLedger{}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  std::size_t seen = 0;
  sim.run(0.02, [&](const auto& now) {
    const auto e = now.energy();
    CHECK(now.kinetic_energy() == near(e.kinetic()).epsilon(1e-12));
    CHECK(now.rotational_energy() == near(e.rotation).epsilon(1e-12));
    ++seen;
  });
  CHECK(seen > 20);
  silt::Particles<silt::Sphere> one;
  one.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500});
  silt::Simulation falls{std::move(one), silt::Contacts<silt::HertzMindlin>{glass}};
  falls.gravity = {0, 0, -10};
  falls.time_step = 1e-5;
  falls.run(0.1);
  CHECK(falls.kinetic_energy() == near(0.5 * falls.total_mass()).epsilon(1e-12));
}

}  // namespace total_readings_test
