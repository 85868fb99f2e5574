// silt - BSD-3-Clause, see LICENSE
#pragma once

// The dam break's scene: a column of water in a channel, by SPH, in 2D or 3D.
//
//   dam_break::Scene s;
//   auto water = dam_break::make_water(s);
//   water.run(0.5);  // [s]
//   water.write("water.vtp");

#include <cmath>

#include <silt/sph.hpp>

namespace dam_break {

using silt::Vec3d;

struct Scene {
  static constexpr double a = 0.146;                 // [m] the column's width, half its height
  static constexpr double g = 9.81;                  // [m/s2]
  static constexpr double length = 8, height = 2.2;  // [-] of the channel, over a
  static constexpr double deep = 0.2;                // [-] of the second front, over a
  double spacing = 3.65;                             // [mm]
  double sound = 10;                                 // [-] speed of sound over sqrt(2 g 2 a)
  double alpha = 0.02;                               // [-] artificial viscosity
  double end = 4.9;                                  // [-] T
  bool three_dimensional = false;
  bool sticking = false;  // to the floor and the walls

  double unit() const { return std::sqrt(a / (2 * g)); }    // [s] of T
  double fall() const { return std::sqrt(2 * g * 2 * a); }  // [m/s] from the column's height
  double across() const { return 1e-3 * spacing; }          // [m]
  // [m] period of a channel in 3D: about a, a whole number of spacings.
  double breadth() const { return three_dimensional ? std::round(a / across()) * across() : 0; }
};

inline auto make_water(const Scene& s) {
  const double a = Scene::a, length = Scene::length * a, breadth = s.breadth();
  // The region ends behind the walls: a particle may penetrate them by a fraction of its spacing.
  const double more = 3 * s.across();
  silt::Sph water{silt::Liquid{.density = 1000, .sound_speed = s.sound * s.fall()},
                  {.spacing = s.across(),
                   .region = {{-more, 0, -more}, {length + more, breadth, Scene::height * a}},
                   .dimensions = s.three_dimensional ? 3 : 2,
                   .periodic = {false, s.three_dimensional, false},
                   .gravity = {0, 0, -Scene::g},
                   .slip = s.sticking ? silt::Slip::None : silt::Slip::Free},
                  silt::ArtificialViscosity{.alpha = s.alpha}};
  water.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor"});
  water.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, {.name = "wall"});
  water.add_wall(silt::Plane{{length, 0, 0}, {-1, 0, 0}}, {.name = "far wall"});
  water.fill([](const Vec3d& x) { return x.x < Scene::a && x.z < 2 * Scene::a; });
  return water;
}

}  // namespace dam_break
