// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include <silt/core/error.hpp>
#include <silt/engine/state/module_columns.hpp>
#include <silt/module/concept.hpp>

/// What fields of modules may be, and the errors of those that are not.
namespace silt::inline SILT_TARGET::detail {

template <class M>
bool all_finite(const FieldsOf<M>& own) {
  const auto* const numbers = reinterpret_cast<const double*>(&own);
  return std::all_of(numbers, numbers + numbers_of_fields<M>,
                     [](double x) { return std::isfinite(x); });
}
template <class M>
const char* words_of() {
  if constexpr (requires { std::string(M::allowed); }) return M::allowed;
  return "its module does not allow that (allows(), silt/module/concept.hpp)";
}
template <class M>
bool allows_fields(const M& module, const FieldsOf<M>& own) {
  if constexpr (requires { bool(module.allows(own)); }) return module.allows(own);
  return true;
}
template <class M, class Engine>
void check_given_fields([[maybe_unused]] const Engine& e, [[maybe_unused]] std::int64_t step,
                        [[maybe_unused]] double time) {
  if constexpr (has_fields<M> && !Updates<M> && !UpdatesByFlux<M>)
    for (std::size_t k = 0; k < e.owners(); ++k) {
      const auto& own = e.modules().template of<M>()[k];
      if (all_finite<M>(own) || !e.owner(k).is_there()) continue;
      const auto* const numbers = reinterpret_cast<const double*>(&own);
      std::size_t n = 0;
      while (std::isfinite(numbers[n])) ++n;
      const Seen p = e.seen(k, time);
      throw SimulationError(
          readable(
              "step ", step, ", t = ", time, " s: the field '",
              FieldNames<M>::at(n / FieldNames<M>::components), "' of particle ", p.id, " at ",
              p.position, " m is ", numbers[n],
              ", which must be finite; it began so, or an observer, or the program between two "
              "runs, has set it"),
          step, {p.id}, p.position);
    }
}
template <class M, class Engine>
void stop_at_field(const M& module, const Engine& e, std::int64_t step, double time,
                   std::size_t k) {
  if constexpr (Updates<M> || UpdatesByFlux<M>) {
    const auto& own = e.modules().template of<M>()[k];
    const auto* const numbers = reinterpret_cast<const double*>(&own);
    for (std::size_t n = 0; n < numbers_of_fields<M>; ++n) {
      if (std::isfinite(numbers[n])) continue;
      const Seen p = e.seen(k, time);
      std::string mend = "; mend its update()";
      if constexpr (UpdatesByFlux<M>)
        if (const double received = e.modules().template received_of<M>()[k];
            !std::isfinite(received))
          mend = text(", as it received ", received,
                      FlowsInPairs<M>
                          ? " from others; mend the module's flux(), pair_flux() or at_wall()"
                          : " from its contacts; mend the module's flux() or at_wall()");
      throw SimulationError(
          readable("step ", step, ", t = ", time, " s: the field '",
                   FieldNames<M>::at(n / FieldNames<M>::components), "' of the module ",
                   name_of_module<M>(), " became ", numbers[n], " for particle ", p.id, " at ",
                   p.position, " m", mend),
          step, {p.id}, p.position);
    }
    if (!allows_fields(module, own)) {
      const Seen p = e.seen(k, time);
      std::string values;
      for (std::size_t n = 0; n < numbers_of_fields<M>; ++n)
        values += sentence(n > 0 ? ", " : "", FieldNames<M>::at(n / FieldNames<M>::components),
                           " = ", numbers[n]);
      throw SimulationError(sentence("step ", step, ", t = ", time, " s: particle ", p.id, " at ",
                                     p.position, " m got ", values, "; ", words_of<M>()),
                            step, {p.id}, p.position);
    }
  }
}

}  // namespace silt::detail
