// silt - BSD-3-Clause, see LICENSE
//
// A spiral jet mill: four air jets drive grains round a flat chamber. They break at its wall and on
// each other until they are dust, which leaves with the air through a central tube. The air is
// incompressible and turbulent, with two-way coupling.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "jet_mill/scene.hpp"
#include "support/example.hpp"

namespace {

using jet_mill::Scene;
using silt::Vec3d;

/// Sizes [m] d10, d50 and d90 by mass of a table; NaN while it is empty.
std::array<double, 3> quantiles(const silt::SizeTable& sizes) {
  if (!(sizes.mass() > 0)) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    return {none, none, none};
  }
  return {sizes.quantile(0.1), sizes.quantile(0.5), sizes.quantile(0.9)};
}

/// The mean flow in the cells next to half of the chamber's height.
void write_gas(const std::string& path, const silt::FlowMean& mean, const Scene& s) {
  silt::CsvTable out(path, {"x [m]", "y [m]", "u [m/s]", "v [m/s]", "w [m/s]"});
  const auto& grid = mean.grid();
  const int middle = static_cast<int>(0.5 * s.height / s.cell);
  for (int j = 0; j < grid.ny(); ++j)
    for (int i = 0; i < grid.nx(); ++i) {
      const Vec3d low = grid.box().min;
      const Vec3d x{low.x + (i + 0.5) * s.cell, low.y + (j + 0.5) * s.cell, 0.5 * s.height};
      if (jet_mill::room(s, x) <= 0) continue;
      const Vec3d v = 0.5 * (mean.velocity(i, j, middle - 1) + mean.velocity(i, j, middle));
      out.add_row({x.x, x.y, v.x, v.y, v.z});
    }
}

void write_impacts(const std::string& path, const silt::ImpactEnergies& impacts, double duration) {
  silt::CsvTable out(path, {"from [J]", "to [J]", "at walls [1/s]", "in pairs [1/s]",
                            "energy at walls [W]", "energy in pairs [W]"});
  for (const auto& c : impacts.table())
    out.add_row({c.from, c.to, static_cast<double>(c.at_walls) / duration,
                 static_cast<double>(c.in_pairs) / duration, c.walls_energy / duration,
                 c.pairs_energy / duration});
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  silt::make_folder(options.out);
  silt::CoupledFlow gas{silt::DiFelice{}, silt::Kernel{}, jet_mill::air(s)};
  gas.diameter = s.feed, gas.most_steps = 200;
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, jet_mill::contacts(s), std::move(gas),
                       jet_mill::breakage(s)};
  jet_mill::furnish(sim, s);
  sim.threads = options.threads;
  // Large grains press fragments deeper into walls than impacts of equal grains do.
  sim.guard.max_overlap = 0.89, sim.guard.max_travel = 0.1;
  if (!options.restart.empty()) silt::load_checkpoint(sim, options.restart);

  example::Summary summary;
  summary.input("jets_m_s", s.jets);
  summary.input("gas_kg_s", s.gas_rate() * Scene::air.density);
  summary.input("feed_kg_s", s.rate);
  summary.input("feed_diameter_m", s.feed);
  summary.input("strength_n", s.strength);
  summary.input("dust_below_m", s.dust);
  summary.input("softened_below_m", 2 * s.full_radius);
  summary.input("cell_m", s.cell);
  summary.input("duration_s", s.duration);

  silt::FlowMean mean;
  double worst_mass = 0, fastest = 0, gas_speed = 0, most = 0, swirl = 0, samples = 0;
  const double interval = s.duration / 150;
  auto watch = silt::at(silt::every(interval), [&](const auto& now) {
    const auto m = now.mass_balance();
    if (m.fed > 0) worst_mass = std::max(worst_mass, std::abs(m.residual()) / m.fed);
    most = std::max(most, static_cast<double>(now.size()));
    for (std::size_t k = 0; k < now.rows(); ++k)
      if (now.is_present(k)) fastest = std::max(fastest, norm(now.velocity(k)));
    const auto& flow = now.fluid().flow();
    const auto& grid = flow.grid();
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j)
        for (int i = 0; i < grid.nx(); ++i)
          for (int d = 0; d < 3; ++d)
            gas_speed = std::max(gas_speed, std::abs(flow.velocity(d)(i, j, k)));
    if (now.time() < 0.5 * s.duration) return;
    mean.add(flow, interval);
    for (int k = 0; k < 32; ++k) {
      const double angle = 2 * std::numbers::pi * k / 32, r = 0.5 * s.radius;
      const Vec3d x{r * std::cos(angle), r * std::sin(angle), 0.5 * s.height};
      const Vec3d v = silt::flow_at(flow, x).velocity;
      swirl += v.y * std::cos(angle) - v.x * std::sin(angle), samples += 1;
    }
  });
  auto sizes = silt::table(
      options.out + "/sizes_over_time.csv",
      {"time [s]", "dust x10 [m]", "dust x50 [m]", "dust x90 [m]", "grains x10 [m]",
       "grains x50 [m]", "grains x90 [m]"},
      silt::every(s.duration / 50), [](const auto& now) {
        const auto dust = quantiles(now.dust()), there = quantiles(silt::sizes_present(now));
        return std::array{now.time(), dust[0], dust[1], dust[2], there[0], there[1], there[2]};
      });
  sim.run(s.duration - sim.time(), watch, sizes,
          silt::breakage_table(options.out + "/breakage.csv", silt::every(s.duration / 50)),
          silt::vtk_series(options.out + "/vtk", silt::every(s.duration / 10)),
          silt::checkpoints(options.out + "/last.silt", silt::every(s.duration / 5)),
          silt::progress());

  silt::write_particles(options.out + "/end.vtp", sim);
  write_gas(options.out + "/gas.csv", mean, s);
  write_impacts(options.out + "/impacts.csv", sim.impact_energies(), sim.time());
  silt::write_sizes(options.out + "/dust.csv", sim.dust());
  silt::write_sizes(options.out + "/grains.csv", silt::sizes_present(sim));
  silt::SizeTable product = sim.dust();
  product.merge(sim.left());
  silt::write_sizes(options.out + "/product.csv", product);

  const auto m = sim.mass_balance();
  const auto& closure = sim.fluid().closure();
  const auto at_walls = static_cast<double>(sim.broken(silt::BreakCause::Wall)),
             in_pairs = static_cast<double>(sim.broken(silt::BreakCause::Pair));
  summary.result("fed_kg", m.fed);
  summary.result("present_kg", m.present);
  summary.result("left_kg", m.left);
  summary.result("dust_kg", m.dust);
  summary.result("grains", static_cast<double>(sim.size()));
  summary.result("most_grains", most);
  summary.result("broken_at_walls", at_walls);
  summary.result("broken_in_pairs", in_pairs);
  summary.result("fastest_grain_m_s", fastest);
  summary.result("fastest_gas_m_s", gas_speed);
  summary.result("swirl_at_half_radius_m_s", swirl / std::max(samples, 1.0));
  summary.result("safeguarded", static_cast<double>(sim.safeguarded()));
  summary.result("time_step_s", sim.step_length());
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("fluid_steps", static_cast<double>(sim.fluid().fluid_steps()));
  summary.result("wall_time_s", whole.seconds());
  summary.check_at_most("mass_unexplained_over_fed", worst_mass, 1e-12);
  summary.check_at_least("broken", at_walls + in_pairs, 1);
  summary.check_at_most("momentum_of_gas_and_grains_off", closure.momentum, 1e-8);
  summary.check_at_most("volume_of_solids_off", closure.volume, 1e-10);
  summary.check_at_most("fastest_grain_over_fastest_gas", fastest / gas_speed, 1);
  summary.write(options.out + "/summary.json");
  std::printf("\nBroken: %.0f at walls, %.0f on each other. Of %.2f mg fed, %.1f %% are dust.\n",
              at_walls, in_pairs, 1e6 * m.fed, 100 * m.dust / m.fed);
  const bool drawn = example::run_script(
      SILT_JET_MILL_SCRIPT, {options.out, silt::text(s.radius), silt::text(s.outlet),
                             silt::text(s.post), silt::text(s.nozzle), silt::text(s.offset)});
  summary.print_checks();
  std::printf("Look at: %s%s/vtk (ParaView), %s/breakage.csv, %s/product.csv, %s/summary.json\n",
              drawn ? (options.out + "/mill.png, " + options.out + "/milling.png, ").c_str() : "",
              options.out.c_str(), options.out.c_str(), options.out.c_str(), options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("A spiral jet mill: grains break at its wall and on each other");
  Scene scene;
  command.add("--jets", scene.jets, 20, 200, "Speed of the gas in the nozzles [m/s]");
  command.add("--rate", scene.rate, 1e-5, 1e-2, "Feed rate [kg/s]");
  command.add("--strength", scene.strength, 1e-3, 1e3, "Median strength of grains of 0.3 mm [N]");
  double dust = 1e6 * scene.dust, softened = 2e6 * scene.full_radius;
  command.add("--dust", dust, 5, 250, "Diameter below which fragments are dust [um]");
  command.add("--softened", softened, 0, 300, "Diameter below which grains are softened [um]");
  command.add("--duration", scene.duration, 1e-4, 10, "Duration [s]");
  bool fine = false;
  command.add_flag("--fine", fine, "Flow cells of 0.5 mm instead of 1 mm");
  return command.run(argc, argv, [&] {
    if (command.options.quick && !command.given("--duration")) scene.duration = 5e-3;
    if (fine) scene.cell = 0.5e-3;
    scene.dust = 1e-6 * dust, scene.full_radius = 0.5e-6 * softened;
    return simulate(scene, command.options);
  });
}
