// silt - BSD-3-Clause, see LICENSE
// Grains that break because the program asks for it: books, before the first step too; ids that
// cannot be.
#include <cmath>

#include <doctest/doctest.h>

#include <silt/module/charge/charge.hpp>
#include <silt/shape/laguerre_cells.hpp>
#include <silt/shape/polyhedron.hpp>

#include "breakage/scene.hpp"
#include "breakage/stones.hpp"
#include "near.hpp"
#include "refusal.hpp"

namespace breakage_asked_test {

using namespace breakage_scene;  // NOLINT: of this test alone
using silt_test::has, silt_test::refusal;

/// Breaks particle 0, which falls and turns, after a run of `first` [s]; none if it is negative.
template <class Grains>
auto broken_after(double first, Grains grains) {
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{salt},
                       silt::EnergyLedger{}, policy({.dust_below = 0.8e-3})};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 1e-7;
  if (first >= 0) sim.run(first);
  sim.break_particle(0);
  sim.run(0);
  sim.run(1e-5);
  CHECK(sim.broken() == 1);
  CHECK(sim.dust().mass() > 0);
  return sim.energy();
}
template <class Grains>
void check_books(const Grains& grains, double energy) {
  // Catches a ledger that begins after the break and books its dust as well: the residual is
  // that of the dust. And dust of a stone that is booked as if it had been at the stone's centre:
  // 1.7e-4 of the energy.
  const auto before = broken_after(-1, grains), at_once = broken_after(0, grains),
             later = broken_after(1e-6, grains);
  CHECK(before.initial == near(energy).epsilon(1e-12));
  CHECK(before.openings < -0.02 * energy);
  for (const auto& e : {before, at_once, later}) {
    CHECK(std::abs(e.residual()) < 2e-6 * energy);
    CHECK(e.initial == near(energy).epsilon(1e-12));
  }
  // The same break; half a step of free fall apart.
  CHECK(before.openings == near(at_once.openings).epsilon(1e-6));
  CHECK(std::abs(before.breaking - at_once.breaking) < 1e-6 * energy);
}

TEST_CASE("breakage as asked before the first step: the ledger begins with the whole grain") {
  silt::Particles<silt::Sphere> grains;
  grains.add({.position = {0, 0, 0.02},
              .radius = 1e-3,
              .density = 2165,
              .velocity = {1, 2, 3},
              .angular_velocity = {100, 50, -20}});
  grains.add({.position = {1, 0, 0}, .radius = 1e-3, .density = 2165, .velocity = {1, 2, 3}});
  const double m = 2165 * silt::sphere_volume(1e-3);
  check_books(grains, m * 14 + 0.2 * m * 1e-6 * (100 * 100 + 50 * 50 + 20 * 20) + m * 9.81 * 0.02);
}
TEST_CASE("breakage as asked before the first step: of a polyhedron") {
  silt::Particles<silt::Polyhedron> stones;
  const auto form = stones.add_form(stone());
  stones.add({.form = form, .position = {0, 0, 0}, .density = 2165, .velocity = {1, 2, 3}});
  const double m = 2165 * stone().mass_properties().volume;
  check_books(stones, m * 7);
}

TEST_CASE("breakage: fragments share what is of the whole grain, and have its temperature") {
  // Catches charge that each of ten fragments has whole, and a temperature that is divided.
  silt::Particles<silt::Sphere> grains;
  grains.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2165});
  silt::Simulation sim{
      std::move(grains),
      silt::Contacts<silt::HertzMindlin>{salt},
      silt::Charge{.cutoff = 5e-3},
      silt::Field<"moles">{.extensive = true},
      silt::Field<"temperature [K]">{},
      silt::Breakage{
          silt::WeibullStrength{.scale = 1e-6, .at_diameter = 2e-3, .exponent = 2, .modulus = 9},
          silt::EnergyEquivalence{},
          silt::GaudinSchuhmann{.exponent = 1, .coarsest = 0.8},
          silt::NoFatigue{},
          {.dust_below = 0.5e-3}}};
  sim.field<silt::ElectricCharge>(0) = 1e-12;
  sim.field<"moles">(0) = 3, sim.field<"temperature [K]">(0) = 400;
  const double m = sim.mass(0);
  sim.time_step = 1e-7;
  sim.break_particle(0);
  sim.run(1e-7);
  REQUIRE(sim.size() > 3);
  double charge = 0, moles = 0, mass = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    charge += sim.field<silt::ElectricCharge>(k), moles += sim.field<"moles">(k);
    mass += sim.mass(k);
    CHECK(sim.field<"temperature [K]">(k) == 400);
  }
  CHECK(mass < 0.9999 * m);  // the rest is dust, with its share
  CHECK(charge == near(1e-12 * mass / m).epsilon(1e-12));
  CHECK(moles == near(3 * mass / m).epsilon(1e-12));
}

TEST_CASE("breakage as asked: ids that cannot be") {
  auto sim = shower(2);
  sim.time_step = 1e-7;
  has(refusal([&] { sim.break_particle(2); }),
      "Simulation::break_particle: there is no particle 2; none has had this id so far");
  sim.break_particle(1);
  sim.run(1e-6);
  has(refusal([&] { sim.break_particle(1); }),
      "Simulation::break_particle: there is no particle 1 any more: it has broken, has left or was "
      "removed");
}

}  // namespace breakage_asked_test
