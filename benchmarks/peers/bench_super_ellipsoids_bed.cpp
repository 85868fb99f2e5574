// silt - BSD-3-Clause, see LICENSE
//
// Settled beds of 1 476 super-ellipsoids, as LIGGGHTS has its superquadrics in shapes.py, or of as
// many spheres; see there.
//   bench_super_ellipsoids_bed settle FORM FILE
//     lets a lattice collapse in a box for 30 000 steps; writes a checkpoint
//   bench_super_ellipsoids_bed time FORM FILE STEPS
//     goes on from FILE on one thread, 200 steps untimed; prints one line of results
// FORM: 2, 4, 8: super-ellipsoids of 2 x 2 x 4 mm with this exponent; ball: of 2.5 mm with equal
// axes and exponent 2; sphere: the same as silt::Sphere.

#include <chrono>
#include <cstdio>
#include <exception>
#include <string>

#include <silt/boundary/wall.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/shape/sphere.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/simulation.hpp>

namespace {

constexpr double time_step = 1e-5, density = 2500;  // [s], [kg/m3]

/// Particles on the lattice that LIGGGHTS makes; balls and spheres with a push aside, as their
/// columns would stand.
template <class Particles, class Add>
auto bed(Particles particles, bool pushed, const Add& add) {
  silt::Random random(1);
  for (int k = 0; k < 41; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i) {
        const silt::Vec3d place = 0.0085 * silt::Vec3d{i + 1.0, j + 1.0, k + 1.0};
        const auto push = [&] { return pushed ? random.uniform(-0.3, 0.3) : 0.0; };
        const silt::Vec3d velocity{push(), push(), 0};
        add(particles, place, velocity, random);
      }
  const silt::HertzMindlin::Material m{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.4};
  silt::Simulation sim{std::move(particles), silt::Contacts<silt::HertzMindlin>{m}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = time_step;
  sim.threads = 1;
  sim.guard.max_overlap = 1, sim.guard.max_time_step = 1;
  sim.add_wall(silt::box({0, 0, 0}, {0.06, 0.06, 0.5}), m);
  return sim;
}

auto super_ellipsoids(const std::string& name) {
  silt::Particles<silt::SuperEllipsoid> particles;
  const bool is_ball = name == "ball";
  if (is_ball) {
    particles.add_form({.a = 2.5e-3, .b = 2.5e-3, .c = 2.5e-3});
  } else {
    const double s = std::stod(name);
    particles.add_form({.a = 2e-3, .b = 2e-3, .c = 4e-3, .s1 = s, .s2 = s});
  }
  return bed(std::move(particles), is_ball,
             [](auto& all, const auto& place, const auto& velocity, auto& random) {
               all.add({.position = place,
                        .orientation = silt::random_orientation(random),
                        .density = density,
                        .velocity = velocity});
             });
}
auto spheres() {
  return bed(silt::Particles<silt::Sphere>{}, true,
             [](auto& all, const auto& place, const auto& velocity, auto&) {
               all.add({place, 2.5e-3, density, velocity});
             });
}

template <class Sim>
int run(Sim sim, const std::string& mode, const std::string& file, double steps) {
  if (mode == "settle") {
    sim.run(30000 * time_step);
    silt::save_checkpoint(sim, file);
    return 0;
  }
  silt::load_checkpoint(sim, file);
  sim.run(200 * time_step);
  const auto start = std::chrono::steady_clock::now();
  sim.run(steps * time_step);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("seconds %.6g contacts %.6g\n", seconds,
              2.0 * static_cast<double>(sim.touching_pairs()) / static_cast<double>(sim.size()));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string mode = argc > 1 ? argv[1] : "";
    if ((mode == "settle" && argc == 4) || (mode == "time" && argc == 5)) {
      const double steps = argc == 5 ? std::stod(argv[4]) : 0;
      const std::string form = argv[2];
      return form == "sphere" ? run(spheres(), mode, argv[3], steps)
                              : run(super_ellipsoids(form), mode, argv[3], steps);
    }
    std::fprintf(stderr,
                 "bench_super_ellipsoids_bed settle FORM FILE | time FORM FILE STEPS; "
                 "FORM: 2, 4, 8, ball, sphere\n");
    return 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
