// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include <silt/breakage/concept.hpp>
#include <silt/core/error.hpp>
#include <silt/io/scene_warnings.hpp>

namespace silt::inline SILT_TARGET {

/// What is odd after a run of grains that break: impacts, all of them far below any strength, as
/// with numbers in other units. It knows the loads since the program began.
/// Tests: tests/breakage/warnings.cpp.
template <class Sim>
[[gnu::cold]] std::vector<std::string> break_warnings(const Sim& sim) {
  std::vector<std::string> out;
  if constexpr (Sim::has_breakage) {
    using Policy = std::remove_cvref_t<decltype(sim.breakage())>;
    const LargestLoad& most = sim.largest_load();
    if (sim.broken() > 0 || most.weighed < WarningLimits::few ||
        most.share >= WarningLimits::far_from_breaking)
      return out;
    const bool force = Policy::unit == LoadUnit::Force;
    const char* const unit = force ? " N" : " J";
    out.push_back(text(
        "Breakage: nothing broke, and of ", most.weighed, " loads the largest was ",
        detail::about(most.share), " of the strength, ", detail::about(most.load), unit,
        " against ", detail::about(most.strength), unit, ", of a particle ",
        detail::about(most.diameter), " m across",
        most.speed > 0 ? text(" that was hit at ", detail::about(most.speed), " m/s")
                       : std::string(),
        force
            ? "; strengths are in N (1 mN is 0.001 N), diameters in m, and youngs_modulus in Pa (1 "
              "GPa is 1e9 Pa), that of the grains and not a softened one"
            : "; strengths are in J (1 mJ is 0.001 J), those of a mass in J/kg, diameters in m"));
  }
  return out;
}

}  // namespace silt
