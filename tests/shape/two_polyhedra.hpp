// silt - BSD-3-Clause, see LICENSE
#pragma once

#include "bodies.hpp"

#include <silt/shape/narrow/volume_overlap.hpp>

/// A small engine of its own: free bodies by leapfrog and NO_SQUISH (T. F. Miller et al., J. Chem.
/// Phys. 116 (2002) 8649): symplectic and of second order, so that an energy that does not come
/// back is the contact's fault.

namespace shape_test {

using silt::PlacedPolyhedron;

struct Body {
  Polyhedron shape;
  double mass;
  Vec3d inertia;  // principal
  Vec3d position{0, 0, 0}, velocity{0, 0, 0};
  Quaternion turn;
  Vec3d spin{0, 0, 0};  // angular momentum in body axes
  Vec3d force{0, 0, 0}, torque{0, 0, 0};

  explicit Body(const Polyhedron& given, double density = 1) : shape(given), mass(0), inertia{} {
    const auto p = principal_shape(given);
    shape = p.parts[0], mass = density * p.volume, inertia = density * p.inertia;
  }
  PlacedPolyhedron placed() const { return {&shape, {position, turn}}; }
  double kinetic_energy() const {
    return 0.5 * mass * dot(velocity, velocity) +
           0.5 * (spin.x * spin.x / inertia.x + spin.y * spin.y / inertia.y +
                  spin.z * spin.z / inertia.z);
  }
  Vec3d rate() const {
    return rotate(turn, {spin.x / inertia.x, spin.y / inertia.y, spin.z / inertia.z});
  }
  void kick(double h) {
    velocity += (h / mass) * force;
    spin += h * rotate(conjugate(turn), torque);
  }
  void drift(double h) {
    position += h * velocity;
    turn_about(2, 0.5 * h), turn_about(1, 0.5 * h), turn_about(0, h);
    turn_about(1, 0.5 * h), turn_about(2, 0.5 * h);
  }

 private:
  void turn_about(int axis, double h) {
    const Vec3d e{axis == 0 ? 1.0 : 0, axis == 1 ? 1.0 : 0, axis == 2 ? 1.0 : 0};
    const double angle = h * dot(e, spin) / dot(e, inertia);
    turn = turn * rotation_about(e, angle);
    spin = rotate(rotation_about(e, -angle), spin);
  }
};

/// A law with a potential: force U'(overlap) = stiffness overlap^power, and a dashpot on its rate.
struct TestLaw {
  double stiffness, power, damping = 0;

  double energy(double overlap) const {
    return stiffness / (power + 1) * std::pow(overlap, power + 1);
  }
  double force(double overlap, double rate) const {
    return stiffness * std::pow(overlap, power) + damping * rate;
  }
};

/// Adds force and torque on i, `r_i` the point from i's centre; motion of i relative to its
/// partner.
inline Vec3d act(const silt::VolumeContact& c, const TestLaw& law, const Vec3d& velocity,
                 const Vec3d& rate) {
  const double closing = -c.gradient * (dot(c.normal, velocity) + c.couple * dot(c.normal, rate));
  return law.force(c.overlap, closing) * c.gradient * c.normal;
}

}  // namespace shape_test
