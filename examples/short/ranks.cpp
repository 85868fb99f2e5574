// silt - BSD-3-Clause, see LICENSE
//
// Beads on four processes. A column of beads collapses; each process (an MPI rank) computes the
// beads in its part of the box, and the parts follow the beads. The program prints the work of
// each.
//
// picture: draw ranks/particles.pvd --colour rank --time 0 0.06 0.12 0.3 --view 20,15 --width 1200 -o ranks.png

#include <cmath>
#include <cstdio>

#include <silt/mpi.hpp>
#include <silt/silt.hpp>

int main(int argc, char** argv) {
  silt::Mpi mpi(argc, argv);

  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e6,  // [Pa]
      .poisson_ratio = 0.25,
      .restitution = 0.8,
      .friction = 0.4,
  };
  silt::Particles<silt::Sphere> beads;  // every rank makes all of them, and keeps its own
  beads.fill({.min = {0, 0, 0}, .max = {0.03, 0.02, 0.06}},
             {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500});
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Ranks{MPI_COMM_WORLD, silt::Bisection{}}};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;  // of each rank
  sim.add_wall(silt::box({0, 0, 0}, {0.1, 0.02, 0.1}), glass);
  const double mass = sim.total_mass();

  sim.run(0.3, silt::vtk_series("ranks", silt::every(0.02)), silt::progress());

  // Sums over ranks are collective: all ranks call them, even if only one prints.
  double run_out = 0;  // [kg] of own beads
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.position(k).x > 0.03) run_out += sim.mass(k);
  run_out = sim.sum_over_ranks(run_out);
  const bool kept = std::abs(sim.total_mass() / mass - 1) < 1e-12;
  const auto loads = sim.rank_loads();
  if (sim.rank() == 0) {
    std::printf("%zu beads, %.0f %% of them ran out of the dam\n", sim.size(),
                100 * run_out / mass);
    for (std::size_t r = 0; r < loads.size(); ++r)
      std::printf("rank %zu: %zu beads, %zu ghosts\n", r, std::size_t{loads[r].particles},
                  std::size_t{loads[r].ghosts});
  }
  // Fails for beads lost between ranks, and for missing contacts between beads of different ranks.
  return kept && run_out > 0.3 * mass && run_out < 0.9 * mass ? 0 : 1;
}
