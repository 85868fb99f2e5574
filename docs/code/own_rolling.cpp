// silt - BSD-3-Clause, see LICENSE
// A user-defined model of rolling resistance: docs/contact_laws.md.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

// A couple against rolling and twisting, in proportion to their speed.
struct Greased {
  static constexpr bool is_rolling_model = true;
  struct Pair {
    double grease = 0;  // [N m s]
  };
  template <class Real>
  struct Coefficients {
    Real grease;
  };
  static Coefficients<double> mix(const Pair& p) { return {p.grease}; }
  template <class Real>
  static silt::Vec3<Real> torque(const silt::RollingContact<Real>& c,
                                 const Coefficients<Real>& p) {  // [N m] on i
    return -p.grease * (c.angular_velocity + c.twist * c.normal);
  }
};
static_assert(silt::RollingModel<Greased>);

int main() {
  const silt::HertzMindlin::Material smooth{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0};
  silt::Particles<silt::Sphere> ball;
  ball.add({.position = {0, 0, 0.9999e-3},
            .radius = 1e-3,
            .density = 1000,
            .angular_velocity = {10, 0, 5}});
  silt::Simulation sim{std::move(ball),
                       silt::Contacts<silt::HertzMindlin, Greased>{smooth, {.grease = 1e-10}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, smooth);
  sim.run(0.02);

  // Fails if the couple does not act, if one of its parts is left out, or if its sign is wrong.
  const double inertia = 0.4 * sim.mass(0) * 1e-6;  // [kg m2]
  const double left = std::exp(-1e-10 * sim.time() / inertia);
  const silt::Vec3d w = sim.angular_velocity(0);
  std::printf("rolls at %.4f rad/s, twists at %.4f rad/s; exp(-grease t/I): %.4f, %.4f\n", w.x, w.z,
              10 * left, 5 * left);
  return std::abs(w.x / left / 10 - 1) < 1e-3 && std::abs(w.z / left / 5 - 1) < 1e-3 ? 0 : 1;
}
