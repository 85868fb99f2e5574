// silt - BSD-3-Clause, see LICENSE
//
// bench_polyhedra_bed time BODIES WARMUP STEPS
//   goes on, on one thread, from the state of random polyhedra on a plane that Yade has written
//   (decks/yade_polyhedra.py); WARMUP steps untimed; prints one line of results, with what
//   `measure` prints of the end.
// bench_polyhedra_bed measure BODIES
//   bodies in BODIES, their contacts by silt's geometry and their mean height

#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <silt/boundary/wall.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/shape/dilated_moments.hpp>
#include <silt/simulation.hpp>

namespace {

constexpr double time_step = 2e-5;  // [s]

silt::Particles<silt::Polyhedron> read(const std::string& path) {
  silt::Particles<silt::Polyhedron> all;
  std::ifstream file(path);
  if (!file) throw silt::FileError("cannot read '" + path + "'");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::vector<double> v;
    for (double x; words >> x;) v.push_back(x);
    if (v.size() < 13 + 12) throw silt::FileError("'" + path + "': a line is too short: " + line);
    std::vector<silt::Vec3d> corners;
    for (std::size_t k = 13; k + 2 < v.size(); k += 3)
      corners.push_back({v[k], v[k + 1], v[k + 2]});
    const auto form = all.add_form(silt::Polyhedron::from_points(corners));
    all.add({.form = form,
             .position = {v[0], v[1], v[2]},
             .orientation = {v[3], v[4], v[5], v[6]},
             .density = 2600,
             .velocity = {v[7], v[8], v[9]},
             .angular_velocity = {v[10], v[11], v[12]}});
  }
  return all;
}

template <class Sim>
void measure(const Sim& sim) {
  double height = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    height += sim.position(k).z / static_cast<double>(sim.rows());
  std::printf("bodies %zu contacts %.6g height %.8g\n", sim.rows(),
              2.0 * static_cast<double>(sim.touching_pairs()) / static_cast<double>(sim.size()),
              height);
}

int run(const std::string& path, double warmup, double steps) {
  const silt::HertzMindlin::Material m{
      .youngs_modulus = 1e6, .poisson_ratio = 0.02, .restitution = 0.5, .friction = 0.68};
  silt::Simulation sim{read(path), silt::Contacts<silt::HertzMindlin>{m}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = time_step, sim.threads = 1;
  sim.guard.max_overlap = 1, sim.guard.max_time_step = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, m);
  sim.run(warmup * time_step);
  if (steps == 0) {
    measure(sim);
    return 0;
  }
  const auto start = std::chrono::steady_clock::now();
  sim.run(steps * time_step);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("seconds %.6g ", seconds);
  measure(sim);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string mode = argc > 2 ? argv[1] : "";
    if (mode == "time" && argc == 5) return run(argv[2], std::stod(argv[3]), std::stod(argv[4]));
    if (mode == "measure" && argc == 3) return run(argv[2], 0, 0);
    std::fprintf(stderr, "bench_polyhedra_bed time BODIES WARMUP STEPS | measure BODIES\n");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
  }
  return 2;
}
