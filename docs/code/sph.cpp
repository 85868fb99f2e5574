// silt - BSD-3-Clause, see LICENSE
// Water that runs along a tank and hits its far wall, of docs/sph.md.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include <silt/sph.hpp>

int main() {
  const double g = 9.81, depth = 0.2;               // [m/s2], [m]
  const double fastest = std::sqrt(4 * g * depth);  // [m/s] that the water may reach
  silt::Sph water{silt::Liquid{.density = 1000, .sound_speed = 10 * fastest},
                  {.spacing = 0.01,
                   .region = {{-0.03, 0, -0.03}, {0.63, 0, 0.8}},
                   .dimensions = 2,
                   .gravity = {0, 0, -g}},
                  silt::ArtificialViscosity{.alpha = 0.1}};  // for the impact
  water.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor"});
  water.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, {.name = "wall"});
  water.add_wall(silt::Plane{{0.6, 0, 0}, {-1, 0, 0}}, {.name = "far wall"});
  water.fill([=](const silt::Vec3d& x) { return x.x < 0.2 && x.z < depth; });

  silt::VtkSeries series("sph", "water");  // sph/water.pvd, for ParaView
  double most = 0;                         // [N/m] on the far wall
  for (int k = 1; k <= 30; ++k) {
    water.run(0.02);
    most = std::max(most, water.wall_load(2).first.x);
    const std::string file = "water_" + std::to_string(k) + ".vtp";
    water.write("sph/" + file), series.add(water.time(), file);
  }
  for (const auto& warning : water.warnings()) std::printf("warning: %s\n", warning.c_str());

  double front = 0;  // [m]
  water.for_each([&](std::uint32_t, const silt::Vec3d& x, const silt::Vec3d&, double, double) {
    front = std::max(front, x.x);
  });
  std::printf("%zu particles, %lld steps; front at %.2f m, most on the far wall %.0f N/m\n",
              water.size(), static_cast<long long>(water.steps()), front, most);
  // A column as high as the first one, at rest, would push with rho g depth^2/2.
  return front > 0.55 && most > 0.2 * 1000 * g * depth * depth / 2 && water.left() == 0 ? 0 : 1;
}
