// silt - BSD-3-Clause, see LICENSE
// Every search as a policy of Simulation: driving the contacts at every step, or building the
// Verlet list. The physics must not depend on it.
#include <engine/mixed_scene.hpp>

#include <silt/io/checkpoint.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/cell_grid.hpp>
#include <silt/search/fastest_of.hpp>
#include <silt/search/hashed_grid.hpp>
#include <silt/search/nbs.hpp>
#include <silt/simulation/contact_check.hpp>

#include <filesystem>

namespace search_policies_test {

namespace {

using namespace engine_test;

#define SILT_POLICIES                                                              \
  silt::CellGrid, silt::Nbs, silt::HashedGrid, silt::BruteForce, silt::AutoSearch, \
      silt::VerletList<silt::Nbs>, silt::VerletList<silt::HashedGrid>,             \
      silt::VerletList<silt::BruteForce>, silt::VerletList<silt::AutoSearch>

/// A sphere that is squeezed between two fixed ones and pulled sideways: friction alone holds it,
/// with the slip that the contacts remember.
template <class Search>
auto held_by_friction(const Search& search) {
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, -1.98e-3}, .radius = 1e-3, .density = 2500, .fixed = true});
  p.add({.position = {0, 0, 1.98e-3}, .radius = 1e-3, .density = 2500, .fixed = true});
  p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{
      std::move(p), silt::Contacts<HertzMindlin>{rubber}, search,
      silt::PeriodicBox{{{-8e-3, -8e-3, -1}, {8e-3, 8e-3, 1}}, {true, true, false}}};
  sim.gravity = {0, 9.81, 0};
  sim.time_step = 4e-6;
  sim.threads = 1;
  return sim;
}

template <class Search>
auto colliding(const Search& search, int threads = 1) {
  silt::Particles<Sphere> p;
  p.fill({{0, 0, 2e-3}, {16e-3, 16e-3, 12e-3}}, {.radius = silt::uniform(0.3e-3, 1e-3),
                                                 .density = 2500,
                                                 .count = 250,
                                                 .arrangement = silt::Arrangement::Random,
                                                 .velocity = {0.2, 0.1, -0.5}});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, search,
                       silt::PeriodicBox{{{0, 0, 0}, {16e-3, 16e-3, 1}}, {true, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 4e-6;
  sim.threads = threads;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  return sim;
}

/// Largest distance [m] between the places of the same particle in two simulations.
template <class Sim, class Other>
double apart(const Sim& sim, const Other& other) {
  const auto a = bits(sim), b = bits(other);
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const auto& x = a[k].values;
    const auto& y = b[k].values;
    Vec3d d{x[0] - y[0], x[1] - y[1], x[2] - y[2]};
    if constexpr (Sim::Domain::periodic) d = sim.domain().shortest(d);
    most = std::max(most, norm(d));
  }
  return most;
}

}  // namespace

TEST_CASE_TEMPLATE("search_policies: history survives: friction holds a sphere for 10000 steps",
                   Search, SILT_POLICIES) {
  auto reference = held_by_friction(silt::VerletList<>{});
  auto sim = held_by_friction(Search{});
  sim.run(0.04), reference.run(0.04);
  CHECK(sim.touching_pairs() == 2);
  CHECK(apart(sim, reference) < 1e-12);
  // It moved by what the tangential springs give, and no further: without a memory of the slip it
  // would have run away.
  CHECK(std::abs(sim.position(sim.find(2)).y) < 1e-4);
  CHECK(std::abs(sim.velocity(sim.find(2)).y) < 1e-3);
}

TEST_CASE_TEMPLATE("search_policies: 3000 steps of collisions end as with the default list", Search,
                   SILT_POLICIES) {
  auto reference = colliding(silt::VerletList<>{});
  auto sim = colliding(Search{});
  silt::ContactCheck<silt::BruteForce> check;
  reference.run(0.012);
  sim.run(0.012, check);
  CHECK(check.contacts() > 20000);
  CHECK(sim.touching_pairs() > 50);
  // Rounding, which depends on the order of the pairs, grows with every collision.
  CHECK(apart(sim, reference) < 1e-9);
}

TEST_CASE_TEMPLATE("search_policies: the same bits for any number of threads, and when run again",
                   Search, silt::Nbs, silt::HashedGrid, silt::AutoSearch,
                   silt::VerletList<silt::HashedGrid>, silt::VerletList<silt::AutoSearch>) {
  const auto run = [](int threads) {
    auto sim = colliding(Search{}, threads);
    sim.run(0.006);
    return bits(sim);
  };
  const auto first = run(1);
  CHECK(run(1) == first);
  CHECK(run(2) == first);
  CHECK(run(3) == first);
}

TEST_CASE("search_policies: a choice between searches changes no bit, and a restart keeps it") {
  const auto path = (std::filesystem::temp_directory_path() / "silt_search_choice").string();
  using Search = silt::VerletList<silt::AutoSearch>;
  std::vector<ParticleBits> expected;
  for (std::uint64_t finder = 0; finder < 4; ++finder) {
    CAPTURE(finder);
    Search search;
    search.finder.keep({finder, 250});
    auto sim = colliding(search);
    sim.run(0.004);
    CHECK(sim.search().finder.choice().finder == finder);
    silt::save_checkpoint(sim, path);
    sim.run(0.004);
    if (finder == 0) expected = bits(sim);
    CHECK(bits(sim) == expected);

    auto again = colliding(Search{});
    silt::load_checkpoint(again, path);
    CHECK(again.search().finder.choice().finder == finder);
    CHECK(again.search().finder.choice().spheres == 250);
    again.run(0.004);
    CHECK(again.search().finder.choice().finder == finder);
    CHECK(bits(again) == expected);
  }
  std::filesystem::remove(path);
}

TEST_CASE("search_policies: a run without a list goes on from a checkpoint with the same bits") {
  const auto path = (std::filesystem::temp_directory_path() / "silt_direct").string();
  auto sim = colliding(silt::HashedGrid{});
  sim.run(0.0038);  // particles are sorted at step 1000, between here and the end
  silt::save_checkpoint(sim, path);
  sim.run(0.004);
  auto again = colliding(silt::HashedGrid{});
  silt::load_checkpoint(again, path);
  again.run(0.004);
  CHECK(bits(again) == bits(sim));
  std::filesystem::remove(path);
}

}  // namespace search_policies_test
