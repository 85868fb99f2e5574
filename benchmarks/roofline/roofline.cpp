// silt - BSD-3-Clause, see LICENSE
//
// Limits of this machine, the resulting bound for a settled bed, and the distance of silt from it,
// stage by stage, on one thread. Also the gain from more threads, compared with that of as many
// independent single-thread runs, which is the most that the machine can give at that moment.
//   roofline [N...] [--quick] [--out DIR]    spheres; default 5000 50000
// DIR/summary.json: all numbers, and checks that the timed scene is as stated: a bed at rest,
// complete, whose lists contain each contact, and no stage faster than its bound.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <silt/files/atomic_file.hpp>

#include "support/example.hpp"

#include "../bed.hpp"

namespace {

using Clock = std::chrono::steady_clock;

/// All printed values are also in summary.json.
struct Report {
  example::Summary summary;
  bool quick = false;
};

/// Seconds of `work`, the minimum of `repeats`.
template <class Work>
double least_time(int repeats, const Work& work) {
  double least = 1e30;
  for (int k = 0; k < repeats; ++k) {
    const auto start = Clock::now();
    work();
    least = std::min(least, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return least;
}

template <class T>
void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

// Each measured piece takes a fraction of a millisecond, like the stages, and is repeated often:
// some of the repeats are then undisturbed by other programs.
constexpr std::size_t short_work = std::size_t{1} << 22;  // bytes
int short_repeats(bool quick) { return quick ? 100 : 1000; }

/// Bytes per second of a = a + s b over arrays of `bytes` in total: two reads and a write. Every
/// written line has been read, as in the stages of a step.
double update(std::size_t bytes, bool quick) {
  const std::size_t n = bytes / (2 * sizeof(double));
  silt::AlignedVector<double> a(n, 1.0), b(n, 2.0);
  const std::size_t rounds = std::max<std::size_t>(1, short_work / bytes);
  const double seconds = least_time(bytes > short_work ? 5 : short_repeats(quick), [&] {
    for (std::size_t r = 0; r < rounds; ++r) {
      for (std::size_t k = 0; k < n; ++k) a[k] += 1e-9 * b[k];
      keep(a);
    }
  });
  return static_cast<double>(3 * sizeof(double) * n * rounds) / seconds;
}

/// Operations per second on batches, with `chains` independent of each other.
template <class Scalar, std::size_t chains, class Operation>
double rate(const Operation& operation, bool quick) {
  using Real = typename silt::Lanes<silt::DefaultArch, Scalar>::Real;
  constexpr int rounds = 2000;
  Real x[chains];
  for (std::size_t c = 0; c < chains; ++c) x[c] = Real(Scalar(1) + Scalar(c) / 64);
  const double seconds = least_time(short_repeats(quick), [&] {
    for (int r = 0; r < rounds; ++r) {
      for (std::size_t c = 0; c < chains; ++c) x[c] = operation(x[c]);
      keep(x);
    }
  });
  return static_cast<double>(chains) * rounds * silt::Lanes<silt::DefaultArch, Scalar>::width /
         seconds;
}

struct Machine {
  std::vector<std::pair<std::size_t, double>> bandwidth;  // bytes of the arrays, bytes/s
  double flops, roots, divisions;                         // [1/s] in one scalar type

  /// For a working set of so many bytes, interpolated between the measured sizes.
  double bandwidth_for(double bytes) const {
    for (std::size_t k = 0; k + 1 < bandwidth.size(); ++k)
      if (bytes <= static_cast<double>(bandwidth[k].first)) return bandwidth[k].second;
    return bandwidth.back().second;
  }
};

template <class Scalar>
Machine measure_machine(const std::vector<std::pair<std::size_t, double>>& bandwidth, bool quick) {
  Machine m{bandwidth, 0, 0, 0};
  // Registers alone would be faster: `keep` makes each round go through the first-level cache.
  m.flops = 2 *
            rate<Scalar, 12>(
                [](auto x) {
                  using Real = decltype(x);
                  for (int k = 0; k < 16; ++k) x = x * Real(Scalar(0.999)) + Real(Scalar(0.001));
                  return x;
                },
                quick) *
            16;
  m.roots = rate<Scalar, 8>([](auto x) { return silt::sqrt(x); }, quick);
  m.divisions = rate<Scalar, 8>(
      [](auto x) {
        using Real = decltype(x);
        return Real(Scalar(1.5)) / x;
      },
      quick);
  return m;
}

// Counted by hand in pair_pipeline.hpp, contact_kernel.hpp and the law, for one pair.
constexpr double pair_flops = 230, pair_roots = 4, pair_divisions = 3;
constexpr double particle_flops = 40;

void row(Report& report, const std::string& scene, const char* stage, double measured, double bytes,
         double working_set, double flops, double roots, double divisions, const Machine& machine) {
  const double by_bytes = 1e9 * bytes / machine.bandwidth_for(working_set);
  const double by_flops = 1e9 * flops / machine.flops;
  const double by_divider = 1e9 * (roots / machine.roots + divisions / machine.divisions);
  const double bound = std::max({by_bytes, by_flops, by_divider});
  std::printf("  %-12s %8.2f   %8.2f %8.2f %8.2f   %6.1f\n", stage, measured, by_bytes, by_flops,
              by_divider, measured / bound);
  const std::string name = scene + "_" + stage;
  report.summary.result(name + "_ns", measured);
  report.summary.result(name + "_bound_ns", bound);
  // A stage faster than its bound means a wrong count, or a stage that did not do its work. The
  // bound by bytes does not hold where the working set is in a nearer cache than the measured
  // arrays.
  report.summary.check_at_least(name + "_over_bound_by_arithmetic",
                                measured / std::max(by_flops, by_divider), 1);
}

/// The spheres of a simulation at present.
template <class Sim>
silt::Particles<silt::Sphere> copy_of(const Sim& sim) {
  silt::Particles<silt::Sphere> spheres;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    spheres.add({.position = sim.position(k),
                 .radius = sim.radius(k),
                 .density = 2500,
                 .velocity = sim.velocity(k),
                 .angular_velocity = sim.angular_velocity(k)});
  return spheres;
}

/// Checks that the scene is as stated in its rows: at rest, complete, all contacts in the lists.
template <class Sim>
void check_bed(Report& report, const std::string& scene, Sim& sim) {
  std::vector<silt::PositionRow> rows;
  double largest = 0;  // [m]
  std::size_t outside = 0;
  const double width = bench::width_for(sim.rows());
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const auto p = sim.position(k);
    const double r = sim.radius(k);
    rows.push_back({p.x, p.y, p.z, r});
    largest = std::max(largest, r);
    const bool in = std::min(p.x, p.y) > 0 && std::max(p.x, p.y) < width && p.z > 0;
    outside += in ? 0 : 1;
  }
  std::vector<silt::IndexPair> touching;
  silt::CellGrid{}.find({rows, largest}, 0.0, silt::OpenDomain{}, silt::Team(1), touching);
  const auto pairs = static_cast<double>(touching.size());
  const auto count = static_cast<double>(sim.rows());
  const double mass = 2500 * 4.0 / 3 * 3.14159265 * 2.15e-3 * 2.15e-3 * 2.15e-3;  // [kg]
  report.summary.result(scene + "_contacts_a_sphere", 2 * pairs / count);
  report.summary.check_at_most(scene + "_spheres_outside", static_cast<double>(outside), 0);
  report.summary.check_within(scene + "_touching_pairs", static_cast<double>(sim.touching_pairs()),
                              pairs, 1e-3 * pairs,
                              "another search finds them anew; float rounds in mixed precision");
  report.summary.check_at_least(scene + "_listed_over_touching",
                                static_cast<double>(sim.engine().lists.pairs.size()) / pairs, 1);
  report.summary.check_at_least(scene + "_contacts_a_sphere", 2 * pairs / count, 3);
  report.summary.check_at_most(scene + "_kinetic_energy_over_weight_times_d",
                               bench::kinetic_energy(sim) / (count * mass * 9.81 * 4.3e-3), 0.01);
  report.summary.check_at_most(scene + "_time_step_over_limit",
                               bench::time_step / *sim.time_step_limit(1.0), 1);
}

/// Number of particles whose position, velocity or spin differs between runs on all threads and on
/// one.
template <class Sim, class Precision>
std::size_t differ_by_threads(const Sim& sim, Precision precision) {
  auto one = bench::bed(copy_of(sim), 1, precision);
  auto all = bench::bed(copy_of(sim), std::max(2, silt::default_threads()), precision);
  one.run(50 * bench::time_step), all.run(50 * bench::time_step);
  std::size_t differ = 0;
  for (std::size_t k = 0; k < one.rows(); ++k) {
    const auto same = [](const silt::Vec3d& a, const silt::Vec3d& b) {
      return a.x == b.x && a.y == b.y && a.z == b.z;
    };
    if (!same(one.position(k), all.position(k)) || !same(one.velocity(k), all.velocity(k)) ||
        !same(one.angular_velocity(k), all.angular_velocity(k)))
      ++differ;
  }
  return differ;
}

/// Steps per second of a team of all threads over those of one thread; and of as many threads that
/// run one copy each. Medians of interleaved rounds.
template <class Sim, class Precision>
void show_threads(Report& report, const std::string& scene, Sim& sim, Precision precision,
                  int steps) {
  const int threads = silt::default_threads();
  if (threads < 2) return;
  std::vector<Sim> copies;
  for (int t = 0; t < threads; ++t) {
    copies.push_back(bench::bed(copy_of(sim), 1, precision));
    copies.back().run(200 * bench::time_step);
  }
  const double time = steps * bench::time_step;
  std::vector<double> team, apart;
  constexpr int rounds = 7;
  for (int round = 0; round < rounds; ++round) {
    sim.threads = 1;
    const double one = least_time(1, [&] { sim.run(time); });
    sim.threads = threads;
    team.push_back(one / least_time(1, [&] { sim.run(time); }));
    apart.push_back(threads * one / least_time(1, [&] {
                      std::vector<std::thread> workers;
                      for (auto& copy : copies) workers.emplace_back([&] { copy.run(time); });
                      for (auto& w : workers) w.join();
                    }));
  }
  for (auto* of : {&team, &apart}) std::sort(of->begin(), of->end());
  std::printf(
      "  %d threads: %.2f times one (%.2f to %.2f); %d runs at once, one thread each: "
      "%.2f times one (%.2f to %.2f)\n",
      threads, team[3], team[0], team[6], threads, apart[3], apart[0], apart[6]);
  report.summary.result(scene + "_team_over_one_thread", team[rounds / 2]);
  report.summary.result(scene + "_apart_over_one_thread", apart[rounds / 2]);
}

template <class Precision>
void show(Report& report, std::size_t n, Precision precision, const Machine& machine,
          const char* name) {
  using Scalar = typename Precision::PairScalar;
  auto sim = bench::bed(bench::lattice(n), silt::default_threads(), precision);
  sim.run(20000 * bench::time_step);
  const std::string scene = silt::text(n, "_", name);
  check_bed(report, scene, sim);
  report.summary.check_at_most(scene + "_particles_that_differ_by_threads",
                               static_cast<double>(differ_by_threads(sim, precision)), 0);
  sim.threads = 1;
  sim.run(200 * bench::time_step);
  auto& e = sim.engine();
  using Engine = std::remove_reference_t<decltype(e)>;
  using Search = typename decltype(sim)::Search;
  Search search;
  const auto count = static_cast<double>(sim.rows());
  const double pairs = static_cast<double>(e.lists.pairs.size()) / count;
  const double walls = static_cast<double>(e.lists.walls.candidates().size()) / count;
  double seconds[3] = {1e30, 1e30, 1e30};
  const silt::detail::StepTimes times{
      .step = bench::time_step, .worked = bench::time_step, .ask = false};
  for (int k = 0; k < 30; ++k) {
    const auto least = [](double& now, const auto& work) {
      now = std::min(now, least_time(1, work));
    };
    least(seconds[0], [&] { e.pair_forces(sim.domain(), times); });
    least(seconds[1], [&] { e.wall_forces(times); });
    // Time does not advance: sums are read and cleared, rows are read and written as in a step.
    least(seconds[2], [&] { e.integrate(Engine::Advance::KickAndDrift, {0, 0, 0}, 0, 0, false); });
  }
  const double prune = least_time(10, [&] {
    e.lists.upkeep.pruned_at = -1;
    e.renew_lists(search, sim.domain(), sim.step(), bench::time_step);
  });
  const double renew = least_time(10, [&] {
    e.lists.forget();
    e.renew_lists(search, sim.domain(), sim.step(), bench::time_step);
  });
  const double whole = least_time(3, [&] { sim.run(500 * bench::time_step); }) / 500;

  const double ns = 1e9 / count;
  constexpr double sum = 8 * sizeof(Scalar), motion = 8 * sizeof(Scalar),
                   history = 3 * sizeof(Scalar);
  constexpr double kept_twice = sizeof(Scalar) < 8 ? motion : 0;
  const double pair_bytes = 32 + motion + 2 * sum + pairs * (8 + 2 * history);
  const double step_bytes = 2 * (32 + 64 + sum) + kept_twice + 8;
  const double set = count * (32 + motion + sum + pairs * (8 + 2 * history));
  const double integrated = count * (32 + 64 + sum + kept_twice);
  std::printf("\n%zu spheres, %s: %.2f pairs and %.2f wall candidates a sphere, %.1f MB a step\n",
              n, name, pairs, walls, set / 1e6);
  std::printf(
      "               measured   bounds by bytes, arithmetic, divider   measured\n"
      "               [ns a sphere]                                    / bound\n");
  row(report, scene, "pairs", seconds[0] * ns, pair_bytes, set, pairs * pair_flops,
      pairs * pair_roots, pairs * pair_divisions, machine);
  row(report, scene, "walls", seconds[1] * ns, walls * (32 + 64 + 2 * sum + 12 + 48), set,
      walls * pair_flops, walls * pair_roots, walls * pair_divisions, machine);
  row(report, scene, "integration", seconds[2] * ns, step_bytes, integrated, particle_flops, 0, 0,
      machine);
  std::printf(
      "  a whole step %6.2f ns = %.1f M particle-steps/s; pruning %.1f ns, a search %.0f ns\n",
      whole * ns, 1e-6 * count / whole, prune * ns, renew * ns);
  report.summary.result(scene + "_step_ns", whole * ns);
  report.summary.result(scene + "_pruning_ns", prune * ns);
  report.summary.result(scene + "_search_ns", renew * ns);
  // The stages are parts of a step; as the minimum of 30 calls they are not slower than in it.
  report.summary.check_at_most(scene + "_stages_over_step",
                               (seconds[0] + seconds[1] + seconds[2]) / whole, 1.2);
  show_threads(report, scene, sim, precision,
               static_cast<int>((report.quick ? 1e6 : 2e7) / count) + 1);
}

int run(const example::Options& options, std::vector<std::size_t> sizes) {
  silt::make_folder(options.out);
  Report report{{}, options.quick};
  if (sizes.empty())
    sizes = options.quick ? std::vector<std::size_t>{2000} : std::vector<std::size_t>{5000, 50000};
  report.summary.input("quick", options.quick);
  std::string all;
  for (const std::size_t n : sizes) all += silt::text(all.empty() ? "" : " ", n);
  report.summary.input("spheres", all);
  std::printf("%s\n", example::processor().c_str());
  std::vector<std::pair<std::size_t, double>> bandwidth;
  std::printf("memory, one thread (a = a + s b):");
  for (const std::size_t kib : {24, 900, 4096, 16384, 262144}) {
    bandwidth.emplace_back(kib << 10, update(kib << 10, options.quick));
    std::printf("  %zu kiB %.0f GB/s", kib, 1e-9 * bandwidth.back().second);
    report.summary.result(silt::text("bandwidth_", kib, "_kib_bytes_per_s"),
                          bandwidth.back().second);
  }
  const auto full = measure_machine<double>(bandwidth, options.quick);
  const auto single = measure_machine<float>(bandwidth, options.quick);
  std::printf(
      "\narithmetic, one thread [1e9/s]: double %.1f flop, %.2f roots, %.2f divisions;"
      " float %.1f flop, %.2f roots, %.2f divisions\n",
      1e-9 * full.flops, 1e-9 * full.roots, 1e-9 * full.divisions, 1e-9 * single.flops,
      1e-9 * single.roots, 1e-9 * single.divisions);
  for (const auto& [name, m] : {std::pair{"double", &full}, std::pair{"float", &single}}) {
    report.summary.result(silt::text(name, "_flops_per_s"), m->flops);
    report.summary.result(silt::text(name, "_roots_per_s"), m->roots);
    report.summary.result(silt::text(name, "_divisions_per_s"), m->divisions);
  }
  for (const std::size_t n : sizes) {
    show(report, n, silt::Double{}, full, "double");
    show(report, n, silt::Mixed{}, single, "mixed");
  }
  report.summary.write(options.out + "/summary.json");
  std::printf("\n");
  report.summary.print_checks();
  std::printf("Look at: %s/summary.json\n", options.out.c_str());
  return report.summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command(
      "What this machine can do, the bound for a settled bed, and silt's stages",
      example::Kind::Study, "out/roofline");
  std::vector<std::size_t> sizes;
  command.add("N", sizes, 2000, 100000000, "Spheres; default 5000 50000, with --quick 2000");
  return command.run(argc, argv, [&] { return run(command.options, sizes); });
}
