// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include <silt/io/observers.hpp>

#include "rank_scenes.hpp"

// Contacts of many ranks against brute force: all ranks put their spheres together, every pair is
// looked at, and the contacts that the step has computed must be these, each on one rank.

namespace parallel_oracle_test {

namespace {

constexpr silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e8, .poisson_ratio = 0.3, .restitution = 0.95, .friction = 0.2};

struct Ball {
  silt::ParticleId id;
  silt::Vec3d place;
  double radius;
};
/// Two ids, or an id and minus the number of a wall, less one.
using Touching = std::set<std::pair<std::int64_t, std::int64_t>>;

constexpr double width = 0.06;  // [m] of the box

/// Spheres of 1 to 4 mm in a box that repeats along x, fast enough to cross half of it.
silt::Particles<silt::Sphere> swarm(std::uint64_t seed) {
  silt::Random random(seed);
  silt::Particles<silt::Sphere> balls;
  std::vector<silt::PositionRow> placed;
  for (int tries = 0; tries < 6000 && balls.size() < 220; ++tries) {
    const double r = 1e-3 * std::pow(4.0, random.uniform());
    const silt::Vec3d at{random.uniform(0, width), random.uniform(r, width - r),
                         random.uniform(r, width - r)};
    const bool free = std::none_of(placed.begin(), placed.end(), [&](const auto& p) {
      silt::Vec3d d = at - p.centre();
      d.x -= width * std::round(d.x / width);
      return norm(d) < r + p.r;
    });
    if (!free) continue;
    placed.push_back({at.x, at.y, at.z, r});
    const auto speed = [&] { return random.uniform(-3, 3); };  // [m/s]
    balls.add(
        {.position = at, .radius = r, .density = 2500, .velocity = {speed(), speed(), speed()}});
  }
  return balls;
}

Touching by_brute_force(std::span<const Ball> balls, bool repeats) {
  Touching all;
  for (const Ball& a : balls) {
    const auto id = static_cast<std::int64_t>(a.id);
    for (const Ball& b : balls) {
      silt::Vec3d d = a.place - b.place;
      if (repeats) d.x -= width * std::round(d.x / width);
      if (a.id < b.id && norm(d) < a.radius + b.radius)
        all.insert({id, static_cast<std::int64_t>(b.id)});
    }
    const double ends[4] = {a.place.y, width - a.place.y, a.place.z, width - a.place.z};
    for (int w = 0; w < 4; ++w)
      if (ends[w] < a.radius) all.insert({id, -1 - w});
  }
  return all;
}

struct Looks {
  std::mutex mutex;
  std::size_t contacts = 0, between_ranks = 0, at_walls = 0, wrong = 0, looks = 0;
};

/// What the ranks have computed in this step, against all pairs.
template <class Sim>
void look(const Sim& sim, bool repeats, Looks& looks) {
  std::vector<Ball> own;
  std::vector<std::array<std::int64_t, 3>> seen;  // ids, or wall; whether b is of another rank
  for (std::size_t k = 0; k < sim.rows(); ++k)
    own.push_back({sim.id(k), sim.position(k), sim.radius(k)});
  sim.for_each_contact([&](const silt::ContactSeen& c) {
    const bool at_wall = c.b == silt::no_particle;
    seen.push_back(
        {static_cast<std::int64_t>(c.a),
         at_wall ? -1 - static_cast<std::int64_t>(c.wall) : static_cast<std::int64_t>(c.b),
         !at_wall && c.place_b >= sim.rows()});
  });
  const auto& comm = sim.engine().ranks.comm();
  const auto balls = gather(comm, std::span<const Ball>(own)).values;
  const auto all = gather(comm, std::span<const std::array<std::int64_t, 3>>(seen)).values;
  if (comm.rank() != 0) return;
  const Touching wanted = by_brute_force(balls, repeats);
  Touching found;
  std::size_t twice = 0, between = 0, walls = 0;
  for (const auto& [a, b, other] : all)
    twice += !found.insert({a, b}).second, between += other != 0, walls += b < 0;
  const std::lock_guard lock(looks.mutex);
  looks.contacts += wanted.size(), looks.between_ranks += between, looks.at_walls += walls;
  looks.wrong += twice + (found != wanted);
  ++looks.looks;
}

template <class Parts, class... Policies>
void check(int ranks, std::uint64_t seed, bool repeats, Parts parts, Looks& looks,
           Policies... policies) {
  silt::run_on_ranks(ranks, [&](const silt::ThreadComm& comm) {
    silt::Simulation sim{
        swarm(seed), silt::Contacts<silt::HertzMindlin>{glass},
        silt::Ranks{comm, parts, silt::Rebalance{.above = 1, .each = 0, .per_moved = 0}},
        policies...};
    sim.threads = 1, sim.gravity = {0, 0, -9.81};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, glass);
    sim.add_wall(silt::Plane{{0, width, 0}, {0, -1, 0}}, glass);
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
    sim.add_wall(silt::Plane{{0, 0, width}, {0, 0, -1}}, glass);
    if (!repeats) {
      sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, glass);
      sim.add_wall(silt::Plane{{width, 0, 0}, {-1, 0, 0}}, glass);
    }
    auto each = silt::at(silt::every(1.3e-4), [&](const auto& s) { look(s, repeats, looks); });
    sim.run(0.012, each);
  });
}

}  // namespace

// Catches: ghosts that do not reach far enough for a large and a small sphere, or around the box;
// spheres that cross a rank within one list; contacts that no rank or two ranks compute.
TEST_CASE("ranks: contacts are those of brute force, in random scenes, on up to 8 ranks") {
  for (const int ranks : {2, 3, 5, 8}) {
    Looks looks;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(ranks);
      CAPTURE(seed);
      const silt::PeriodicBox box{{{0, 0, 0}, {width, width, width}}, {true, false, false}};
      check(ranks, seed, true, silt::Bisection{}, looks, box);
      check(ranks, seed, true, silt_test::WanderingSlabs{0, width}, looks, box);
      CHECK(looks.wrong == 0);
    }
    CHECK(looks.contacts > 3000);
    CHECK(looks.between_ranks > 100);
    CHECK(looks.at_walls > 300);
  }
}

}  // namespace parallel_oracle_test
