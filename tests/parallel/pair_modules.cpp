// silt - BSD-3-Clause, see LICENSE
// Modules that act between particles at a distance, where the two belong to two ranks, or to two
// that do not touch: charges, radiation, a module of one's own.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/module/charge/tribo_charge.hpp>
#include <silt/module/heat/mutual_radiation.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/simulation/energy_ledger.hpp>

#include "body_scenes.hpp"
#include "near.hpp"
#include "rank_scenes.hpp"

namespace parallel_pair_modules_test {

namespace {

using silt::Charge;
using silt::ElectricCharge;
using silt::Vec3d;
using silt_test::glass;
using silt_test::Seen;

/// Charges of both signs; each sees some 40 others. They push grains of 0.4 g with up to 0.01 N.
const double q = 1e-8;  // [C]
const Charge charge{.cutoff = 0.022};

template <class Sim>
void give_charges(Sim& sim, double of = q) {
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.template field<ElectricCharge>(k) = (sim.id(k) % 3 == 0 ? -2 : 1) * of;
}
template <class... Policies>
auto charged(Policies... policies) {
  auto sim = silt_test::trough(silt_test::cloud(12, 4, 3), policies...);
  give_charges(sim);
  return sim;
}

// Catches: pairs that a rank misses because the other is no ghost, or whose ghost has an old place
// or charge; pairs that two ranks count twice; a time step chosen by the pairs of one rank alone.
TEST_CASE("ranks: charges move as in one process") {
  Seen plain, one;
  double step = 0;
  const auto run = [&](Seen& to, auto... policies) {
    auto sim = charged(charge, policies...);
    sim.run(0.015), sim.run(0.005);
    to.add(sim);
    return sim.step_length();
  };
  step = run(one);
  {
    auto sim = silt_test::trough(silt_test::cloud(12, 4, 3));
    sim.run(0.02);
    plain.add(sim);
  }
  REQUIRE(one.off(plain)[0] > 1e-3);  // or the charges would do nothing
  for (const int n : {1, 2, 3, 5, 8}) {
    CAPTURE(n);
    Seen many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      CHECK(run(many, silt_test::wandering(comm)) == near(step).epsilon(1e-12));
    });
    // Rounding, which collisions have amplified; in one rank nothing is rounded differently.
    CHECK(many.off(one)[0] < (n == 1 ? 1e-300 : 1e-10));
    CHECK(many.off(one)[1] < (n == 1 ? 1e-300 : 1e-8));
  }
}

// Catches: a rate that each rank measures among the particles that it was given, before they are
// divided; the step would depend on the number of ranks, and be too long for the two.
TEST_CASE("ranks: the time step resolves a pair whose particles begin on two ranks") {
  const auto step_of = [](auto... policies) {
    silt::Particles<silt::Sphere> two;
    for (const double x : {0.0, 1.0})
      two.add({.position = {x * 3e-4, 0, 0}, .radius = 1e-4, .density = 2500});
    silt::Simulation sim{std::move(two), silt::Contacts<silt::HertzMindlin>{glass},
                         Charge{.cutoff = 0.01}, policies...};
    give_charges(sim, 4e-11);
    sim.gravity = {0, 0, -1e-3};
    sim.run(0);
    return sim.step_length();
  };
  const double wanted = step_of();
  for (const int n : {2, 4})
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      CHECK(step_of(silt::Ranks{comm}) == near(wanted).epsilon(1e-12));
    });
}

/// The same from both sides, but for rounding.
struct Lopsided {
  struct Fields {
    double strength = 0;
  };
  static constexpr std::array names{"strength"};
  double range = 0.03;  // [m]
  double reach() const { return range; }
  Vec3d pair_force(const silt::Apart& d, const silt::Seen&, const Fields& f, const silt::Seen&,
                   const Fields& g) const {
    return (1e-6 * ((0.1 + f.strength) + g.strength) / d.distance) * d.from_other;
  }
  double pair_stiffness(const silt::Apart&, const silt::Seen&, const Fields&, const silt::Seen&,
                        const Fields&) const {
    return 0.1;
  }
};
template <class Module, class Sim>
void give_strengths(Sim& sim) {
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.template field<Module>(k).strength = 0.7 * static_cast<double>(sim.id(k) + 1);
}

// Catches: two ranks that compute a pair each from its own side, whose forces then differ in the
// last bit.
TEST_CASE("ranks: the two forces of a pair are opposite to the bit") {
  std::array<Vec3d, 2> force{};
  std::mutex mutex;
  silt::run_on_ranks(2, [&](const silt::ThreadComm& comm) {
    silt::Particles<silt::Sphere> two;
    two.add({.position = {0.017, 0.003, 0.001}, .radius = 1e-3, .density = 2500});
    two.add({.position = {0.002, 0.004, 0.002}, .radius = 1e-3, .density = 2500});
    silt::Simulation sim{std::move(two), silt::Contacts<silt::HertzMindlin>{glass}, Lopsided{},
                         silt::Ranks{comm, silt_test::WanderingSlabs{0, 0.02, false}}};
    sim.time_step = 1e-5;
    give_strengths<Lopsided>(sim);
    sim.run(1e-5);
    CHECK(sim.rows() == 1);
    const std::lock_guard lock(mutex);
    force.at(sim.id(0)) = sim.module_force(0);
  });
  CHECK(norm(force[0]) > 1e-7);
  for (const auto x : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) CHECK(force[0].*x == -(force[1].*x));
  const double a = 1e-6 * ((0.1 + 0.7) + 1.4), b = 1e-6 * ((0.1 + 1.4) + 0.7);
  REQUIRE(a != b);  // or the order would not matter
}

// Catches: a rank that goes on with the ghosts of a shorter reach.
TEST_CASE("ranks: an observer may lengthen the reach of a module") {
  const auto run = [](Seen& to, auto... policies) {
    auto sim = silt_test::trough(silt_test::cloud(12, 4, 3), Lopsided{.range = 0.009}, policies...);
    sim.time_step = 1e-5;
    give_strengths<Lopsided>(sim);
    sim.run(4e-3, silt::at(silt::every_steps(37), [](auto& s) {
              s.template module<Lopsided>().range = 0.009 + 2 * s.time();
            }));
    to.add(sim);
  };
  Seen one;
  run(one);
  for (const int n : {2, 5}) {
    Seen many;
    silt::run_on_ranks(
        n, [&](const silt::ThreadComm& comm) { run(many, silt_test::wandering(comm)); });
    CHECK(many.off(one)[0] < 1e-11);
  }
}

/// Bodies with a module of one's own, between surfaces, which reaches over several ranks, in a box
/// that is periodic along x.
struct Between {
  using Fields = Lopsided::Fields;
  static constexpr std::array names{"strength"};
  double gap_reach() const { return 0.02; }
  Vec3d pair_force(const silt::Apart& d, const silt::Seen& a, const Fields& f, const silt::Seen& b,
                   const Fields& g) const {
    return Lopsided{}.pair_force(d, a, f, b, g);
  }
  double pair_stiffness(const silt::Apart&, const silt::Seen&, const Fields&, const silt::Seen&,
                        const Fields&) const {
    return 0.1;
  }
};
template <class Shape, class AddForms>
void check_bodies(const AddForms& add_forms) {
  const auto run = [&](Seen& to, auto... policies) {
    silt::Simulation sim{silt_test::bodies<Shape>({8, 3, 2}, 0.01, add_forms, 0.3),
                         silt::Contacts<silt::HertzMindlin>{silt_test::stone}, Between{},
                         silt::PeriodicBox{{{0, -1, -1}, {0.08, 1, 1}}, {true, false, false}},
                         policies...};
    give_strengths<Between>(sim);
    sim.time_step = 1e-5;
    sim.run(4e-3);
    to.add(sim);
  };
  Seen one;
  run(one);
  for (const int n : {2, 3, 5}) {
    CAPTURE(n);
    Seen many;
    silt::run_on_ranks(
        n, [&](const silt::ThreadComm& comm) { run(many, silt_test::wandering(comm, 0.08)); });
    CHECK(many.off(one)[0] < 1e-11);
    CHECK(many.off(one)[1] < 1e-9);
  }
}
// Catches: ghosts chosen by the places of parts, where modules see centres of mass and bounding
// spheres; images of a periodic box that one rank sees and the other does not.
TEST_CASE("ranks: bodies of balls act on each other at a distance") {
  check_bodies<silt::MultiSphere>([](auto& all) {
    all.add_form(
        silt::MultiSphere{{{{0, 0, 0}, 1e-3}, {{0.9e-3, 0, 0}, 0.8e-3}, {{0, 0, 0.9e-3}, 0.8e-3}}});
    return std::size_t{1};
  });
}
TEST_CASE("ranks: super-ellipsoids act on each other at a distance") {
  check_bodies<silt::SuperEllipsoid>([](auto& all) {
    all.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 0.9e-3, .c = 0.6e-3, .s1 = 4, .s2 = 4});
    return std::size_t{1};
  });
}

/// A number of each particle, put together by the ranks.
struct Numbers {
  std::map<silt::ParticleId, double> all;
  std::mutex mutex;
};

// Catches: heat that one side of a pair gives and the other does not get, also while fluxes are
// held for some steps.
TEST_CASE("ranks: radiation between neighbours is that of one process, and none is lost") {
  const silt::MutualRadiation radiating{
      silt::HeatConduction{.conductivity = 20, .heat_capacity = 0.05},
      {.emissivity = 0.9, .gap = 0.006}};
  const auto run = [&](Numbers& to, auto... policies) {
    auto sim = silt_test::trough(silt_test::cloud(12, 4, 3), radiating, policies...);
    const auto all = [&] {
      double sum = 0;
      for (std::size_t k = 0; k < sim.rows(); ++k)
        sum += 0.05 * sim.mass(k) * sim.template field<silt::Temperature>(k);
      return sim.sum_over_ranks(sum);
    };
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sim.template field<silt::Temperature>(k) = 300 + 500 * static_cast<double>(sim.id(k) % 4);
    const double before = all();
    sim.run(0.02);
    const double gained = (all() - before) / before;
    const std::lock_guard lock(to.mutex);
    for (std::size_t k = 0; k < sim.rows(); ++k)
      to.all[sim.id(k)] = sim.template field<silt::Temperature>(k);
    return gained;
  };
  Numbers one;
  CHECK(std::abs(run(one)) < 1e-13);
  double most = 0;
  for (const auto& [id, T] : one.all)
    most = std::max(most, std::abs(T - 300 - 500 * static_cast<double>(id % 4)));
  REQUIRE(most > 1);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Numbers many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      CHECK(std::abs(run(many, silt_test::wandering(comm))) < 1e-13);
    });
    REQUIRE(many.all.size() == one.all.size());
    for (const auto& [id, T] : one.all)
      CHECK(std::abs(many.all[id] - T) < (n == 1 ? 1e-300 : 1e-8));
  }
}

// Catches: charges that pass in contacts of two ranks and are lost, or of which ghosts do not know.
TEST_CASE("ranks: charges that impacts separate are those of one process") {
  const auto run = [&](Numbers& to, auto... policies) {
    auto other = glass;
    other.poisson_ratio = 0.25;
    silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials> contacts{{glass, other}};
    contacts.set_pair(contacts.material(0), contacts.material(1),
                      {.restitution = 0.6, .friction = 0.4});
    silt::Simulation sim{silt_test::cloud(12, 4, 3, 0.0085, 2), contacts,
                         silt::TriboCharge{charge, {.work_functions = {4.0, 4.5}}}, policies...};
    sim.gravity = {1, 0, -9.81};
    sim.threads = 1;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
    sim.run(0.02);
    const std::lock_guard lock(to.mutex);
    for (std::size_t k = 0; k < sim.rows(); ++k)
      to.all[sim.id(k)] = sim.template field<ElectricCharge>(k);
  };
  Numbers one;
  run(one);
  double most = 0;
  for (const auto& [id, x] : one.all) most = std::max(most, std::abs(x));
  REQUIRE(most > 1e-13);
  for (const int n : {2, 3, 5}) {
    CAPTURE(n);
    Numbers many;
    silt::run_on_ranks(
        n, [&](const silt::ThreadComm& comm) { run(many, silt_test::wandering(comm)); });
    REQUIRE(many.all.size() == one.all.size());
    for (const auto& [id, x] : one.all) CHECK(std::abs(many.all[id] - x) < 1e-7 * most);
  }
}

// Catches: newcomers and removed particles of another rank that modules do not see, or still see;
// work of a pair that two ranks book, or none.
TEST_CASE("ranks: charged particles come and go, and the books are those of one process") {
  std::array<double, 3> wanted{};
  Seen one;
  const auto run = [&](Seen& to, auto... policies) {
    auto sim = charged(charge, silt::EnergyLedger{}, policies...);
    sim.time_step = 1e-5;
    int call = 0;
    sim.run(
        0.015, silt::at(silt::every(0.003), [&](auto& s) {
          if (++call == 1) return;
          s.remove(static_cast<silt::ParticleId>(17 * call));
          silt::Particles<silt::Sphere> more;
          more.add(
              {.position = {0.005 + 0.015 * call, 0.02, 0.05}, .radius = 2e-3, .density = 2500});
          s.add(more);
          for (std::size_t k = 0; k < s.rows(); ++k)
            if (s.is_present(k) && s.id(k) >= 144) s.template field<ElectricCharge>(k) = 2 * q;
        }));
    sim.share_edits();
    to.add(sim);
    const auto books = sim.energy();
    return std::array{books.kinetic(), books.turned_over, books.residual()};
  };
  wanted = run(one);
  REQUIRE(one.all.size() == 144);  // as many as came have gone
  REQUIRE(one.all.rbegin()->first >= 147);
  CHECK(std::abs(wanted[2]) < 0.01 * wanted[1]);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Seen many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      const auto got = run(many, silt_test::wandering(comm));
      for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(got[k] - wanted[k]) < 1e-8 * wanted[1]);
    });
    CHECK(many.off(one)[0] < 1e-9);
  }
}

// Catches: the reach of ghosts or the work of pairs that a file lacks, so that the run that goes on
// searches, or divides space, where the one that never stopped does not.
TEST_CASE("ranks: a run of charges continues from its file, on as many ranks to the bit") {
  const silt_test::Folder folder;
  const std::string path = folder / "run";
  for (const int to : {3, 2, 0}) {
    Seen through, again;
    const auto through_run = [&](auto... policies) {
      auto sim = charged(charge, policies...);
      sim.time_step = 1e-5;
      sim.run(4.07e-3);
      silt::save_checkpoint(sim, path);
      sim.run(8e-3);
      through.add(sim);
    };
    const auto again_run = [&](auto... policies) {
      auto sim = charged(charge, policies...);
      sim.time_step = 1e-5;
      silt::load_checkpoint(sim, path);
      sim.run(8e-3);
      again.add(sim);
    };
    const auto eager = [](const silt::ThreadComm& comm) {
      return silt::Ranks{comm, silt::Bisection{},
                         silt::Rebalance{.above = 1, .each = 0.2, .per_moved = 0.5}};
    };
    silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) { through_run(eager(comm)); });
    if (to == 0)
      again_run();
    else
      silt::run_on_ranks(to, [&](const silt::ThreadComm& comm) { again_run(eager(comm)); });
    CAPTURE(to);
    CHECK(again.off(through)[0] < (to == 3 ? 1e-300 : 1e-10));
    CHECK(again.off(through)[1] < (to == 3 ? 1e-300 : 1e-8));
  }
}

// Catches: work that is counted in a list of before a search, in steps in which a flux is held: the
// file would hold the work of other particles, and be refused where their number is another one.
TEST_CASE("ranks: a run with radiation that is held continues from any of its files") {
  const silt_test::Folder folder;
  const silt::MutualRadiation radiating{
      silt::HeatConduction{.conductivity = 1, .heat_capacity = 100, .flux_every = 40},
      {.emissivity = 0.9, .gap = 0.006}};
  const auto path = [&](int k) { return folder / ("run" + std::to_string(k)); };
  const auto with = [&](const auto& use) {
    silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
      auto sim = silt_test::trough(
          silt_test::cloud(12, 4, 3), radiating,
          silt::Ranks{comm, silt::Bisection{},
                      silt::Rebalance{.above = 1, .each = 0.2, .per_moved = 0.5}});
      sim.time_step = 1e-5;
      for (std::size_t k = 0; k < sim.rows(); ++k)
        sim.template field<silt::Temperature>(k) = 300 + 500 * static_cast<double>(sim.id(k) % 4);
      use(sim);
    });
  };
  const int saved = 6;
  Seen through;
  with([&](auto& sim) {
    int call = 0;
    sim.run(6.1e-3, silt::at(silt::every_steps(101), [&](auto& s) {
              if (call < saved) silt::save_checkpoint(s, path(call++));
            }));
    sim.run(2e-3);
    through.add(sim);
  });
  for (int k = 1; k < saved; ++k) {
    CAPTURE(k);
    Seen again;
    with([&](auto& sim) {
      silt::load_checkpoint(sim, path(k));
      sim.run(6.1e-3 - sim.time());
      sim.run(2e-3);
      again.add(sim);
    });
    CHECK(again.off(through)[0] < 1e-300);
  }
}

// Catches: a decomposition that weighs contacts alone, where nearly all work is that of pairs at a
// distance: here a dense block of charges beside a long row of few.
TEST_CASE("ranks: work of pairs at a distance is divided as well") {
  silt::run_on_ranks(2, [&](const silt::ThreadComm& comm) {
    silt::Particles<silt::Sphere> grains;
    for (int k = 0; k < 400; ++k)
      grains.add(
          {.position = {1e-3 * (k % 20), 1e-3 * (k / 20), 0}, .radius = 4e-4, .density = 2500});
    for (int k = 0; k < 400; ++k)
      grains.add({.position = {0.05 + 2e-2 * k, 0, 0}, .radius = 4e-4, .density = 2500});
    silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
                         Charge{.cutoff = 0.01},
                         silt::Ranks{comm, silt::Bisection{}, silt::Rebalance{.above = 1.02}}};
    sim.time_step = 1e-5;
    give_charges(sim, 1e-12);
    for (std::size_t k = 0; k < sim.rows(); ++k)  // or nobody searches, and nothing is divided
      sim.set_velocity(sim.id(k), {0, 0, sim.id(k) % 2 == 0 ? 0.2 : -0.2});
    sim.run(5e-3);
    const auto loads = sim.rank_loads();
    CHECK(std::max(loads[0].particles, loads[1].particles) > 500);
    CHECK(std::max(loads[0].work, loads[1].work) < 1.1 * 0.5 * (loads[0].work + loads[1].work));
  });
}

}  // namespace

}  // namespace parallel_pair_modules_test
