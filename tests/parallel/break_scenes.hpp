// silt - BSD-3-Clause, see LICENSE
#pragma once

// Particles that break on ranks, and what is compared with one process.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <mutex>
#include <tuple>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "breakage/scene.hpp"
#include "rank_scenes.hpp"

namespace break_scenes {

using breakage_scene::salt;

/// Slabs whose planes move at each search.
inline auto ranks(const silt::ThreadComm& comm, double to = 0.018) {
  return silt::Ranks<silt::ThreadComm, silt_test::WanderingSlabs>{
      comm, {0, to}, {.above = 1, .each = 0, .per_moved = 0}};
}
/// Grains that fly at the corner of three planes, and an outlet above it.
template <class Of, class... Policies>
auto shower(Of of, Policies... policies) {
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

/// What broke, put together by the ranks: id, time, first fragment, their number, dust.
class Broken {
 public:
  std::vector<std::tuple<silt::ParticleId, double, silt::ParticleId, std::size_t, double>> all;

  void add(const std::vector<silt::BreakEvent>& own) {
    const std::lock_guard lock(mutex_);
    for (const auto& b : own) all.push_back({b.id, b.time, b.first, b.fragments, b.dust});
  }
  void sort() { std::sort(all.begin(), all.end()); }

 private:
  std::mutex mutex_;
};
struct Books {
  std::vector<double> whole;    // numbers that are equal
  std::vector<double> rounded;  // [kg], and counts as sums
  silt::EnergyBalance energy;

  void check_same(const Books& one) const {
    for (std::size_t k = 0; k < one.whole.size(); ++k) CHECK(whole[k] == one.whole[k]);
    for (std::size_t k = 0; k < one.rounded.size(); ++k)
      CHECK(std::abs(rounded[k] - one.rounded[k]) <= 1e-12 * one.rounded[k]);
    const auto numbers = [](const silt::EnergyBalance& e) {
      return std::bit_cast<std::array<double, sizeof e / sizeof(double)>>(e);
    };
    const auto mine = numbers(energy), its = numbers(one.energy);
    for (std::size_t k = 0; k < its.size(); ++k) {
      CAPTURE(k);
      CHECK(std::abs(mine[k] - its[k]) < 1e-7 * one.energy.initial);
    }
  }
};
template <class Sim>
Books books_of(Sim& sim, silt_test::Seen& seen) {
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
           sim.outlets() > 0 ? static_cast<double>(sim.outlet(0).count) : 0,
           static_cast<double>(load.weighed), static_cast<double>(there.number())},
          {m.fed, m.present, m.left, m.dust, sim.dust().mass(), sim.left().mass(),
           sim.dust().number(), there.mass(), load.share},
          sim.energy()};
}

}  // namespace break_scenes
