// silt - BSD-3-Clause, see LICENSE
// Bonds on ranks: of a beam that bends, of fibres that fall onto each other, of agglomerates that
// break; while the planes between ranks move through them at each search.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <mutex>
#include <string>
#include <vector>

#include <silt/io/bond_observers.hpp>
#include <silt/io/checkpoint.hpp>

#include "bond_scenes.hpp"

namespace parallel_bonds_test {

namespace {

using silt::Vec3d;
using silt_test::beam;
using silt_test::brittle;
using silt_test::cubes;
using silt_test::glass;
using silt_test::Seen;
using silt_test::tough;
using Broken = silt_test::BrokenBonds;
using Law = silt::HertzMindlin;
constexpr double R = silt_test::bonded_radius;  // [m]

auto ranks(const silt::ThreadComm& comm) { return silt_test::bond_ranks(comm); }

struct Books {
  double bonds, broken, energy, fragments, largest;
};
template <class Model, class... Policies>
Books fall(Seen& seen, Broken& breaks, const Model& model, double time, Policies... policies) {
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<Law>{glass},
                       silt::Bonds{model}, std::move(policies)...};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, glass);
  sim.add_wall(silt::Plane{{0.1, 0, 0}, {-1, 0, 0}}, glass);
  silt::add_bonded(sim, cubes(6));
  CHECK(sim.bonds() == 6 * 54);
  std::vector<silt::BondBreak> own;
  const auto watch = silt::on_bond_break([&](const silt::BondBreak& b) { own.push_back(b); });
  sim.run(time / 2, watch), sim.run(time / 2, watch);
  seen.add(sim);
  const auto pieces = silt::fragments(sim);
  {
    const std::lock_guard lock(breaks.mutex);
    for (const auto& b : own) breaks.all.push_back({b.number, b.a, b.b, b.time, b.energy});
  }
  const auto most = std::max_element(pieces.spheres.begin(), pieces.spheres.end());
  return {static_cast<double>(sim.bonds()), static_cast<double>(sim.broken_bonds()),
          sim.bond_energy(), static_cast<double>(pieces.spheres.size()),
          static_cast<double>(*most)};
}
void check_same(const Books& many, const Books& one, double rounding) {
  CHECK(many.bonds == one.bonds);
  CHECK(many.broken == one.broken);
  CHECK(std::abs(many.energy - one.energy) <= rounding * one.energy);
  CHECK(many.fragments == one.fragments);
  CHECK(many.largest == one.largest);
}

// Catches: bonds that stay behind when a particle passes on, or come twice; partners that are not
// among the ghosts; orientations of a step ago; loads that both ranks give.
TEST_CASE("ranks: bonded cubes that fall and roll are those of one process") {
  Seen one;
  Broken none;
  const Books wanted = fall(one, none, tough, 0.02);
  CHECK(wanted.bonds == 6 * 54);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Seen many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      check_same(fall(many, none, tough, 0.02, ranks(comm)), wanted, 1e-8);
    });
    const auto [place, velocity] = many.off(one);
    CHECK(place < 1e-12);
    CHECK(velocity < 1e-9);
    if (n == 1) CHECK(place + velocity == 0);  // the same bits
  }
}

// Bonds break on both sides in the same step, are told once, and their particles touch from then
// on. Numbers of bonds are whole: the same ones break.
TEST_CASE("ranks: agglomerates break as on one process, each bond told once") {
  Seen one;
  Broken breaks;
  const Books wanted = fall(one, breaks, brittle, 0.006);
  breaks.sort();
  CHECK(wanted.broken > 20);
  CHECK(wanted.broken < 200);
  CHECK(breaks.all.size() == static_cast<std::size_t>(wanted.broken));
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Seen many;
    Broken of_many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      check_same(fall(many, of_many, brittle, 0.006, ranks(comm)), wanted, 1e-6);
    });
    of_many.sort();
    REQUIRE(of_many.all.size() == breaks.all.size());
    std::size_t off = 0;
    for (std::size_t k = 0; k < breaks.all.size(); ++k) {
      const auto& [number, a, b, time, energy] = of_many.all[k];
      const auto& [number1, a1, b1, time1, energy1] = breaks.all[k];
      off += number != number1 || a != a1 || b != b1 || time != time1 ||
             !(std::abs(energy - energy1) <= 1e-6 * energy1);
    }
    CHECK(off == 0);
    CHECK(many.off(one)[0] < 1e-10);
    if (n == 1) CHECK(many.off(one)[0] == 0);
  }
}

TEST_CASE("ranks: broken bonds in mixed precision, and twice the same bits") {
  Seen one;
  Broken breaks;
  fall(one, breaks, brittle, 0.004, silt::Mixed{});
  Seen first, second;
  for (Seen* const seen : {&first, &second})
    silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
      Broken own;
      fall(*seen, own, brittle, 0.004, silt::Mixed{}, ranks(comm));
    });
  CHECK(first.all == second.all);
  CHECK(first.off(one)[0] < 1e-7);
}

TEST_CASE("ranks: a beam on a wall, with bonds longer than contacts; its books of energy") {
  Seen one, many;
  auto alone = beam();
  alone.run(0.01), one.add(alone);
  const auto books = alone.energy();
  CHECK(norm(alone.wall(0).force) > 0);
  const double bent = [&] {
    double most = 0;
    for (const auto& [id, p] : one.all) most = std::max(most, std::abs(p.position.z));
    return most;
  }();
  CHECK(bent > 1e-5);
  for (const int n : {2, 3, 5}) {
    Seen seen;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      auto sim = beam(ranks(comm));
      sim.run(0.01), seen.add(sim);
      CHECK(norm(sim.wall(0).force - alone.wall(0).force) < 1e-8 * norm(alone.wall(0).force));
      const auto got = sim.energy();
      CHECK(std::abs(got.bonds - books.bonds) < 1e-9 * books.bonds);
      CHECK(std::abs(got.bond_damping - books.bond_damping) < 1e-9 * books.bonds);
      CHECK(sim.bonded(3, 4));
      CHECK(!sim.bonded(3, 5));
    });
    CHECK(seen.off(one)[0] < 1e-12);
  }
}

// A ring: bonds through the side that repeats, between the first and the last rank.
/// All ranks ask; the one that has the bond tells it, once.
TEST_CASE("ranks: bonds that the user breaks, of two ranks and of a wall") {
  Seen one, many;
  const auto run = [](auto& sim, Seen& seen) {
    sim.run(0.002);
    for (const silt::ParticleId a : {4, 11, 17}) sim.unbond(a + 1, a);
    sim.unbond_from_wall(0, "root");
    sim.run(0.002);
    seen.add(sim);
    CHECK(sim.bonds() == 20);
    CHECK(sim.broken_bonds() == 4);
    CHECK_FALSE(sim.bonded(11, 12));
    return sim.energy().bond_breaking;
  };
  auto alone = beam();
  const double wanted = run(alone, one);
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = beam(ranks(comm));
    CHECK(std::abs(run(sim, many) - wanted) < 1e-6 * wanted);
  });
  CHECK(many.off(one)[0] < 1e-10);
}

TEST_CASE("ranks: bonds through the side of a periodic box") {
  const silt::PeriodicBox ring{{{0, 0, 0}, {0.1, 1, 1}}, {true, false, false}};
  const auto turn = [&](Seen& seen, auto... policies) {
    silt::Particles<silt::Sphere> spheres;
    for (int k = 0; k < 25; ++k)
      spheres.add({.position = {0.002 + 0.004 * k, 0.5, 0.5},
                   .radius = R,
                   .density = 2500,
                   .velocity = {1, 0.1 * std::sin(k), 0.1 * std::cos(k)}});
    silt::Simulation sim{std::move(spheres), silt::Contacts<Law>{glass}, silt::Bonds{tough}, ring,
                         policies...};
    sim.threads = 1;
    CHECK(silt::bond_near(sim, 1e-5) == 25);
    sim.run(0.01), seen.add(sim);
  };
  Seen one;
  turn(one);
  for (const int n : {2, 3}) {
    Seen many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) { turn(many, ranks(comm)); });
    CHECK(many.off(one)[0] < 1e-12);
  }
}

TEST_CASE("ranks: bonds of a particle that leaves through an outlet go with it, on all ranks") {
  const auto leave = [](auto... policies) {
    silt::Particles<silt::Sphere> spheres;
    for (int k = 0; k < 20; ++k)
      spheres.add({.position = {0.004 + 0.004 * k, 0, 0},
                   .radius = R,
                   .density = 2500,
                   .velocity = {2, 0, 0}});
    silt::Simulation sim{std::move(spheres), silt::Contacts<Law>{glass}, silt::Bonds{tough},
                         policies...};
    sim.threads = 1;
    sim.add_outlet({{0.07, -1, -1}, {1, 1, 1}});
    silt::bond_near(sim, 1e-5);
    sim.run(0.01);
    CHECK(sim.size() < 18);
    CHECK(sim.size() > 5);
    CHECK(sim.bonds() == sim.size() - 1);
    CHECK(sim.broken_bonds() == 0);
    return sim.size();
  };
  const std::size_t one = leave();
  for (const int n : {1, 2, 3, 5})
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) { CHECK(leave(ranks(comm)) == one); });
}

TEST_CASE("ranks: a restart on as many ranks goes on with the same bits; bonds are pieces of VTK") {
  const silt_test::Folder folder;
  Seen through, again;
  const auto scene = [&](const silt::ThreadComm& comm) {
    silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<Law>{glass},
                         silt::Bonds{brittle}, silt_test::eager(comm)};
    sim.gravity = {0, 0, -9.81};
    sim.threads = 1;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
    silt::add_bonded(sim, cubes(3));
    return sim;
  };
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = scene(comm);
    sim.run(0.0014);
    silt::save_checkpoint(sim, folder / "run.silt");
    silt::write_bonds(folder / "bonds.vtp", sim);
    sim.run(0.0014);
    through.add(sim);
  });
  CHECK(std::ifstream(folder / "bonds.pvtp").good());
  CHECK(std::ifstream(folder / "bonds_r2.vtp").good());
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = scene(comm);
    silt::load_checkpoint(sim, folder / "run.silt");
    sim.run(0.0014);
    again.add(sim);
  });
  CHECK(through.all == again.all);
}

TEST_CASE("ranks: a restart of bonds on other numbers of ranks, and in one process") {
  const silt_test::Folder folder;
  const auto with_scene = [&](int n, const auto& use) {
    const auto scene = [&](auto... policies) {
      silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<Law>{glass},
                           silt::Bonds{brittle}, policies...};
      sim.gravity = {0, 0, -9.81};
      sim.threads = 1, sim.time_step = 1e-6;
      sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass, {.name = "floor"});
      const auto first = silt::add_bonded(sim, cubes(3));
      sim.bond_to_wall(first + 4, "floor", {0.01, 0.01, 0});
      use(sim);
    };
    if (n == 0) return scene();
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) { scene(silt_test::eager(comm)); });
  };
  for (const int from : {0, 3}) {
    const std::string path = folder / ("run" + std::to_string(from));
    Seen through;
    std::atomic<std::size_t> broken{0}, left{0}, before{0};
    with_scene(from, [&](auto& sim) {
      sim.run(0.0014);
      before = sim.broken_bonds();
      silt::save_checkpoint(sim, path);
      sim.run(0.0006);
      through.add(sim), broken = sim.broken_bonds(), left = sim.bonds();
    });
    CHECK(broken > before);
    CHECK(before > 0);
    CHECK(broken + left == 3 * 54 + 1);
    for (const int to : {0, 1, 2, 5}) {
      CAPTURE(from);
      CAPTURE(to);
      Seen again;
      with_scene(to, [&](auto& sim) {
        silt::load_checkpoint(sim, path);
        CHECK(sim.broken_bonds() == before);
        // Catches the words about bonds that "were made": nothing was, and run(0) does not help.
        if (to > 1 && to != from) {
          CHECK_THROWS_WITH(static_cast<void>(sim.bond_energy()),
                            doctest::Contains("the checkpoint is of another number of ranks"));
        } else {
          CHECK(sim.bond_energy() > 0);
        }
        sim.run(0.0006);
        CHECK(sim.bond_energy() > 0);
        again.add(sim);
        CHECK(sim.broken_bonds() == broken);
        CHECK(sim.bonds() == left);
      });
      CHECK(again.off(through)[0] < 1e-11);
    }
  }
}

// What one rank finds wrong all refuse, and none has half of the bonds.
TEST_CASE("ranks: bonds that cannot be are refused by all ranks alike") {
  std::atomic<int> told{0};
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    silt::Particles<silt::Sphere> spheres;
    for (int k = 0; k < 9; ++k)
      spheres.add({.position = {0.004 * k, 0, 0}, .radius = R, .density = 2500});
    silt::Simulation sim{std::move(spheres), silt::Contacts<Law>{glass}, silt::Bonds{tough},
                         ranks(comm)};
    sim.time_step = 1e-6;
    sim.bond(0, 1), sim.bond(4, 5);
    for (const auto& [a, b] : {std::pair{0, 1}, std::pair{7, 7}, std::pair{3, 99}}) try {
        sim.bond_all(
            {{2, 3}, {static_cast<silt::ParticleId>(a), static_cast<silt::ParticleId>(b)}});
      } catch (const silt::InputError& e) {
        told += std::string(e.what()).find("Simulation::bond") != std::string::npos;
      }
    CHECK(sim.bonds() == 2);
    CHECK_THROWS_WITH(sim.for_each_bond([](const auto&) {}), doctest::Contains("run() first"));
    sim.run(1e-5);
    std::size_t own = 0;
    sim.for_each_bond([&](const auto&) { ++own; });
    CHECK(sim.sum_over_ranks(static_cast<double>(own)) == 2);
    // Between two runs a run of 0 s makes no step, and a step is what they wait for.
    sim.bond(6, 7);
    sim.run(0);
    CHECK_THROWS_WITH(
        sim.for_each_bond([](const auto&) {}),
        doctest::Contains("run() first for at least a step, as by run(step_length())"));
    sim.run(sim.step_length());
    own = 0;
    sim.for_each_bond([&](const auto&) { ++own; });
    CHECK(sim.sum_over_ranks(static_cast<double>(own)) == 3);
  });
  CHECK(told == 9);
}

}  // namespace

}  // namespace parallel_bonds_test
