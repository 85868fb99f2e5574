// silt - BSD-3-Clause, see LICENSE
// Polyhedra that break into cells which fill them.
#include <algorithm>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include <silt/shape/laguerre_cells.hpp>
#include <silt/shape/polyhedron.hpp>

#include "breakage/scene.hpp"
#include "breakage/stones.hpp"
#include "near.hpp"

namespace breakage_polyhedra_test {

using namespace breakage_scene;  // NOLINT: of this test alone
using Stones = silt::Particles<silt::Polyhedron>;

auto simulation_of(Stones stones, Policy of) {
  return silt::Simulation{std::move(stones), silt::Contacts<silt::HertzMindlin>{salt},
                          silt::EnergyLedger{}, std::move(of)};
}
struct Moments {
  double mass = 0;
  Vec3d momentum{0, 0, 0}, angular{0, 0, 0}, first{0, 0, 0};
};
template <class Sim>
Moments moments_of(const Sim& sim) {
  Moments all;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    const double m = sim.mass(k);
    const auto p = sim.engine().owner(k);
    const auto& b = sim.engine().mover.bodies[k];
    all.mass += m, all.momentum += m * p.velocity(), all.first += m * p.centre();
    all.angular += m * cross(p.centre(), p.velocity()) + rotate(b.orientation, b.momentum);
  }
  return all;
}

TEST_CASE("breakage: a polyhedron becomes cells of its mass, momentum and angular momentum") {
  std::size_t whole = 0, dusty = 0;
  for (const bool halves : {false, true})
    for (std::uint64_t seed = 1; seed <= (halves ? 10 : 3); ++seed) {
      Stones stones;
      const auto form = stones.add_form(stone());
      stones.add({.form = form,
                  .position = {0.01, 0.02, -0.01},
                  .orientation = {0.5, 0.5, -0.5, 0.5},
                  .density = 2165,
                  .velocity = {3, -1, 2},
                  .angular_velocity = {300, 0, -200}});
      const silt::BreakageRules rules{.dust_below = 2e-4, .seed = seed};
      auto sim = simulation_of(std::move(stones), halves ? halving(rules) : policy(rules));
      sim.time_step = 5e-8;
      sim.run(1e-6);
      const auto before = moments_of(sim);
      const Vec3d X = (1 / before.mass) * before.first, V = (1 / before.mass) * before.momentum;
      const Vec3d w = sim.angular_velocity(0);
      sim.break_particle(0);
      double dust = 0;
      std::size_t fragments = 0;
      sim.run(5e-8, silt::on_break([&](const silt::BreakEvent& b) {
                dust = b.dust, fragments = b.fragments;
              }));
      CHECK(fragments >= 1);
      CHECK(sim.size() == fragments);
      const auto after = moments_of(sim);
      CHECK(after.mass + dust == near(before.mass).epsilon(1e-12));
      const auto m = sim.mass_balance();
      CHECK(std::abs(m.residual()) < 1e-12 * m.fed);
      if (dust == 0) {  // all is there
        ++whole;
        CHECK(norm(after.momentum - before.momentum) < 1e-11 * norm(before.momentum));
        CHECK(norm(after.angular - before.angular) < 1e-9 * norm(before.angular));
      } else {  // the rest of the body, which its dust was
        ++dusty;
        const Vec3d arm = (1 / after.mass) * after.first - X;  // two steps later: 1e-7 m
        CHECK(norm((1 / after.mass) * after.momentum - V - cross(w, arm)) < 1e-3 * norm(V));
      }
      CHECK(sim.peak_overlap() < 1e-6);
      const double kinetic = sim.energy().kinetic();
      sim.run(5e-4);
      const auto e = sim.energy();
      CHECK(e.kinetic() < (1 + 1e-6) * kinetic + e.parting);
      CHECK(std::abs(e.residual()) < 1e-4 * kinetic);
    }
  CHECK(whole >= 2);
  CHECK(dusty >= 2);
}

TEST_CASE("breakage: stones that fall onto a plate break, the same for any threads") {
  const auto run = [](int threads, bool living) {
    Stones stones;
    const auto form = stones.add_form(stone());
    for (int k = 0; k < 16; ++k)
      stones.add({.form = form,
                  .position = {0.004 * (k % 4), 0.004 * (k / 4), 0.0012},
                  .orientation = silt::rotation_about(silt::normalised(Vec3d{1, 2, 3}), 0.3 * k),
                  .density = 2165,
                  .velocity = {0, 0, -12}});
    auto sim = simulation_of(std::move(stones),
                             policy({.dust_below = 4e-4,
                                     .step = living ? silt::BreakStep::SmallestLiving
                                                    : silt::BreakStep::SmallestPossible}));
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
    sim.threads = threads;
    sim.gravity = {0, 0, -9.81};
    if (!living) sim.time_step = 5e-8;
    sim.run(1e-9);
    const double first = sim.step_length();
    sim.run(4e-4);
    if (living) CHECK(sim.step_length() < 0.5 * first);
    CHECK(sim.broken() > 4);
    CHECK(sim.size() > 30);
    const auto m = sim.mass_balance();
    CHECK(std::abs(m.residual()) < 1e-12 * m.fed);
    std::vector<double> all{static_cast<double>(sim.broken()), m.dust};
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) all.push_back(sim.position(k).z + sim.velocity(k).x);
    return all;
  };
  for (const bool living : {false, true}) CHECK(run(1, living) == run(2, living));
}

}  // namespace breakage_polyhedra_test
