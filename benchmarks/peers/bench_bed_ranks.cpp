// silt - BSD-3-Clause, see LICENSE
//
// The scenes of bench_bed on several processes of one thread each, by MPI:
//   mpirun -np N bench_bed_ranks time FILE WARMUP STEPS RANKS double|mixed END level|tilted|hopper
// FILE, END and the line of results are those of bench_bed; RANKS must be N.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <silt/mpi.hpp>

#include "bed_files.hpp"
#include "bed_scenes.hpp"

namespace {

using namespace bench;

struct Timed {
  std::string file;
  double warmup, steps;
  std::string end, scene;
};

template <class Precision>
void time(const silt::MpiComm& comm, const Timed& of, Precision precision) {
  auto spheres = read(of.file);
  const std::size_t n = spheres.size();
  const double width = width_for(n);
  auto sim =
      bed(std::move(spheres), width, 1, silt::Ranks{MPI_COMM_WORLD, silt::Bisection{}}, precision);
  set_scene(sim, of.scene, n);
  sim.run(of.warmup * time_step);
  const auto before = sim.rank_loads();
  comm.barrier();
  const auto start = std::chrono::steady_clock::now();
  sim.run(of.steps * time_step);
  comm.barrier();
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto own = states_of(sim);
  const auto all = silt::gather(comm, std::span<const SphereState>(own));
  double energy = kinetic_energy(sim);
  energy = sim.sum_over_ranks(energy);
  const double contacts = static_cast<double>(sim.touching_pairs());
  const auto loads = sim.rank_loads();
  double ghosts = 0, work = 0, largest = 0;
  std::string shares;  // of the time, in percent, of each rank: ghosts, agreement, searches
  for (std::size_t r = 0; r < loads.size(); ++r) {
    const auto &then = before[r].seconds, &now = loads[r].seconds;
    ghosts += static_cast<double>(loads[r].ghosts);
    work += loads[r].work, largest = std::max(largest, loads[r].work);
    char words[64];
    std::snprintf(words, sizeof words, " %.1f+%.1f+%.1f",
                  100 * (now.ghosts - then.ghosts) / seconds,
                  100 * (now.agreement - then.agreement) / seconds,
                  100 * (now.searches - then.searches) / seconds);
    shares += words;
  }
  if (comm.rank() != 0) return;
  std::printf(
      "seconds %.6g kinetic_energy %.6g contacts %.0f ghosts %.0f imbalance %.4g overlap %.4g\n"
      "percent_of_time%s\n",
      seconds, energy, contacts, ghosts, largest * static_cast<double>(loads.size()) / work,
      sim.largest_overlap(), shares.c_str());
  write(all.values, of.end);
}

}  // namespace

int main(int argc, char** argv) {
  silt::Mpi mpi(argc, argv);
  const silt::MpiComm comm = mpi.comm();
  silt::require(argc == 9 && argv[1] == std::string("time") && is_scene(argv[8]),
                "mpirun -np RANKS bench_bed_ranks time FILE WARMUP STEPS RANKS double|mixed END "
                "level|tilted|hopper");
  silt::require(std::atoi(argv[5]) == comm.size(), "RANKS is ", argv[5],
                ", and mpirun has started ", comm.size());
  const Timed of{argv[2], std::stod(argv[3]), std::stod(argv[4]), argv[7], argv[8]};
  if (argv[6] == std::string("mixed"))
    time(comm, of, silt::Mixed{});
  else
    time(comm, of, silt::Double{});
}
