// silt - BSD-3-Clause, see LICENSE
// A shape of one's own: a hollow sphere, which rolls down a slope more slowly than a solid one.

#include <cmath>
#include <cstdio>
#include <utility>

#include <silt/silt.hpp>

/// A thin shell: the volume of a sphere (the density is that of shell and void together), and the
/// inertia of a shell.
struct HollowSphere : silt::Sphere {
  static constexpr double inertia_factor() { return 2.0 / 3.0; }  // [-] I/(m r^2)
};
static_assert(silt::Shape<HollowSphere>);

/// The speed [m/s] after 0.1 s on a slope of 10 degrees.
template <class Shape>
double speed_down_a_slope() {
  const silt::LinearSpringFriction::Material rubber{
      .stiffness = 1e4, .restitution = 0.5, .friction = 0.8};
  const double slope = 10 * M_PI / 180, radius = 2e-3;
  silt::Particles<Shape> ball;
  ball.add({.position = {0, 0, radius}, .radius = radius, .density = 1000});
  silt::Simulation sim{std::move(ball), silt::Contacts<silt::LinearSpringFriction>{rubber}};
  sim.gravity = {9.81 * std::sin(slope), 0, -9.81 * std::cos(slope)};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  sim.run(0.1);
  return sim.velocity(0).x / sim.time();
}

int main() {
  const double g = 9.81 * std::sin(10 * M_PI / 180);
  const double hollow = speed_down_a_slope<HollowSphere>() / (g / (1 + 2.0 / 3));
  const double solid = speed_down_a_slope<silt::Sphere>() / (g / (1 + 2.0 / 5));
  std::printf("over g sin(a)/(1 + I/(m r^2)): hollow %.4f, solid %.4f\n", hollow, solid);
  // Catches an inertia that is not asked for: the hollow ball would be 19 % too fast.
  return std::abs(hollow - 1) < 0.01 && std::abs(solid - 1) < 0.01 ? 0 : 1;
}
