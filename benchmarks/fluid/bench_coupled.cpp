// silt - BSD-3-Clause, see LICENSE
//
// What a fluid step costs on one thread: the flow solver alone, in a box with a bed in its lower
// half, and CoupledFlow with 100 000 spheres in 20 480 cells, in each of its modes.

#include <cstdio>
#include <ctime>
#include <numbers>
#include <vector>

#include <silt/fluid.hpp>

namespace {

constexpr double time_step = 1e-4;  // [s]
constexpr int steps = 20;

/// Processor time [s] so far: others may use the machine too.
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
                        {.density = 1.2, .viscosity = 1.8e-5}, {.tolerance = 1e-5});
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
  double spent = 0;  // on changing the bed
  const double all = seconds([&] {
    const double start = now();
    bed([&](int i, int j, int k) {
      double& eps = flow.voidage()(i, j, k);
      eps += 0.02 * (random.uniform(0.42, 0.5) - eps);
    });
    if (calls >= 5) spent += now() - start;
    iterations += flow.step(time_step).iterations, ++calls;
  });
  const auto cells = static_cast<double>(flow.grid().size());
  std::printf("flow alone, %7.0f cells: %4.0f ns a cell and step, %.1f iterations\n", cells,
              1e9 * (all - spent / steps) / cells, double(iterations) / calls);
}

template <class Mode>
void coupled(const char* name, const Mode& mode) {
  const double d = 1e-3, h = 2 * d, a = 1.02 * d;
  const int nx = 16, nz = 80;
  silt::CoupledFlow flow(
      silt::DiFelice{}, mode,
      silt::FlowSolver(silt::Grid({{0, 0, 0}, {nx * h, nx * h, nz * h}}, {nx, nx, nz}),
                       {.density = 1.2, .viscosity = 1.8e-5}, {.tolerance = 1e-5}));
  flow.flow().set_side(2, 0, silt::Inflow{{0, 0, 0.8}});
  flow.flow().set_side(2, 1, silt::Outflow{});
  const std::size_t count = 100000;
  std::vector<silt::Vec3d> place, velocity(count, {0, 0, 0}), force(count);
  const int across = static_cast<int>(nx * h / a);
  for (int k = 0; place.size() < count; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across && place.size() < count; ++i)
        place.push_back({(i + 0.6) * a, (j + 0.6) * a, 5e-3 + (k + 0.6) * a});
  const double V = std::numbers::pi / 6 * d * d * d;
  const std::vector<double> radius(count, 0.5 * d), volume(count, V), mass(count, 2500 * V);
  const silt::CoupledParticles grains{{place, radius}, velocity, volume, mass};
  const double step = seconds([&] { flow.advance(grains, time_step, force); });
  const double alone = seconds([&] { flow.flow().step(time_step); });
  std::printf("%-22s %5.1f ms a step, of it flow %4.1f ms; the rest %3.0f ns a particle\n", name,
              1e3 * step, 1e3 * alone, 1e9 * (step - alone) / count);
}

/// The same bed in a Simulation, fallen and at rest but for what the gas stirs; with or without a
/// fluid.
template <class... Fluid>
auto bed(const Fluid&... fluid) {
  const double d = 1e-3, a = 1.02 * d, width = 32 * d;
  silt::Particles<silt::Sphere> grains;
  const int across = static_cast<int>(width / a);
  for (int k = 0; grains.size() < 100000; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across && grains.size() < 100000; ++i)
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
/// What of the time of a run is the fluid's, at 50 particle steps a fluid step.
template <class Mode>
void in_simulation(const char* name, const Mode& mode) {
  const double h = 2e-3;
  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {16 * h, 16 * h, 80 * h}}, {16, 16, 80}),
                        {.density = 1.2, .viscosity = 1.8e-5}, {.tolerance = 1e-5});
  flow.set_side(2, 0, silt::Inflow{{0, 0, 0.3}});
  flow.set_side(2, 1, silt::Outflow{});
  silt::CoupledFlow air{silt::DiFelice{}, mode, std::move(flow)};
  air.steps = 50;
  auto coupled = bed(air);
  auto dry = bed();
  const auto timed = [&](auto& sim) {
    const double start = now();
    sim.run(200 * 1e-5);
    return (now() - start) / 200;
  };
  double with = 0, without = 0;
  for (int round = 0; round < 5; ++round) with += timed(coupled) / 5, without += timed(dry) / 5;
  std::printf("%-22s %5.2f ms a particle step, the dry bed %5.2f: the fluid's share %2.0f %%\n",
              name, 1e3 * with, 1e3 * without, 100 * (1 - without / with));
}

}  // namespace

int main() {
  flow_alone(32, 16, 96);
  flow_alone(64, 64, 64);
  std::printf("100 000 spheres, 20 480 cells of 2 diameters:\n");
  using silt::Unresolved;
  coupled("Unresolved, centre", Unresolved{.share = Unresolved::Share::Centre});
  coupled("Unresolved, exact", Unresolved{});
  coupled("TwoGrid", silt::TwoGrid{});
  coupled("Kernel", silt::Kernel{});
  coupled("Diffusion", silt::Diffusion{});
  std::printf("Simulation of 100 000 spheres in 20 480 cells, 50 particle steps a fluid step:\n");
  in_simulation("Kernel", silt::Kernel{});
  in_simulation("Unresolved, exact", Unresolved{});
}
