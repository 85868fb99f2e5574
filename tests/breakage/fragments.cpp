// silt - BSD-3-Clause, see LICENSE
// What takes the place of a particle that breaks: mass, momentum, energy, and where it lies.
#include <algorithm>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include <silt/breakage/placement.hpp>

#include "breakage/scene.hpp"
#include "near.hpp"
#include "refusal.hpp"

namespace breakage_fragments_test {

using namespace breakage_scene;  // NOLINT: of this test alone
using silt_test::has, silt_test::refusal;

TEST_CASE("breakage: placed fragments lie inside, about one centre of mass, and turn as one") {
  silt::Random random(5);
  for (int event = 0; event < 50; ++event) {
    std::vector<double> radii, masses;
    const auto count = 1 + random.index(12);
    for (std::size_t k = 0; k < count; ++k) radii.push_back(random.uniform(0.05, 0.8));
    std::sort(radii.rbegin(), radii.rend());
    for (const double r : radii) masses.push_back(r * r * r);
    const auto places = silt::place_fragments(radii, masses, 1, random);
    Vec3d moment{0, 0, 0};
    double all = 0;
    for (std::size_t k = 0; k < count; ++k) {
      CHECK(norm(places[k]) + radii[k] <= 1 + 1e-12);
      moment += masses[k] * places[k], all += masses[k];
    }
    CHECK(norm(moment) < 1e-14 * all);
    const Vec3d L{0.3, -2, 1};
    const Vec3d w = silt::rotation_of_fragments(places, radii, masses, 0.4, L);
    Vec3d has{0, 0, 0};
    for (std::size_t k = 0; k < count; ++k)
      has += masses[k] * cross(places[k], cross(w, places[k])) +
             (0.4 * masses[k] * radii[k] * radii[k]) * w;
    CHECK(norm(has - L) < 1e-11 * norm(L));
  }
}

/// Angular momentum about the centre of mass.
template <class Sim>
Vec3d spin_of(const Sim& sim) {
  const Sums all = sums_of(sim);
  Vec3d moment{0, 0, 0};
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) moment += sim.mass(k) * sim.position(k);
  return all.angular - cross((1 / all.mass) * moment, all.momentum);
}

TEST_CASE(
    "breakage: a spinning grain in free flight becomes fragments of its mass, momentum and "
    "angular momentum; they part without a push") {
  silt::Particles<silt::Sphere> grain;
  grain.add({.position = {0.01, 0.02, 0.03},
             .radius = 1e-3,
             .density = 2165,
             .velocity = {3, -2, 1},
             .angular_velocity = {400, 0, -900}});
  std::size_t whole = 0, dusty = 0;
  for (const bool halves : {false, true})
    for (std::uint64_t seed = 1; seed <= (halves ? 12 : 4); ++seed) {
      const silt::BreakageRules rules{.dust_below = 1e-4, .most_fragments = 60, .seed = seed};
      auto sim = simulation(grain, halves ? halving(rules) : policy(rules));
      sim.time_step = 4e-8;
      sim.run(1e-6);
      const Sums before = sums_of(sim);
      const Vec3d spin = spin_of(sim);
      sim.break_particle(0);
      double dust = 0;
      sim.run(4e-8, silt::on_break([&](const silt::BreakEvent& b) {
                dust = b.dust;
                CHECK(b.id == 0);
                CHECK(b.cause == silt::BreakCause::Asked);
                CHECK(b.fragments == sim.size());
                CHECK(b.mass == near(before.mass).epsilon(1e-14));
              }));
      CHECK(sim.broken() == 1);
      const Sums after = sums_of(sim);
      const double share = 1 - dust / before.mass;
      CHECK(after.mass == near(share * before.mass).epsilon(1e-13));
      CHECK(norm(after.momentum - share * before.momentum) < 1e-12 * norm(before.momentum));
      const Vec3d now = spin_of(sim);
      if (dust == 0) {
        ++whole;
        CHECK(norm(now - spin) < 1e-10 * norm(spin));
        CHECK(norm(after.angular - before.angular) < 1e-11 * norm(before.angular));
      } else {
        // Dust takes its share of the spin, and more where the fragments would have more than their
        // share of its energy: what they have is along the grain's.
        ++dusty;
        CHECK(norm(cross(now, spin)) < 1e-9 * dot(spin, spin));
        CHECK(dot(now, spin) > 0.3 * share * dot(spin, spin));
        CHECK(dot(now, spin) < (share + 1e-10) * dot(spin, spin));
        CHECK(after.kinetic < share * before.kinetic * (1 + 1e-12));
      }
      // What they overlap by at birth is left out: nothing is stored, nothing accelerates.
      CHECK(sim.energy().elastic() == 0);
      sim.run(0.015);
      const Sums later = sums_of(sim);
      CHECK(norm(later.momentum - after.momentum) < 1e-11 * norm(after.momentum));
      CHECK(norm(later.angular - after.angular) < 1e-8 * norm(after.angular));
      CHECK(later.kinetic < after.kinetic + sim.energy().parting + 1e-12 * after.kinetic);
      CHECK(sim.touching_pairs() == 0);
      CHECK(std::abs(sim.mass_balance().residual()) < 1e-12 * before.mass);
    }
  CHECK(whole >= 2);
  CHECK(dusty >= 4);
}

TEST_CASE("breakage: what sets fragments apart is bounded by the speed of parting") {
  silt::Particles<silt::Sphere> grain;
  grain.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2165});
  grain.add({.position = {1, 0, 0}, .radius = 1e-3, .density = 2165, .velocity = {0, 0, 1e-3}});
  for (const double speed : {0.0, 0.1, 0.5}) {
    auto sim = simulation(grain, policy({.dust_below = 3e-4, .separation_speed = speed}));
    sim.time_step = 2e-8;
    sim.break_particle(0);
    sim.run(0.02);
    double most = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k) && sim.position(k).x < 0.5)
        most = std::max(most, norm(sim.velocity(k)));
    // A pair gets 2 m* v^2 at most, which is 2 v for a light one at a heavy one; several push.
    CHECK(most <= 4 * speed);
    if (speed > 0) CHECK(most > 0.1 * speed);
    CHECK((sim.touching_pairs() == 0) == (speed > 0));
    const auto e = sim.energy();
    CHECK(std::abs(e.residual()) <= 1e-3 * e.parting);
  }
}

TEST_CASE("breakage: only what may break does") {
  silt::Particles<silt::Sphere> grains;
  grains.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2165, .velocity = {1, 0, 0}});
  grains.add({.position = {0.01, 0, 0}, .radius = 1e-3, .density = 2165, .fixed = true});
  auto sim = simulation(grains);
  has(refusal([&] { sim.break_particle(7); }), "break_particle: there is no particle 7");
  has(refusal([&] { sim.break_particle(1); }),
      "particle 1 cannot break: it is fixed, or BreakageRules.materials leaves its material out");
  sim.time_step = 1e-7;
  sim.break_particle(0), sim.break_particle(0);
  sim.run(2e-7);
  CHECK(sim.broken() == 1);
}

}  // namespace breakage_fragments_test
