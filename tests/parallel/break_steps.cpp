// silt - BSD-3-Clause, see LICENSE
// The time step that follows the smallest living particles, on ranks: it changes in the same steps
// to the same lengths as on one process, wherever the smallest particles are born.
#include <doctest/doctest.h>

#include <cmath>
#include <mutex>
#include <string>
#include <vector>

#include <silt/contact/softened.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>

#include "break_scenes.hpp"

namespace parallel_break_steps_test {

namespace {

using break_scenes::Broken, break_scenes::Books, break_scenes::books_of, break_scenes::ranks;
using silt_test::Seen;

constexpr auto living = silt::BreakStep::SmallestLiving;

template <class... Policies>
auto shower(Policies... policies) {
  auto sim = break_scenes::shower(breakage_scene::policy({.dust_below = 0.2e-3, .step = living}),
                                  policies...);
  sim.time_step.reset();
  sim.guard.max_overlap = 0.6;
  return sim;
}
/// Takes out the small ones now and then, so that the step grows again.
auto sieve() {
  return silt::at(silt::every(6e-5), [](auto& sim) {
    std::vector<silt::ParticleId> small;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k) && sim.radius(k) < 0.6e-3) small.push_back(sim.id(k));
    for (const silt::ParticleId id : small) sim.remove(id);
  });
}
struct Fall {
  Books books;
  std::vector<double> steps;  // [s] length of each, if they are observed
  double time = 0;            // [s]
  std::int64_t step = 0;
};
template <class... Policies>
Fall fall(Seen& seen, Broken& breaks, bool observed, Policies... policies) {
  auto sim = shower(policies...);
  Fall out;
  std::vector<silt::BreakEvent> own;
  const auto watch = silt::on_break([&](const silt::BreakEvent& b) { own.push_back(b); });
  const auto run = [&](double time) {
    if (observed)
      sim.run(time, watch, sieve(), [&](const auto& s) { out.steps.push_back(s.step_length()); });
    else
      sim.run(time, watch, sieve());
  };
  run(1.1e-4);
  sim.break_particle(143);
  run(1.1e-4);
  breaks.add(own);
  out.books = books_of(sim, seen), out.time = sim.time(), out.step = sim.step();
  return out;
}

// Catches: a step for the smallest ones of one rank alone; fragments of another rank that shorten
// the step late or never; sizes and speeds of the begin of the run, so that the step never grows.
TEST_CASE("ranks: the step of the smallest living is that of one process, and changes with it") {
  for (const bool observed : {false, true}) {
    Seen one;
    Broken breaks;
    const Fall wanted = fall(one, breaks, observed);
    breaks.sort();
    CHECK(breaks.all.size() > 20);
    if (observed) {
      int shorter = 0, longer = 0;
      for (std::size_t k = 1; k < wanted.steps.size(); ++k)
        shorter += wanted.steps[k]<0.9 * wanted.steps[k - 1], longer += wanted.steps[k]> 1.1 *
                   wanted.steps[k - 1];
      CHECK(shorter > 1);
      CHECK(longer > 1);
    }
    for (const int n : {1, 2, 3, 5}) {
      CAPTURE(n);
      Seen many;
      Broken of_many;
      silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
        const Fall got = fall(many, of_many, observed, ranks(comm));
        got.books.check_same(wanted.books);
        CHECK(got.step == wanted.step);
        CHECK(std::abs(got.time - wanted.time) < 1e-9 * wanted.time);
        REQUIRE(got.steps.size() == wanted.steps.size());
        for (std::size_t k = 0; k < got.steps.size(); ++k)
          CHECK(std::abs(got.steps[k] - wanted.steps[k]) < 1e-9 * wanted.steps[k]);
      });
      of_many.sort();
      REQUIRE(of_many.all.size() == breaks.all.size());
      for (std::size_t k = 0; k < breaks.all.size(); ++k) {
        const auto [id, time, first, number, dust] = of_many.all[k];
        const auto [its_id, its_time, its_first, its_number, its_dust] = breaks.all[k];
        CHECK(id == its_id);
        CHECK(first == its_first);
        CHECK(number == its_number);
        CHECK(std::abs(time - its_time) < 1e-9 * its_time);  // the step depends on the speeds
        CHECK(std::abs(dust - its_dust) <= 1e-12 * its_dust);
      }
      CHECK(many.off(one)[0] < 1e-9);
    }
  }
}

TEST_CASE("ranks: a restart where the step has just been chosen anew has the same bits") {
  const silt_test::Folder folder;
  Seen through, again;
  std::mutex mutex;
  int changed = 0;
  std::vector<std::int64_t> steps;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = shower(silt_test::eager(comm));
    // In the step that has seen the first fragments, before the next one is shorter.
    bool saved = false;
    double before = 0, last = 0;
    sim.run(1.2e-4, silt::at<silt::ActionKind::Saves>(silt::every(1e-9), [&](const auto& s) {
              if (saved && last == before) last = s.step_length();
              if (saved || s.broken() == 0) return;
              silt::save_checkpoint(s, folder / "run.silt");
              saved = true, before = last = s.step_length();
            }));
    books_of(sim, through);
    const std::lock_guard lock(mutex);
    changed += saved && last < 0.9 * before, steps.push_back(sim.step());
  });
  CHECK(changed == 3);
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    auto sim = shower(silt_test::eager(comm));
    silt::load_checkpoint(sim, folder / "run.silt");
    sim.run(1.2e-4 - sim.time());
    books_of(sim, again);
    const std::lock_guard lock(mutex);
    steps.push_back(sim.step());
  });
  CHECK(steps == std::vector<std::int64_t>(6, steps.front()));
  CHECK(through.all == again.all);
}

/// A pair that meets at 8 m/s, so soft that the safeguard turns it, on one rank, and a hard grain
/// far away on another, which breaks after so many steps. Velocities of the pair, then the step.
template <class... Policies>
std::array<double, 3> turned(int after, Policies... policies) {
  using Law = silt::Softened<silt::HertzMindlin>;
  const Law::Material soft{
      .solid = {.youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = 0.6},
      .full_radius = 2e-3};
  auto hard = soft;
  hard.full_radius = 0;
  silt::Contacts<Law, silt::SeveralMaterials> contacts{{soft, hard}};
  contacts.set_pair(soft, hard, {.restitution = 0.6, .friction = 0});
  silt::Particles<silt::Sphere> grains;
  for (const double side : {-1.0, 1.0})
    grains.add({.position = {side * 0.52e-3, 0, 0},
                .radius = 0.5e-3,
                .density = 2165,
                .velocity = {-side * 4, 0, 0}});
  grains.add({.position = {0.2, 0, 0}, .radius = 3e-3, .density = 2165, .material = 1});
  silt::Simulation sim{
      std::move(grains), contacts,
      silt::Breakage{
          silt::LogLogisticStrength{1e3, 2e-3, 0, 3},
          silt::EnergyEquivalence{},
          silt::GaudinSchuhmann{1, 0.3},
          {.dust_below = 0.5e-3, .most_fragments = 20, .separation_speed = 0, .step = living}},
      policies...};
  sim.guard.max_overlap = 3, sim.guard.max_travel = 1, sim.threads = 1;
  sim.run(1e-9);
  const double step = sim.step_length();
  sim.run(after * step);
  sim.break_particle(2);
  sim.run(400 * step);
  std::array<double, 3> seen{0, 0, sim.step_length()};
  for (const silt::ParticleId id : {0u, 1u})
    if (const std::size_t k = sim.find(id); k < sim.rows()) seen[id] = sim.velocity(k).x;
  sim.sum_over_ranks(std::span<double>(seen).first(2));
  return seen;
}
// Catches: a rank that changes the step in which another rank's safeguard has turned a pair, and
// ranks that disagree on whether the step is to change.
TEST_CASE("ranks: a safeguard that acts on one rank postpones the change of the step on all") {
  for (int after = 0; after < 40; ++after) {
    CAPTURE(after);
    const auto wanted = turned(after);
    CHECK(wanted[1] > 2);
    silt::run_on_ranks(2, [&](const silt::ThreadComm& comm) {
      const auto got =
          turned(after, silt::Ranks{comm, silt_test::WanderingSlabs{-0.2, 0.3, false}});
      for (std::size_t k = 0; k < 3; ++k)
        CHECK(std::abs(got[k] - wanted[k]) < 1e-9 * std::abs(wanted[k]));
    });
  }
}

}  // namespace

}  // namespace parallel_break_steps_test
