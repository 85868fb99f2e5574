// silt - BSD-3-Clause, see LICENSE
//
// Cost of a fluid step on one thread: the flow solver alone, in a box with a bed in its lower half,
// and CoupledFlow with 100 000 spheres in 20 480 cells, in each of its modes.
//   bench_coupled [--quick] [--out DIR]
// DIR/summary.json: all numbers, and checks that all timed balances of fluid and particles close:
// continuity, volume and momentum, and that no sphere is lost.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <string>
#include <vector>

#include <silt/files/atomic_file.hpp>
#include <silt/fluid.hpp>

#include "support/example.hpp"

namespace {

constexpr double time_step = 1e-4;  // [s]
constexpr double tolerance = 1e-5;  // [-] of the pressure solver

example::Summary summary;
int steps = 20;                // of each of the modes
std::size_t spheres = 100000;  // in the bed
int height = 80;               // [-] cells of the bed's grid

/// Largest allowed closure error of fluid and particles.
void check(const std::string& name, const silt::FluidClosure& closure) {
  summary.check_at_most(name + "_volume_error", closure.volume, 1e-10);
  summary.check_at_most(name + "_momentum_error", closure.momentum, 1e-9);
  summary.check_at_most(name + "_continuity_error", closure.continuity, tolerance);
}

/// Processor time [s] so far: other programs may use the machine too.
double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Mean time [s] of a call.
template <class Call>
double seconds(const Call& call) {
  for (int s = 0; s < 5; ++s) call();
  const double start = now();
  for (int s = 0; s < steps; ++s) call();
  return (now() - start) / steps;
}

void flow_alone(int nx, int ny, int nz) {
  const double h = 5e-3, speed = 1.8;
  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {nx * h, ny * h, nz * h}}, {nx, ny, nz}),
                        {.density = 1.2, .viscosity = 1.8e-5}, {.tolerance = tolerance});
  flow.set_side(2, 0, silt::Inflow{{0, 0, speed}});
  flow.set_side(2, 1, silt::Outflow{});
  silt::Random random(1);
  const auto bed = [&](const auto& visit) {
    for (int k = 0; k < nz / 2; ++k)
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) visit(i, j, k);
  };
  bed([&](int i, int j, int k) {
    flow.voidage()(i, j, k) = random.uniform(0.42, 0.5);
    flow.drag()(i, j, k) = random.uniform(1600, 2400);
  });
  flow.velocity(2).fill(speed);
  int iterations = 0, calls = 0;
  double spent = 0, unbalanced = 0;  // on changing the bed; of continuity
  const double all = seconds([&] {
    const double start = now();
    bed([&](int i, int j, int k) {
      double& eps = flow.voidage()(i, j, k);
      eps += 0.02 * (random.uniform(0.42, 0.5) - eps);
    });
    if (calls >= 5) spent += now() - start;
    const auto done = flow.step(time_step);
    iterations += done.iterations, ++calls;
    unbalanced = std::max(unbalanced, done.unbalanced);
  });
  const auto cells = static_cast<double>(flow.grid().size());
  const std::string name = silt::text("flow_", flow.grid().size(), "_cells");
  summary.result(name + "_ns_a_cell", 1e9 * (all - spent / steps) / cells);
  summary.result(name + "_iterations", double(iterations) / calls);
  summary.check_at_most(name + "_continuity_error", unbalanced, tolerance);
  std::printf("flow alone, %7.0f cells: %4.0f ns a cell and step, %.1f iterations\n", cells,
              1e9 * (all - spent / steps) / cells, double(iterations) / calls);
}

template <class Mode>
void coupled(const char* name, const std::string& key, const Mode& mode) {
  const double d = 1e-3, h = 2 * d, a = 1.02 * d;
  const int nx = 16, nz = height;
  silt::CoupledFlow flow(
      silt::DiFelice{}, mode,
      silt::FlowSolver(silt::Grid({{0, 0, 0}, {nx * h, nx * h, nz * h}}, {nx, nx, nz}),
                       {.density = 1.2, .viscosity = 1.8e-5}, {.tolerance = tolerance}));
  flow.flow().set_side(2, 0, silt::Inflow{{0, 0, 0.8}});
  flow.flow().set_side(2, 1, silt::Outflow{});
  const std::size_t count = spheres;
  std::vector<silt::Vec3d> place, velocity(count, {0, 0, 0}), force(count);
  const int across = static_cast<int>(nx * h / a);
  for (int k = 0; place.size() < count; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across && place.size() < count; ++i)
        place.push_back({(i + 0.6) * a, (j + 0.6) * a, 5e-3 + (k + 0.6) * a});
  const double V = std::numbers::pi / 6 * d * d * d;
  const std::vector<double> radius(count, 0.5 * d), volume(count, V), mass(count, 2500 * V);
  const silt::CoupledParticles grains{{place, radius}, velocity, volume, mass};
  silt::FluidClosure closure;
  const double step = seconds([&] { closure.add(flow.advance(grains, time_step, force)); });
  const double alone = seconds([&] { flow.flow().step(time_step); });
  summary.result(key + "_ms_a_step", 1e3 * step);
  summary.result(key + "_flow_ms_a_step", 1e3 * alone);
  summary.result(key + "_ns_a_particle", 1e9 * (step - alone) / static_cast<double>(count));
  check(key, closure);
  std::printf("%-22s %5.1f ms a step, of it flow %4.1f ms; the rest %3.0f ns a particle\n", name,
              1e3 * step, 1e3 * alone, 1e9 * (step - alone) / static_cast<double>(count));
}

/// The same bed in a Simulation, settled and at rest except for motion by the gas; with or without
/// a fluid.
template <class... Fluid>
auto bed(const Fluid&... fluid) {
  const double d = 1e-3, a = 1.02 * d, width = 32 * d;
  silt::Particles<silt::Sphere> grains;
  const int across = static_cast<int>(width / a);
  for (int k = 0; grains.size() < spheres; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across && grains.size() < spheres; ++i)
        grains.add({.position = {(i + 0.6 + 0.05 * (k % 3)) * a, (j + 0.6 + 0.05 * (k % 2)) * a,
                                 (k + 0.6) * a},
                    .radius = 0.5 * d,
                    .density = 2500});
  const silt::HertzMindlin::Material glass{1e6, 0.3, 0.8, 0.3};
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass}, fluid...};
  sim.add_wall(silt::box({0, 0, 0}, {width, width, 0.32}), glass);
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 1e-5;
  sim.threads = 1;
  sim.run(0.05);
  return sim;
}

/// Fraction of the run time spent on the fluid, at 50 particle steps per fluid step.
template <class Mode>
void in_simulation(const char* name, const std::string& key, const Mode& mode) {
  const double h = 2e-3;
  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {16 * h, 16 * h, height * h}}, {16, 16, height}),
                        {.density = 1.2, .viscosity = 1.8e-5}, {.tolerance = tolerance});
  flow.set_side(2, 0, silt::Inflow{{0, 0, 0.3}});
  flow.set_side(2, 1, silt::Outflow{});
  silt::CoupledFlow air{silt::DiFelice{}, mode, std::move(flow)};
  air.steps = 50;
  air.least_voidage = 0.1;  // cells of two diameters hold more than 0.7 of solids here and there
  auto coupled = bed(air);
  auto dry = bed();
  const auto timed = [&](auto& sim) {
    const double start = now();
    sim.run(200 * 1e-5);
    return (now() - start) / 200;
  };
  timed(coupled), timed(dry);  // to warm up
  double with = 0, without = 0;
  for (int round = 0; round < 5; ++round) with += timed(coupled) / 5, without += timed(dry) / 5;
  std::printf("%-22s %5.2f ms a particle step, the dry bed %5.2f: the fluid's share %2.0f %%\n",
              name, 1e3 * with, 1e3 * without, 100 * (1 - without / with));
  summary.result(key + "_ms_a_particle_step", 1e3 * with);
  summary.result(key + "_dry_ms_a_particle_step", 1e3 * without);
  check(key, coupled.fluid().closure());
  summary.check_at_most(key + "_clipped", coupled.fluid().closure().clipped, 0);
  summary.check_at_most(key + "_lost", static_cast<double>(spheres - coupled.rows()), 0);
  // The lowest of 104 layers have overlaps of 0.05 by Hertz at rest, and 0.12 as the lattice
  // collapses.
  summary.check_at_most(key + "_overlap_over_radius", coupled.peak_overlap(), 0.2);
}

int run(const example::Options& options) {
  silt::make_folder(options.out);
  if (options.quick) steps = 3, spheres = 3000, height = 16;
  summary.input("quick", options.quick);
  summary.input("spheres", static_cast<double>(spheres));
  std::printf("%s\n", example::processor().c_str());
  if (options.quick) {
    flow_alone(16, 16, 24);
  } else {
    flow_alone(32, 16, 96);
    flow_alone(64, 64, 64);
  }
  std::printf("%zu spheres, %d cells of 2 diameters:\n", spheres, 256 * height);
  using silt::Unresolved;
  coupled("Unresolved, centre", "centre", Unresolved{.share = Unresolved::Share::Centre});
  coupled("Unresolved, exact", "exact", Unresolved{});
  coupled("TwoGrid", "two_grid", silt::TwoGrid{});
  coupled("Kernel", "kernel", silt::Kernel{});
  coupled("Diffusion", "diffusion", silt::Diffusion{});
  std::printf("Simulation of the same, 50 particle steps a fluid step:\n");
  in_simulation("Kernel", "simulation_kernel", silt::Kernel{});
  in_simulation("Unresolved, exact", "simulation_exact", Unresolved{});
  summary.write(options.out + "/summary.json");
  summary.print_checks();
  std::printf("Look at: %s/summary.json\n", options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("What a fluid step costs: the flow solver, its coupling in each mode",
                           example::Kind::Study, "out/bench-fluid/coupled");
  return command.run(argc, argv, [&] { return run(command.options); });
}
