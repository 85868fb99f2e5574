// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>

#include <silt/breakage/breakage.hpp>
#include <silt/breakage/concept.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/io/scene_warnings.hpp>

namespace silt::inline SILT_TARGET {

/// Collects breakages under loads far above the strength. Filled by an observer with tell(events).
/// Breakages on request do not count.
class BrokenLoads {
 public:
  void add(const DynArray<BreakEvent>& broken) {
    for (const BreakEvent& one : broken) {
      if (one.cause == BreakCause::Asked) continue;
      ++counted_;
      if (!(one.load > WarningLimits::far_above_breaking * one.strength)) continue;
      if (far_above_++ == 0) first_ = one;
    }
  }
  /// Whether, of a sufficient number, half were far above.
  bool is_odd() const { return counted_ >= WarningLimits::few && 2 * far_above_ > counted_; }
  const BreakEvent& first() const { return first_; }  // of those far above

 private:
  std::uint64_t counted_ = 0, far_above_ = 0;  // [-]
  BreakEvent first_{};
};

namespace detail {

/// Units that may have been confused in a strength.
inline const char* units_of_strengths(bool force) {
  return force ? "; strengths are in N (1 mN is 0.001 N), diameters in m, and youngs_modulus in Pa "
                 "(1 GPa is 1e9 Pa), that of the grains and not a softened one"
               : "; strengths are in J (1 mJ is 0.001 J), those of a mass in J/kg, diameters in m";
}
[[gnu::cold]] inline std::string far_above_words(const BrokenLoads& broken, bool force) {
  const BreakEvent& one = broken.first();
  const char* const unit = force ? " N" : " J";
  return text("Breakage: most grains that broke did so under more than ",
              about(WarningLimits::far_above_breaking), " times their strength, one ",
              about(one.diameter), " m across under ", about(one.load), unit, " against ",
              about(one.strength), unit, units_of_strengths(force),
              ", at_diameter too: 2 mm is 0.002 m");
}

}  // namespace detail

/// Warnings after a run with breakage. First: there were impacts, and all of them were far below
/// any strength, as with numbers in wrong units; the loads are those since the program started.
/// Second: particles broke under loads far above their strengths, as collected by `broken`.
/// Tests: tests/breakage/warnings.cpp.
template <class Sim>
[[gnu::cold]] DynArray<std::string> break_warnings(const Sim& sim, const BrokenLoads& broken = {}) {
  DynArray<std::string> out;
  if constexpr (Sim::has_breakage) {
    using Policy = std::remove_cvref_t<decltype(sim.breakage())>;
    const bool force = Policy::unit == LoadUnit::Force;
    if (broken.is_odd()) out.push_back(detail::far_above_words(broken, force));
    const LargestLoad& most = sim.largest_load();
    if (sim.broken() > 0 || most.weighed < WarningLimits::few ||
        most.share >= WarningLimits::far_from_breaking)
      return out;
    const char* const unit = force ? " N" : " J";
    out.push_back(text("Breakage: nothing broke, and of ", most.weighed, " loads the largest was ",
                       detail::about(most.share), " of the strength, ", detail::about(most.load),
                       unit, " against ", detail::about(most.strength), unit, ", of a particle ",
                       detail::about(most.diameter), " m across",
                       most.speed > 0 ? text(" that was hit at ", detail::about(most.speed), " m/s")
                                      : std::string(),
                       detail::units_of_strengths(force)));
  }
  return out;
}

}  // namespace silt
