// silt - BSD-3-Clause, see LICENSE
#pragma once

// Bodies of any shape on any number of ranks, and what must hold of them.

#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <map>
#include <mutex>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/fill/bodies.hpp>
#include <silt/io/observers.hpp>

#include "rank_scenes.hpp"

namespace silt_test {

using BodyLaw = silt::HertzMindlin;
const BodyLaw::Material stone{
    .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.4};
inline constexpr double body_radius = 3e-3;  // [m] of the bounding spheres

/// Planes that move at each search.
inline auto wandering(const silt::ThreadComm& comm, double length) {
  return silt::Ranks<silt::ThreadComm, WanderingSlabs>{
      comm, {0, length}, {.above = 1, .each = 0, .per_moved = 0}};
}

/// Bodies on a lattice, turned at random, with velocities at random; those of the first layer lie
/// 0.1 mm above z = 0.
template <class Shape, class AddForms>
silt::Particles<Shape> bodies(std::array<int, 3> n, double spacing, const AddForms& add_forms,
                              double speed) {
  silt::Random random(3);
  silt::Particles<Shape> all;
  const std::size_t forms = add_forms(all);
  for (int i = 0; i < n[0]; ++i)
    for (int j = 0; j < n[1]; ++j)
      for (int k = 0; k < n[2]; ++k) {
        typename silt::Particles<Shape>::Particle p{};
        const auto at = [&](int m) { return spacing * (m + 0.5); };
        p.position = {at(i), at(j), at(k) + body_radius + 1e-4 - 0.5 * spacing};
        p.radius = body_radius * (1 - 0.2 * random.uniform()), p.density = 2500;
        p.form = all.size() % forms, p.orientation = silt::random_orientation(random);
        p.velocity = {speed * (random.uniform() - 0.5), speed * (random.uniform() - 0.5),
                      speed * (random.uniform() - 0.5)};
        p.angular_velocity = {20 * random.uniform(), 20 * random.uniform(), 20 * random.uniform()};
        all.add(p);
      }
  return all;
}

/// What pairs remember of which a rank has but one particle.
class Copies {
 public:
  std::size_t pairs = 0;        // that two ranks remember
  std::size_t unlike = 0;       // that they remember differently
  std::size_t alone = 0;        // that one rank remembers alone
  std::size_t ghost_pairs = 0;  // that no rank of the two owns

  template <class Sim>
  void add(const Sim& sim) {
    const std::lock_guard lock(mutex_);
    const auto& e = sim.engine();
    const std::size_t owned = e.particles.owned();
    e.lists.pairs.for_each([&](std::size_t k) {
      const std::uint32_t a = e.lists.pairs.first()[k], b = e.lists.pairs.second()[k];
      if (std::min(a, b) >= owned) ++ghost_pairs;
      if (std::max(a, b) < owned || !e.lists.pairs.remembers(k)) return;
      const auto memory = e.lists.pairs.memory(k);
      auto& copies = of_[{sim.step(), e.particles.id[a], e.particles.id[b]}];
      copies.emplace_back(memory.begin(), memory.end());
    });
  }
  void compare() {
    for (const auto& [key, copies] : of_) {
      if (copies.size() != 2) {
        ++alone;
        continue;
      }
      ++pairs;
      unlike += std::memcmp(copies[0].data(), copies[1].data(),
                            copies[0].size() * sizeof copies[0][0]) != 0;
    }
  }

 private:
  struct Step {
    std::int64_t step;
    silt::ParticleId a, b;
    auto operator<=>(const Step&) const = default;
  };
  std::map<Step, std::vector<std::vector<double>>> of_;
  std::mutex mutex_;
};

/// A few bodies in two layers that fall onto a plane and slide along it; they turn about, hit and
/// rub each other.
template <class Shape, class AddForms, class... Policies>
auto slide(const AddForms& add_forms, Policies... policies) {
  silt::Simulation sim{bodies<Shape>({6, 2, 2}, 6.1e-3, add_forms, 0.4),
                       silt::Contacts<BodyLaw>{stone}, silt::VerletList<>{.skin = 0.2e-3},
                       std::move(policies)...};
  sim.gravity = {4, 0, -30};
  sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, stone);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, stone);
  sim.add_wall(silt::Plane{{0, 0.0122, 0}, {0, -1, 0}}, stone);
  return sim;
}
inline constexpr double slide_length = 6 * 6.1e-3;  // [m]
inline const silt::PeriodicBox slide_ring{{{0, 0, 0}, {slide_length, 1, 1}}, {true, false, false}};

/// The slide on 1, 2 and 3 ranks is that on one process; both ranks of a cut remember the same.
template <class Shape, class AddForms, class... Policies>
void check_slide(const AddForms& add_forms, double time, double place_limit, double speed_limit,
                 Policies... policies) {
  Seen one;
  std::size_t touching = 0;
  {
    auto sim = slide<Shape>(add_forms, policies...);
    sim.run(time, silt::at(silt::every(time / 60),
                           [&](const auto& s) { touching += s.touching_pairs(); }));
    one.add(sim);
  }
  CHECK(touching > 100);
  for (const int n : {1, 2, 3}) {
    CAPTURE(n);
    Seen many;
    Copies copies;
    std::atomic<std::uint64_t> migrated{0};
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      auto sim = slide<Shape>(add_forms, policies..., wandering(comm, slide_length));
      CHECK(sim.size() == 24);
      sim.run(time, silt::at(silt::every(time / 60), [&](const auto& s) { copies.add(s); }));
      CHECK(sim.size() == 24);
      many.add(sim), migrated += sim.engine().ranks.counts.migrated;
    });
    copies.compare();
    const auto off = many.off(one);
    const double place = off[0], velocity = off[1];
    INFO("off ", place, " m, ", velocity, " m/s; migrated ", migrated.load(), ", copies ",
         copies.pairs, ", unlike ", copies.unlike, ", alone ", copies.alone);
#ifdef SILT_TEST_TELLS
    std::printf("touching %zu, ", touching);
    std::printf("ranks %d: off %.3g m, %.3g m/s; migrated %lu, copies %zu, unlike %zu, alone %zu\n",
                n, place, velocity, static_cast<unsigned long>(migrated.load()), copies.pairs,
                copies.unlike, copies.alone);
#endif
    if (n == 1) {
      CHECK(place + velocity == 0);  // the same bits
      continue;
    }
    CHECK(place < place_limit);
    CHECK(velocity < speed_limit);
    CHECK(migrated > 100);
    CHECK(copies.pairs > 10);
    CHECK(copies.unlike == 0);
    CHECK(copies.alone == 0);
    CHECK(copies.ghost_pairs == 0);
  }
}

inline constexpr double cloud_edge = 6 * 6.1e-3;  // [m]
inline const silt::PeriodicBox cloud_box{{{0, 0, 0}, {cloud_edge, cloud_edge, cloud_edge}},
                                         {true, true, true}};
struct Sums {
  silt::Vec3d momentum{0, 0, 0};  // [kg m/s]
  double speeds = 0;              // [kg m/s] sum of m |v|
};

/// A dense cloud in a box that repeats, on 3 ranks; what all are is added to `seen`.
template <class Shape, class AddForms>
void run_cloud(const AddForms& add_forms, double time, int threads, Seen& seen, Copies& copies,
               Sums& start, Sums& end) {
  std::mutex mutex;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    silt::Simulation sim{bodies<Shape>({6, 6, 6}, 6.1e-3, add_forms, 1.0),
                         silt::Contacts<BodyLaw>{stone}, silt::VerletList<>{.skin = 0.3e-3},
                         cloud_box, wandering(comm, cloud_edge)};
    sim.threads = threads;
    const auto add = [&](Sums& sums) {
      const std::lock_guard lock(mutex);
      for (std::size_t k = 0; k < sim.rows(); ++k)
        sums.momentum += sim.mass(k) * sim.velocity(k),
            sums.speeds += sim.mass(k) * norm(sim.velocity(k));
    };
    add(start);
    sim.run(time, silt::at(silt::every(time / 20), [&](const auto& s) { copies.add(s); }));
    CHECK(sim.size() == 216);
    add(end), seen.add(sim);
  });
  copies.compare();
}

/// Nobody is lost or doubled, momentum is kept, both ranks of a cut remember the same, and threads
/// change no bit.
template <class Shape, class AddForms>
void check_cloud(const AddForms& add_forms, double time) {
  Seen first, second;
  Copies copies, other;
  Sums start, end, none;
  run_cloud<Shape>(add_forms, time, 1, first, copies, start, end);
  CHECK(first.all.size() == 216);
  CHECK(!first.doubled);
  CHECK(first.all.rbegin()->first == 215);
  // Some 1e3 contacts, each of which rounds by 1e-16 of a momentum.
  CHECK(norm(end.momentum - start.momentum) < 1e-13 * start.speeds);
  CHECK(end.speeds < 0.95 * start.speeds);
  INFO("copies ", copies.pairs, ", unlike ", copies.unlike, ", alone ", copies.alone);
#ifdef SILT_TEST_TELLS
  std::printf("cloud: momentum %.3g, speeds %.3g, copies %zu, unlike %zu, alone %zu\n",
              norm(end.momentum - start.momentum) / start.speeds, end.speeds / start.speeds,
              copies.pairs, copies.unlike, copies.alone);
#endif
  CHECK(copies.pairs > 40);
  CHECK(copies.unlike == 0);
  CHECK(copies.alone == 0);
  CHECK(copies.ghost_pairs == 0);
  run_cloud<Shape>(add_forms, time, 2, second, other, none, none);
  CHECK(first.all == second.all);
}

}  // namespace silt_test
