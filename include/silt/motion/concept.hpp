// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <limits>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// The largest dt c/m* [-] that an impact may have, along the normal and for the slip.
struct DampingLimit {
  double normal;
  double shear = std::numeric_limits<double>::infinity();
};

/// An integrator of translation and rotation: a policy of Simulation. Two kinds:
///
/// Of kicks and drifts (Leapfrog, SymplecticEuler), `derivatives` = 0: velocities are kicked over
/// the time between two steps, positions drift with them.
///   static constexpr double first_kick     [-] share of a step that the first kick is long: 1/2
///     where velocities belong to half steps
/// Of predictor and corrector (Gear), `derivatives` > 0: that many further derivatives of position
/// and of velocity of rotation are kept for each particle.
///
/// How strong dashpots may be over a step, dt c/m*, and what becomes of a rate; left out, they are
/// Leapfrog's:
///   static constexpr DampingLimit damping_limit   at the guard's limit of the time step
///   static double rate(double spring, double dashpot)   [-] that guard.max_rate limits, of a
///     particle whose contacts swing with the frequency spring/dt and damp with the rate dashpot/dt
///
/// `lag` [steps]: by how much the velocities that contacts see are older than positions.
template <class I>
concept Integrator = requires {
  I::is_integrator;
  { I::derivatives } -> std::convertible_to<std::size_t>;
  { I::lag } -> std::convertible_to<double>;
};

namespace detail {

/// Kicks and drifts follow dashpots up to dt c/m* = 1.25: an impact of e = 0.05 may leave with 0.1
/// there. From 2.4 on impacts gain energy.
template <class I>
inline constexpr DampingLimit damping_limit = [] {
  if constexpr (requires { I::damping_limit; })
    return DampingLimit{I::damping_limit};
  else
    return DampingLimit{1.25};
}();

/// Leapfrog breaks where the rate is 2.
template <class I>
double rate_of(double spring, double dashpot) {
  if constexpr (requires { I::rate(spring, dashpot); })
    return I::rate(spring, dashpot);
  else
    return spring + dashpot / 2;
}

}  // namespace detail

}  // namespace silt
