// silt - BSD-3-Clause, see LICENSE
//
// Sliding and rolling friction from a heap and two throws of one grain. A column of spheres
// collapses in a channel, periodic across, on a floor of glued spheres. The heap's angle and
// run-out depend on both frictions and cannot separate them. The distance that a grain rolls on a
// plane, and the distance that it slides before it rolls, can.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/silt.hpp>

#include "calibrate/cases.hpp"

namespace {

using silt::Vec3d;
using Contacts = silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>;

constexpr double radius = 4e-3, density = 2500;                    // [m], [kg/m3]
constexpr double length = 0.0528, width = 0.0264, channel = 0.24;  // [m] column, period, all
constexpr double apart = 2.2 * radius;                             // [m] of glued spheres

silt::HertzMindlin::Material material(double friction) {
  return {.youngs_modulus = 2e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = friction};
}

/// Angle [degrees] of the heap, and distance of its outermost tenth from the wall, over the
/// column's length [-].
std::vector<double> collapse(double friction, double rolling, std::size_t grains, int threads,
                             std::uint64_t seed) {
  silt::Random random(seed);
  silt::Particles<silt::Sphere> all;
  const double pitch = 2.1 * radius;
  const int nx = static_cast<int>(length / pitch), ny = static_cast<int>(width / pitch);
  double top = 0;
  for (std::size_t k = 0; k < grains; ++k) {
    const int n = static_cast<int>(k);
    const double z = 2.5 * radius + n / (nx * ny) * pitch;
    all.add({.position = {(n % nx + 0.5) * length / nx, (n / nx % ny + 0.5) * width / ny, z},
             .radius = radius,
             .density = density,
             .velocity = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0}});
    top = std::max(top, z + 3 * radius);
  }
  for (double x = apart / 2; x < channel; x += apart)
    for (double y = apart / 2; y < width; y += apart)
      all.add({.position = {x, y, 0}, .radius = radius, .density = density, .fixed = true});
  const Contacts contacts{material(friction), {.rolling_friction = rolling}};
  const silt::Box box{{0, 0, 0}, {channel, width, top}};
  silt::Simulation sim{std::move(all), contacts, silt::PeriodicBox{box, {false, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.threads = threads;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, material(friction));
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, material(friction));
  sim.add_wall(silt::Plane{{channel, 0, 0}, {-1, 0, 0}}, material(friction));
  const Vec3d from{length, -width, 0}, to{length, 2 * width, 0}, up{0, 0, top};
  sim.add_wall(silt::TriangleMesh({{from, to, to + up}, {from, to + up, from + up}}),
               material(friction));
  sim.run(0.3);
  sim.remove_wall(3);
  sim.run(0.8);
  std::vector<double> x;
  Vec3d sum{};
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (std::isfinite(sim.mass(k))) x.push_back(sim.position(k).x), sum += sim.position(k);
  std::sort(x.begin(), x.end(), std::greater<>());
  const auto n = static_cast<double>(x.size());
  const std::size_t outermost = x.size() / 10;
  double out = 0;
  for (std::size_t k = 0; k < outermost; ++k) out += x[k] / static_cast<double>(outermost);
  // The angle of a triangle with the heap's centre of mass, above the centres of the glued grains.
  return {std::atan((sum.z - radius * n) / sum.x) * 180 / std::numbers::pi, out / length};
}

/// Distance [mm] that one grain rolls on a plane within 4 s, from 0.3 m/s of pure rolling.
double rolled(double friction, double rolling) {
  silt::Particles<silt::Sphere> one;
  one.add({.position = {0, 0, radius},
           .radius = radius,
           .density = density,
           .velocity = {0.3, 0, 0},
           .angular_velocity = {0, 0.3 / radius, 0}});
  silt::Simulation sim{std::move(one), Contacts{material(friction), {.rolling_friction = rolling}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, material(friction));
  while (sim.time() < 4 && sim.velocity(0).x > 1e-3) sim.run(0.02);
  return 1e3 * sim.position(0).x;
}

/// Distance [mm] that one grain slides, thrown along a plane at 0.5 m/s without spin, until its
/// slip velocity is a hundredth of that: then it rolls.
double slid(double friction, double rolling) {
  silt::Particles<silt::Sphere> one;
  one.add(
      {.position = {0, 0, radius}, .radius = radius, .density = density, .velocity = {0.5, 0, 0}});
  silt::Simulation sim{std::move(one), Contacts{material(friction), {.rolling_friction = rolling}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, material(friction));
  while (sim.time() < 2 && sim.velocity(0).x - radius * sim.angular_velocity(0).y > 5e-3)
    sim.run(1e-3);
  return 1e3 * sim.position(0).x;
}

calibrate::Case make(const calibrate::Setting& setting) {
  const std::size_t grains = setting.quick ? 120 : 300;
  const int threads = setting.threads;
  calibrate::Case c{.parameters = {{.name = "friction [-]", .least = 0.1, .most = 0.9},
                                   {.name = "rolling friction [-]",
                                    .least = 0.01,
                                    .most = 0.4,
                                    .logarithmic = true}},
                    .targets = {{.name = "angle of the heap [deg]", .measured = 0, .error = 1},
                                {.name = "run-out over length [-]", .measured = 0, .error = 0.05},
                                {.name = "a grain rolls [mm]", .measured = 0, .error = 5},
                                {.name = "a grain slides [mm]", .measured = 0, .error = 3}},
                    .scene =
                        [=](const std::vector<double>& p, std::uint64_t seed) {
                          auto out = collapse(p[0], p[1], grains, threads, seed);
                          out.push_back(rolled(p[0], p[1]));
                          out.push_back(slid(p[0], p[1]));
                          return out;
                        },
                    .options = {.budget = setting.quick ? 63u : 120u, .repeats = 3}};
  calibrate::plant(c, {0.4, 0.1}, 1, 10);
  return c;
}

const calibrate::Registered here{
    "heap", "sliding and rolling friction from a heap and a grain that slides and rolls", make};

}  // namespace
