// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// An integrator of translation and rotation: a policy of Simulation. Two kinds:
///
/// Of kicks and drifts (Leapfrog, SymplecticEuler), `derivatives` = 0: velocities are kicked over
/// the time between two steps, positions drift with them.
///   static constexpr double first_kick     [-] share of a step that the first kick is long: 1/2
///     where velocities belong to half steps
/// Of predictor and corrector (Gear), `derivatives` > 0: that many further derivatives of position
/// and of velocity of rotation are kept for each particle.
///
/// `lag` [steps]: by how much the velocities that contacts see are older than positions.
template <class I>
concept Integrator = requires {
  I::is_integrator;
  { I::derivatives } -> std::convertible_to<std::size_t>;
  { I::lag } -> std::convertible_to<double>;
};

}  // namespace silt
