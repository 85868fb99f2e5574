// silt - BSD-3-Clause, see LICENSE
// What restart.sh kills: a bed that saves itself every 10 steps to FOLDER/run, goes on from there
// if there is such a file, and writes its particles to FOLDER/END.csv. Without Ranks if it is
// called with "one" as the third word.

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>

#include <silt/io/observers.hpp>
#include <silt/io/particle_csv.hpp>
#include <silt/mpi.hpp>

#include "../parallel/rank_scenes.hpp"

namespace {

void go_on(auto& sim, const std::string& folder, double end) {
  const std::string path = folder + "/run";
  std::ofstream(folder + "/pid." + std::to_string(sim.rank())) << ::getpid() << '\n';
  if (std::ifstream(path).good()) silt::load_checkpoint(sim, path);
  const auto from = sim.step();
  if (sim.time() < end - 1e-9)
    sim.run(end - sim.time(), silt::checkpoints(path, silt::every(0.0001)));
  silt::write_particle_csv(folder + "/end.csv", sim);
  if (sim.rank() == 0) std::printf("from step %ld to %ld\n", long(from), long(sim.step()));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string folder = argv[1];
  const double end = std::stod(argv[2]);
  const auto run = [&](auto& sim) { go_on(sim, folder, end); };
  if (argc > 3) {
    silt_test::with_bed({}, run);
    return 0;
  }
  silt::Mpi mpi(argc, argv);
  silt_test::with_bed({}, run, silt::Ranks{mpi.comm(), silt::Bisection{}});
}
