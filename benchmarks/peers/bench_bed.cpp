// silt - BSD-3-Clause, see LICENSE
//
// The dense bed that silt, LAMMPS and LIGGGHTS are timed on, see peers.py.
//   bench_bed settle N STEPS FILE
//     lets a lattice of N spheres fall into a box and settle; writes FILE
//   bench_bed time FILE STEPS THREADS [mixed]
//     runs the bed in FILE, in double or mixed precision; prints one line of results
// FILE is a data file of LAMMPS (atom style sphere). Law: Hertz, Tsuji damping, Mindlin spring with
// the slip as history and Coulomb friction, as `hertz/material ... tangential mindlin ... damping
// tsuji`.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

namespace {

using Law =
    silt::BasicHertzMindlin<silt::DampingEnd::ZeroOverlap, silt::TangentialMemory::Displacement>;
constexpr double width = 0.15, time_step = 2e-5;  // [m], [s]

template <class Precision>
auto bed(silt::Particles<silt::Sphere> spheres, int threads, Precision precision) {
  const Law::Material m{
      .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.4};
  silt::Simulation sim{std::move(spheres), silt::Contacts<Law>{m}, precision};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = time_step;
  sim.threads = threads;
  sim.guard.max_overlap = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, m);
  sim.add_wall(silt::Plane{{width, 0, 0}, {-1, 0, 0}}, m);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, m);
  sim.add_wall(silt::Plane{{0, width, 0}, {0, -1, 0}}, m);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, m);
  return sim;
}

template <class Sim>
double kinetic_energy(const Sim& sim) {
  double e = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    e += 0.5 * sim.mass(k) * silt::dot(sim.velocity(k), sim.velocity(k));
  return e;
}

silt::Particles<silt::Sphere> lattice(std::size_t n) {
  silt::Random random(1);
  constexpr double r_max = 2.35e-3, spacing = 2 * r_max * 1.02;
  const int side = static_cast<int>(width / spacing);
  silt::Particles<silt::Sphere> spheres;
  for (std::size_t k = 0; k < n; ++k) {
    const auto layer = static_cast<double>(k / static_cast<std::size_t>(side * side));
    const int place = static_cast<int>(k % static_cast<std::size_t>(side * side));
    const auto jitter = [&] { return random.uniform(-3e-5, 3e-5); };
    spheres.add(
        {.position = {(place % side + 0.5) * width / side + jitter(),
                      (place / side + 0.5) * width / side + jitter(), (layer + 0.5) * spacing},
         .radius = random.uniform(1.95e-3, 2.35e-3),
         .density = 2500});
  }
  return spheres;
}

silt::Particles<silt::Sphere> read(const std::string& path) {
  std::ifstream in(path);
  silt::require(in.good(), "cannot read ", path);
  silt::Particles<silt::Sphere> spheres;
  for (std::string line; std::getline(in, line) && line != "Atoms";) {
  }
  double id, type, diameter, density, x, y, z;
  while (in >> id >> type >> diameter >> density >> x >> y >> z)
    spheres.add({.position = {x, y, z}, .radius = diameter / 2, .density = density});
  return spheres;
}

template <class Sim>
void write(const Sim& sim, const std::string& path) {
  double top = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) top = std::max(top, sim.position(k).z);
  std::string out =
      silt::text("spheres\n\n", sim.size(), " atoms\n1 atom types\n\n0 ", width, " xlo xhi\n0 ",
                 width, " ylo yhi\n-0.01 ", top + 0.02, " zlo zhi\n\nAtoms\n\n");
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const auto p = sim.position(k);
    out += silt::text(k + 1, " 1 ", 2 * sim.radius(k), " 2500 ", p.x, ' ', p.y, ' ', p.z, '\n');
  }
  silt::AtomicFile file(path);
  file.write(out);
  file.commit();
}

template <class Precision>
void time(const std::string& file, double steps, int threads, Precision precision) {
  auto sim = bed(read(file), threads, precision);
  sim.run(200 * time_step);
  const auto start = std::chrono::steady_clock::now();
  sim.run(steps * time_step);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("seconds %.6g kinetic_energy %.6g contacts %zu overlap %.4g megabytes %.4g\n",
              seconds, kinetic_energy(sim), sim.touching_pairs(), sim.largest_overlap(),
              static_cast<double>(sim.engine().bytes()) / 1e6);
}

int main_with(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  if (mode == "settle" && argc == 5) {
    auto sim = bed(lattice(std::stoul(argv[2])), silt::default_threads(), silt::Double{});
    sim.run(std::stod(argv[3]) * time_step);
    write(sim, argv[4]);
    return 0;
  }
  if (mode == "time" && (argc == 5 || (argc == 6 && argv[5] == std::string("mixed")))) {
    const double steps = std::stod(argv[3]);
    const int threads = std::stoi(argv[4]);
    if (argc == 6)
      time(argv[2], steps, threads, silt::Mixed{});
    else
      time(argv[2], steps, threads, silt::Double{});
    return 0;
  }
  std::fprintf(stderr,
               "bench_bed settle N STEPS FILE | bench_bed time FILE STEPS THREADS [mixed]\n");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return main_with(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
