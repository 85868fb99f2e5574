// silt - BSD-3-Clause, see LICENSE
#include "scenes.hpp"

#include <array>
#include <vector>

#include <silt/silt.hpp>

namespace {

void write_run(const std::string& folder, double gravity) {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 2e6, .poisson_ratio = 0.25, .restitution = 0.4, .friction = 0.4};
  silt::Particles<silt::Sphere> beads;
  beads.fill({.min = {0, 0, 0.006}, .max = {0.02, 0.012, 0.036}},
             {.radius = silt::uniform(0.9e-3, 1.2e-3), .density = 2500, .count = 120, .seed = 3});
  const silt::HeatConduction heat{.conductivity = 200, .heat_capacity = 500};
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e6}}, heat};
  sim.threads = 1;
  sim.gravity = {0, 0, -gravity};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.012, 0.05}), glass, {.name = "box"});
  sim.add_wall(silt::rectangle({0.004, 0.002, 0.004}, {0.004, 0, 0}, {0, 0.008, 0}), glass,
               {.name = "shelf", .motion = silt::translation({0, 0, 0.02})});
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.template field<silt::Temperature>(k) = 300 + static_cast<double>(k);
  silt::bond_near(sim, 1e-3, [](auto a, auto b) { return a < 30 && b < 30; });

  const auto observed = [&](double duration) {
    sim.run(duration, silt::vtk_series(folder, silt::every(0.04)),
            silt::contact_series(folder, silt::every(0.04)),
            silt::contact_csv(folder, silt::every(0.04)),
            silt::bond_series(folder, silt::every(0.04)),
            silt::csv_series(folder, silt::every(0.04)),
            silt::table(
                folder + "/energy.csv", {"time [s]", "kinetic energy [J]", "particles [-]"},
                silt::every(0.02), [](const auto& s) {
                  return std::array{s.time(), s.kinetic_energy(), static_cast<double>(s.size())};
                }));
  };
  silt::make_folder(folder);
  observed(0.08);
  sim.remove(sim.id(7));
  silt::save_checkpoint(sim, folder + "/half.silt");
}

}  // namespace

void write_grains(const std::string& folder) {
  write_run(folder + "/grains", 9.81);
  write_run(folder + "/again", 9.81);
  write_run(folder + "/other", 9.80);
}
