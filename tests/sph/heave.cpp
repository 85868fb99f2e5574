// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"

namespace sph_heave_test {

using namespace silt;

namespace {

constexpr double g = 9.81;

/// z(t) - z at rest [m] of a box 0.2 m wide and high, of half the liquid's density, every 0.05 s
/// from t = 0 on; let go 20 mm above its equilibrium in a tank 1 m long, 0.4 m deep, whose surface
/// is flat at first.
std::vector<double> heave(double spacing, double raised, double end) {
  const double L = 1, depth = 0.4, rest = depth + 0.25 * raised, start = rest + raised;
  Sph water{
      Liquid{.density = 1000, .sound_speed = 10 * std::sqrt(g * depth)},
      {.spacing = spacing, .region = {{0, 0, 0}, {L, 0, 0.7}}, .smoothing = 1.0, .dimensions = 2}};
  water.gravity = {0, 0, -g};
  std::vector<Vec3d> corners;
  for (const double x : {-0.1, 0.1})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-0.1, 0.1}) corners.push_back({x, y, z});
  Particles<Polyhedron> boxes;
  const auto form = boxes.add_form(Polyhedron::from_points(corners));
  boxes.add({.form = form, .position = {L / 2, 0, start}, .density = 500});
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  water.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}});
  water.fill([&](const Vec3d& x) {
    return x.z < depth && !(std::abs(x.x - L / 2) < 0.1 && x.z > start - 0.1);
  });
  Simulation sim{
      std::move(boxes),
      Contacts<HertzMindlin>{
          {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}},
      std::move(water)};
  sim.gravity = {0, 0, -g};
  sim.time_step = 1e-4;
  std::vector<double> z{sim.position(0).z - rest};
  for (int k = 1; k * 0.05 < end + 1e-9; ++k) {
    sim.run(0.05);
    z.push_back(sim.position(0).z - rest);
  }
  CHECK(sim.fluid().displaced() == 0);
  CHECK(sim.fluid().left() == 0);
  return z;
}

}  // namespace

TEST_CASE("SPH: a floating box that is let go heaves at its period, too much damped") {
  // Linear potential theory of the same tank (heave_linear.py): a trough of -19.0 mm at 0.44 s, a
  // crest of 17.4 mm at 0.87 s. SPH has -12.1 mm and 12.7 mm at 0.84 s: docs/sph.md says what is
  // known of that. Here: the crest within 8 % of its time (a body without added mass would be there
  // at 0.63 s), and at least half of the amplitudes.
  const std::vector<double> z = heave(0.0125, 0.02, 0.95);
  CHECK(z[0] == near(0.02).epsilon(1e-9));
  const auto trough = std::min_element(z.begin(), z.begin() + 12) - z.begin();
  const auto crest = std::max_element(z.begin() + 12, z.end()) - z.begin();
  CHECK(z[static_cast<std::size_t>(trough)] < -0.010);
  CHECK(z[static_cast<std::size_t>(trough)] > -0.019);
  CHECK(z[static_cast<std::size_t>(crest)] > 0.010);
  CHECK(z[static_cast<std::size_t>(crest)] < 0.0174);
  // The parabola through the highest three.
  const auto c = static_cast<std::size_t>(crest);
  const double a = z[c - 1], b = z[c], d = z[c + 1];
  const double when = 0.05 * (static_cast<double>(c) + 0.5 * (a - d) / (a - 2 * b + d));
  CHECK(when == near(0.87).epsilon(0.08));
}

}  // namespace sph_heave_test
