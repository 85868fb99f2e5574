// silt - BSD-3-Clause, see LICENSE

#include "study/decomposition_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include <silt/files/atomic_file.hpp>
#include <silt/files/csv_table.hpp>

#include "study/decomposition_model.hpp"

namespace decomposition_study {

namespace {

constexpr int shown = 4;  // ranks, as in the paper's figures

/// One decomposition on one number of ranks, in time average.
struct Average {
  double imbalance = 1, particles = 0, work = 0;                 // largest over mean
  double least_ghosts = 0, ghosts = 0, messages = 0, bytes = 0;  // of the rank with most
  double all_ghosts = 0, all_least = 0;                          // of all ranks
  double ghosts_over_least() const { return all_least > 0 ? all_ghosts / all_least : 1; }
};

Average average(const Recorded& recorded, std::size_t division) {
  Average mean;
  double steps = 0;
  for (std::size_t k = 0; k < recorded.timed.size(); ++k) {
    const double w = recorded.timed[k].steps;
    RankCount most, sum;
    for (const RankCount& r : recorded.ranks[k][division])
      for (const auto what : {&RankCount::particles, &RankCount::work, &RankCount::least_ghosts,
                              &RankCount::ghosts, &RankCount::sent, &RankCount::messages})
        most.*what = std::max(most.*what, r.*what), sum.*what += r.*what;
    const double ranks = static_cast<double>(recorded.ranks[k][division].size());
    mean.particles += w * most.particles * ranks / sum.particles;
    mean.work += w * most.work * ranks / sum.work;
    mean.least_ghosts += w * most.least_ghosts, mean.ghosts += w * most.ghosts;
    mean.messages += w * most.messages;
    mean.bytes += w * recorded.ghost_bytes * std::max(most.sent, most.ghosts);
    mean.all_ghosts += w * sum.ghosts, mean.all_least += w * sum.least_ghosts;
    steps += w;
  }
  for (const auto what :
       {&Average::particles, &Average::work, &Average::least_ghosts, &Average::ghosts,
        &Average::messages, &Average::bytes, &Average::all_ghosts, &Average::all_least})
    mean.*what /= steps;
  mean.imbalance = recorded.divisions[division].mean_imbalance();
  return mean;
}

/// Speed-up over one process by the model; partitioning at the cost that Rebalance assumes.
double speed_up(const Recorded& recorded, const Costs& costs, const Network& net,
                std::size_t division) {
  double alone = 0, together = 0, steps = 0, work = 0;
  for (std::size_t k = 0; k < recorded.timed.size(); ++k) {
    const Timed& t = recorded.timed[k];
    alone += t.steps * costs.of(t.pairs, t.owners, 0, t.steps);
    together +=
        t.steps * step_time(costs, net, recorded.ranks[k][division], t.steps, recorded.ghost_bytes);
    work += t.steps * (t.pairs + t.owners), steps += t.steps;
  }
  together += recorded.divisions[division].partition_cost * alone / work;
  return alone / together;
}

void write_over_time(const Recorded& recorded, const std::string& folder) {
  for (std::size_t d = 0; d < recorded.divisions.size(); ++d) {
    const Division& on = recorded.divisions[d];
    std::vector<std::string> columns{"time [s]", "imbalance [-]"};
    for (const char* what : {"particles", "contacts", "work", "pairs", "ghosts", "least ghosts",
                             "rows sent", "messages"})
      for (int r = 0; r < on.ranks; ++r) columns.push_back(silt::text(what, " rank ", r, " [-]"));
    silt::CsvTable table(silt::text(folder, "/", on.name, "_", on.ranks, ".csv"), columns);
    for (std::size_t k = 0; k < recorded.times.size(); ++k) {
      std::vector<double> row{recorded.times[k], recorded.imbalance[k][d]};
      for (const auto what :
           {&RankCount::particles, &RankCount::contacts, &RankCount::work, &RankCount::pairs,
            &RankCount::ghosts, &RankCount::least_ghosts, &RankCount::sent, &RankCount::messages})
        for (const RankCount& r : recorded.ranks[k][d]) row.push_back(r.*what);
      table.add_row(row);
    }
  }
}

void write_times(const Recorded& recorded, const Costs& costs, const std::string& out) {
  silt::CsvTable table(out + "/step_times.csv",
                       {"time [s]", "pairs [-]", "steps to the next search [-]",
                        "processor time of a step [ms]", "by the fit [ms]"});
  for (std::size_t k = 0; k < recorded.timed.size(); ++k) {
    const Timed& t = recorded.timed[k];
    table.add_row({recorded.times[k], t.pairs, t.steps, 1e3 * t.seconds,
                   1e3 * costs.of(t.pairs, t.owners, 0, t.steps)});
  }
}

/// As in the paper's pictures: the particles of four ranks at its times.
void print_moments(const Recorded& recorded) {
  for (const double moment : recorded.moments) {
    const auto at = static_cast<std::size_t>(
        std::min(std::lower_bound(recorded.times.begin(), recorded.times.end(), moment) -
                     recorded.times.begin(),
                 static_cast<std::ptrdiff_t>(recorded.times.size()) - 1));
    std::printf("\n%.3f s after opening, %d ranks: particles / contacts / work\n",
                recorded.times[at], shown);
    for (std::size_t d = 0; d < recorded.divisions.size(); ++d) {
      if (recorded.divisions[d].ranks != shown) continue;
      std::printf("  %-10s", recorded.divisions[d].name.c_str());
      for (const RankCount& r : recorded.ranks[at][d])
        std::printf("  %6.0f /%7.0f /%8.0f", r.particles, r.contacts, r.work);
      std::printf("  imbalance %.3f\n", recorded.imbalance[at][d]);
    }
  }
}

}  // namespace

void report(const studies::Setting& setting, const Recorded& recorded, example::Summary& summary) {
  silt::require(recorded.timed.size() > 3, "study decomposition: ", recorded.timed.size(),
                " searches were seen, too few to fit costs to; take more --particles");
  const std::string ranks_folder = setting.out + "/ranks";
  silt::make_folder(ranks_folder);
  write_over_time(recorded, ranks_folder);
  // During the discharge alone the number of pairs is nearly constant.
  std::vector<Timed> timed = recorded.filling;
  timed.insert(timed.end(), recorded.timed.begin(), recorded.timed.end());
  Costs costs = fit(timed);
  costs.ghost = recorded.ghost;
  const bool usable = std::min({costs.pair, costs.owner, costs.search}) >= 0;
  if (!usable)
    std::printf(
        "A cost came out negative: the machine was too busy to fit them. What is predicted "
        "below is not to be used; what is counted is.\n");
  summary.result("costs_are_usable", usable);
  write_times(recorded, costs, setting.out);
  print_moments(recorded);

  const std::vector<Network> nets{
      {"none", 0, std::numeric_limits<double>::infinity()},
      {"given", setting.latency, setting.bandwidth},
      {"gigabit", 50e-6, 0.117e9},
  };
  summary.input("latency_s", setting.latency);
  summary.input("bandwidth_bytes_per_s", setting.bandwidth);
  summary.result("searches", static_cast<double>(recorded.times.size()));
  summary.result("bytes_of_a_ghost", recorded.ghost_bytes);
  summary.result("cost_of_a_pair_ns", 1e9 * costs.pair);
  summary.result("cost_of_an_own_particle_ns", 1e9 * costs.owner);
  summary.result("cost_of_a_search_a_particle_ns", 1e9 * costs.search);
  summary.result("cost_of_a_ghost_ns", 1e9 * costs.ghost);
  summary.result("scatter_of_the_fit", costs.scatter);

  const std::vector<std::string> columns{"ranks [-]",
                                         "imbalance [-]",
                                         "worst imbalance at the end of a decomposition [-]",
                                         "most over mean particles [-]",
                                         "ghosts of the rank with most [-]",
                                         "ghosts over the least that do [-]",
                                         "messages a step [-]",
                                         "bytes a step [kB]",
                                         "migrated a search [-]",
                                         "partitions [-]",
                                         "speed-up without a network [-]",
                                         "speed-up [-]",
                                         "speed-up on gigabit Ethernet [-]"};
  std::vector<std::string> names;
  std::vector<silt::CsvTable> tables;
  double missing = 0, lost = 0;
  std::printf("\n%-10s %5s %9s %9s %9s %8s %8s %9s %9s %10s | predicted speed-up\n", "", "ranks",
              "imbalance", "worst end", "particles", "ghosts", "/ least", "messages", "kB a step",
              "partitions");
  for (std::size_t d = 0; d < recorded.divisions.size(); ++d) {
    const Division& on = recorded.divisions[d];
    const Average mean = average(recorded, d);
    std::size_t of =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), on.name) - names.begin());
    if (of == names.size())
      names.push_back(on.name), tables.emplace_back(setting.out + "/" + on.name + ".csv", columns);
    std::vector<double> row{static_cast<double>(on.ranks),
                            mean.imbalance,
                            on.worst_end,
                            mean.particles,
                            mean.ghosts,
                            mean.ghosts_over_least(),
                            mean.messages,
                            1e-3 * mean.bytes,
                            on.migrated / static_cast<double>(recorded.times.size() - 1),
                            on.partitions};
    std::printf("%-10s %5d %9.3f %9.3f %9.3f %8.0f %8.2f %9.1f %9.1f %10.0f |", on.name.c_str(),
                on.ranks, mean.imbalance, on.worst_end, mean.particles, mean.ghosts,
                mean.ghosts_over_least(), mean.messages, 1e-3 * mean.bytes, on.partitions);
    for (const Network& net : nets) {
      row.push_back(speed_up(recorded, costs, net, d));
      std::printf(" %6.2f", row.back());
    }
    std::printf("\n");
    tables[of].add_row(row);
    const std::string name = silt::text(on.name, "_", on.ranks);
    summary.result("imbalance_" + name, mean.imbalance);
    summary.result("ghosts_over_least_" + name, mean.ghosts_over_least());
    summary.result("partitions_" + name, on.partitions);
    summary.result("predicted_speed_up_" + name, row[11]);
    missing += on.missing_ghosts, lost += on.lost_particles;
    summary.result("worst_imbalance_after_a_decomposition_" + name, on.worst_start);
    summary.result("worst_imbalance_at_the_end_of_one_" + name, on.worst_end);
    if (on.name == "bisection" && on.ranks >= 4 && on.ranks <= 16) {
      // A rank of the quick run has a few hundred particles, too few for the limits of the full
      // run.
      if (setting.quick) {
        const auto slabs = std::find_if(
            recorded.divisions.begin(), recorded.divisions.end(),
            [&](const Division& o) { return o.name == "static_z" && o.ranks == on.ranks; });
        summary.check_at_most("imbalance_over_that_of_static_slabs_" + name,
                              mean.imbalance / slabs->mean_imbalance(), 0.8);
      } else {
        summary.check_at_most("imbalance_in_time_average_of_" + name, mean.imbalance, 1.05);
        summary.check_at_most("imbalance_after_a_decomposition_of_" + name, on.worst_start, 1.10);
        summary.check_at_most("imbalance_at_the_end_of_a_decomposition_of_" + name, on.worst_end,
                              1.10);
      }
    }
  }
  std::printf("(networks: none; %g us and %g GB/s; gigabit Ethernet, 50 us)\n",
              1e6 * setting.latency, 1e-9 * setting.bandwidth);
  summary.check_at_most("ghosts_that_are_needed_and_not_sent", missing, 0);
  summary.check_at_most("particles_without_a_rank", lost, 0);

  // Weak scaling, predicted: with the imbalance that Rebalance allows.
  const Timed& last = recorded.timed.back();
  const WeakRank rank{1e6, last.pairs / last.owners, recorded.layer, silt::Rebalance{}.above,
                      last.steps};
  silt::CsvTable weak(setting.out + "/weak.csv",
                      {"ranks [-]", "efficiency without a network [-]", "efficiency [-]",
                       "efficiency on gigabit Ethernet [-]"});
  std::printf("\n1e6 particles a rank: %.0f ghosts, imbalance %.3f; efficiency\n", rank.ghosts(),
              rank.imbalance);
  for (const double ranks : {1.0, 10.0, 100.0, 1000.0, 10000.0}) {
    std::vector<double> row{ranks};
    for (const Network& net : nets)
      row.push_back(rank.step_time(costs, net, 1, recorded.ghost_bytes) /
                    rank.step_time(costs, net, ranks, recorded.ghost_bytes));
    weak.add_row(row);
    std::printf("  %6.0f ranks %6.3f %6.3f %6.3f\n", ranks, row[1], row[2], row[3]);
    if (ranks == 10000) summary.result("predicted_weak_efficiency_10000_ranks", row[2]);
  }
  tables.clear();
  example::run_script(SILT_DECOMPOSITION_SCRIPT, {setting.out});
}

}  // namespace decomposition_study
