// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/breakage/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Selection function: probability [-] that a particle of this size, not weakened before, breaks in
/// this impact. It is not used to draw breakages: a particle breaks if the load reaches the
/// strength of its rank, and this is the share of such particles.
/// A log-logistic strength with the spread s and F = C d^2 v^1.2 give
///   S = 1 - 1/(1 + (v/v50)^(1.2 s)),  v50 = (F50/(C d^2))^(1/1.2).
/// Tests: tests/breakage/selection.cpp (this form; the share of drawn ranks).
template <Strength S, Equivalence E>
double selection(const S& strength, const E& equivalence, const Impact& impact) {
  static_assert(same_load_unit<S, E>(),
                "this strength is an energy and the equivalence gives a force, or vice "
                "versa: use an equivalence with the unit of the strength");
  return strength.weaker(equivalence.load(impact), impact.diameter, impact.mass);
}

}  // namespace silt
