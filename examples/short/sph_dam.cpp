// silt - BSD-3-Clause, see LICENSE
//
// Dam break. A column of water (SPH, in two dimensions) collapses, runs along a tank and climbs the
// far wall. The program prints the speed of the front and the force on the wall.
//
// picture: draw sph_dam/water.pvd --colour velocity --time 0.12 0.24 0.4 0.8 --radius 0.003 --bounds -0.005,0.605,-0.005,0.4 --width 1200 -o sph_dam.png

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include <silt/sph.hpp>

int main() {
  const double g = 9.81, depth = 0.2, length = 0.6;  // [m/s2], [m] of the column, of the tank
  const double fastest = std::sqrt(4 * g * depth);   // [m/s] that the water may reach
  silt::Sph water{silt::Liquid{.density = 1000, .sound_speed = 10 * fastest},
                  {.spacing = 5e-3,
                   .region = {{-0.03, 0, -0.03}, {length + 0.03, 0, 0.8}},
                   .dimensions = 2,
                   .gravity = {0, 0, -g}},
                  silt::ArtificialViscosity{.alpha = 0.1}};  // for the impact
  water.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor"});
  water.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, {.name = "wall"});
  water.add_wall(silt::Plane{{length, 0, 0}, {-1, 0, 0}}, {.name = "far wall"});
  water.fill([=](const silt::Vec3d& x) { return x.x < depth && x.z < depth; });

  const auto front = [&] {  // [m]
    double most = 0;
    water.for_each([&](std::uint32_t, const silt::Vec3d& x, const silt::Vec3d&, double, double) {
      most = std::max(most, x.x);
    });
    return most;
  };

  silt::VtkSeries series("sph_dam", "water");
  double early = 0, late = 0, hardest = 0;  // [m] front at 0.12 and 0.2 s; [N/m] on the far wall
  for (int k = 1; k <= 40; ++k) {
    water.run(0.02);
    hardest = std::max(hardest, water.wall_load(2).first.x);
    if (k == 6) early = front();
    if (k == 10) late = front();
    const std::string file = "water_" + std::to_string(k) + ".vtp";
    water.write("sph_dam/" + file), series.add(water.time(), file);
  }

  const double speed = (late - early) / 0.08, wave = std::sqrt(g * depth);
  const double still = 1000 * g * depth * depth / 2;  // [N/m] of the column at rest on a wall
  std::printf("front %.2f m/s, %.2f times sqrt(g H); a dry bed has 2\n", speed, speed / wave);
  std::printf("far wall %.0f N/m, %.1f times the column at rest\n", hardest, hardest / still);
  // Fails for water that is too slow, or faster than any front on a dry bed, and for lost water.
  return speed > 1.2 * wave && speed < 2 * wave && hardest > 0.5 * still && water.left() == 0 ? 0
                                                                                              : 1;
}
