// silt - BSD-3-Clause, see LICENSE
// Bonded grains that break, on ranks: their bonds end with them, on whichever rank the other end
// is, and are told, counted and booked once.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <vector>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/io/bond_observers.hpp>
#include <silt/io/checkpoint.hpp>

#include "break_scenes.hpp"

namespace parallel_bonded_breaks_test {

namespace {

using break_scenes::Broken, break_scenes::Books, break_scenes::books_of, break_scenes::ranks;
using breakage_scene::halving, breakage_scene::policy, breakage_scene::salt;
using silt::Vec3d;
using silt_test::Seen;

constexpr double R = 1e-3;  // [m]
const silt::ParallelBond glue{.youngs_modulus = 1e8};

/// Bonds that broke, put together by the ranks.
class BrokenBonds {
 public:
  std::vector<silt::BondBreak> all;
  void add(const std::vector<silt::BondBreak>& own) {
    const std::lock_guard lock(mutex_);
    all.insert(all.end(), own.begin(), own.end());
  }
  void check_same(const BrokenBonds& one, double energy) {
    sort();
    REQUIRE(all.size() == one.all.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto &a = all[k], &b = one.all[k];
      CHECK(a.number == b.number);
      CHECK(a.a == b.a);
      CHECK(a.b == b.b);
      CHECK(std::abs(a.time - b.time) <= 1e-9 * b.time);
      CHECK(std::abs(a.energy - b.energy) < 1e-9 * energy);
      CHECK(norm(a.to - b.to) < 1e-9);
    }
  }
  void sort() {
    std::sort(all.begin(), all.end(),
              [](const auto& a, const auto& b) { return a.number < b.number; });
  }

 private:
  std::mutex mutex_;
};

/// A chain that is stretched, bent and twisted as it moves, its last grain held by a wall.
template <class... Policies>
auto chain(double dust_below, Policies... policies) {
  silt::Particles<silt::Sphere> grains;
  for (int k = 0; k < 8; ++k)
    grains.add({.position = {2.01 * R * k, 0, 0},
                .radius = R,
                .density = 2165,
                .velocity = {0.5 * k, 0.3 * (k % 2), -0.2 * k},
                .angular_velocity = {150.0 * k, 0, 100}});
  silt::Simulation sim{std::move(grains),    silt::Contacts<silt::HertzMindlin>{salt},
                       silt::EnergyLedger{}, halving({.dust_below = dust_below}),
                       silt::Bonds{glue},    std::move(policies)...};
  const auto clamp = sim.add_wall(silt::Plane{{17 * R, 0, 0}, {-1, 0, 0}}, salt);
  for (silt::ParticleId k = 0; k < 7; ++k) sim.bond(k, k + 1);
  sim.bond_to_wall(7, clamp, {17 * R, 0, 0}, silt::WallContact::Excluded);
  sim.time_step = 1e-7, sim.threads = 1;
  return sim;
}
struct Chain {
  Books books;
  double stored = 0;           // [J] before the grains broke
  std::vector<double> counts;  // of bonds: there, broken
};
/// Breaks 1; 3 and 4, which share a bond; and 7, at the wall. With `at_once` before the first step.
template <class... Policies>
Chain pull(Seen& seen, BrokenBonds& bonds, bool at_once, double dust_below, Policies... policies) {
  auto sim = chain(dust_below, policies...);
  Chain out;
  if (!at_once) sim.run(3.1e-5), out.stored = sim.bond_energy();
  for (const silt::ParticleId id : {1, 3, 4, 7}) sim.break_particle(id);
  std::vector<silt::BondBreak> own;
  const auto tell = silt::on_bond_break([&](const silt::BondBreak& b) { own.push_back(b); });
  sim.run(1e-7, tell);
  out.counts = {static_cast<double>(sim.bonds()), static_cast<double>(sim.broken_bonds()),
                sim.bonded(5, 6) ? 1.0 : 0.0, sim.bonded(0, 1) ? 1.0 : 0.0};
  sim.run(2e-5, tell);
  out.counts.push_back(static_cast<double>(sim.broken_bonds()));
  bonds.add(own);
  out.books = books_of(sim, seen);
  return out;
}

// Catches: bonds that outlive a grain of another rank; bonds that both ranks tell, count or book;
// energies of bonds between ranks from places of a step ago; contacts that begin with what broke.
TEST_CASE("ranks: bonds of grains that break are told, counted and booked as on one process") {
  for (const bool at_once : {false, true})
    for (const double dust_below : {0.3e-3, 1.2e-3}) {
      Seen one;
      BrokenBonds told;
      const Chain wanted = pull(one, told, at_once, dust_below);
      told.sort();
      CHECK(told.all.size() == 7);  // that of 3 and 4 once
      CHECK(wanted.counts == std::vector<double>{1, 7, 1, 0, 7});
      const double energy = wanted.books.energy.initial;
      double sum = 0;
      for (const auto& b : told.all) sum += b.energy;
      CHECK(std::abs(sum) <= energy);
      if (!at_once) CHECK(sum > 0.05 * energy);
      for (const int n : {1, 2, 3, 5}) {
        CAPTURE(n);
        Seen many;
        BrokenBonds of_many;
        silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
          const Chain got = pull(many, of_many, at_once, dust_below, ranks(comm, 17 * R));
          got.books.check_same(wanted.books);
          CHECK(got.counts == wanted.counts);
          CHECK(std::abs(got.stored - wanted.stored) <= 1e-9 * wanted.stored);
        });
        of_many.check_same(told, energy);
        CHECK(many.off(one)[0] < 1e-9);
      }
    }
}

/// Bonded cubes that hit a floor: bonds break, and so do grains; the time step follows.
template <class... Policies>
auto cubes(Policies... policies) {
  silt::Simulation sim{silt::Particles<silt::Sphere>{},
                       silt::Contacts<silt::HertzMindlin>{salt},
                       silt::EnergyLedger{},
                       policy({.dust_below = 0.4e-3, .step = silt::BreakStep::SmallestLiving}),
                       silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e8,
                                                      .tensile_strength = 2e6,
                                                      .shear_strength = 2e6,
                                                      .damping = 0.05,
                                                      .weibull_modulus = 6}},
                       std::move(policies)...};
  sim.gravity = {0, 0, -9.81}, sim.threads = 1, sim.guard.max_overlap = 0.6;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
  silt::BondedSpheres all;
  silt::Random random(5);
  for (int c = 0; c < 2; ++c) {
    const std::size_t first = all.spheres.size();
    for (int n = 0; n < 27; ++n) {
      silt::Particles<silt::Sphere>::Particle p;
      const auto at = [&](int k) { return 2 * R * k + 1e-5 * random.uniform(); };
      p.position = {1.5e-3 + 8e-3 * c + at(n % 3), at(n / 3 % 3), 1.02e-3 + at(n / 9)};
      p.radius = R, p.density = 2165, p.velocity = {2, 0.5, -7};
      all.spheres.push_back(p);
    }
    for (std::size_t a = first; a < all.spheres.size(); ++a)
      for (std::size_t b = a + 1; b < all.spheres.size(); ++b)
        if (norm(all.spheres[a].position - all.spheres[b].position) < 2.2 * R)
          all.bonds.push_back({a, b});
  }
  silt::add_bonded(sim, all);
  return sim;
}
struct Crash {
  Books books;
  double bonds, broken_bonds, step;
  std::int64_t steps;
};
template <class... Policies>
Crash crash(Seen& seen, BrokenBonds& bonds, Broken& grains, Policies... policies) {
  auto sim = cubes(policies...);
  std::vector<silt::BondBreak> own;
  std::vector<silt::BreakEvent> broken;
  sim.run(1e-4, silt::on_bond_break([&](const silt::BondBreak& b) { own.push_back(b); }),
          silt::on_break([&](const silt::BreakEvent& b) { broken.push_back(b); }));
  bonds.add(own), grains.add(broken);
  return {books_of(sim, seen), static_cast<double>(sim.bonds()),
          static_cast<double>(sim.broken_bonds()), sim.step_length(), sim.step()};
}
// Catches: ranks that disagree on the step while bonds and grains break, on which grain breaks, or
// on whether a freed contact has begun.
TEST_CASE("ranks: bonded cubes that crash lose the bonds and grains of one process") {
  Seen one, three, again;
  BrokenBonds told;
  Broken breaks;
  const Crash wanted = crash(one, told, breaks);
  told.sort(), breaks.sort();
  CHECK(breaks.all.size() > 5);
  CHECK(told.all.size() > 20);
  CHECK(wanted.bonds > 5);
  for (const int n : {2, 3, 5}) {
    CAPTURE(n);
    Seen many;
    BrokenBonds of_many;
    Broken grains;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      const Crash got = crash(many, of_many, grains, ranks(comm, 0.014));
      got.books.check_same(wanted.books);
      CHECK(got.bonds == wanted.bonds);
      CHECK(got.broken_bonds == wanted.broken_bonds);
      CHECK(std::abs(got.step - wanted.step) < 1e-9 * wanted.step);
      CHECK(got.steps == wanted.steps);
    });
    of_many.check_same(told, wanted.books.energy.initial);
    grains.sort();
    REQUIRE(grains.all.size() == breaks.all.size());
    for (std::size_t k = 0; k < grains.all.size(); ++k) {
      CHECK(std::get<0>(grains.all[k]) == std::get<0>(breaks.all[k]));
      CHECK(std::get<2>(grains.all[k]) == std::get<2>(breaks.all[k]));
    }
    CHECK(many.off(one)[0] < 1e-9);
    if (n == 3) three.all = many.all;
  }
  BrokenBonds same;
  Broken grains;
  silt::run_on_ranks(
      3, [&](const silt::ThreadComm& comm) { crash(again, same, grains, ranks(comm, 0.014)); });
  CHECK(again.all == three.all);
}

/// The lengths of the steps where two stiff bonds set them: one is broken in the step in which a
/// grain elsewhere breaks, the other ends with its grain.
template <class... Policies>
std::vector<double> stiff_steps(Policies... policies) {
  silt::Particles<silt::Sphere> grains;
  for (const double x : {0.0, 2.01, 4.02, 12.0})
    grains.add(
        {.position = {x * R, 0, 0}, .radius = R, .density = 2165, .velocity = {0.01 * x, 0.1, 0}});
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{salt},
                       halving({.dust_below = 0.3e-3, .step = silt::BreakStep::SmallestLiving}),
                       silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e12}},
                       std::move(policies)...};
  sim.threads = 1;
  sim.bond(0, 1), sim.bond(1, 2);
  sim.run(1e-12);
  const double step = sim.step_length();
  std::vector<double> steps;
  const auto look = [&](const auto& s) { steps.push_back(s.step_length()); };
  sim.run(3 * step, look);
  sim.unbond(1, 2), sim.break_particle(3);
  sim.run(10 * step, look);
  sim.break_particle(0);
  sim.run(300 * step, look);
  return steps;
}
// Catches: a step for the bonds that there were as the run began, and one that still counts the
// bond which breaks in the step of the look.
TEST_CASE("ranks: the step of the smallest living follows the bonds of all ranks") {
  const auto wanted = stiff_steps();
  CHECK(wanted[9] > 1.25 * wanted[2]);  // with one bond; the grains themselves allow far more
  CHECK(wanted.back() > 10 * wanted[9]);
  for (const int n : {2, 3}) {
    CAPTURE(n);
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      const auto got = stiff_steps(ranks(comm, 14 * R));
      REQUIRE(got.size() == wanted.size());
      for (std::size_t k = 0; k < got.size(); ++k)
        CHECK(std::abs(got[k] - wanted[k]) <= 1e-9 * wanted[k]);
    });
  }
}

TEST_CASE("ranks: a restart of bonded grains that are due to break has the same bits") {
  const silt_test::Folder folder;
  Seen through, again;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = cubes(silt_test::eager(comm));
    sim.run(4e-5);
    for (const silt::ParticleId id : {13, 14, 40}) sim.break_particle(id);
    silt::save_checkpoint(sim, folder / "run.silt");
    sim.run(4e-5);
    books_of(sim, through);
  });
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = cubes(silt_test::eager(comm));
    silt::load_checkpoint(sim, folder / "run.silt");
    CHECK(sim.breaks_due() >= 3);
    sim.run(4e-5);
    books_of(sim, again);
  });
  CHECK(through.all == again.all);
}

}  // namespace

}  // namespace parallel_bonded_breaks_test
