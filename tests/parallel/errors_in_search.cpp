// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/observers.hpp>

#include "rank_scenes.hpp"

namespace parallel_errors_in_search_test {

namespace {

using Law = silt::HertzMindlin;
const Law::Material glass{
    .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4};

/// Slabs that one rank cannot make at its third search.
struct FailingSlabs : silt_test::WanderingSlabs {
  int rank = -1;  // that fails
  template <class Comm>
  std::vector<int> partition(const Comm& comm, std::span<const silt::Vec3d> points,
                             std::span<const double> work) {
    if (comm.rank() == rank && searches == 2) throw silt::Error("no slabs today");
    return WanderingSlabs::partition(comm, points, work);
  }
};
/// A search that fails where it has more than so many pairs, as one whose list overflows.
struct SmallList {
  silt::HashedGrid grid;
  std::size_t most = 0;
  template <class Domain>
  void find(const silt::SphereSet& spheres, double skin, const Domain& domain,
            const silt::Team& team, std::vector<silt::IndexPair>& pairs) {
    grid.find(spheres, skin, domain, team, pairs);
    silt::require(pairs.size() <= most, "there is room for ", most, " pairs");
  }
};
/// A place for inlets that one rank cannot tell any more after some time.
struct FailingRegion : silt::BoxRegion {
  mutable int looks = 0;
  int most = 1 << 20;
  bool fits(const silt::Vec3d& centre, double radius) const {
    silt::require(++looks <= most, "nobody knows what fits");
    return silt::BoxRegion::fits(centre, radius);
  }
};
/// A module that fails between two steps.
struct FailingModule {
  struct Fields {
    double age = 0;
  };
  silt::ParticleId which = silt::no_particle;
  double at = 1;  // [s]
  void update(const silt::Seen& p, Fields&, double) const {
    if (p.id == which && p.time > at) throw silt::Error("too old");
  }
};

/// Takes the place of a sphere away between two steps, where nobody looks until the search.
struct LosesPlace {
  bool is_due(const auto&) const { return false; }
  void operator()(auto&) const {}
  template <class Sim>
  void watch(const Sim& as_read) const {
    auto& sim = const_cast<Sim&>(as_read);
    if (sim.step() != 500) return;
    sim.engine().lists.forget();
    if (const std::size_t k = sim.find(70); k < sim.rows())
      sim.engine().particles.position[k].x = NAN;
  }
};

template <class... Policies>
auto trough(Policies... policies) {
  silt::Simulation sim{silt_test::cloud(12, 4, 2), silt::Contacts<Law>{glass},
                       std::move(policies)...};
  sim.gravity = {1, 0, -9.81};
  sim.threads = 1, sim.time_step = 2e-5;
  sim.add_wall(silt::box({0, 0, 0}, {0.11, 0.04, 0.1}), glass);
  return sim;
}
auto ranks(const silt::ThreadComm& comm) {
  return silt::Ranks{
      comm, silt_test::WanderingSlabs{0, 0.11}, {.above = 1, .each = 0, .per_moved = 0}};
}

/// All ranks throw the same, that of one of them, at the same time.
template <class Make, class... Observers>
void check_told(const std::string& words, const Make& make, const Observers&... observers) {
  std::atomic<int> told{0};
  const auto run_one = [&](const silt::ThreadComm& comm) {
    auto sim = make(comm);
    try {
      sim.run(0.02, Observers(observers)...);
    } catch (const silt::Error& e) {
      const std::string what = e.what();
      CAPTURE(what);
      CHECK(what.find(words) != what.npos);
      ++told;
    }
  };
  CAPTURE(words);
  CHECK_NOTHROW(silt::run_on_ranks(3, run_one, 20));
  CHECK(told == 3);
}

// A rank that leaves the search by itself would be waited for by the others, for ever.
TEST_CASE("ranks: what one rank throws in the middle of a search, all throw") {
  check_told(
      "of 3: neighbour search: sphere", [](const auto& comm) { return trough(ranks(comm)); },
      LosesPlace{});
  check_told("rank 1 of 3: no slabs today", [](const auto& comm) {
    FailingSlabs parts;
    parts.from = 0, parts.to = 0.11, parts.rank = 1;
    return trough(silt::Ranks{comm, parts, {.above = 1, .each = 0, .per_moved = 0}});
  });
  check_told("rank 0 of 3: there is room for 5 pairs", [](const auto& comm) {
    return trough(ranks(comm), silt::VerletList<SmallList>{
                                   .finder = {.grid = {}, .most = comm.rank() == 0 ? 5u : 9999u}});
  });
}

// The others would wait for the ghosts of the rank that failed, or take what it says at a later
// inlet for what it says at this one.
TEST_CASE("ranks: what one rank throws at an inlet, all throw") {
  for (const int failing : {0, 1})
    check_told(silt::text("rank 2 of 3: nobody knows what fits"), [=](const auto& comm) {
      auto sim = trough(ranks(comm));
      for (int k = 0; k < 2; ++k) {
        FailingRegion region;
        region.box = {{0.01, 0.005, 0.06 + 0.015 * k}, {0.1, 0.035, 0.07 + 0.015 * k}};
        if (comm.rank() == 2 && k == failing) region.most = 20;
        sim.add_inlet(region, {.radius = 1e-3, .density = 2500, .rate = 5000, .interval = 2e-3});
      }
      return sim;
    });
}

TEST_CASE("ranks: what a module throws between two steps on one rank, all throw") {
  check_told("too old", [](const auto& comm) {
    return trough(ranks(comm), FailingModule{.which = 70, .at = 0.01});
  });
}

}  // namespace

}  // namespace parallel_errors_in_search_test
