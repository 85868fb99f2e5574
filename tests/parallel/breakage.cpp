// silt - BSD-3-Clause, see LICENSE
// Spheres that break on ranks: the same ones break into the same fragments as on one process, while
// the planes between ranks move through them at each search.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include <silt/io/checkpoint.hpp>

#include "breakage/scene.hpp"
#include "near.hpp"
#include "rank_scenes.hpp"

namespace parallel_breakage_test {

namespace {

using breakage_scene::salt, breakage_scene::Policy;
using silt_test::Seen;
using silt_test::WanderingSlabs;
using Ranks = silt::Ranks<silt::ThreadComm, WanderingSlabs>;

Ranks ranks(const silt::ThreadComm& comm) {
  return Ranks{comm, {0, 0.018}, {.above = 1, .each = 0, .per_moved = 0}};
}
/// Grains that fly at the corner of three planes, and an outlet above it.
template <class... Policies>
auto shower(Policy of, Policies... policies) {
  silt::Particles<silt::Sphere> feed;
  silt::Random random(3);
  for (std::size_t k = 0; k < 144; ++k) {
    const auto i = static_cast<double>(k % 6), j = static_cast<double>(k / 6 % 6),
               l = static_cast<double>(k / 36);
    feed.add({.position = {0.003 + 0.0025 * i, 0.003 + 0.0025 * j, 0.0012 + 0.0025 * l},
              .radius = random.uniform(0.8e-3, 1e-3),
              .density = 2165,
              .velocity = {-random.uniform(0, 4), random.uniform(-2, 2), -random.uniform(6, 10)},
              .angular_velocity = {random.uniform(-500, 500), 0, 300}});
  }
  silt::Simulation sim{std::move(feed), silt::Contacts<silt::HertzMindlin>{salt},
                       silt::EnergyLedger{}, std::move(of), std::move(policies)...};
  sim.threads = 1;
  sim.time_step = 1.2e-7;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, salt);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, salt);
  sim.add_outlet({{0, 0, 0.0115}, {1, 1, 1}});
  return sim;
}

/// What broke, put together by the ranks.
struct Broken {
  std::vector<std::tuple<silt::ParticleId, double, silt::ParticleId, std::size_t, double>> all;
  std::mutex mutex;
  void sort() { std::sort(all.begin(), all.end()); }
};
struct Books {
  std::vector<double> whole;    // numbers that are equal
  std::vector<double> rounded;  // [kg], and counts as sums
  silt::EnergyBalance energy;
};
template <class Sim>
Books books_of(Sim& sim, Seen& seen) {
  seen.add(sim);
  const auto m = sim.mass_balance();
  CHECK(std::abs(m.residual()) < 1e-12 * m.fed);
  double impacts = 0;
  for (const auto& c : sim.impact_energies().table())
    impacts += static_cast<double>(c.at_walls + c.in_pairs);
  const auto there = silt::sizes_present(sim);
  const silt::LargestLoad load = sim.largest_load();
  return {{static_cast<double>(sim.size()), static_cast<double>(sim.broken()),
           static_cast<double>(sim.broken(silt::BreakCause::Pair)),
           static_cast<double>(sim.broken(silt::BreakCause::Asked)), impacts,
           static_cast<double>(sim.outlet(0).count), static_cast<double>(load.weighed),
           static_cast<double>(there.number())},
          {m.fed, m.present, m.left, m.dust, sim.dust().mass(), sim.left().mass(),
           sim.dust().number(), there.mass(), load.share},
          sim.energy()};
}
template <class... Policies>
Books fall(Seen& seen, Broken& breaks, double time, Policies... policies) {
  auto sim = shower(breakage_scene::policy(), policies...);
  std::vector<silt::BreakEvent> own;
  const auto watch = silt::on_break([&](const silt::BreakEvent& b) { own.push_back(b); });
  sim.run(time / 2, watch);
  sim.break_particle(143);
  sim.run(time / 2, watch);
  {
    const std::lock_guard lock(breaks.mutex);
    for (const auto& b : own) breaks.all.push_back({b.id, b.time, b.first, b.fragments, b.dust});
  }
  return books_of(sim, seen);
}

// Catches: particles that break on two ranks or on none; ids, draws and dust that depend on ranks;
// fragments that touch as they come where a partner is a ghost; impacts that are counted twice.
TEST_CASE("ranks: spheres that break are those of one process, and so are their fragments") {
  Seen one;
  Broken breaks;
  const Books wanted = fall(one, breaks, 2.4e-4);
  breaks.sort();
  CHECK(wanted.whole[1] > 30);
  CHECK(wanted.whole[2] > 3);
  CHECK(one.all.size() > 200);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Seen many;
    Broken of_many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      const Books got = fall(many, of_many, 2.4e-4, ranks(comm));
      for (std::size_t k = 0; k < wanted.whole.size(); ++k) CHECK(got.whole[k] == wanted.whole[k]);
      for (std::size_t k = 0; k < wanted.rounded.size(); ++k)
        CHECK(std::abs(got.rounded[k] - wanted.rounded[k]) <= 1e-12 * wanted.rounded[k]);
      const auto numbers = [](const silt::EnergyBalance& e) {
        return std::bit_cast<std::array<double, sizeof e / sizeof(double)>>(e);
      };
      const auto mine = numbers(got.energy), its = numbers(wanted.energy);
      for (std::size_t k = 0; k < its.size(); ++k) {
        CAPTURE(k);
        CHECK(std::abs(mine[k] - its[k]) < 1e-7 * wanted.energy.initial);
      }
    });
    of_many.sort();
    CHECK(of_many.all == breaks.all);
    CHECK(many.off(one)[0] < 1e-9);
  }
}

TEST_CASE("ranks: a restart of breaking spheres on as many ranks has the same bits") {
  const silt_test::Folder folder;
  Seen through, again;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = shower(breakage_scene::policy(), silt_test::eager(comm));
    sim.run(6e-5);
    sim.break_particle(143);
    silt::save_checkpoint(sim, folder / "run.silt");
    sim.run(6e-5);
    books_of(sim, through);
  });
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = shower(breakage_scene::policy(), silt_test::eager(comm));
    silt::load_checkpoint(sim, folder / "run.silt");
    sim.run(6e-5);
    books_of(sim, again);
  });
  CHECK(through.all == again.all);
}

/// Which nobody has for a few particles.
struct Faulty {
  double strength(double, double, double rank) const { return rank > 0.993 ? 0 : 8; }
  double weaker(double, double, double) const { return 0; }
  void check() const {}
};
// A strength that one rank alone finds wrong is a sentence on all.
TEST_CASE("ranks: a strength of 0 on one rank, and what cannot break, are refused by all") {
  std::atomic<int> told{0}, refused{0};
  const auto run = [&](const silt::ThreadComm& comm) {
    auto sim = shower(breakage_scene::policy(), ranks(comm));
    try {
      sim.break_particle(999);
    } catch (const silt::InputError& e) {
      told += std::string(e.what()).find("there is no particle 999") != std::string::npos;
    }
    sim.module<Policy>().rules.step = silt::BreakStep::SmallestLiving;
    sim.time_step.reset();
    try {
      sim.run(1e-6);
    } catch (const silt::InputError& e) {
      told += std::string(e.what()).find("does not go with Ranks") != std::string::npos;
    }
    silt::Breakage faulty{Faulty{}, silt::HertzEquivalence{}, silt::GaudinSchuhmann{1, 0.8},
                          silt::PowerFatigue{.kappa = 0.1, .psi = 3},
                          silt::BreakageRules{.dust_below = 0.3e-3}};
    silt::Particles<silt::Sphere> feed;
    for (int k = 0; k < 300; ++k)
      feed.add({.position = {0.002 * k, 0, 0}, .radius = 1e-3, .density = 2165});
    try {
      silt::Simulation other{std::move(feed), silt::Contacts<silt::HertzMindlin>{salt}, faulty,
                             ranks(comm)};
    } catch (const silt::InputError& e) {
      refused += std::string(e.what()).find("strength() gives 0") != std::string::npos;
    }
  };
  silt::run_on_ranks(3, run);
  CHECK(told == 6);
  CHECK(refused == 3);
}

}  // namespace

}  // namespace parallel_breakage_test
