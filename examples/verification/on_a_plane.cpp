// silt - BSD-3-Clause, see LICENSE
// A sphere on a plane: slopes with and without rolling resistance, and sliding that ends in
// rolling. References are closed forms of rigid bodies.

#include <algorithm>
#include <cmath>
#include <utility>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/io/observers.hpp>
#include <silt/simulation.hpp>

#include "verification/gallery.hpp"

namespace verification {
namespace on_a_plane_cases {

using silt::Vec3d;
using Rough = silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>;

constexpr double g = 9.81, radius = 1e-3, density = 2500;  // [m/s2], [m], [kg/m3]
constexpr double mu = 0.2, mu_r = 0.1;                     // [-]
constexpr silt::HertzMindlin::Material material{
    .youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = 0.5, .friction = mu};

/// [m] overlap at rest on the plane under the weight m a.
double depth(double a) {
  const double E = silt::effective_modulus(material.youngs_modulus, material.poisson_ratio,
                                           material.youngs_modulus, material.poisson_ratio);
  const double weight = density * silt::Sphere::volume(radius) * a;
  return std::pow(weight / silt::hertz_stiffness(E, radius), 2.0 / 3.0);
}

/// A sphere on the plane z = 0, with the overlap at rest.
auto on_plane(const Vec3d& gravity, double rolling_friction, double speed) {
  silt::Particles<silt::Sphere> one;
  one.add({.position = {0, 0, radius - depth(-gravity.z)},
           .radius = radius,
           .density = density,
           .velocity = {speed, 0, 0}});
  silt::Simulation sim{std::move(one), Rough{material, {.rolling_friction = rolling_friction}}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, material);
  sim.gravity = gravity;
  sim.threads = 1;
  sim.time_step = 5e-6;  // [s] 20 steps of a contact at 1 m/s
  return sim;
}

/// Acceleration down a slope over g cos, of rigid bodies: it rests, rolls or slides.
double rigid(double tangent, double rolling) {
  if (tangent <= rolling) return 0;
  const double rolls = 5.0 / 7 * (tangent - rolling);  // with the friction tangent - rolls
  return tangent - rolls <= mu ? rolls : tangent - mu;
}

}  // namespace on_a_plane_cases

void slopes(Gallery& gallery) {
  using namespace on_a_plane_cases;
  auto table = gallery.table("slopes", {"tangent of the slope [-]", "acceleration over g cos [-]",
                                        "with rolling resistance [-]", "rigid body [-]",
                                        "rigid body with rolling resistance [-]"});
  Worst free, resisted;
  for (double tangent = 0.05; tangent < 1.21; tangent += gallery.quick ? 0.15 : 0.05) {
    const double angle = std::atan(tangent);
    const Vec3d down{g * std::sin(angle), 0, -g * std::cos(angle)};
    double seen[2];
    for (int k = 0; k < 2; ++k) {
      const double rolling = k == 0 ? 0 : mu_r;
      auto sim = on_plane(down, rolling, 0);
      sim.run(0.1);  // the springs take up their load
      const double time = sim.time(), v = sim.velocity(0).x;
      sim.run(0.1);
      seen[k] = (sim.velocity(0).x - v) / (sim.time() - time) / -down.z;
      // The lever arm is R minus the overlap, which changes each of the terms by that fraction;
      // less than 1e-6 of the initial oscillation is left after 0.1 s.
      const double tolerance = tangent * depth(g) / radius + 1e-6;
      (k == 0 ? free : resisted).compare(seen[k], rigid(tangent, rolling), tolerance);
    }
    table.add_row({tangent, seen[0], seen[1], rigid(tangent, 0), rigid(tangent, mu_r)});
  }
  const char* const reason = "the lever arm of friction is R less the overlap";
  gallery.check("slope_acceleration", free, reason);
  gallery.check("slope_acceleration_with_rolling_resistance", resisted, reason);
}

void from_slip_to_roll(Gallery& gallery) {
  using namespace on_a_plane_cases;
  auto table = gallery.table("slip_to_roll", {"time [s]", "speed [m/s]", "R w [m/s]",
                                              "speed rigid [m/s]", "R w rigid [m/s]"});
  const double u0 = 0.1, rolls = 2 * u0 / (7 * mu * g);  // [m/s], [s]
  auto sim = on_plane({0, 0, -g}, 0, u0);
  Worst course, end;
  const double share = depth(g) / radius;
  sim.run(2 * rolls, silt::at(silt::every(rolls / 20), [&](const auto& s) {
            const double t = std::min(s.time(), rolls);
            const double v = s.velocity(0).x, w = s.angular_velocity(0).y * radius;
            const double exact_v = u0 - mu * g * t, exact_w = 2.5 * mu * g * t;
            // In the first three steps the tangential spring is loaded up to Coulomb's limit.
            const double late = 3 * mu * g * s.step_length();
            course.compare(v, exact_v, late + share * u0);
            course.compare(w, exact_w, 2.5 * late + 2 * share * u0);
            table.add_row({s.time(), v, w, exact_v, exact_w});
          }));
  end.compare_relative(sim.velocity(0).x, 5.0 / 7 * u0, share);
  gallery.check("slip_to_roll_course", course,
                "three steps until friction is at its limit; the lever arm is R less the overlap");
  gallery.check("slip_to_roll_five_sevenths", end, "the lever arm is R less the overlap");
}

}  // namespace verification
