// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <type_traits>

#include <silt/contact/hertz_mindlin.hpp>

#include "rank_scenes.hpp"

namespace parallel_ledger_test {

namespace {

using silt_test::Seen;

/// The books of spheres that fall into a trough with a floor that shakes; some come while it runs.
template <class... Policies>
silt::EnergyBalance books(Policies... policies) {
  using Law = silt::HertzMindlin;
  const Law::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4};
  silt::Simulation sim{silt_test::cloud(12, 4, 3), silt::Contacts<Law>{glass}, silt::EnergyLedger{},
                       policies...};
  constexpr bool ring = (std::is_same_v<Policies, silt::PeriodicBox> || ...);
  sim.gravity = {ring ? 30.0 : 1.0, 0, -9.81};
  sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass, silt::vibration({0, 0, 0.001}, 30));
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, glass);
  sim.add_wall(silt::Plane{{0, 0.04, 0}, {0, -1, 0}}, glass);
  if (!ring) sim.add_wall(silt::Plane{{0.11, 0, 0}, {-1, 0, 0}}, glass);
  sim.run(0.015);
  const auto more = silt_test::cloud(6, 2, 1);
  silt::Particles<silt::Sphere> above;
  for (auto p : more.all()) p.position.z += 0.05, above.add(p);
  sim.add(above);
  return sim.run(0.015), sim.energy();
}

auto numbers_of(const silt::EnergyBalance& e) {
  return std::bit_cast<std::array<double, sizeof e / sizeof(double)>>(e);
}

/// The same, in a box with these policies, on several ranks as on one process.
template <class... Policies>
silt::EnergyBalance compare(Policies... policies) {
  const auto one = books(policies...);
  const auto expected = numbers_of(one);
  for (const int n : {2, 3})
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      const auto many = books(policies..., silt::Ranks{comm,
                                                       silt_test::WanderingSlabs{0, 0.11},
                                                       {.above = 1, .each = 0, .per_moved = 0}});
      const auto got = numbers_of(many);
      for (std::size_t k = 0; k < got.size(); ++k) {
        CAPTURE(k);
        CHECK(std::abs(got[k] - expected[k]) < 1e-9 * one.turned_over);
      }
    });
  return one;
}

// Catches: energies of contacts between ranks counted twice or left behind when a particle passes
// on, and friction that is the larger the more often stored energy passes from rank to rank.
TEST_CASE("ranks: the books of energy are those of one process") {
  const auto one = compare();
  CHECK(one.friction > 0.01 * one.turned_over);
  CHECK(one.walls != 0);
}

// Catches: ghosts that are booked as they are wrapped, and passages that the old or the new rank
// forgets.
#ifdef SILT_LONG_TESTS
TEST_CASE("ranks: gravity along a ring gives what it gives on one process") {
  const auto one = compare(silt::PeriodicBox{{{0, -1, -1}, {0.11, 1, 1}}, {true, false, false}});
  CHECK(one.going_round > 0.1 * one.turned_over);
  // An error of the step, of second order (1e-4 at 10 us); a single passage is 0.4 of it.
  CHECK(std::abs(one.residual()) < 3e-3 * one.turned_over);
}
#endif

}  // namespace

}  // namespace parallel_ledger_test
