// silt - BSD-3-Clause, see LICENSE
// Spheres that break on ranks: the same ones break into the same fragments as on one process, while
// the planes between ranks move through them at each search.
#include <doctest/doctest.h>

#include <atomic>
#include <string>
#include <vector>

#include <silt/io/checkpoint.hpp>

#include "break_scenes.hpp"

namespace parallel_breakage_test {

namespace {

using break_scenes::Broken, break_scenes::Books, break_scenes::ranks, break_scenes::shower,
    break_scenes::books_of;
using breakage_scene::salt, breakage_scene::Policy;
using silt_test::Seen;

template <class Policy, class... Policies>
Books fall_of(const Policy& policy, Seen& seen, Broken& breaks, double time, Policies... policies) {
  auto sim = shower(policy, policies...);
  std::vector<silt::BreakEvent> own;
  const auto watch = silt::on_break([&](const silt::BreakEvent& b) { own.push_back(b); });
  sim.run(time / 2, watch);
  sim.break_particle(143);
  sim.run(time / 2, watch);
  breaks.add(own);
  return books_of(sim, seen);
}
template <class... Policies>
Books fall(Seen& seen, Broken& breaks, double time, Policies... policies) {
  return fall_of(breakage_scene::policy(), seen, breaks, time, policies...);
}

// Catches: particles that break on two ranks or on none; ids, draws and dust that depend on ranks;
// fragments that touch as they come where a partner is a ghost; impacts that are counted twice.
TEST_CASE("ranks: spheres that break are those of one process, and so are their fragments") {
  Seen one;
  Broken breaks;
  const Books wanted = fall(one, breaks, 2.4e-4);
  breaks.sort();
  CHECK(wanted.whole[1] > 30);
  CHECK(wanted.whole[2] > 3);
  CHECK(one.all.size() > 200);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Seen many;
    Broken of_many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      fall(many, of_many, 2.4e-4, ranks(comm)).check_same(wanted);
    });
    of_many.sort();
    CHECK(of_many.all == breaks.all);
    CHECK(many.off(one)[0] < 1e-9);
  }
}

silt::Breakage<silt::LogLogisticStrength, silt::ForceEquivalence, silt::GaudinSchuhmann,
               silt::PowerFatigue>
by_force(const silt::LogLogisticStrength& strength) {
  const auto of = breakage_scene::policy();
  return {strength, silt::ForceEquivalence{}, of.sizes, of.fatigue, of.rules};
}

// Catches: loads that one of two ranks alone sees; largest forces that do not move with a contact.
TEST_CASE("ranks: spheres that break by the force of a contact do so in the steps of one process") {
  const auto of = by_force(breakage_scene::strong);
  Seen one;
  Broken breaks;
  const Books wanted = fall_of(of, one, breaks, 2.4e-4);
  breaks.sort();
  CHECK(wanted.whole[1] > 30);
  CHECK(wanted.whole[2] > 3);
  for (const int n : {1, 2, 3, 5}) {
    CAPTURE(n);
    Seen many;
    Broken of_many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      Books books = fall_of(of, many, of_many, 2.4e-4, ranks(comm));
      books.whole[6] = wanted.whole[6];  // loads looked at: those above the weakest of a rank
      books.check_same(wanted);
    });
    of_many.sort();
    CHECK(of_many.all == breaks.all);
    CHECK(many.off(one)[0] < 1e-9);
  }
}

// Catches: a grain that comes from another rank and is weaker than all that are there, whose loads
// are not looked at, or only when they are as large as the strength of another one.
TEST_CASE("ranks: a weak grain that comes among strong ones breaks under its own strength") {
  // 0.09 N at 1.6 mm, 300 N at 2.4 mm.
  const auto of = by_force({.median = 8, .at_diameter = 2e-3, .exponent = 20, .spread = 50});
  const auto hit = [&](Broken& breaks, auto... policies) {
    silt::Particles<silt::Sphere> feed;
    for (int k = 0; k < 6; ++k) {
      const double y = 4e-3 * k;
      feed.add(
          {.position = {1e-3, y, 0}, .radius = 0.8e-3, .density = 2165, .velocity = {8, 0, 0}});
      feed.add({.position = {0.005 + 0.002 * k, y, 0}, .radius = 1.2e-3, .density = 2165});
    }
    silt::Simulation sim{std::move(feed), silt::Contacts<silt::HertzMindlin>{salt},
                         silt::EnergyLedger{}, of, std::move(policies)...};
    sim.threads = 1;
    sim.time_step = 1.2e-7;
    std::vector<silt::BreakEvent> own;
    sim.run(2.4e-7);  // each rank now has its own grains alone
    sim.run(1.6e-3, silt::on_break([&](const silt::BreakEvent& b) {
              if (b.generation == 0) own.push_back(b);
            }));
    breaks.add(own);
  };
  Broken one;
  hit(one);
  one.sort();
  CHECK(one.all.size() == 6);
  for (const int n : {2, 3, 5}) {
    CAPTURE(n);
    Broken many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      hit(many, silt::Ranks{comm, silt::StaticSlabs{.axis = 0}});
    });
    many.sort();
    REQUIRE(many.all.size() == one.all.size());
    for (std::size_t k = 0; k < one.all.size(); ++k) {
      CHECK(std::get<0>(many.all[k]) == std::get<0>(one.all[k]));
      CHECK(std::get<1>(many.all[k]) == std::get<1>(one.all[k]));
    }
  }
}

TEST_CASE("ranks: a restart of breaking spheres on as many ranks has the same bits") {
  const silt_test::Folder folder;
  Seen through, again;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = shower(breakage_scene::policy(), silt_test::eager(comm));
    sim.run(6e-5);
    sim.break_particle(143);
    silt::save_checkpoint(sim, folder / "run.silt");
    sim.run(6e-5);
    books_of(sim, through);
  });
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = shower(breakage_scene::policy(), silt_test::eager(comm));
    silt::load_checkpoint(sim, folder / "run.silt");
    sim.run(6e-5);
    books_of(sim, again);
  });
  CHECK(through.all == again.all);
}

/// Which nobody has for a few particles.
struct Faulty {
  double strength(double, double, double rank) const { return rank > 0.993 ? 0 : 8; }
  double weaker(double, double, double) const { return 0; }
  void check() const {}
};
// A strength that one rank alone finds wrong is a sentence on all.
TEST_CASE("ranks: a strength of 0 on one rank, and what cannot break, are refused by all") {
  std::atomic<int> told{0}, refused{0};
  const auto run = [&](const silt::ThreadComm& comm) {
    auto sim = shower(breakage_scene::policy(), ranks(comm));
    try {
      sim.break_particle(999);
    } catch (const silt::InputError& e) {
      told += std::string(e.what()).find("there is no particle 999") != std::string::npos;
    }
    silt::Breakage faulty{Faulty{}, silt::HertzEquivalence{}, silt::GaudinSchuhmann{1, 0.8},
                          silt::PowerFatigue{.kappa = 0.1, .psi = 3},
                          silt::BreakageRules{.dust_below = 0.3e-3}};
    silt::Particles<silt::Sphere> feed;
    for (int k = 0; k < 300; ++k)
      feed.add({.position = {0.002 * k, 0, 0}, .radius = 1e-3, .density = 2165});
    try {
      silt::Simulation other{std::move(feed), silt::Contacts<silt::HertzMindlin>{salt}, faulty,
                             ranks(comm)};
    } catch (const silt::InputError& e) {
      refused += std::string(e.what()).find("strength() gives 0") != std::string::npos;
    }
  };
  silt::run_on_ranks(3, run);
  CHECK(told == 3);
  CHECK(refused == 3);
}

}  // namespace

}  // namespace parallel_breakage_test
