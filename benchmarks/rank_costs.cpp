// silt - BSD-3-Clause, see LICENSE
// Cost of a decomposition and of a particle that migrates to another rank, in Rebalance's units of
// work: processor times of two ranks that are threads, 50 000 spheres in a bed, with a search at
// each step.
//   clang++ -std=c++20 -O3 -march=native -I include benchmarks/rank_costs.cpp -pthread && ./a.out

#include <cstdio>
#include <ctime>
#include <mutex>
#include <vector>

#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/observers.hpp>
#include <silt/parallel/thread_comm.hpp>
#include <silt/ranks.hpp>

namespace {

double processor_time() {  // [s] of this thread
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Two halves of the bed, with a plane that moves by `shift` [m] at each search, back and forth; or
/// Bisection.
struct Halves {
  double shift = 0;
  bool bisects = false;
  int searches = 0;
  silt::Bisection bisection{};
  static constexpr bool by_place = false;
  template <class Comm>
  std::vector<int> partition(const Comm& comm, std::span<const silt::Vec3d> points,
                             std::span<const double> work) {
    if (bisects) return bisection.partition(comm, points, work);
    const double cut = 0.1 + (searches++ % 2 == 0 ? 0 : shift);
    std::vector<int> rank;
    for (const auto& p : points) rank.push_back(p.x > cut);
    return rank;
  }
};

/// [s] per step of each rank, and the work of one; `searches`: at each step.
struct Cost {
  double time[2], work, moved;
};
Cost cost_of(const Halves& halves, bool searches) {
  constexpr int steps = 40;
  Cost cost{};
  std::mutex mutex;
  silt::run_on_ranks(2, [&](const silt::ThreadComm& comm) {
    silt::Particles<silt::Sphere> beads;
    silt::Random random(1);
    const auto speed = [&] { return 0.02 * (random.uniform() - 0.5); };
    for (int i = 0; i < 100; ++i)
      for (int j = 0; j < 25; ++j)
        for (int k = 0; k < 20; ++k)
          beads.add({.position = {0.001 + 0.002 * i, 0.001 + 0.002 * j, 0.001 + 0.00198 * k},
                     .radius = 0.00099 + 0.00002 * random.uniform(),
                     .density = 2500,
                     .velocity = {speed(), speed(), speed()}});
    const silt::HertzMindlin::Material glass{
        .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.4};
    silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::Ranks{comm, halves, {.above = 1, .each = 0, .per_moved = 0}}};
    sim.threads = 1, sim.gravity = {0, 0, -9.81}, sim.time_step = 1e-5;
    sim.add_wall(silt::box({0, 0, 0}, {0.2, 0.05, 0.1}), glass);
    sim.run(60e-5);
    const auto came = sim.engine().ranks.counts.migrated;
    const double start = processor_time();
    if (searches)
      sim.run(steps * 1e-5,
              silt::at(silt::every(1e-5), [](auto& s) { s.engine().lists.forget(); }));
    else
      sim.run(steps * 1e-5);
    const double time = (processor_time() - start) / steps;
    const double moved =
        sim.sum_over_ranks(static_cast<double>(sim.engine().ranks.counts.migrated - came) / steps);
    const auto loads = sim.rank_loads();
    const std::lock_guard lock(mutex);
    cost.time[comm.rank()] = time, cost.work = loads[0].work, cost.moved = moved;
  });
  return cost;
}

}  // namespace

int main() {
  const auto step = cost_of({}, false), search = cost_of({}, true);
  const double unit = 0.5 * (step.time[0] + step.time[1]) / step.work;  // [s]
  std::printf("a unit of work: %.3g ns\n", 1e9 * unit);
  const auto more = [&](const Cost& cost) {  // [units] of both ranks, in a search
    return (cost.time[0] + cost.time[1] - search.time[0] - search.time[1]) / unit;
  };
  std::printf("Bisection: %.3g a point\n", more(cost_of({.bisects = true}, true)) / 50000);
  for (const double shift : {0.02, 0.04}) {
    const auto cost = cost_of({.shift = shift}, true);
    std::printf("%.0f particles that pass in a search: %.3g each\n", cost.moved,
                more(cost) / cost.moved);
  }
}
