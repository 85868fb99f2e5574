// silt - BSD-3-Clause, see LICENSE
// Bonds that the user breaks, and the step of a simulation in which only bonds give one.
//   a bond that is gone without a word: not counted, not booked, and its pair never touches
//   a request that a checkpoint forgets
#include <cmath>
#include <filesystem>
#include <vector>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/bond_observers.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/module/body_force.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace unbond_test {

using silt::Vec3d;
constexpr double R = 1e-3;
const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
const silt::Bonds glue{silt::ParallelBond{.youngs_modulus = 1e7, .damping = 0}};

/// A fibre of four that hangs from a ceiling, stretched by its weight; an undamped one.
auto hanging() {
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       glue, silt::EnergyLedger{}};
  sim.add_wall(silt::Plane{{0, 0, R}, {0, 0, -1}}, glass, {.name = "ceiling"});
  add_bonded(sim, silt::fibre({0, 0, 0}, {0, 0, -6 * R}, 4, {.radius = R, .density = 2000}));
  sim.bond_to_wall(0, "ceiling", {0, 0, R});
  sim.gravity = {0, 0, -9.81}, sim.threads = 1, sim.time_step = 5e-7;
  return sim;
}

TEST_CASE("unbond: the bond breaks in the next step, is reported, counted and booked") {
  auto sim = hanging();
  sim.run(1e-3);
  const double stored = sim.bond_energy();
  CHECK(stored > 0);
  sim.unbond(2, 1);
  CHECK(sim.bonded(1, 2));
  std::vector<silt::BondBreak> told;
  const auto listen = silt::on_bond_break([&](const silt::BondBreak& b) { told.push_back(b); });
  sim.run(5e-7, listen);
  REQUIRE(told.size() == 1);
  CHECK(told[0].a == 1);
  CHECK(told[0].b == 2);
  CHECK(told[0].load < 1);
  CHECK(told[0].energy > 0);
  CHECK_FALSE(sim.bonded(1, 2));
  CHECK(sim.bonds() == 3);
  CHECK(sim.broken_bonds() == 1);
  CHECK(silt::fragments(sim).bonded() == 2);
  CHECK(sim.energy().bond_breaking == near(told[0].energy).epsilon(1e-9));
  sim.unbond_from_wall(0, "ceiling");
  sim.run(5e-7, listen);
  CHECK(told.size() == 2);
  CHECK(sim.bonds() == 2);
  sim.run(5e-6);  // the last force of a broken bond acts until the middle of the next step
  const auto e = sim.energy();
  CHECK(std::abs(e.residual()) < 5e-4 * stored);  // second order in the step
  CHECK(silt_test::has(silt_test::refusal([&] { sim.unbond(1, 2); }),
                       "particles 1 and 2 are not bonded"));
  CHECK(silt_test::has(silt_test::refusal([&] { sim.unbond_from_wall(0, "ceiling"); }),
                       "particle 0 has no bond to wall 0 'ceiling'"));
}

TEST_CASE("unbond: in an observer, by a criterion of one's own; the pair meets again as contact") {
  auto sim = hanging();
  sim.run(1e-3, silt::at(silt::every(1e-4), [&](const auto& now) {
            if (now.time() > 4.5e-4 && now.bonded(0, 1)) sim.unbond(0, 1);
          }));
  CHECK(sim.broken_bonds() == 1);
  sim.set_velocity(1, {0, 0, 1});
  double most = 0;
  for (int k = 0; k < 200; ++k) {
    sim.run(2e-6);
    most = std::max(most, sim.velocity(sim.find(0)).z);
  }
  CHECK(most > 0.05);  // a contact pushed it
}

TEST_CASE("unbond: a checkpoint keeps what is to break") {
  const auto path = (std::filesystem::temp_directory_path() / "unbond.silt").string();
  auto one = hanging(), other = hanging();
  one.run(1e-3);
  one.unbond(0, 1), one.unbond_from_wall(0, "ceiling");
  save_checkpoint(one, path);
  load_checkpoint(other, path);
  one.run(1e-4), other.run(1e-4);
  CHECK(other.broken_bonds() == 2);
  CHECK(other.position(0).z == one.position(0).z);
  CHECK(other.energy().bond_breaking == one.energy().bond_breaking);
  std::filesystem::remove(path);
}

#ifdef SILT_LONG_TESTS
TEST_CASE("bonds: they alone set the step where nothing moves yet and there is no gravity") {
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       glue, silt::BodyForce{[](const silt::Seen& p) {
                         return Vec3d{0, 0, p.id == 1 ? 1e-3 : 0.0};
                       }}};
  auto pair = silt::fibre({0, 0, 0}, {0, 0, 2 * R}, 2, {.radius = R, .density = 2000});
  pair.spheres[0].fixed = true;
  add_bonded(sim, pair);
  sim.threads = 1;
  sim.run(1e-3);
  const double k = 1e7 * 3.141592653589793 * R * R / (2 * R);
  // Undamped: it swings between 0 and twice the stretch at rest.
  CHECK(sim.position(1).z > 2 * R);
  CHECK(sim.position(1).z < 2 * R + 2.1 * 1e-3 / k);
  CHECK(silt_test::has(silt_test::refusal([] {
                         silt::Simulation loose{silt::Particles<silt::Sphere>{},
                                                silt::Contacts<silt::HertzMindlin>{glass}, glue};
                         silt::Particles<silt::Sphere> p;
                         p.add({.position = {0, 0, 0}, .radius = R, .density = 2000});
                         loose.add(p), loose.run(1e-3);
                       }),
                       "nothing moves and there is no gravity"));
}
#endif

}  // namespace unbond_test
