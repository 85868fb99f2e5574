// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>

#include <silt/motion/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Gear's predictor-corrector of 5th order for translation (six values) and of 4th order for
/// rotation (five values of the angular velocity), as in DEMMAT.
///
///   q_k = x^(k) dt^k/k!: predicted by a Taylor series, corrected by c_k D, D = a dt^2/2 - q_2,
///   c = (3/16, 251/360, 1, 11/18, 1/6, 1/60)                                                  (1)
///   w: q_k = w^(k) dt^k/k!, D = w' dt - q_1, c = (251/720, 1, 11/12, 1/3, 1/24)               (2)
///
/// The order holds for smooth forces. Where contacts begin and end within a step it falls to that
/// of the other integrators, at twice the cost. It resolves dashpots only in short steps. With the
/// steps of Leapfrog, impacts of e = 0.1 rebound with 0.3 to 0.7, of 0.01 with up to 2.9, and a bed
/// of 300 spheres compacted itself by 9 %. The automatic time step and the guard's limit are
/// therefore shorter (damping_limit). Tangential springs grow by the present velocity times the
/// step, to first order. Choose it for comparison with other codes.
///
/// Source: C. W. Gear 1971; M. P. Allen, D. J. Tildesley, Computer Simulation of Liquids, appendix
///         E ((1): 3/16 for velocity-dependent forces too); R. Markauskas et al. 2011 (in DEM).
/// Valid:  new particles have no derivatives and start with the acceleration only. Not for laws
///         with a safeguard, which act within one step.
/// Units:  SI. Shapes: rows of four; the last entry is constant. Errors: none.
/// Tests:  tests/physics/integrators.cpp (order 5 in a linear spring), impact_steps.cpp.
struct Gear {
  static constexpr bool is_integrator = true;
  static constexpr std::size_t derivatives = 4;
  static constexpr double first_kick = 1, lag = 0;
  /// A dashpot alone is unstable from dt c/m = 0.17, a spring alone from dt omega = 0.79, both
  /// together from (dt omega/0.79)^2 + dt c/(0.17 m) = 1. The sums of a packing are up to four
  /// times those of a pair.
  static constexpr DampingLimit damping_limit{.normal = 0.08, .shear = 0.15};
  static double rate(double spring, double dashpot) {  // 1.25 just before
    return 1.25 * std::sqrt(spring * spring / (0.72 * 0.72) + dashpot / 0.16);
  }

  /// Corrects {x, r}, {v, 1/m} and q_2 ... q_5 by the acceleration [m/s2].
  template <class Row>
  static void correct(Row& position, Row& velocity, Row (&q)[4], const Row& acceleration,
                      double dt) {
    const Row D = acceleration * Row::all(0.5 * dt * dt) - q[0];
    position = position + D * Row::all(3.0 / 16);
    velocity = velocity + D * Row::all(251.0 / 360 / dt);
    q[0] = q[0] + D, q[1] = q[1] + D * Row::all(11.0 / 18);
    q[2] = q[2] + D * Row::all(1.0 / 6), q[3] = q[3] + D * Row::all(1.0 / 60);
  }
  /// Increment of {x, r} [m] in the next prediction.
  template <class Row>
  static Row displacement(const Row& velocity, const Row (&q)[4], const Row& time) {
    return velocity * time + (q[0] + q[1] + (q[2] + q[3]));
  }
  template <class Row>
  static void predict(Row& position, Row& velocity, Row (&q)[4], const Row& time, double dt) {
    position = position + displacement(velocity, q, time);
    velocity = velocity + (q[0] * Row::all(2) + q[1] * Row::all(3) +
                           (q[2] * Row::all(4) + q[3] * Row::all(5))) *
                              Row::all(1 / dt);
    q[0] = q[0] + q[1] * Row::all(3) + q[2] * Row::all(6) + q[3] * Row::all(10);
    q[1] = q[1] + q[2] * Row::all(4) + q[3] * Row::all(10);
    q[2] = q[2] + q[3] * Row::all(5);
  }
  /// Corrects {r w, 1/r} and q_1 ... q_4 by its rate [m/s2].
  template <class Row>
  static void correct_spin(Row& spin, Row (&q)[4], const Row& rate, double dt) {
    const Row D = rate * Row::all(dt) - q[0];
    spin = spin + D * Row::all(251.0 / 720);
    q[0] = q[0] + D, q[1] = q[1] + D * Row::all(11.0 / 12);
    q[2] = q[2] + D * Row::all(1.0 / 3), q[3] = q[3] + D * Row::all(1.0 / 24);
  }
  template <class Row>
  static void predict_spin(Row& spin, Row (&q)[4]) {
    spin = spin + (q[0] + q[1] + (q[2] + q[3]));
    q[0] = q[0] + q[1] * Row::all(2) + q[2] * Row::all(3) + q[3] * Row::all(4);
    q[1] = q[1] + q[2] * Row::all(3) + q[3] * Row::all(6);
    q[2] = q[2] + q[3] * Row::all(4);
  }
};

static_assert(Integrator<Gear>);

}  // namespace silt
