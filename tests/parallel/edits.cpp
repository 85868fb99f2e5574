// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <bit>
#include <string>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>

#include "near.hpp"
#include "rank_scenes.hpp"
#include "refusal.hpp"

namespace parallel_edits_test {

namespace {

using silt::Vec3d;
using silt_test::Seen;
using Law = silt::HertzMindlin;

const Law::Material glass{
    .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4},
    rubber{.youngs_modulus = 2e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.8};

/// Spheres of two materials in a trough, so close that they touch from the start.
template <class... Policies>
auto trough(Policies... policies) {
  silt::Simulation sim{silt_test::cloud(12, 4, 3, 0.0078, 2),
                       silt::Contacts<Law, silt::SeveralMaterials>{{glass, rubber}},
                       silt::EnergyLedger{}, std::move(policies)...};
  sim.set_pair(0, 1, {.restitution = 0.5, .friction = 0.6});
  sim.gravity = {1, 0, -9.81};
  sim.threads = 1, sim.time_step = 2e-5;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, glass);
  sim.add_wall(silt::Plane{{0, 0.04, 0}, {0, -1, 0}}, glass);
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, glass);
  sim.add_wall(silt::Plane{{0.11, 0, 0}, {-1, 0, 0}}, glass);
  return sim;
}
auto ranks(const silt::ThreadComm& comm) {
  return silt::Ranks{
      comm, silt_test::WanderingSlabs{0, 0.11}, {.above = 1, .each = 0, .per_moved = 0}};
}

/// Takes away all own spheres in a slice of the bed, which is so broad that ones that touch each
/// other go on two ranks at once.
template <class Sim>
void remove_slice(Sim& sim, double from, double to) {
  std::vector<silt::ParticleId> gone;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (const double x = sim.position(k).x; sim.is_present(k) && x > from && x < to)
      gone.push_back(sim.id(k));
  std::sort(gone.begin(), gone.end());
  for (const auto id : gone) sim.remove(id);
}
/// Changes by ids, which every rank calls; of own rows, by the number of the call; and of one rank.
template <class Sim>
void change(Sim& sim, int call) {
  sim.set_velocity(17, {0.3, 0.1 * call, 0.5});
  sim.set_angular_velocity(40, {10, 20, 3});
  sim.set_material(25, call % 2);
  if (call == 2) sim.time_step = 1.6e-5;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k) && sim.id(k) % 7 == 3)
      sim.set_radius(sim.id(k), sim.radius(k) * (call % 2 ? 1.01 : 0.995));
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k) && sim.id(k) == 135u) sim.set_velocity(135, {0, 0, -0.5});
}
struct Outcome {
  Seen seen;
  std::array<double, sizeof(silt::EnergyBalance) / sizeof(double)> books;
  double turned_over = 0, mass = 0;
  std::size_t size = 0, touching = 0;
};
template <class Sim>
void run(Sim& sim, Outcome& out) {
  int call = 0;
  auto edit = silt::at(silt::every(0.004), [&](auto& s) {
    change(s, ++call);
    if (call == 4) remove_slice(s, 0.035, 0.06);
  });
  sim.run(0.016, edit);
  remove_slice(sim, 0.07, 0.085);
  sim.remove(0);
  sim.run(0.012, edit);
  const auto energy = sim.energy();
  const double mass = sim.total_mass();
  const std::size_t touching = sim.touching_pairs();
  out.seen.add(sim);
  if (sim.rank() != 0) return;
  out.books = std::bit_cast<decltype(out.books)>(energy), out.turned_over = energy.turned_over;
  out.size = sim.size(), out.mass = mass, out.touching = touching;
}

// Catches: other ranks that go on with what was removed, or with another size or material; lists
// that one rank alone makes anew; books that count the contacts of a cut twice or not at all.
TEST_CASE("ranks: changes of single particles are those of one process") {
  Outcome one;
  auto alone = trough();
  run(alone, one);
  CHECK(one.size < 115);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Outcome many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      auto sim = trough(ranks(comm));
      run(sim, many);
    });
    const auto [place, velocity] = many.seen.off(one.seen);
    CHECK(place < 1e-12);
    CHECK(velocity < 1e-10);
    CHECK(many.size == one.size);
    CHECK(many.touching == one.touching);
    CHECK(many.mass == near(one.mass).epsilon(1e-12));
    for (std::size_t k = 0; k < one.books.size(); ++k) {
      CAPTURE(k);
      CHECK(std::abs(many.books[k] - one.books[k]) < 1e-9 * one.turned_over);
    }
  }
}

TEST_CASE("ranks: what is removed between two runs is counted when edits are shared") {
  const silt_test::Folder folder;
  auto alone = trough();
  alone.run(0.015);
  const std::size_t before = alone.touching_pairs();
  remove_slice(alone, 0.035, 0.06);
  const std::size_t size = alone.size(), after = alone.touching_pairs();
  CHECK(before > after + 10);
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = trough(ranks(comm));
    sim.run(0.015);
    CHECK(sim.touching_pairs() == before);
    remove_slice(sim, 0.035, 0.06);
    sim.share_edits();
    CHECK(sim.size() == size);
    CHECK(sim.touching_pairs() == after);
    remove_slice(sim, 0.03, 0.035);
    save_checkpoint(sim, folder / "run.silt");
    sim.run(0.001);
    const double kinetic = sim.kinetic_energy();
    auto again = trough(ranks(comm));
    load_checkpoint(again, folder / "run.silt");
    CHECK(again.size() < size);
    again.run(0.001);
    CHECK(again.kinetic_energy() == kinetic);  // the same bits
  });
}

template <class Refuse>
void check_refused(const std::string& words, const Refuse& refuse) {
  std::atomic<int> told{0};
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = trough(ranks(comm));
    sim.run(0.001);
    try {
      refuse(sim);
    } catch (const silt::InputError& e) {
      told += std::string(e.what()).find(words) != std::string::npos;
    }
    sim.run(0.001);  // all go on together
  });
  CAPTURE(words);
  CHECK(told == 3);
}

TEST_CASE("ranks: an id that no rank has, and values that cannot be, are refused on all") {
  check_refused("Simulation::remove: there is no particle 1000 on any rank", [](auto& sim) {
    sim.remove(1000);
    sim.run(0.001);
  });
  check_refused("rank 1 of 3: Simulation::set_radius: there is no particle 999 on any rank",
                [](auto& sim) {
                  sim.run(0.001, silt::at(silt::every(0.0005), [](auto& s) {
                            if (s.rank() == 1) s.set_radius(999, 0.001);
                          }));
                });
  check_refused("set_velocity: (nan, 0, 0) [m/s] must be finite", [](auto& sim) {
    sim.set_velocity(3, {NAN, 0, 0});
  });
  check_refused("material 5 is not in the table", [](auto& sim) { sim.set_material(3, 5); });
}

}  // namespace

}  // namespace parallel_edits_test
