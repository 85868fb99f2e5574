// silt - BSD-3-Clause, see LICENSE
// The program of docs/ranks.md: mpirun -np 4 docs_ranks. Beads fall into a box, on any number of
// processes.

#include <cstdio>

#include <silt/mpi.hpp>
#include <silt/silt.hpp>

int main(int argc, char** argv) {
  silt::Mpi mpi(argc, argv);

  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};
  silt::Particles<silt::Sphere> beads;
  beads.fill({.min = {0, 0, 0}, .max = {0.06, 0.02, 0.04}},
             {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500});

  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Ranks{MPI_COMM_WORLD, silt::Bisection{}}};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;  // of each rank
  sim.add_wall(silt::box({0, 0, 0}, {0.06, 0.02, 0.1}), glass);

  sim.run(0.05, silt::vtk_series("ranks", silt::every(0.01)), silt::progress());

  double high = 0;  // [kg] of own particles
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.position(k).z > 0.02) high += sim.mass(k);
  high = sim.sum_over_ranks(high);

  const auto loads = sim.rank_loads();
  if (sim.rank() == 0) {
    std::printf("%.3g kg above 20 mm; %zu beads\n", high, sim.size());
    for (std::size_t r = 0; r < loads.size(); ++r)
      std::printf("rank %zu: %zu beads, %zu contacts, %zu ghosts, %.2g s for messages\n", r,
                  std::size_t{loads[r].particles}, std::size_t{loads[r].contacts},
                  std::size_t{loads[r].ghosts}, loads[r].seconds.ghosts);
  }

  for (std::size_t k = 0; k < sim.rows(); ++k)  // own particles, as many as each rank likes
    if (sim.is_present(k) && sim.position(k).z > 0.04) sim.remove(sim.id(k));
  sim.set_velocity(17, {0, 0, 0.1});  // every rank calls it, one has particle 17
  sim.run(0.01);
}
