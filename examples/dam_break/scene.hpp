// silt - BSD-3-Clause, see LICENSE
#pragma once

// The dam break's scene: a column of water in a channel, by SPH, in 2D or 3D.
//
//   dam_break::Scene s;
//   auto water = dam_break::make_water(s);
//   water.run(0.5);  // [s]
//   water.write("water.vtp");

#include <cmath>
#include <numbers>

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

/// [Pa] in the column just after its gate has gone: the solution of Laplace's equation with 0 at
/// the top and at the free side, d p/dz = -rho g at the floor and d p/dx = 0 at the wall. With the
/// pressure of the column at rest instead, sound as strong as that pressure goes through the
/// liquid.
inline double start_pressure(const Vec3d& x, double density) {
  constexpr double a = Scene::a, H = 2 * a;
  double sum = H - x.z;
  for (int n = 0; n < 200; ++n) {
    const double k = (n + 0.5) * std::numbers::pi / H;
    sum -= 2 / (H * k * k) * std::cos(k * x.z) * std::exp(k * (x.x - a)) *
           (1 + std::exp(-2 * k * x.x)) / (1 + std::exp(-2 * k * a));  // cosh(k x)/cosh(k a)
  }
  return density * Scene::g * sum;
}

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
  water.fill([](const Vec3d& x) { return x.x < Scene::a && x.z < 2 * Scene::a; },
             [](const Vec3d&) {
               return Vec3d{0, 0, 0};
             },
             [&](const Vec3d& x) { return start_pressure(x, water.liquid().density); });
  return water;
}

}  // namespace dam_break
