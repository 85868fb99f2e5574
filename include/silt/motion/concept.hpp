// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <limits>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Largest dt c/m* [-] of an impact, along the normal and for the slip.
struct DampingLimit {
  double normal;
  double shear = std::numeric_limits<double>::infinity();
};

/// Integrator of translation and rotation, a policy of Simulation. Two kinds:
///
/// Kick and drift (Leapfrog, SymplecticEuler), `derivatives` = 0: velocities are kicked over the
/// time between two steps, positions drift with them.
///   static constexpr double first_kick     [-] length of the first kick over the step: 1/2
///     if velocities belong to half steps
/// Predictor and corrector (Gear), `derivatives` > 0: the number of further derivatives of position
/// and of angular velocity that are kept for each particle.
///
/// Optional, with the values of Leapfrog as default: the limit dt c/m* of dashpots in a step, and
/// the measure of a rate:
///   static constexpr DampingLimit damping_limit   at the guard's limit of the time step
///   static double rate(double spring, double dashpot)   [-] limited by guard.max_rate, for a
///     particle whose contacts oscillate with the frequency spring/dt and decay with dashpot/dt
///
/// `lag` [steps]: age of the velocities of contacts relative to the positions.
template <class I>
concept Integrator = requires {
  I::is_integrator;
  { I::derivatives } -> std::convertible_to<std::size_t>;
  { I::lag } -> std::convertible_to<double>;
};

namespace detail {

/// Kick and drift schemes resolve dashpots up to dt c/m* = 1.25: an impact with e = 0.05 may
/// rebound with 0.1 there. From 2.4 on impacts gain energy.
template <class I>
inline constexpr DampingLimit damping_limit = [] {
  if constexpr (requires { I::damping_limit; })
    return DampingLimit{I::damping_limit};
  else
    return DampingLimit{1.25};
}();

/// Leapfrog becomes unstable at a rate of 2.
template <class I>
double rate_of(double spring, double dashpot) {
  if constexpr (requires { I::rate(spring, dashpot); })
    return I::rate(spring, dashpot);
  else
    return spring + dashpot / 2;
}

}  // namespace detail

}  // namespace silt
