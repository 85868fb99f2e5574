// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"

namespace sph_heave_test {

using namespace silt;

namespace {

constexpr double g = 9.81, half = 0.1;

/// What floats in a tank 1 m long and 0.4 m deep, in 2D, half in the liquid: a disc, or a box, 0.2
/// m wide. Let go 20 mm above its equilibrium, the surface flat.
template <class Bodies>
std::vector<double> heave(Bodies bodies, double start, double spacing) {
  const double L = 1, depth = 0.4;
  const bool box = bodies.size() == 1 && std::is_same_v<Bodies, Particles<Polyhedron>>;
  Sph water{Liquid{.density = 1000, .sound_speed = 10 * std::sqrt(g * depth)},
            {.spacing = spacing, .region = {{0, 0, 0}, {L, 0, 0.7}}, .dimensions = 2}};
  water.gravity = {0, 0, -g};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  water.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}});
  water.fill([&](const Vec3d& x) {
    const bool inside = box ? std::abs(x.x - L / 2) < half && x.z > start - half
                            : std::hypot(x.x - L / 2, x.z - start) < half;
    return x.z < depth && !inside;
  });
  Simulation sim{
      std::move(bodies),
      Contacts<HertzMindlin>{
          {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}},
      std::move(water)};
  sim.gravity = {0, 0, -g};
  sim.time_step = 1e-4;
  std::vector<double> z{1000 * (sim.position(0).z - depth)};
  for (int k = 1; k <= 18; ++k) sim.run(0.05), z.push_back(1000 * (sim.position(0).z - depth));
  CHECK(sim.fluid().displaced() == 0);
  CHECK(sim.fluid().left() == 0);
  return z;
}

/// Rms of z - rest - linear [mm].
double off(const std::vector<double>& z, double rest, const std::array<double, 19>& linear) {
  double sum = 0;
  for (std::size_t k = 0; k < linear.size(); ++k)
    sum += (z[k] - rest - linear[k]) * (z[k] - rest - linear[k]);
  return std::sqrt(sum / static_cast<double>(linear.size()));
}

}  // namespace

// Linear potential theory of the same tank (heave_linear.py), z [mm] every 0.05 s. The scene is
// not linear in all, as the disc's sides are not upright and the level is 5 % of the depth off.
// What the tests would catch: a body without added mass is back after 0.63 s; a kernel that makes
// the lattice stiff (smoothing = 1.0 in 2D: docs/sph_method.md) ends at -12.6 and 10.4 mm (disc),
// -12.1 and 12.7 mm (box).
TEST_CASE("SPH: a floating disc that is let go heaves as potential theory says") {
  const std::array<double, 19> linear{20,     18.15,  13,    5.61,  -2.54, -9.89, -15.14,
                                      -17.47, -16.69, -13.2, -7.85, -1.71, 4.10,  8.68,
                                      11.45,  12.21,  11.13, 8.67,  5.4};
  const double start = 0.425, pi = std::numbers::pi;
  Particles<Sphere> discs;  // in 2D a sphere is a cylinder of 1 m, by its mass
  discs.add({.position = {0.5, 0, start},
             .radius = half,
             .density = 500 * pi * half * half / (4 * pi / 3 * half * half * half)});
  const std::vector<double> z = heave(std::move(discs), start, 0.0125);
  CHECK(off(z, 5, linear) < 2.5);  // 1.9; 0.7 at half the spacing
  CHECK(z[7] - 5 == near(-17.47).epsilon(0.25));
  CHECK(z[15] - 5 == near(12.21).epsilon(0.10));
}

TEST_CASE("SPH: a floating box that is let go heaves as potential theory says") {
  const std::array<double, 19> linear{20,   18.69,  14.92,  9.23,   2.37,   -4.73, -11.13,
                                      -16,  -18.74, -19.04, -16.92, -12.71, -6.99, -0.55,
                                      5.81, 11.29,  15.25,  17.26,  17.14};
  const double start = 0.425;
  std::vector<Vec3d> corners;
  for (const double x : {-half, half})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-half, half}) corners.push_back({x, y, z});
  Particles<Polyhedron> boxes;
  const auto form = boxes.add_form(Polyhedron::from_points(corners));
  boxes.add({.form = form, .position = {0.5, 0, start}, .density = 500});
  const std::vector<double> z = heave(std::move(boxes), start, 0.0125);
  CHECK(off(z, 5, linear) < 2.5);  // 2.1; 1.6 at half the spacing
  CHECK(z[9] - 5 == near(-19.04).epsilon(0.25));
  // 14.4, at half the spacing 14.5: vortices leave the edges, which potential theory does not have.
  CHECK(z[17] - 5 == near(17.26).epsilon(0.20));
}

}  // namespace sph_heave_test
