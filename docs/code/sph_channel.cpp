// silt - BSD-3-Clause, see LICENSE
// A stream with a free surface, from an inlet to an outlet, of docs/sph.md.

#include <cmath>
#include <cstdio>

#include <silt/sph.hpp>

int main() {
  const double g = 9.81, depth = 0.1, length = 0.5;  // [m/s2], [m], [m]
  const double speed = 0.4 * std::sqrt(g * depth);   // [m/s] Froude number 0.4
  silt::Sph water{silt::Liquid{.density = 1000, .sound_speed = 15 * std::sqrt(g * depth)},
                  {.spacing = 0.01,
                   .region = {{0, 0, 0}, {length, 0, 2 * depth}},
                   .dimensions = 2,
                   .gravity = {0, 0, -g}},
                  silt::ArtificialViscosity{.alpha = 0.05},
                  silt::NoShifting{}};
  water.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "bed"});
  const silt::Vec3d height{0, 0, 2 * depth};
  water.add_inlet({.corner = {0, 0, 0}, .edge = height, .into = {1, 0, 0}},
                  {.name = "river", .velocity = {speed, 0, 0}, .surface = depth});
  water.add_outlet({.corner = {length, 0, 0}, .edge = height, .into = {-1, 0, 0}},
                   {.name = "lake", .pressure = silt::Hydrostatic{depth}});
  water.fill([=](const silt::Vec3d& x) { return x.z < depth; },
             [=](const silt::Vec3d&) {
               return silt::Vec3d{speed, 0, 0};
             },
             [=](const silt::Vec3d& x) { return 1000 * g * (depth - x.z); });
  water.run(0.5);

  const silt::OpeningBooks &river = water.opening_books(0), &lake = water.opening_books(1);
  const double level = water.mass() / (1000 * length);  // [m]
  std::printf("%.1f kg/m came, %.1f left; %.1f kg/(m s) come now; level %.3f m\n", river.in.mass,
              lake.out.mass, water.flow_rate(0), level);
  return std::abs(level - depth) < 0.02 * depth && river.in.particles > 180 ? 0 : 1;
}
