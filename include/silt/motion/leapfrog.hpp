// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/row4.hpp>
#include <silt/motion/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Leapfrog: velocities at half steps, positions identical to those of velocity Verlet.
///
///   v(t + dt/2) = v(t - dt/2) + (F/m + g) dt,   x(t + dt) = x(t) + v(t + dt/2) dt            (1)
///   u(t + dt/2) = u(t - dt/2) + (r T/I) dt for the spin velocity u = r w                     (2)
///
/// Second order, symplectic for position-dependent forces. The first kick has half the length of a
/// step. Default integrator. Observers get velocities at whole steps, as means of two half steps.
/// Source: W. C. Swope et al., J. Chem. Phys. 76 (1982) 637.
/// Units:  SI. Shapes: one particle per call; rows of four whose last entry is constant.
/// Errors: none.
/// Tests:  tests/physics/conservation.cpp.
/// Valid:  steps that resolve a contact; from dt c/m* = 2.4 on impacts gain energy
///         (motion/concept.hpp).
struct Leapfrog {
  static constexpr bool is_integrator = true;
  static constexpr std::size_t derivatives = 0;
  static constexpr double first_kick = 0.5, lag = 0.5;

  /// Kicks {v, 1/m} by {F, 0} [N] and {g, 0} [m/s2] during `time` [s]; fixed if 1/m = 0.
  template <class Row>
  static SILT_INLINE Row kick(const Row& velocity, const Row& force, double inv_m,
                              const Row& gravity, double time) {
    return velocity + force * Row::all(inv_m * time) + gravity * Row::all(inv_m > 0 ? time : 0);
  }
  /// Kicks {r w, 1/r} by {T/r, 0} [N]; `push` = time/(factor m), where I = factor m r^2.
  template <class Row>
  static SILT_INLINE Row spin(const Row& spin, const Row& twirl, double push) {
    return spin + twirl * Row::all(push);
  }
  /// The same by a couple {M, 0} [N m].
  template <class Row>
  static SILT_INLINE Row turn(const Row& spin, const Row& couple, double push, double inv_r) {
    return spin + couple * Row::all(push * inv_r);
  }
  /// Moves {x, r} by {v, 1/m}; time = {dt, dt, dt, 0} [s].
  template <class Row>
  static SILT_INLINE Row drift(const Row& position, const Row& velocity, const Row& time) {
    return position + velocity * time;
  }
};

/// Its positions are those of velocity Verlet.
using VelocityVerlet = Leapfrog;

/// Semi-implicit Euler: as Leapfrog, but velocities are taken as those of whole steps, and the
/// first kick has the length of a whole step; first order. Positions are those
/// of a leapfrog whose initial velocity is half a step off; energy errors have the same size.
/// Tests: tests/physics/integrators.cpp.
/// Source: as Leapfrog.
/// Valid:  as Leapfrog.
/// Units:  SI.
/// Errors: none.
struct SymplecticEuler : Leapfrog {
  static constexpr double first_kick = 1, lag = 0.5;
};

static_assert(Integrator<Leapfrog> && Integrator<SymplecticEuler>);

}  // namespace silt
