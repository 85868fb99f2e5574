// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>

#include <silt/breakage/impact.hpp>
#include <silt/core/error.hpp>
#include <silt/core/target.hpp>

/// Contracts of the comminution functions. All are pure functions of one particle. Each has a
/// `check()` that throws InputError, naming field, value, unit and allowed range.
/// Source:  the split into strength, selection, equivalence, breakage and fatigue functions follows
///          Brosh, Kalman and Levy 2014, which gives no formulas; those of each are recalled.
/// Tests:   tests/breakage.
namespace silt::inline SILT_TARGET {

/// Load of an impact, in N or J by `unit`, to compare with a strength.
template <class T>
concept Equivalence = requires(const T& t, const Impact& impact) {
  { t.load(impact) } -> std::same_as<double>;
  { T::unit } -> std::convertible_to<LoadUnit>;
  t.check();
};

/// Strengths of particles of one size: the quantile at `rank` in (0, 1), and its inverse, the share
/// of particles weaker than `load`. A strength with a fixed unit has a `static constexpr LoadUnit
/// unit`.
template <class T>
concept Strength = requires(const T& t, double x) {
  { t.strength(x, x, x) } -> std::same_as<double>;  // diameter [m], mass [kg], rank [-]
  { t.weaker(x, x, x) } -> std::same_as<double>;    // load, diameter [m], mass [kg]
  t.check();
};

/// Fragment sizes: share of the parent's mass in fragments with diameters below x [m]. It is 0 at
/// 0, 1 from `largest` [m] on, and does not decrease; check_sizes (breakage/sizes.hpp) tests this.
template <class T>
concept BreakageFunction = requires(const T& t, double x, const Broken& parent) {
  { t.finer(x, parent) } -> std::same_as<double>;
  { t.largest(parent) } -> std::same_as<double>;
  t.check();
};

/// Remaining strength after a load below the strength, both in the same unit.
template <class T>
concept Fatigue = requires(const T& t, double x) {
  { t.weakened(x, x) } -> std::same_as<double>;  // strength, load < strength
  t.check();
};

/// Whether a strength has the unit of the loads of an equivalence.
template <Strength S, Equivalence E>
constexpr bool same_load_unit() {
  if constexpr (requires { S::unit; })
    return S::unit == E::unit;
  else
    return true;
}

}  // namespace silt
