// silt - BSD-3-Clause, see LICENSE
// A heap of mud that spreads until its yield stress holds it, of docs/sph.md.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include <silt/sph.hpp>

int main() {
  const double g = 9.81, density = 1600, yield = 60;  // [m/s2], [kg/m3], [Pa]
  silt::Sph mud{silt::Liquid{.density = density, .sound_speed = 15},
                {.spacing = 0.005,
                 .region = {{-0.5, 0, 0}, {0.5, 0, 0.15}},
                 .dimensions = 2,
                 .gravity = {0, 0, -g}},
                silt::HerschelBulkley{
                    .yield_stress = yield, .consistency = 8, .index = 1, .most_viscosity = 400}};
  mud.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}});
  mud.fill([](const silt::Vec3d& x) { return std::abs(x.x) < 0.1 && x.z < 0.1; });
  mud.run(1.0);

  double front = 0, fastest = 0;  // [m], [m/s]
  mud.for_each([&](std::uint32_t, const silt::Vec3d& x, const silt::Vec3d& v, double, double) {
    front = std::max(front, std::abs(x.x)), fastest = std::max(fastest, norm(v));
  });
  const double near = silt::liquid_level(mud, {0.04, 0, 0}),
               far = silt::liquid_level(mud, {0.16, 0, 0});
  // Mud that has come to rest bears its slope: rho g h dh/dx = -yield.
  const double held = density * g * (near * near - far * far) / (2 * 0.12);  // [Pa]
  std::printf("front at %.3f m, fastest %.4f m/s; levels %.4f and %.4f m: its slope takes %.0f Pa\n",
              front, fastest, near, far, held);
  return front < 0.3 && fastest < 0.03 && std::abs(held / yield - 1) < 0.25 ? 0 : 1;
}
