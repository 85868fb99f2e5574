// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <optional>

#include <silt/core/error.hpp>
#include <silt/coupling/concept.hpp>
#include <silt/coupling/step_response.hpp>

/// Number of particle steps in a step of a two-way coupled fluid.
namespace silt::inline SILT_TARGET::detail {

/// Fluid steps that resolve contacts, relative to the limit of the particle steps, an eighth of a
/// contact: omega dt = 0.4 for a pair, about 1.1 for the fastest motion of a packing; 1.7 is
/// stable.
inline constexpr double held_share_of_contact = 1;  // [-]

inline void check_steps(const char* of, const std::optional<int>& steps, int most_steps) {
  require(!steps || *steps >= 1, of, ".steps = ", steps.value_or(0),
          " particle steps a fluid step must be at least 1, or left out");
  require(most_steps >= 1, of, ".most_steps = ", most_steps, " must be at least 1");
}

/// Number of particle steps in `longest` [s], at most `most_steps`.
inline int steps_in(double longest, const FluidPace& pace, int most_steps) {
  return static_cast<int>(std::clamp(longest / pace.step, 1.0, static_cast<double>(most_steps)));
}

/// For light or stiffly coupled particles in contact. The fluid force is constant over the fluid
/// step and uses the contacts of the previous step. A step of up to `longest` [s] must therefore
/// either keep the fluid's response small or resolve the contacts.
inline double longest_held_step(const HeldAnswer& held, const FluidClock& clock, double longest,
                                const FluidPace& pace) {
  const double lag = held.in_contact, small = held.most_lag * clock.last_step;
  if (lag * longest > small)
    if (const auto limit = pace.contact_limit())
      return std::min(longest, std::max(small / lag, held_share_of_contact * *limit));
  return longest;
}

/// The same for a given number of steps: refuses a step of `span` [s] that was too long.
inline void check_held_step(const char* of, int steps, const HeldAnswer& held, double span,
                            const FluidPace& pace, const char* or_else) {
  if (!(held.lag > held.most_lag && held.density_ratio < 1)) return;
  const auto limit = pace.contact_limit();
  if (!limit || span <= held_share_of_contact * *limit) return;
  throw Error(sentence(
      of, ".steps = ", steps, " particle steps a fluid step are too many for particles of ",
      held.density_ratio, " of the fluid's density: what it gives them is held for ", span,
      " s, longer than an eighth of a contact, which makes contacts oscillate; set it to at "
      "most ",
      static_cast<int>(held_share_of_contact * *limit / pace.step), " or leave it out", or_else));
}

}  // namespace silt::detail
