// silt - BSD-3-Clause, see LICENSE
// The program of docs/shapes.md.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

namespace {

/// Writes a tetrahedron as an STL file, in place of a scanned stone.
void write_stone(const std::string& path) {
  const silt::Vec3d p[] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const int faces[][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  std::FILE* file = std::fopen(path.c_str(), "w");
  std::fprintf(file, "solid stone\n");
  for (const auto& f : faces) {
    std::fprintf(file, "facet normal 0 0 0\nouter loop\n");
    for (const int k : f)
      std::fprintf(file, "vertex %g %g %g\n", 2e-3 * p[k].x, 2e-3 * p[k].y, 2e-3 * p[k].z);
    std::fprintf(file, "endloop\nendfacet\n");
  }
  std::fprintf(file, "endsolid stone\n");
  std::fclose(file);
}

}  // namespace

int main() {
  write_stone("stone.stl");
  const silt::HertzMindlin::Material granite{
      .youngs_modulus = 5e7, .poisson_ratio = 0.25, .restitution = 0.4, .friction = 0.6};

  silt::Particles<silt::MultiSphere> stones;
  const auto rod = stones.add_form({.balls = {{{-1e-3, 0, 0}, 1e-3},  // [m] centre and radius
                                              {{1e-3, 0, 0}, 1e-3}}});
  const auto fit =
      silt::fit_spheres(silt::TriangleMesh(silt::read_stl("stone.stl")), {.spheres = 20});
  const auto stone = stones.add_form(fit.form);
  std::printf("20 spheres: volume %+.1e, surface %.2g mm off, %.2g mm at most\n", fit.volume_error,
              1e3 * fit.surface_error, 1e3 * fit.largest_error);

  stones.fill(
      {.min = {0, 0, 0}, .max = {0.03, 0.03, 0.05}},
      {.radius = silt::uniform(1.8e-3, 2.2e-3), .density = 2600, .count = 150, .form = rod});
  stones.add({.form = stone,
              .position = {0.015, 0.015, 0.06},
              .orientation = silt::rotation_about({0, 0, 1}, 0.3),
              .density = 2600,
              .angular_velocity = {0, 20, 0}});

  silt::Simulation sim{std::move(stones), silt::Contacts<silt::HertzMindlin>{granite}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.03, 0.03, 0.1}), granite);
  sim.run(0.3, silt::vtk_series("out", silt::every(0.02)));

  const silt::Quaternion q = sim.orientation(sim.find(150));  // of the frame the stone was given in
  std::printf("the stone rests at z = %.2f mm, turned to (%.3f, %.3f, %.3f, %.3f)\n",
              1e3 * sim.position(sim.find(150)).z, q.w, q.x, q.y, q.z);

  // Fails if the spheres do not fill the stone (its volume), if the stone sinks into the floor or
  // hangs above the rods, if bodies fall through walls or each other (too low) or stay where they
  // were placed, and if rods never come to rest.
  double mean = 0, fastest = 0;
  bool inside = sim.size() == 151;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const silt::Vec3d x = sim.position(k);
    mean += x.z / static_cast<double>(sim.size());
    fastest = std::max(fastest, norm(sim.velocity(k)));
    inside &= std::min({x.x, x.y, x.z, 0.03 - x.x, 0.03 - x.y}) > 0.8e-3;
  }
  const double stone_z = sim.position(sim.find(150)).z;
  std::printf("mean height %.2f mm, fastest %.3f m/s\n", 1e3 * mean, fastest);
  if (std::abs(fit.volume_error) < 1e-3 && fit.surface_error < 0.3e-3 && inside && fastest < 0.1 &&
      mean > 0.9e-3 && mean < 3e-3 && stone_z > 1.1e-3 && stone_z < 15e-3)
    return 0;
  std::puts(
      "wrong: a fit of the stone's volume to 1e-3 and of its surface to 0.3 mm, all 151 bodies "
      "at rest inside the box, at a mean height of 0.9 to 3 mm, the stone among or on the rods");
  return 1;
}
