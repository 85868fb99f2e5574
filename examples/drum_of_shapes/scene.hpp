// silt - BSD-3-Clause, see LICENSE
#pragma once

// The drum's scene: grains of several shapes and equal volume in a drum that is periodic along its
// axis.
//
//   drum_of_shapes::Scene s;
//   const auto start = drum_of_shapes::not_yet();
//   auto sim = drum_of_shapes::make_simulation(s, start);
//   drum_of_shapes::fill(sim, s);
//   *start = sim.time();
//   sim.run(s.turns * s.turn(), silt::vtk_series("out", silt::every(0.1)));

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <silt/shape/mix.hpp>
#include <silt/silt.hpp>

namespace drum_of_shapes {

using Law = silt::HertzMindlin;
using Grains = silt::Mix<silt::Sphere, silt::SuperEllipsoid, silt::Polyhedron>;

struct Scene {
  std::size_t particles = 900;
  double radius = 0.05;   // [m] of the drum, which is periodic along its axis
  double length = 0.03;   // [m] of a period
  double grain = 2.2e-3;  // [m] radius of the sphere of a grain's volume
  double density = 2500;  // [kg/m3]
  double rpm = 20;        // [1/min]
  double turns = 2;       // [-] of which the last is measured
  std::string shapes = "mix";

  static constexpr std::size_t batch = 100;  // grains that are put in at a time
  static constexpr double between = 0.12;    // [s] for them to fall

  double turn() const { return 60 / rpm; }                     // [s]
  double rate() const { return rpm * std::numbers::pi / 30; }  // [rad/s]
  Law::Material material() const {
    return {.youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.5};
  }
};

/// Half sizes 1: a cube.
inline silt::Polyhedron cube() {
  std::vector<silt::Vec3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back({k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0});
  return silt::Polyhedron::from_points(corners);
}

/// Spheres, lens-shaped superellipsoids with a rim, cubes.
inline std::vector<Grains> forms() {
  return {silt::Sphere{}, silt::SuperEllipsoid{.a = 1, .b = 1, .c = 0.5, .s1 = 4, .s2 = 2}, cube()};
}
inline std::vector<std::size_t> kinds_of(const std::string& shapes) {
  if (shapes == "spheres") return {0};
  if (shapes == "super-ellipsoids") return {1};
  if (shapes == "cubes") return {2};
  return {0, 1, 2};
}

/// Up to `count` grains in the free upper half of the drum, of all kinds in turn.
inline silt::Particles<Grains> batch(const Scene& s, std::size_t count, std::uint64_t seed) {
  silt::Particles<Grains> grains;
  for (const auto& form : forms()) grains.add_form(form);
  const auto kinds = kinds_of(s.shapes);
  silt::Random random(seed);
  double reach = 0;  // [m] largest bounding radius
  const auto size_of = [&](std::size_t k) {
    const auto& form = grains.forms()[k];
    return form.radius * s.grain * std::cbrt(4.0 / 3 * std::numbers::pi / form.mass.volume);
  };
  for (const std::size_t k : kinds) reach = std::max(reach, size_of(k));
  const double pitch = 2.05 * reach, top = 0.6 * s.radius, side = 0.75 * s.radius;
  const auto cells = [&](double width) { return static_cast<int>(width / pitch); };
  for (int z = 0; z < cells(top); ++z)
    for (int y = 0; y < cells(s.length); ++y)
      for (int x = 0; x < cells(2 * side) && grains.size() < count; ++x) {
        const std::size_t kind = kinds[grains.size() % kinds.size()];
        grains.add({.form = kind,
                    .position = {-side + (x + 0.5) * pitch, (y + 0.5) * pitch, (z + 0.5) * pitch},
                    .orientation = silt::random_orientation(random),
                    .radius = size_of(kind),
                    .density = s.density,
                    .velocity = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), -0.3}});
      }
  return grains;
}

/// When the drum begins to rotate [s]: never, until it is set, as in *start = sim.time().
inline std::shared_ptr<double> not_yet() {
  return std::make_shared<double>(std::numeric_limits<double>::infinity());
}

/// The drum at rest, with the first grains; it rotates from `start` on.
inline auto make_simulation(const Scene& s, const std::shared_ptr<double>& start) {
  const silt::Box period{{-s.radius, 0, -s.radius}, {s.radius, s.length, s.radius}};
  silt::Simulation sim{batch(s, std::min(s.particles, Scene::batch), 1),
                       silt::Contacts<Law>{s.material()},
                       silt::PeriodicBox{period, {false, true, false}}, silt::ContactEvents{}};
  sim.gravity = {0, 0, -9.81};
  sim.guard.domain =
      silt::Box{{-s.radius, -s.length, -s.radius}, {s.radius, 2 * s.length, s.radius}};
  sim.add_wall(
      silt::Cylinder{{0, -s.length, 0}, {0, 2 * s.length, 0}, s.radius, silt::Side::Inside},
      s.material(), [turn = silt::rotation({0, 0, 0}, {0, 1, 0}, s.rate()), start](double time) {
        return turn(std::max(time - *start, 0.0));
      });
  return sim;
}

/// Puts in the other grains, batch by batch, and lets each fall.
template <class Sim>
void fill(Sim& sim, const Scene& s) {
  for (std::uint64_t seed = 2; sim.size() < s.particles; ++seed) {
    sim.run(Scene::between);
    sim.add(batch(s, std::min(s.particles - sim.size(), Scene::batch), seed));
  }
  sim.run(Scene::between);
}

}  // namespace drum_of_shapes
