// silt - BSD-3-Clause, see LICENSE
//
// The fluidised bed of OpenFOAM's tutorial DPMFoam/Goldschmidt, timed in silt and DPMFoam
// (fluid.py): 24 750 spheres of 2.5 mm in a box of 15 x 150 x 450 mm, 2 x 30 x 90 cells.
//   bench_goldschmidt settle FILE
//     fluidises a lattice until bubbles rise; writes the places of the spheres, 'x y z' a line
//   bench_goldschmidt time FILE SECONDS centre|kernel SUBSTEPS END
//     runs the bed in FILE, which begins at rest, on one thread. SUBSTEPS: particle steps in a
//     fluid step of 2e-5 s, or 0 for silt's own choice of both. The first tenth of SECONDS warms up
//     and is not timed. Prints one line of results; writes
//     'time [s] pressure [Pa] height [m]' to END: mean pressure of the lowest cells, mean height of
//     the spheres.
// As in DPMFoam: Hertz's law with a dashpot, Coulomb friction, moduli, densities, drag of Ergun and
// of Wen and Yu, model B (the pressure gradient acts on the fluid only, and the drag is divided by
// eps).

#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>
#include <utility>

#include <silt/fluid.hpp>

namespace {

using silt::Vec3d;
using Law =
    silt::BasicHertzMindlin<silt::DampingEnd::ZeroOverlap, silt::TangentialMemory::Displacement>;

constexpr double deep = 0.0075, half = 0.075, high = 0.45;  // [m] box: +-deep, +-half, 0 to high
constexpr double diameter = 2.5e-3, density = 2526;         // [m], [kg/m3]
constexpr double fluid_step = 2e-5, gas_velocity = 1.875;   // [s], [m/s]

silt::Particles<silt::Sphere> lattice() {
  silt::Particles<silt::Sphere> spheres;
  silt::Random random(1);
  for (int k = 0; k < 99; ++k)
    for (int j = 0; j < 50; ++j)
      for (int i = 0; i < 5; ++i)
        spheres.add({.position = {(i - 2) * 3e-3, (j - 24.5) * 3e-3, (k + 0.5) * 3e-3},
                     .radius = diameter / 2,
                     .density = density,
                     .velocity = {random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), 0}});
  return spheres;
}

silt::Particles<silt::Sphere> read(const std::string& path) {
  std::ifstream in(path);
  silt::require(in.good(), "cannot read ", path);
  silt::Particles<silt::Sphere> spheres;
  Vec3d p;
  while (in >> p.x >> p.y >> p.z)
    spheres.add({.position = p, .radius = diameter / 2, .density = density});
  return spheres;
}

template <class Mode>
auto bed(silt::Particles<silt::Sphere> spheres, const Mode& mode, double modulus) {
  // The range of sphere centres, including overlap with a plane: a sphere outside the grid would
  // remove its volume from the flow at once.
  const double reach = deep + 5e-5;
  silt::FlowSolver flow(silt::Grid({{-reach, -half, 0}, {reach, half, high}}, {2, 30, 90}),
                        {.density = 1.2, .viscosity = 1.2e-5}, {.model = silt::MomentumModel::B});
  flow.set_side(0, 0, silt::FreeSlip{}), flow.set_side(0, 1, silt::FreeSlip{});
  flow.set_side(2, 0, silt::Inflow{{0, 0, gas_velocity}});
  flow.set_side(2, 1, silt::Outflow{});
  // DPMFoam's dashpots of alpha = 0.02 and 0.01.
  const Law::Material glass{modulus, 0.35, 0.9723, 0.10}, wall{modulus, 0.23, 0.9860, 0.09};
  const Law::Material mirror{modulus, 0.35, 0.97, 0};
  silt::Contacts<Law> contacts{glass};
  contacts.add(wall), contacts.add(mirror);
  contacts.set_pair(glass, wall, {wall.restitution, wall.friction});
  contacts.set_pair(glass, mirror, {mirror.restitution, mirror.friction});
  silt::Simulation sim{std::move(spheres), contacts,
                       silt::CoupledFlow{silt::Gidaspow{}, mode, std::move(flow)}};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, wall);
  sim.add_wall(silt::Plane{{0, -half, 0}, {0, 1, 0}}, wall);
  sim.add_wall(silt::Plane{{0, half, 0}, {0, -1, 0}}, wall);
  sim.add_wall(silt::Plane{{0, 0, high}, {0, 0, -1}}, wall);  // the lattice splashes
  // Symmetry planes in DPMFoam, which sphere centres may reach.
  sim.add_wall(silt::Plane{{-deep - diameter / 2, 0, 0}, {1, 0, 0}}, mirror);
  sim.add_wall(silt::Plane{{deep + diameter / 2, 0, 0}, {-1, 0, 0}}, mirror);
  return sim;
}

void settle(const std::string& path) {
  // Soft spheres first, then those that are timed.
  auto soft = bed(lattice(), silt::Kernel{}, 5e6);
  soft.guard.max_overlap = 0.9;
  soft.run(0.6, silt::progress());
  silt::Particles<silt::Sphere> now;
  for (std::size_t k = 0; k < soft.rows(); ++k)
    now.add({.position = soft.position(k),
             .radius = diameter / 2,
             .density = density,
             .velocity = soft.velocity(k)});
  auto sim = bed(std::move(now), silt::Kernel{}, 1e8);
  sim.guard.max_overlap = 0.9, sim.guard.max_time_step = 1;  // overlaps of the soft ones part
  sim.time_step = 2e-6;
  sim.run(0.01, silt::progress());
  std::string out;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    Vec3d p = sim.position(k);
    p.x = std::clamp(p.x, -0.9999 * deep, 0.9999 * deep);
    out += silt::text(p.x, ' ', p.y, ' ', p.z, '\n');
  }
  silt::AtomicFile file(path);
  file.write(out);
  file.commit();
}

template <class Mode>
void time(const std::string& path, double span, const Mode& mode, int substeps,
          const std::string& end) {
  auto sim = bed(read(path), mode, 1e8);
  if (substeps > 0) {
    sim.fluid().steps = substeps;
    sim.time_step = fluid_step / substeps;
  }
  std::string out;
  const auto measure = [&](const auto& s) {
    const auto& p = s.fluid().flow().pressure();
    double pressure = 0, height = 0;
    for (int j = 0; j < 30; ++j)
      for (int i = 0; i < 2; ++i) pressure += p(i, j, 0) / 60;
    for (std::size_t k = 0; k < s.rows(); ++k) height += s.position(k).z;
    out += silt::text(s.time(), ' ', pressure, ' ', height / static_cast<double>(s.rows()), '\n');
  };
  const int slices = std::max(10, static_cast<int>(std::lround(span / 1e-3)));
  const int first = std::max(1, slices / 10);
  for (int k = 0; k < first; ++k) sim.run(span / slices), measure(sim);
  const double from = sim.time();
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t begun = std::clock();
  for (int k = first; k < slices; ++k) sim.run(span / slices), measure(sim);
  const double cpu = static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
  const double wall =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto& closure = sim.fluid().closure();
  std::printf(
      "seconds %.6g timed %.9g wall %.6g steps %lld fluid_steps %lld spheres %zu clipped %.3g "
      "volume_error %.3g momentum_error %.3g overlap %.3g\n",
      cpu, sim.time() - from, wall, static_cast<long long>(sim.step()),
      static_cast<long long>(sim.fluid().fluid_steps()), sim.rows(), closure.clipped,
      closure.volume, closure.momentum, sim.peak_overlap());
  silt::AtomicFile file(end);
  file.write(out);
  file.commit();
}

}  // namespace

int main(int argc, char** argv) {
  const std::string task = argc > 1 ? argv[1] : "";
  try {
    if (task == "settle" && argc == 3) {
      settle(argv[2]);
    } else if (task == "time" && argc == 7) {
      const std::string mode = argv[4];
      const int substeps = std::stoi(argv[5]);
      if (mode == "centre")
        time(argv[2], std::stod(argv[3]), silt::Unresolved{silt::Unresolved::Share::Centre},
             substeps, argv[6]);
      else
        time(argv[2], std::stod(argv[3]), silt::Kernel{}, substeps, argv[6]);
    } else {
      std::fprintf(stderr, "usage: see the head of bench_goldschmidt.cpp\n");
      return 2;
    }
  } catch (const silt::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
