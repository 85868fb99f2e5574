// silt - BSD-3-Clause, see LICENSE
#include "scenes.hpp"

#include <utility>

#include <silt/parallel/thread_comm.hpp>
#include <silt/ranks.hpp>
#include <silt/silt.hpp>

namespace {

template <class... More>
void run(const std::string& folder, More... more) {
  silt::Particles<silt::Sphere> beads;
  for (int k = 0; k < 27; ++k)
    beads.add({.position = {0.005 + 0.01 * (k % 9), 0.005, 0.004 + 0.01 * (k / 9)},
               .radius = 2e-3,
               .density = 2500,
               .velocity = {0.05 * (k % 2), 0, -0.1}});
  const silt::HertzMindlin::Material glass{.youngs_modulus = 5e6, .poisson_ratio = 0.3};
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}, more...};
  sim.gravity = {0, 0, -9.81}, sim.threads = 1, sim.time_step = 1e-5;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.run(0.04, silt::vtk_series(folder, silt::every(0.02)),
          silt::contact_series(folder, silt::every(0.02)));
}

void fail(const std::string& folder) {
  silt::Particles<silt::Sphere> beads;
  beads.add({.position = {0, 0, 0.01}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -1}});
  const silt::HertzMindlin::Material glass{.youngs_modulus = 5e6, .poisson_ratio = 0.3};
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}};
  sim.guard.domain = silt::Box{{-0.01, -0.01, 0}, {0.01, 0.01, 0.02}};
  try {
    sim.run(0.1, silt::on_failure(folder));
  } catch (const silt::SimulationError&) {
    return;
  }
  throw silt::InputError("the run of failed/ must fail");
}

}  // namespace

void write_pieces(const std::string& folder) {
  run(folder + "/whole");
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    run(folder + "/pieces", silt::Ranks{comm, silt::Bisection{}});
  });
  fail(folder + "/failed");
}
