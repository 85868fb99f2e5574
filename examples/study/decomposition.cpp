// silt - BSD-3-Clause, see LICENSE
//
// The hopper of examples/hopper on 2 to 48 ranks, as in its paper: load balance with fixed slabs,
// moving slabs and boxes, and the communication volume. One process computes the discharge; at each
// search every decomposition decides as on ranks: work, ghosts and migration are counted, not
// estimated. A model with measured costs converts the counts to speed-ups: these are predictions.
// Output: decomposition_report.cpp.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include <silt/ranks.hpp>
#include <silt/silt.hpp>

#include "hopper/scene.hpp"
#include "study/decomposition.hpp"
#include "study/decomposition_report.hpp"
#include "study/studies.hpp"

namespace decomposition_study {

namespace {

std::vector<Division> divisions(const hopper::Scene& scene, const std::vector<int>& numbers) {
  const silt::Box all{{0, 0, 0}, {scene.width, scene.width, scene.funnel_top() + scene.room()}};
  std::vector<Division> some;
  for (const int ranks : numbers) {
    some.emplace_back("static_z", ranks, silt::StaticSlabs{.axis = 2, .box = all});
    some.emplace_back("static_x", ranks, silt::StaticSlabs{.axis = 0, .box = all});
    some.emplace_back("moving", ranks, silt::MovingSlabs{.axis = 2, .percent = 2});
    some.emplace_back("bisection", ranks, silt::Bisection{});
  }
  return some;
}

/// [s] to pack and unpack the row of a ghost: the best of 20 rounds.
template <class Row>
double cost_of_ghost(std::size_t particles, const std::function<double()>& clock) {
  std::vector<Row> rows(particles);
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < particles; k += 7) chosen.push_back(k);
  std::vector<std::byte> message(chosen.size() * sizeof(Row));
  double best = 1;
  for (int round = 0; round < 20; ++round) {
    const double from = clock();
    std::byte* to = message.data();
    for (const std::size_t k : chosen) std::memcpy(to, &rows[k], sizeof(Row)), to += sizeof(Row);
    const std::byte* next = message.data();
    for (std::size_t k = 0; k < chosen.size(); ++k)
      std::memcpy(static_cast<void*>(&rows[particles - 1 - k]), next, sizeof(Row)),
          next += sizeof(Row);
    best = std::min(best, (clock() - from) / static_cast<double>(chosen.size()));
  }
  return best;
}

/// Observes a run at every fourth step: the time of steps between two searches and, at each search,
/// the result of every decomposition.
class Looker {
 public:
  /// `divides`: false times the steps only.
  Looker(double opening, std::int64_t searched, bool divides, std::function<double()> clock,
         Recorded& recorded)
      : opening_(opening),
        searched_(searched),
        divides_(divides),
        clock_(std::move(clock)),
        recorded_(recorded) {
    since_ = clock_();
  }

  template <class Sim>
  void operator()(const Sim& sim) {
    spent_ += clock_() - since_;
    const auto searched = sim.engine().lists.upkeep.searched_at;
    if (searched != searched_) {
      time(sim, searched);
      if (divides_) divide(sim, searched);
      searched_ = searched;
    }
    since_ = clock_();
  }
  double mean_reach() const { return reach_ / static_cast<double>(recorded_.times.size()); }  // [m]

 private:
  /// Steps since the previous search, with the pairs that it found.
  template <class Sim>
  void time(const Sim& sim, std::int64_t searched) {
    const auto steps = static_cast<double>(sim.step() - step_);
    if (started_)
      (divides_ ? recorded_.timed : recorded_.filling)
          .push_back({spent_ / steps, pairs_, static_cast<double>(sim.size()),
                      static_cast<double>(searched - searched_)});
    pairs_ = 0;
    sim.engine().lists.pairs.for_each([&](std::size_t) { ++pairs_; });
    started_ = true, step_ = sim.step(), spent_ = 0;
  }
  template <class Sim>
  void divide(const Sim& sim, std::int64_t searched) {
    const Search now(sim, opening_, searched - searched_);
    recorded_.times.push_back(now.time);
    auto& ranks = recorded_.ranks.emplace_back();
    auto& imbalance = recorded_.imbalance.emplace_back();
    for (Division& d : recorded_.divisions) {
      d.look(now);
      ranks.push_back(d.now), imbalance.push_back(d.imbalance);
    }
    double sum = 0, largest = 0;
    for (const double r : now.grown) sum += r, largest = std::max(largest, r);
    reach_ += sum / static_cast<double>(now.grown.size()) + largest;
  }

  double opening_;
  std::int64_t searched_, step_ = 0;
  bool divides_, started_ = false;
  std::function<double()> clock_;
  Recorded& recorded_;
  double spent_ = 0, since_ = 0, reach_ = 0, pairs_ = 0;
};

void run(const studies::Setting& setting, example::Summary& summary) {
  hopper::Scene scene;
  Recorded recorded;
  std::vector<int> numbers{2, 4, 8, 16, 48};
  if (setting.quick) {
    numbers.pop_back();
    scene.particles = 10000, scene.width = 0.05, scene.orifice = 0.025;
    const double moments[4] = {0.1, 0.25, 0.35, 0.65};
    std::copy(moments, moments + 4, scene.moments);
  }
  if (setting.particles > 0) scene.particles = setting.particles;
  auto sim = hopper::make_simulation(scene);
  sim.threads = 1;
  const double opening = scene.settling_time();
  std::printf("%zu spheres in one process; %g s until they are at rest\n", scene.particles,
              opening);
  // Free fall, the impact and the bed at rest: steps with few and with many pairs, for the costs.
  const auto clock = silt::processor_time().now;
  Looker filling(opening, -1, false, clock, recorded);
  sim.run(opening, silt::at(silt::every(4 * scene.time_step), [&](const auto& s) { filling(s); }),
          silt::progress());
  const double rest = sim.kinetic_energy() / (sim.total_mass() * 9.81 * 2 * scene.r_max);
  sim.remove_wall(hopper::lid);

  recorded.divisions = divisions(scene, numbers);
  recorded.particles = static_cast<double>(scene.particles);
  recorded.moments.assign(scene.moments, scene.moments + 4);
  Looker looker(opening, sim.engine().lists.upkeep.searched_at, true, clock, recorded);
  for (const double moment : scene.moments) {
    sim.run(opening + moment - sim.time(),
            silt::at(silt::every(4 * scene.time_step), [&](const auto& s) { looker(s); }),
            silt::progress());
    std::printf("%g s after opening, %zu searches\n", moment, recorded.times.size());
  }
  using Engine = typename decltype(sim)::Engine;
  using Row = silt::detail::RowState<typename Engine::State, typename Engine::Mover>;
  recorded.ghost = cost_of_ghost<Row>(scene.particles, clock);
  recorded.ghost_bytes = sizeof(Row);
  // Mean distance of particles at a solid fraction of 0.6.
  const double d = scene.r_min + scene.r_max;
  recorded.layer = looker.mean_reach() / (d * std::cbrt(M_PI / 6 / 0.6));
  summary.input("particles", recorded.particles);
  summary.input("time_step_s", scene.time_step);
  summary.check_at_most("at_rest_before_opening", rest, 1e-3);
  report(setting, recorded, summary);
}

const studies::Registered here{
    "decomposition", "the hopper on 2 to 48 ranks: work of each, what is sent, predicted speed-up",
    run};

}  // namespace

}  // namespace decomposition_study
