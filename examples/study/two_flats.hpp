// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/boundary/plane.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/motion/leapfrog.hpp>
#include <silt/simulation.hpp>

/// The single particle of the time step and stiffness tests of a study of pneumatic conveying in
/// bends: a sphere of 4 mm between two flat walls of the same material, 5 mm apart, no gravity.
/// (Its table gives 4 mm as R_i; its printed time steps follow for a diameter of 4 mm.)
namespace studies::two_flats {

using Law = silt::BasicHertzMindlin<silt::DampingEnd::ZeroOverlap>;  // as that study

inline constexpr double radius = 2e-3, gap = 5e-3;     // [m]
inline constexpr double density = 1123;                // [kg/m3]
inline constexpr double poisson_ratio = 0.3;           // [-]
inline constexpr double free_path = gap - 2 * radius;  // [m]

inline double mass() { return density * silt::Sphere::volume(radius); }  // [kg]

inline Law::Material material(double shear_modulus, double restitution) {
  return {.youngs_modulus = silt::youngs_modulus(shear_modulus, poisson_ratio),
          .poisson_ratio = poisson_ratio,
          .restitution = restitution};
}
/// E* [Pa] of the sphere and a wall.
inline double modulus(double shear_modulus) {
  const double E = silt::youngs_modulus(shear_modulus, poisson_ratio);
  return silt::effective_modulus(E, poisson_ratio, E, poisson_ratio);
}
/// Contact time [s] of an elastic impact on a wall.
inline double contact_time(double shear_modulus, double speed) {
  return silt::hertz_contact_time(modulus(shear_modulus), radius, mass(), speed);
}

/// The sphere `shift` [m] above the middle between both walls, moving down.
template <class Integrator = silt::Leapfrog>
auto make(double shear_modulus, double restitution, double speed, double shift = 0) {
  silt::Particles<silt::Sphere> one;
  one.add({.position = {0, 0, gap / 2 + shift},
           .radius = radius,
           .density = density,
           .velocity = {0, 0, -speed}});
  const auto m = material(shear_modulus, restitution);
  silt::Simulation sim{std::move(one), silt::Contacts<Law>{m}, Integrator{}};
  sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, m);
  sim.add_wall(silt::Plane{{0, 0, gap}, {0, 0, -1}}, m);
  return sim;
}

/// The published formula, C sqrt(m/k) with k = 4/3 E* sqrt(R*) [s]: numerical, in SI units, as m/k
/// has the unit s2 m^1/2.
inline double time_step(double shear_modulus, double C) {
  return C * std::sqrt(mass() / silt::hertz_stiffness(modulus(shear_modulus), radius));
}

/// [s] until the sphere is in the middle again after so many collisions.
inline double duration(double shear_modulus, double speed, int collisions) {
  return collisions * (free_path / speed + contact_time(shear_modulus, speed));
}

/// Largest change [-] of the free sphere's speed in so many elastic collisions.
template <class Integrator = silt::Leapfrog>
double speed_error(double shear_modulus, double step, double speed, int collisions,
                   double shift = 0) {
  auto sim = make<Integrator>(shear_modulus, 1, speed, shift);
  sim.time_step = step;
  double worst = 0;
  sim.run(duration(shear_modulus, speed, collisions), [&](const auto& s) {
    const double from_middle = std::abs(s.position(0).z - gap / 2);
    if (from_middle < free_path / 2)  // touches no wall
      worst = std::max(worst, std::abs(std::abs(s.velocity(0).z) / speed - 1));
  });
  return worst;
}

}  // namespace studies::two_flats
