// silt - BSD-3-Clause, see LICENSE
//
// Angular stones. Ballast of three forms, convex hulls of random points, falls onto the ground and
// forms a heap; the program prints its angle of repose.
//
// picture: draw polyhedra/particles.pvd --colour form --names round,flat,long --time 0.8 2.5 --view 20,15 --width 1200 -o polyhedra.png

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

/// Convex hull of random points in an ellipsoid with semi-axes `a`, `b`, `c` [m].
silt::Polyhedron stone(double a, double b, double c, silt::Random& random) {
  std::vector<silt::Vec3d> points;
  while (points.size() < 14) {
    const silt::Vec3d u{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (norm(u) > 0.8 && norm(u) < 1) points.push_back({a * u.x, b * u.y, c * u.z});
  }
  return silt::Polyhedron::from_points(points);
}

int main() {
  const silt::HertzMindlin::Material granite{
      .youngs_modulus = 5e7,  // [Pa], 1000 times softer than granite: a larger time step
      .poisson_ratio = 0.2,
      .restitution = 0.3,
      .friction = 0.6,
  };

  silt::Random random(1);
  silt::Particles<silt::Polyhedron> stones;
  const auto round = stones.add_form(stone(0.03, 0.03, 0.03, random));  // [m]
  const auto flat = stones.add_form(stone(0.035, 0.035, 0.02, random));
  const auto longish = stones.add_form(stone(0.04, 0.025, 0.025, random));

  silt::Simulation sim{std::move(stones), silt::Contacts<silt::HertzMindlin>{granite}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, granite);

  // 120 stones, 80 per second; radii are those of the bounding spheres.
  const auto size = silt::uniform(0.03, 0.04);
  sim.add_inlet(silt::CylinderRegion{{0, 0, 0.35}, {0, 0, 0.45}, 0.12},
                {.radius = size,
                 .density = 2600,
                 .rate = 80,
                 .velocity = {0, 0, -1},
                 .total = 120,
                 .form = round,
                 .recipe = {{.share = 0.3, .radius = size, .density = 2600, .form = flat},
                            {.share = 0.3, .radius = size, .density = 2600, .form = longish}}});
  sim.run(3.0, silt::vtk_series("polyhedra", silt::every(0.1)), silt::progress());

  // In a cone of height H and radius R the mean height is H/4, the mean distance from the axis R/2.
  silt::Vec3d centre = sim.centre_of_mass();
  double distance = 0;  // [m]
  for (std::size_t k = 0; k < sim.size(); ++k)
    distance += std::hypot(sim.position(k).x - centre.x, sim.position(k).y - centre.y);
  distance /= static_cast<double>(sim.size());
  const double angle = std::atan(4 * centre.z / (2 * distance)) * 180 / M_PI;
  std::printf("%zu stones, %.0f kg, angle of repose %.1f degrees\n", sim.size(), sim.total_mass(),
              angle);
  // Fails for stones that roll away like marbles, stand as a tower, or never come to rest.
  return angle > 15 && angle < 40 && sim.mean_speed() < 0.01 ? 0 : 1;
}
