// silt - BSD-3-Clause, see LICENSE
#pragma once

#include "engine/support.hpp"

namespace engine_test {

/// Sums over all particles [kg m/s], [kg m2/s about the origin], [J].
struct Totals {
  Vec3d momentum{0, 0, 0}, angular{0, 0, 0};
  double energy = 0;
};
template <class Sim>
Totals totals(const Sim& sim) {
  Totals t;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d v = sim.velocity(k), w = sim.angular_velocity(k);
    const auto& mass = sim.forms()[sim.form(k)].mass;
    const double s = sim.scale(k), unit = sim.mass(k) / mass.volume * s * s;
    const silt::Quaternion axes = sim.orientation(k) * mass.axes;
    const Vec3d b = rotate(conjugate(axes), w);
    const Vec3d l{unit * mass.inertia.x * b.x, unit * mass.inertia.y * b.y,
                  unit * mass.inertia.z * b.z};
    t.momentum += sim.mass(k) * v;
    t.angular += sim.mass(k) * cross(sim.position(k), v) + rotate(axes, l);
    t.energy += 0.5 * sim.mass(k) * dot(v, v) + 0.5 * dot(l, b);
  }
  return t;
}

}  // namespace engine_test
