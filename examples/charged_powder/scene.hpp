// silt - BSD-3-Clause, see LICENSE
#pragma once

// The charged powder's scene: grains that charge on a plate of metal, which is shaken, and their
// closed forms.
//
//   powder::Scene s;
//   auto sim = powder::make_simulation(s);
//   sim.run(s.shaken + s.rest);
//   sim.gravity = {0, 0, s.g};  // the plate is turned over
//   sim.run(s.falling, silt::vtk_series("out", silt::every(0.01)));

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <silt/silt.hpp>

namespace powder {

using silt::Charge, silt::TriboCharge, silt::ElectricCharge, silt::Vec3d;
using Law = silt::HertzMindlin;

struct Scene {
  std::size_t particles = 500;
  double r_min = 40e-6, r_max = 110e-6;  // [m]
  double shaken = 3;                     // [s]
  double frequency = 300, speed = 0.06;  // [Hz], [m/s] the largest of the plate
  double voltage = 0.4;                  // [V] difference of work functions over e
  double area_factor = 1;                // [-]
  double friction = 0.4;                 // [-]
  static constexpr double density = 1500, g = 9.81, delta = 5e-7;  // [kg/m3], [m/s2], [m]
  static constexpr double rest = 0.2, falling = 0.05;              // [s] after shaking

  double side() const {  // [m] of the plate: grains cover a third of it
    const double squares = (std::pow(r_max, 3) - std::pow(r_min, 3)) / (3 * (r_max - r_min));
    return std::sqrt(static_cast<double>(particles) * std::numbers::pi * squares / 0.33);
  }
  Law::Material powder() const {
    return {.youngs_modulus = 3e5, .poisson_ratio = 0.3, .restitution = 0.7, .friction = friction};
  }
  Law::Material metal() const {
    return {.youngs_modulus = 2e7, .poisson_ratio = 0.3, .restitution = 0.7, .friction = friction};
  }
  /// For a grain on the plate: the charge at which transfer stops [C]; the fractions of it whose
  /// image force equals the weight.
  double saturation(double radius) const {
    return 2 * std::numbers::pi * Charge::eps0 * radius * radius * voltage / delta;
  }
  double image_over_weight(double radius, double charge) const {
    const double weight = density * silt::Sphere::volume(radius) * g;
    return charge * charge / (16 * std::numbers::pi * Charge::eps0 * radius * radius) / weight;
  }
  /// Distance [m] at which the image force of a grain with this fraction of its saturation charge
  /// equals its weight.
  double radius_at_limit(double share) const {
    return 3 * Charge::eps0 * std::pow(voltage * share / delta, 2) / (16 * density * g);
  }
  double early() const { return 0.15 * shaken; }  // [s] when a picture is taken
  /// Effect of n impacts that press a grain into the plate by `overlap` [m]: 1/n0 of the
  /// exponential.
  double charging(double radius, double approach) const {
    const Law::Material a = powder(), b = metal();
    const double overlap =
        silt::hertz_max_overlap({silt::effective_modulus(a.youngs_modulus, a.poisson_ratio,
                                                         b.youngs_modulus, b.poisson_ratio),
                                 radius, density * silt::Sphere::volume(radius), approach,
                                 silt::damping_ratio(a.restitution, silt::DampingEnd::ZeroForce)});
    return area_factor * overlap / (2 * radius);
  }
};

/// The grains over the plate, which is at rest in this frame: shaking is a force on them.
inline auto make_simulation(const Scene& s) {
  const double L = s.side();
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 0}, {L, L, 40 * s.r_max}}, {.radius = silt::uniform(s.r_min, s.r_max),
                                                  .density = s.density,
                                                  .count = s.particles,
                                                  .arrangement = silt::Arrangement::Lattice});
  silt::Contacts<Law, silt::SeveralMaterials> contacts{{s.powder(), s.metal()}};
  contacts.set_pair(s.powder(), s.metal(), {.restitution = 0.7, .friction = s.friction});
  const double rate = 2 * std::numbers::pi * s.frequency;  // [1/s]
  silt::Simulation sim{
      std::move(grains),
      contacts,
      silt::PeriodicBox{{{0, 0, 0}, {L, L, 1}}, {true, true, false}},
      silt::ContactEvents{},
      TriboCharge{Charge{.cutoff = 4 * s.r_max, .planes = {{{0, 0, 0}, {0, 0, 1}}}},
                  {.work_functions = {4.5 - s.voltage, 4.5},
                   .transfer_distance = s.delta,
                   .area_factor = s.area_factor}},
      silt::BodyForce{[s, rate](const silt::Seen& p) {
        const double a = p.time < s.shaken ? s.speed * rate * std::sin(rate * p.time) : 0;
        return Vec3d{0, 0, -p.mass * a};
      }}};
  sim.gravity = {0, 0, -s.g};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, s.metal(), {.name = "plate"});
  return sim;
}

}  // namespace powder
