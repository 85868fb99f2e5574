// silt - BSD-3-Clause, see LICENSE
// Bonded spheres that are removed on ranks: in observers, between two runs, before a checkpoint.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <mutex>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <silt/io/bond_observers.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/contact_observers.hpp>
#include <silt/io/observers.hpp>

#include "bond_scenes.hpp"

namespace parallel_bonds_removed_test {

namespace {

using silt_test::beam;
using silt_test::brittle;
using silt_test::glass;
using silt_test::Seen;
using silt_test::tough;
using Law = silt::HertzMindlin;

auto ranks(const silt::ThreadComm& comm) { return silt_test::bond_ranks(comm); }

/// Removes the own spheres for which goes(id) holds, and counts their bonds with ghosts.
template <class Sim, class Goes>
void thin_out(Sim& sim, const Goes& goes, std::atomic<int>& across) {
  sim.for_each_bond([&](const silt::BondSeen& b) {
    across += b.b != silt::no_particle && sim.find(b.b) == sim.rows() && (goes(b.a) || goes(b.b));
  });
  std::vector<silt::ParticleId> gone;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k) && goes(sim.id(k))) gone.push_back(sim.id(k));
  for (const auto id : gone) sim.remove(id);
}
/// What is left of the cubes, of which spheres are removed, between two runs and at the end.
struct Thinned {
  Seen seen;
  silt_test::BrokenBonds breaks;
  std::vector<double> counts, energies;  // [-]; [J]
  double turned_over = 0;                // [J]
  std::atomic<int> across{0}, ended{0};
};
template <class Sim>
void look(Sim& sim, Thinned& out) {
  double visited = 0;
  sim.for_each_bond([&](const auto&) { visited += 1; });
  const std::vector<double> counts{
      static_cast<double>(sim.size()), static_cast<double>(sim.bonds()),
      static_cast<double>(sim.broken_bonds()), static_cast<double>(sim.touching_pairs()),
      sim.sum_over_ranks(visited)};
  const auto energy = sim.energy();
  const double stored = sim.bond_energy();
  if (sim.rank() != 0) return;
  out.counts.insert(out.counts.end(), counts.begin(), counts.end());
  const auto books =
      std::bit_cast<std::array<double, sizeof(silt::EnergyBalance) / sizeof(double)>>(energy);
  out.energies.insert(out.energies.end(), books.begin(), books.end());
  out.energies.push_back(stored), out.turned_over = energy.turned_over;
}
template <class Model, class... Policies>
void fall_thinned(Thinned& out, const Model& model, Policies... policies) {
  silt::Simulation sim{
      silt::Particles<silt::Sphere>{}, silt::Contacts<Law>{glass}, silt::Bonds{model},
      silt::ContactEvents{},           silt::EnergyLedger{},       std::move(policies)...};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1, sim.time_step = 1e-6;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass, {.name = "floor"});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, glass);
  sim.add_wall(silt::Plane{{0.1, 0, 0}, {-1, 0, 0}}, glass);
  silt::add_bonded(sim, silt_test::cubes(6));
  sim.bond_to_wall(4, "floor", {0.01, 0.01, 0});
  sim.bond_to_wall(81, "floor", {0.045, 0.004, 0}, silt::WallContact::Excluded);
  std::vector<silt::BondBreak> own;
  const auto watch = silt::on_bond_break([&](const silt::BondBreak& b) { own.push_back(b); });
  const auto ends = silt::on_contact_end([&](const silt::ContactEvent&) { ++out.ended; });
  const auto inner = [](silt::ParticleId id) { return id % 9 == 4; };
  const auto some = [](silt::ParticleId id) { return id % 27 / 3 == 3 || id == 81; };
  const auto outer = [](silt::ParticleId id) { return id % 27 == 14; };
  int call = 0;
  auto edit = silt::at(silt::every(0.001), [&](auto& s) {
    if (++call == 2) thin_out(s, inner, out.across);
    if (call == 3) thin_out(s, some, out.across);
    if (call == 5) s.remove(26);  // asked for by every rank
  });
  sim.run(0.003, watch, ends, edit);
  look(sim, out);
  thin_out(sim, outer, out.across);
  sim.share_edits();
  look(sim, out);
  sim.run(0.003, watch, ends, edit);
  look(sim, out);
  out.seen.add(sim);
  const std::lock_guard lock(out.breaks.mutex);
  for (const auto& b : own) out.breaks.all.push_back({b.number, b.a, b.b, b.time, b.energy});
}
void check_thinned(Thinned& many, Thinned& one, double rounding) {
  CHECK(many.counts == one.counts);
  REQUIRE(many.energies.size() == one.energies.size());
  for (std::size_t k = 0; k < one.energies.size(); ++k) {
    CAPTURE(k);
    CHECK(std::abs(many.energies[k] - one.energies[k]) <= rounding * one.turned_over);
  }
  CHECK(many.ended == one.ended);
  many.breaks.sort(), one.breaks.sort();
  REQUIRE(many.breaks.all.size() == one.breaks.all.size());
  for (std::size_t k = 0; k < one.breaks.all.size(); ++k) {
    const auto &m = many.breaks.all[k], &o = one.breaks.all[k];
    CHECK(std::tuple(std::get<0>(m), std::get<1>(m), std::get<2>(m), std::get<3>(m)) ==
          std::tuple(std::get<0>(o), std::get<1>(o), std::get<2>(o), std::get<3>(o)));
  }
}

// Catches: bonds that stay with the other rank, which pulls at a sphere that is gone, or reads its
// place, which is no number; that count as broken, or are told; wall bonds that stay; books in
// which a contact or bond across a cut is counted twice or not.
TEST_CASE("ranks: bonds of removed spheres vanish untold on both ranks") {
  const auto check = [](const auto& model, double place_limit, double rounding) {
    Thinned one;
    fall_thinned(one, model);
    CHECK(one.counts[0] == 162 - 18 - 19);
    for (const int n : {1, 2, 3, 5}) {
      CAPTURE(n);
      Thinned many;
      silt::run_on_ranks(
          n, [&](const silt::ThreadComm& comm) { fall_thinned(many, model, ranks(comm)); });
      check_thinned(many, one, rounding);
      CHECK(many.seen.off(one.seen)[0] < place_limit);
      if (n > 1) CHECK(many.across.load() > 0);
    }
    return one.breaks.all.size();
  };
  CHECK(check(tough, 1e-12, 1e-9) == 0);
  CHECK(check(brittle, 1e-10, 1e-6) > 10);
}

// The other rank has such a bond before it has the sphere at its end among its ghosts.
TEST_CASE("ranks: a sphere is removed whose bonds have just been made") {
  const auto run = [](Seen& seen, auto... policies) {
    silt::Particles<silt::Sphere> spheres;
    for (int k = 0; k < 24; ++k)
      spheres.add({.position = {0.003 + 0.004 * k, 0, 0},
                   .radius = 1e-3,
                   .density = 2500,
                   .velocity = {0, 0, 0.1 * std::sin(k)}});
    silt::Simulation sim{std::move(spheres), silt::Contacts<Law>{glass}, silt::Bonds{tough},
                         policies...};
    sim.threads = 1, sim.time_step = 1e-6;
    const auto make = [&](silt::ParticleId from) {
      std::vector<std::pair<silt::ParticleId, silt::ParticleId>> pairs;
      for (silt::ParticleId a = from; a + 1 < 24; a += 3) pairs.push_back({a, a + 1});
      sim.bond_all(pairs);
    };
    make(0);
    sim.remove(4), sim.remove(13), sim.remove(19);
    sim.share_edits();
    CHECK(sim.bonds() == 8 - 3);
    sim.run(0.001);
    make(2);
    sim.remove(8), sim.remove(15), sim.remove(18), sim.remove(11);
    sim.share_edits();
    CHECK(sim.bonds() == 5 - 1 + 7 - 4);
    CHECK(sim.size() == 17);
    sim.run(0.001);
    CHECK(sim.bonds() == 7);
    CHECK(sim.broken_bonds() == 0);
    seen.add(sim);
  };
  Seen one;
  run(one);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Seen many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) { run(many, ranks(comm)); });
    CHECK(many.off(one)[0] < 1e-13);
  }
}

// Catches: bonds in a file whose particle is not; a removal before loading that is shared after it.
TEST_CASE("ranks: what is saved as bonded spheres are removed goes on") {
  const silt_test::Folder folder;
  const std::string path = folder / "run";
  Seen through;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = beam(ranks(comm));
    sim.run(0.002);
    for (const silt::ParticleId id : {0, 7, 8, 11, 16}) sim.remove(id);
    silt::save_checkpoint(sim, path);
    CHECK(sim.bonds() == 24 - 9);
    sim.run(0.002), through.add(sim);
  });
  const auto go_on = [&](auto& sim, Seen& again) {
    sim.remove(5);  // of the state before, and forgotten with it
    silt::load_checkpoint(sim, path);
    CHECK(sim.bonds() == 24 - 9);
    CHECK(sim.size() == 19);
    sim.run(0.002), again.add(sim);
    CHECK(sim.bonds() == 24 - 9);
  };
  Seen alone;
  auto sim = beam();
  go_on(sim, alone);
  CHECK(alone.off(through)[0] < 1e-12);
  for (const int n : {2, 3, 5}) {
    Seen again;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      auto of_rank = beam(ranks(comm));
      go_on(of_rank, again);
    });
    CHECK(again.off(through)[0] < 1e-12);
    if (n == 3) CHECK(again.all == through.all);  // the same bits
  }
}

}  // namespace

}  // namespace parallel_bonds_removed_test
