// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <atomic>
#include <string>

#include <silt/contact/hertz_mindlin.hpp>

#include "near.hpp"
#include "rank_scenes.hpp"
#include "refusal.hpp"

namespace parallel_spheres_test {

namespace {

using silt_test::glass;
using silt_test::Seen;
using silt_test::WanderingSlabs;
using Law = silt::HertzMindlin;
using Ranks = silt_test::WanderingRanks;

Ranks ranks(const silt::ThreadComm& comm) { return silt_test::wandering(comm); }

using silt_test::trough;
template <class... Policies>
void run(Seen& seen, double time, Policies... policies) {
  auto sim = trough(silt_test::cloud(12, 4, 3), policies...);
  sim.run(time);
  seen.add(sim);
}

/// An observer that fails on one rank.
struct Stop {
  int rank;
  bool is_due(const auto& sim) const { return sim.step() == 40; }
  void operator()(auto&) const {
    if (rank == 1) throw silt::Error("the disc is full");
  }
};

// Catches: pairs missed or computed twice at a cut, loads with the wrong sign, ghosts of half a
// step ago, contacts that forget when a particle passes on. In 0.03 s each particle meets others
// some ten times; sums that are added in another order differ by 1e-16 of the forces and grow by
// such contacts to 1e-13: a missing contact is 1e-3.
TEST_CASE("ranks: a scene with friction is that of one process, while cuts move through contacts") {
  Seen one;
  run(one, 0.03);
  for (const int n : {1, 2, 3, 5}) {
    Seen many;
    std::uint64_t migrated = 0;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      auto sim = trough(silt_test::cloud(12, 4, 3), ranks(comm));
      CHECK(sim.size() == 144);
      sim.run(0.03);
      CHECK(sim.size() == 144);
      many.add(sim);
      std::array<double, 1> sum{static_cast<double>(sim.engine().ranks.counts.migrated)};
      sim.engine().ranks.sum_of(sum);
      if (comm.rank() == 0) migrated = static_cast<std::uint64_t>(sum[0]);
    });
    CAPTURE(n);
    const auto [place, velocity] = many.off(one);
    CHECK(place < 1e-12);
    CHECK(velocity < 1e-10);
    CHECK((n == 1 || migrated > 144));
    if (n == 1) CHECK(place + velocity == 0);  // the same bits
  }
}

TEST_CASE("ranks: the same number of ranks gives the same bits, whatever the threads") {
  Seen first;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) { run(first, 0.02, ranks(comm)); });
  for (const int threads : {1, 2}) {
    Seen again;
    silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
      auto sim = trough(silt_test::cloud(12, 4, 3), ranks(comm));
      sim.threads = threads;
      sim.run(0.02);
      again.add(sim);
    });
    CHECK(first.all == again.all);
  }
}

TEST_CASE("ranks: both sides of a cut remember the same of each contact, to the bit") {
  std::mutex mutex;
  std::map<std::array<silt::ParticleId, 2>, std::vector<std::array<double, 3>>> of_pair;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = trough(silt_test::cloud(12, 4, 3), ranks(comm));
    sim.run(0.025);
    const auto& e = sim.engine();
    const std::lock_guard lock(mutex);
    e.lists.pairs.for_each([&](std::size_t k) {
      const std::uint32_t a = e.lists.pairs.first()[k], b = e.lists.pairs.second()[k];
      const std::size_t owned = e.particles.owned();
      CHECK((a < owned || b < owned));
      if (std::max(a, b) < owned || !e.lists.pairs.remembers(k)) return;
      of_pair[{e.particles.id[a], e.particles.id[b]}].push_back(e.lists.pairs.memory(k));
    });
  });
  CHECK(of_pair.size() >= 3);
  for (const auto& [ids, memories] : of_pair) {
    REQUIRE(memories.size() == 2);
    CHECK(memories[0] == memories[1]);
  }
}

TEST_CASE("ranks: loads on walls are those of all particles") {
  auto one = trough(silt_test::cloud(12, 4, 3));
  one.run(0.02), one.set_reference(0, {0.05, 0.02, 0}), one.run(0.01);
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = trough(silt_test::cloud(12, 4, 3), ranks(comm));
    sim.run(0.02), sim.set_reference(0, {0.05, 0.02, 0}), sim.run(0.01);
    CHECK(norm(sim.wall(0).angular_impulse - one.wall(0).angular_impulse) <
          1e-10 * norm(one.wall(0).angular_impulse));
    for (std::size_t w = 0; w < 5; ++w) {
      CHECK(norm(sim.wall(w).force - one.wall(w).force) < 1e-8 * norm(one.wall(0).force));
      CHECK(norm(sim.wall(w).impulse - one.wall(w).impulse) < 1e-10 * norm(one.wall(0).impulse));
    }
  });
}

TEST_CASE("ranks: ranks without particles, and more ranks than particles") {
  const auto three = [] { return silt_test::cloud(3, 1, 1); };
  Seen one;
  auto sim = trough(three());
  sim.run(0.03);
  one.add(sim);
  Seen many;
  silt::run_on_ranks(8, [&](const silt::ThreadComm& comm) {
    auto part = trough(three(), ranks(comm));
    part.run(0.03);
    many.add(part);
    CHECK(part.step() == sim.step());
  });
  CHECK(many.off(one)[0] < 1e-13);
}

TEST_CASE("ranks: what one rank throws, all throw; with the sentence of that rank") {
  std::atomic<int> told{0};
  CHECK_THROWS_WITH(silt::run_on_ranks(3,
                                       [&](const silt::ThreadComm& comm) {
                                         auto sim = trough(silt_test::cloud(12, 4, 3), ranks(comm));
                                         try {
                                           sim.run(0.03, Stop{comm.rank()});
                                         } catch (const silt::Error& e) {
                                           told += std::string(e.what()).find(
                                                       "rank 1 of 3: the disc is full") == 0;
                                           throw;
                                         }
                                       }),
                    doctest::Contains("rank 1 of 3: the disc is full"));
  CHECK(told == 3);
}

TEST_CASE("ranks: a limit that is broken on one rank ends the run on all") {
  std::atomic<int> told{0};
  const auto run_one = [&](const silt::ThreadComm& comm) {
    auto beads = silt_test::cloud(12, 1, 1);
    beads.add({.position = {0.1, 0.02, 0.02}, .radius = 0.003, .density = 2500});
    beads.add({.position = {0.1031, 0.02, 0.02}, .radius = 0.003, .density = 2500});
    auto sim = trough(std::move(beads), ranks(comm));
    try {
      sim.run(0.01);
    } catch (const silt::SimulationError& e) {
      told += e.particles.size() == 2 && e.step == 0;
      throw;
    }
  };
  CHECK_THROWS_WITH(silt::run_on_ranks(3, run_one), doctest::Contains("12 and 13"));
  CHECK(told == 3);
}

// An inlet that draws other places on each rank, or does not see the others' particles, gives other
// particles; an outlet that counts its own rank's alone other books.
TEST_CASE("ranks: inlets and outlets, and their books, are those of one process") {
  const auto scene = [](Seen& seen, auto... policies) {
    auto sim = trough(silt_test::cloud(12, 4, 1), policies...);
    sim.add_inlet(silt::Box{{0.01, 0.005, 0.05}, {0.1, 0.035, 0.07}},
                  {.radius = silt::uniform(0.002, 0.003),
                   .density = 2500,
                   .rate = 3000,
                   .velocity = {0, 0, -0.5}});
    sim.add_outlet({{0.08, 0, 0}, {0.2, 0.02, 0.02}});
    sim.run(0.03);
    seen.add(sim);
    CHECK(sim.size() == 48 + sim.inlet(0).placed - sim.outlet(0).count);
    CHECK(sim.outlet(0).count > 3);
    return std::array{static_cast<double>(sim.inlet(0).placed), sim.inlet(0).mass,
                      static_cast<double>(sim.outlet(0).count), sim.outlet(0).mass};
  };
  Seen one, many;
  const auto books = scene(one);
  CHECK(books[0] > 60);
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    const auto of_rank = scene(many, ranks(comm));
    for (std::size_t k = 0; k < 4; ++k) CHECK(of_rank[k] == near(books[k]).epsilon(1e-12));
  });
  CHECK(many.off(one)[0] < 1e-12);
}

TEST_CASE("ranks: particles that come between two runs are those of one process") {
  const auto scene = [](Seen& seen, auto... policies) {
    auto sim = trough(silt_test::cloud(12, 4, 2), policies...);
    sim.run(0.01);
    auto more = silt_test::cloud(8, 3, 1);
    silt::Particles<silt::Sphere> above;
    for (auto p : more.all()) p.position.z += 0.03, above.add(p);
    sim.add(above);
    CHECK(sim.size() == 96 + 24);
    sim.run(0.02);
    CHECK(sim.size() == 96 + 24);
    seen.add(sim);
  };
  Seen one, many;
  scene(one);
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) { scene(many, ranks(comm)); });
  CHECK(many.off(one)[0] < 1e-12);
}

}  // namespace

}  // namespace parallel_spheres_test
