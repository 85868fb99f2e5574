// silt - BSD-3-Clause, see LICENSE
//
// The hopper on many processes, as in its paper: the work of each rank as the grains fall, with
// fixed slabs and with decompositions that follow the material. Run by ./run hopper --ranks N, or
// mpirun -np N hopper_ranks.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <silt/mpi.hpp>
#include <silt/silt.hpp>

#include "hopper/scene.hpp"
#include "support/example.hpp"

namespace {

using namespace hopper;

/// The decomposition selected on the command line: one simulation is compiled for all of them.
struct AnyParts {
#if __has_include(<zoltan.h>)
  std::variant<silt::StaticSlabs, silt::MovingSlabs, silt::Bisection, silt::Rcb> parts;
#else
  std::variant<silt::StaticSlabs, silt::MovingSlabs, silt::Bisection> parts;
#endif
  static constexpr bool by_place = true;

  std::vector<int> partition(const silt::MpiComm& comm, std::span<const silt::Vec3d> points,
                             std::span<const double> weights) {
    return std::visit([&](auto& of) { return of.partition(comm, points, weights); }, parts);
  }
  int rank_of(const silt::Vec3d& place) const {
    return std::visit([&](const auto& of) { return of.rank_of(place); }, parts);
  }
};

struct Imbalance {
  double work = 0, steps = 0;  // largest work of a rank over the mean, times steps; steps
  double mean() const { return steps > 0 ? work / steps : 1; }
};

double imbalance(const std::vector<silt::RankLoad>& loads) {
  double largest = 0, sum = 0;
  for (const auto& load : loads) largest = std::max(largest, load.work), sum += load.work;
  return sum > 0 ? largest * static_cast<double>(loads.size()) / sum : 1;
}

int simulate(const Scene& scene, const std::string& decomposition, const example::Options& options,
             AnyParts parts) {
  const example::Stopwatch whole;
  auto sim = make_simulation(scene, silt::Ranks{MPI_COMM_WORLD, std::move(parts)});
  sim.threads = options.threads;
  const bool tells = sim.rank() == 0;
  const auto ranks = static_cast<std::size_t>(sim.ranks());
  const double opening = scene.settling_time();
  if (tells) {
    silt::make_folder(options.out);
    std::printf("%zu spheres on %zu ranks of %d threads, decomposition: %s\n", sim.size(), ranks,
                options.threads, decomposition.c_str());
  }
  const double total = sim.total_mass();  // [kg]
  sim.run(opening, silt::progress());
  const double rest = sim.kinetic_energy() / (total * 9.81 * 2 * scene.r_max);
  sim.remove_wall(lid);

  // Every few milliseconds: the work of each rank.
  std::vector<std::string> columns{"time [s]", "mass below [kg]", "imbalance [-]",
                                   "time per step [ms]"};
  for (const char* what : {"particles", "contacts", "work", "ghosts", "migrated"})
    for (std::size_t r = 0; r < ranks; ++r)
      columns.push_back(silt::text(what, " rank ", r, " [-]"));
  Imbalance mean;
  double below = 0;
  example::Stopwatch clock;
  std::int64_t last_step = sim.step();
  double last_seconds = 0;
  const auto look = [&](const auto& s) {
    double own = 0;  // [kg]
    for (std::size_t k = 0; k < s.rows(); ++k)
      if (s.position(k).z < scene.orifice_height()) own += s.mass(k);
    below = s.sum_over_ranks(own);
    const auto loads = s.rank_loads();
    const double seconds = clock.seconds(), steps = static_cast<double>(s.step() - last_step);
    std::vector<double> row{std::round(1e9 * (s.time() - opening)) / 1e9, below, imbalance(loads),
                            steps > 0 ? 1e3 * (seconds - last_seconds) / steps : 0};
    mean.work += row[2] * steps, mean.steps += steps;
    last_step = s.step(), last_seconds = seconds;
    for (const auto& l : loads) row.push_back(static_cast<double>(l.particles));
    for (const auto& l : loads) row.push_back(static_cast<double>(l.contacts));
    for (const auto& l : loads) row.push_back(l.work);
    for (const auto& l : loads) row.push_back(static_cast<double>(l.ghosts));
    for (const auto& l : loads) row.push_back(static_cast<double>(l.migrated));
    return row;
  };
  auto table = silt::table(options.out + "/ranks.csv", columns, silt::every(0.005), look);
  auto series = silt::vtk_series(options.out + "/vtk", silt::every(0.1));
  for (const double moment : scene.moments) {
    sim.run(opening + moment - sim.time(), table, series, silt::progress());
    const auto loads = sim.rank_loads();
    if (!tells) continue;
    std::printf(
        "%g s after opening: imbalance %.3f\n  rank  particles   contacts       work  ghosts\n",
        moment, imbalance(loads));
    for (std::size_t r = 0; r < ranks; ++r)
      std::printf("  %4zu  %9zu  %9zu  %9.0f  %6zu\n", r, std::size_t{loads[r].particles},
                  std::size_t{loads[r].contacts}, loads[r].work, std::size_t{loads[r].ghosts});
  }

  const auto loads = sim.rank_loads();
  const double peak = sim.peak_overlap();
  if (!tells) return 0;
  double migrated = 0, bytes = 0, messages = 0, others = 0;  // [s] with others, waiting included
  for (const auto& l : loads)
    others += l.seconds.ghosts + l.seconds.agreement + l.seconds.searches,
        migrated += static_cast<double>(l.migrated), bytes += static_cast<double>(l.bytes),
        messages += static_cast<double>(l.messages);
  example::Summary summary;
  summary.input("particles", static_cast<double>(scene.particles));
  summary.input("ranks", static_cast<double>(ranks));
  summary.input("threads_of_a_rank", static_cast<double>(options.threads));
  summary.input("decomposition", decomposition);
  summary.input("time_step_s", scene.time_step);
  summary.result("discharged_share", below / total);
  summary.result("imbalance_in_time_average", mean.mean());
  summary.result("partitions", static_cast<double>(loads[0].partitions));
  summary.result("searches", static_cast<double>(loads[0].searches));
  summary.result("migrated", migrated);
  summary.result("messages", messages);
  summary.result("megabytes_sent", bytes / 1e6);
  summary.result("share_of_time_with_others",
                 others / static_cast<double>(ranks) / whole.seconds());
  summary.result("largest_overlap_over_radius", peak);
  summary.result("wall_time_s", whole.seconds());
  summary.check_at_most("at_rest_before_opening", rest, 1e-3);
  summary.write(options.out + "/summary.json");
  const auto lines = [&](const char* what) {
    std::string all;
    for (std::size_t r = 0; r < std::min<std::size_t>(ranks, 8); ++r)
      all += silt::text(r == 0 ? "" : ",", what, " rank ", r);
    return all;
  };
  bool drawn = true;
  for (const char* what : {"particles", "contacts", "work"})
    drawn = drawn &&
            example::draw({"curves", options.out + "/ranks.csv", "--x", "time", "--y", lines(what),
                           "--title", silt::text(what, " of each rank, ", decomposition), "--out",
                           options.out + "/" + what + ".png"});
  std::printf(
      "\nImbalance of the work %.3f in time average; %.0f partitions, %.3g particles passed on, "
      "%.3g MB in %.3g messages; %.0f s, %.1f %% of them with other ranks (messages, waiting).\n",
      mean.mean(), static_cast<double>(loads[0].partitions), migrated, bytes / 1e6, messages,
      whole.seconds(), 100 * others / static_cast<double>(ranks) / whole.seconds());
  summary.print_checks();
  std::printf("Look at: %s/%s\n         %s/vtk/particles.pvd (ParaView), %s/ranks.csv\n",
              options.out.c_str(), drawn ? "particles.png, contacts.png, work.png" : "",
              options.out.c_str(), options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  silt::Mpi mpi(argc, argv);
  example::Command command("The hopper's discharge on many processes (mpirun)");
  command.leave_out("--restart");
  command.options.threads = 1;
  Scene scene;
  std::string decomposition = "rcb";
  command.add("--particles", scene.particles, 1000, 10000000, "Number of spheres");
  command.add("--decomposition", decomposition, {"static", "moving", "bisection", "rcb"},
              "Slabs across the height, static or moving, or boxes, by silt (bisection) or by "
              "Zoltan (rcb)");
  command.add_flag("--flat", scene.flat, "A flat floor around the orifice instead of a funnel");
  const int status = command.run(argc, argv, [&] {
    if (!command.given("--threads")) command.options.threads = 1;
    if (command.options.quick) {
      if (!command.given("--particles")) scene.particles = 10000;
      scene.width = 0.05, scene.orifice = 0.025;
      const double moments[4] = {0.1, 0.25, 0.35, 0.65};
      std::copy(moments, moments + 4, scene.moments);
    }
    const silt::Box all{{0, 0, 0}, {scene.width, scene.width, scene.funnel_top() + scene.room()}};
    AnyParts parts{silt::Bisection{}};
    if (decomposition == "static") parts.parts = silt::StaticSlabs{.axis = 2, .box = all};
    if (decomposition == "moving") parts.parts = silt::MovingSlabs{.axis = 2, .percent = 2};
#if __has_include(<zoltan.h>)
    if (decomposition == "rcb") parts.parts.emplace<silt::Rcb>();
#else
    silt::require(decomposition != "rcb", "--decomposition rcb needs Zoltan (Debian: apt-get "
                  "install libtrilinos-zoltan-dev); take bisection");
#endif
    return simulate(scene, decomposition, command.options, std::move(parts));
  });
  if (status == 2) mpi.fail("the run was refused");
  return status;
}
