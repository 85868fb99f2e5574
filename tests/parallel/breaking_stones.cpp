// silt - BSD-3-Clause, see LICENSE
// Polyhedra that break on ranks: every rank has the forms of all cells, in the same places.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include <silt/shape/laguerre_cells.hpp>
#include <silt/shape/polyhedron.hpp>

#include <silt/io/checkpoint.hpp>

#include "break_scenes.hpp"
#include "breakage/stones.hpp"

namespace parallel_breaking_stones_test {

namespace {

using break_scenes::Broken, break_scenes::Books, break_scenes::books_of, break_scenes::ranks;
using breakage_scene::policy, breakage_scene::salt, breakage_scene::stone;
using silt::Vec3d;
using silt_test::Seen;
using Stones = silt::Particles<silt::Polyhedron>;

/// Stones of two sizes that fall onto a plate.
template <class... Policies>
auto rain(silt::BreakStep step, Policies... policies) {
  Stones stones;
  const auto form = stones.add_form(stone(), "stone");
  for (int k = 0; k < 12; ++k)
    stones.add(
        {.form = form,
         .position = {1.5e-3 + 0.0032 * (k % 3), 0.0032 * (k / 3 % 2), 0.0013 + 0.003 * (k / 6)},
         .orientation = silt::rotation_about(silt::normalised(Vec3d{1, 2, 3}), 0.3 * k),
         .radius = k % 2 == 0 ? 0 : 1.1e-3,
         .density = 2165,
         .velocity = {3, 0, -16}});
  silt::Simulation sim{std::move(stones), silt::Contacts<silt::HertzMindlin>{salt},
                       silt::EnergyLedger{}, policy({.dust_below = 4e-4, .step = step}),
                       std::move(policies)...};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
  sim.gravity = {0, 0, -9.81}, sim.threads = 1;
  if (step == silt::BreakStep::SmallestPossible) sim.time_step = 5e-8;
  sim.guard.max_overlap = 0.9;  // fragments are pressed in
  return sim;
}
/// Of each particle: its mass, and volume, moments of inertia and corners of its form.
class Cells {
 public:
  std::map<silt::ParticleId, std::array<double, 6>> all;
  template <class Sim>
  void add(const Sim& sim) {
    const std::lock_guard lock(mutex_);
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k)) continue;
      const auto& form = sim.forms()[sim.form(k)];
      const Vec3d& I = form.mass.inertia;
      all[sim.id(k)] = {
          sim.mass(k), form.mass.volume,
          I.x,         I.y,
          I.z,         static_cast<double>(form.shape.convex_faces().vertices.size())};
    }
  }
  void check_same(const Cells& one) const {
    REQUIRE(all.size() == one.all.size());
    for (const auto& of_cell : all) {
      const auto id = of_cell.first;
      const auto& numbers = of_cell.second;
      CAPTURE(id);
      const auto found = one.all.find(id);
      REQUIRE(found != one.all.end());
      for (std::size_t k = 0; k < numbers.size(); ++k)
        CHECK(std::abs(numbers[k] - found->second[k]) <= 1e-11 * found->second[k]);
    }
  }

 private:
  std::mutex mutex_;
};
struct End {
  Books books;
  std::size_t forms;
  std::int64_t steps;
};
template <class Sim>
End run(Sim& sim, double time, Seen& seen, Broken& breaks, Cells& cells) {
  std::vector<silt::BreakEvent> own;
  const auto watch = silt::on_break([&](const silt::BreakEvent& b) { own.push_back(b); });
  sim.run(time / 2, watch);
  sim.break_particle(12);  // a fragment
  sim.run(time / 2, watch);
  breaks.add(own), cells.add(sim);
  return {books_of(sim, seen), sim.forms().size(), sim.step()};
}

// Catches: cells that the rank of a body has and its neighbour does not, or another one in that
// place; masses or orientations of another rank's parent that are rounded; fragments that touch as
// they come; generations of fragments that break elsewhere than they were born.
TEST_CASE("ranks: polyhedra that break are those of one process, and so are their cells") {
  using enum silt::BreakStep;
  for (const silt::BreakStep step : {SmallestPossible, SmallestLiving}) {
    const double time = step == SmallestPossible ? 2.5e-4 : 1e-4;
    Seen one;
    Broken breaks;
    Cells cells;
    auto alone = rain(step);
    const End wanted = run(alone, time, one, breaks, cells);
    breaks.sort();
    CHECK(wanted.books.whole[1] > 5);
    CHECK(one.all.size() > 50);
    CHECK(std::any_of(breaks.all.begin(), breaks.all.end(),
                      [](const auto& b) { return std::get<0>(b) >= 12 && std::get<3>(b) > 1; }));
    for (const int n : {1, 2, 3, 5}) {
      if (step == SmallestLiving && n != 3) continue;
      CAPTURE(n);
      Seen many, twice;
      Broken of_many, of_twice;
      Cells of_ranks, again;
      std::vector<std::size_t> forms;
      std::mutex mutex;
      const auto fall = [&](const silt::ThreadComm& comm, Seen& seen, Broken& b, Cells& c) {
        auto sim = rain(step, ranks(comm, 0.011));
        const End got = run(sim, time, seen, b, c);
        got.books.check_same(wanted.books);
        CHECK(got.steps == wanted.steps);
        const std::lock_guard lock(mutex);
        forms.push_back(got.forms);
      };
      silt::run_on_ranks(
          n, [&](const silt::ThreadComm& comm) { fall(comm, many, of_many, of_ranks); });
      CHECK(forms == std::vector<std::size_t>(static_cast<std::size_t>(n), forms.front()));
      of_many.sort();
      REQUIRE(of_many.all.size() == breaks.all.size());
      for (std::size_t k = 0; k < breaks.all.size(); ++k) {
        const auto [id, when, first, number, dust] = of_many.all[k];
        const auto [its_id, its_time, its_first, its_number, its_dust] = breaks.all[k];
        CHECK(id == its_id);
        CHECK(first == its_first);
        CHECK(number == its_number);
        CHECK(std::abs(when - its_time) < 1e-9 * its_time);
        CHECK(std::abs(dust - its_dust) <= 1e-9 * its_dust);
      }
      of_ranks.check_same(cells);
      CHECK(many.off(one)[0] < 1e-9);
      if (n != 3) continue;
      silt::run_on_ranks(n,
                         [&](const silt::ThreadComm& comm) { fall(comm, twice, of_twice, again); });
      CHECK(twice.all == many.all);
      CHECK(again.all == of_ranks.all);
    }
  }
}

TEST_CASE("ranks: a restart of stones on as many ranks has their cells, and the same bits") {
  const silt_test::Folder folder;
  Seen through, again;
  Broken none;
  Cells cells, after;
  std::vector<std::size_t> forms;
  std::mutex mutex;
  const auto go_on = [&](auto& sim, Seen& seen, Cells& of) {
    const End end = run(sim, 5e-5, seen, none, of);
    const std::lock_guard lock(mutex);
    forms.push_back(end.forms);
  };
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = rain(silt::BreakStep::SmallestPossible, silt_test::eager(comm));
    sim.run(1.2e-4);
    CHECK(sim.broken() > 3);
    sim.break_particle(11);
    silt::save_checkpoint(sim, folder / "run.silt");
    go_on(sim, through, cells);
  });
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = rain(silt::BreakStep::SmallestPossible, silt_test::eager(comm));
    silt::load_checkpoint(sim, folder / "run.silt");
    CHECK(sim.breaks_due() > 0);
    go_on(sim, again, after);
  });
  CHECK(through.all == again.all);
  CHECK(cells.all == after.all);
  CHECK(forms == std::vector<std::size_t>(6, forms.front()));
}

Stones::Particle one(double x) {
  Stones::Particle p{};
  p.form = 0, p.position = {x, 0, 0}, p.density = 2165;
  return p;
}
// Catches: a form that one rank takes for free while a body of another rank has it; forms that no
// rank frees.
TEST_CASE("ranks: there are as many forms as fragments at one time, round after round") {
  silt::run_on_ranks(3, [](const silt::ThreadComm& comm) {
    Stones stones;
    stones.add_form(stone(), "stone");
    silt::Simulation sim{stones, silt::Contacts<silt::HertzMindlin>{salt},
                         policy({.dust_below = 4e-4}), ranks(comm, 0.03)};
    sim.time_step = 5e-8, sim.threads = 1;
    std::size_t most_living = 0, most_forms = 0, made = 0;
    const auto ids = [&] {
      std::vector<silt::ParticleId> own;
      for (std::size_t k = 0; k < sim.rows(); ++k)
        if (sim.is_present(k)) own.push_back(sim.id(k));
      auto all = silt::gather(comm, std::span<const silt::ParticleId>(own)).values;
      std::sort(all.begin(), all.end());
      return all;
    };
    for (int round = 0; round < 5; ++round) {
      Stones more;
      more.add_form(stone());
      for (const double x : {0.009, 0.0105, 0.021}) more.add(one(x));
      CHECK(sim.add(more) == std::vector<std::size_t>{0});
      // A part of the fragments stays, on all ranks, while others come.
      for (int generation = 0; generation < 2; ++generation) {
        auto parents = ids();
        if (generation > 0) parents.resize(parents.size() / 4);
        for (const auto id : parents) sim.break_particle(id);
        sim.run(1e-7);
        made += sim.size();
        const auto m = sim.mass_balance();
        CHECK(std::abs(m.residual()) < 1e-12 * m.fed);
        most_living = std::max(most_living, sim.size() + parents.size());
        most_forms = std::max(most_forms, sim.forms().size());
        // As each rank sees it, each body has a form of its mass, and none has that of another.
        std::vector<double> uses(sim.forms().size(), 0);
        for (std::size_t k = 0; k < sim.rows(); ++k) {
          if (!sim.is_present(k)) continue;
          const double scale = sim.scale(k);
          const double volume = sim.forms()[sim.form(k)].mass.volume * scale * scale * scale;
          CHECK(std::abs(sim.mass(k) - 2165 * volume) <= 1e-12 * sim.mass(k));
          ++uses[sim.form(k)];
        }
        sim.sum_over_ranks(std::span<double>(uses));
        CHECK(*std::max_element(uses.begin() + 1, uses.end()) == 1);
        CHECK(sim.largest_over_ranks(static_cast<double>(sim.forms().size())) ==
              static_cast<double>(sim.forms().size()));
      }
      for (const auto id : ids())
        if (id % 3 != 0 || round % 2 == 1) sim.remove(id);
      sim.run(1e-7);
    }
    CHECK(made > 3 * most_living);
    CHECK(most_forms <= most_living + 1);
  });
}

/// Two bricks that are pressed together when the first one breaks: what the ledger cannot explain
/// of it, over what was stored.
template <class... Policies>
double unexplained(double dt, Policies... policies) {
  std::vector<Vec3d> corners;
  for (int c = 0; c < 8; ++c)
    corners.push_back({c & 1 ? 0.6e-3 : -0.6e-3, c & 2 ? 0.8e-3 : -0.8e-3, c & 4 ? 1e-3 : -1e-3});
  Stones two;
  two.add_form(silt::Polyhedron::from_points(corners));
  for (const double side : {-1.0, 1.0})
    two.add({.form = 0,
             .position = {0.6e-3 * side, 2e-4 * side, 0},
             .orientation = silt::rotation_about({1, 0, 0}, 0.3 * side),
             .density = 2165,
             .velocity = {-1.5 * side, 0, 0.5 * side},
             .angular_velocity = {100 * side, 0, 0}});
  silt::Simulation sim{std::move(two), silt::Contacts<silt::HertzMindlin>{salt},
                       silt::EnergyLedger{},
                       policy({.dust_below = 5e-4, .most_fragments = 8},
                              {.median = 1e9, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3}),
                       std::move(policies)...};
  sim.time_step = dt, sim.threads = 1;
  sim.run(2e-6);
  const auto before = sim.energy();
  CHECK(before.normal > 4e-7);
  sim.break_particle(0);
  sim.run(2 * dt);
  CHECK(sim.broken() == 1);
  return (sim.energy().residual() - before.residual()) / before.normal;
}
// Catches: contacts with another rank's body that end unbooked or are booked by both, 0.01 to 1.
TEST_CASE("ranks: the ledger closes where a brick breaks that another rank's brick presses") {
  const double wanted = unexplained(4e-8);
  CHECK(std::abs(wanted) < 2.5e-4);
  silt::run_on_ranks(2, [&](const silt::ThreadComm& comm) {
    const double got =
        unexplained(4e-8, silt::Ranks{comm, silt_test::WanderingSlabs{-2e-3, 2e-3, false}});
    CHECK(std::abs(got - wanted) < 1e-8);
  });
}

}  // namespace

}  // namespace parallel_breaking_stones_test
