// silt - BSD-3-Clause, see LICENSE
// A run that fails, and the files it leaves: docs/failures.md.

#include <cstdio>
#include <filesystem>
#include <utility>

#include <silt/silt.hpp>

int main() {
  silt::Particles<silt::Sphere> beads;
  beads.fill({.min = {0, 0, 0}, .max = {0.02, 0.02, 0.05}},
             {.radius = 1e-3, .density = 2500, .count = 400});
  const silt::HertzMindlin::Material soft{.youngs_modulus = 1e6, .poisson_ratio = 0.3};
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{soft}};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.2}), soft);
  sim.gravity = {0, 0, -9.81};
  // A punch comes down too fast for such soft beads.
  sim.add_wall(silt::Plane{{0, 0, 0.052}, {0, 0, -1}}, soft, silt::translation({0, 0, -0.5}));

  bool failed = false;
  try {
    sim.run(0.2, silt::on_failure("failed", silt::every(0.01)));
  } catch (const silt::SimulationError& error) {
    failed = true;
    std::printf("%s\n", error.what());
  }

  // Back to the last state that was good, 10 ms before at most, to look at it or to change it.
  silt::load_checkpoint(sim, "failed/last_good.silt");
  std::printf("the last good state is of t = %.3f s\n", sim.time());
  sim.remove_wall(1);
  sim.run(0.02);

  const bool there = std::filesystem::exists("failed/contacts.csv") &&
                     std::filesystem::exists("failed/around.vtp") && sim.time() > 0.03;
  if (!failed || !there) std::printf("wrong: the run must fail, leave its files, and go on\n");
  return failed && there ? 0 : 1;
}
