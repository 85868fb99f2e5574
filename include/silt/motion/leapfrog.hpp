// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/vec3.hpp>
#include <silt/engine/rows.hpp>

namespace silt {

/// Leapfrog, which gives the positions of velocity Verlet: velocities live at half steps.
///
///   v(t + dt/2) = v(t - dt/2) + (F/m + g) dt,   x(t + dt) = x(t) + v(t + dt/2) dt            (1)
///   u(t + dt/2) = u(t - dt/2) + (r T/I) dt for the spin velocity u = r w                     (2)
///
/// Second order, symplectic for forces of position; the first kick is half a step long.
/// Source: W. C. Swope et al., J. Chem. Phys. 76 (1982) 637.
/// Units:  SI. Shapes: one particle a call. Errors: none.
/// Tests:  tests/physics/conservation.cpp.
struct Leapfrog {
  /// Kick by force [N], twirl [N] (torque over radius) and couple [N m] during `time` [s].
  template <class Motion>
  static void kick(Motion& m, const double* load, const Vec3d& gravity, double time) {
    const double push = m.inv_m * time, weight = m.inv_m > 0 ? time : 0;
    m.vx += load[0] * push + gravity.x * weight;
    m.vy += load[1] * push + gravity.y * weight;
    m.vz += load[2] * push + gravity.z * weight;
  }
  /// As above for a sphere that rotates: I = inertia_factor m r^2, so r T/I = twirl/(factor m).
  template <bool HasCouple>
  static void spin(MotionRow<true>& m, const double* load, double inertia_factor, double time) {
    const double push = m.inv_m * time / inertia_factor;
    const double* twirl = load + 4;
    m.wx += twirl[0] * push, m.wy += twirl[1] * push, m.wz += twirl[2] * push;
    if constexpr (HasCouple) {
      const double turn = push * m.inv_r;
      const double* couple = load + 8;
      m.wx += couple[0] * turn, m.wy += couple[1] * turn, m.wz += couple[2] * turn;
    }
  }
  template <class Motion>
  static void drift(PositionRow& p, const Motion& m, double time) {
    p.x += m.vx * time, p.y += m.vy * time, p.z += m.vz * time;
  }
};

}  // namespace silt
