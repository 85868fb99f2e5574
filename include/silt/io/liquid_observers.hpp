// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/io/observers.hpp>

/// Observers of the liquid of an Sph in a run: at points, and levels of its surface. liquid_at()
/// and liquid_level() do the same without a simulation. Each place takes one pass over the liquid.
/// Errors: InputError for points that are not finite, empty names, and no points.
/// Tests:  tests/sph/liquid_at.cpp.

namespace silt::inline SILT_TARGET {

/// A place where a liquid is measured.
struct LiquidProbe {
  std::string name;
  Vec3d place;  // [m]; of a level: any point on its line
};

namespace detail {

template <class Sim>
const auto& liquid_of(const Sim& sim) {
  static_assert(
      requires { liquid_at(sim.fluid(), Vec3d{}); },
      "liquid_probes and liquid_levels need a simulation with an Sph: give it one in "
      "addition to particles and contacts. For the flow of a CoupledFlow take flow_probes");
  return sim.fluid();
}
inline void check_liquid_probes(const char* what, const std::string& path,
                                const DynArray<LiquidProbe>& probes) {
  require(!probes.empty(), what, " '", path, "': there are no places");
  for (const auto& p : probes) {
    require(!p.name.empty(), what, " '", path, "': the name of the place ", p.place, " m is empty");
    require(is_finite(p.place), what, " '", path, "': the place of ", in_quotes(p.name), ", ",
            p.place, " [m], must be finite");
  }
}

}  // namespace detail

/// Writes velocity [m/s], pressure [Pa] with the weight of the liquid, and how much the place is
/// filled by liquid [-] at points, one row per time, to the table `path`; velocity and pressure are
/// 0 where that is below 0.01. For `silt curves`.
///
///   sim.run(1.0, silt::liquid_probes("p.csv", {{"wall", {0, 0.1, 0.02}}}, silt::every(0.01)));
inline auto liquid_probes(const std::string& path, DynArray<LiquidProbe> probes,
                          Schedule schedule) {
  detail::check_liquid_probes("liquid_probes", path, probes);
  DynArray<std::string> columns{"time [s]"};
  for (const auto& probe : probes)
    for (const char* what : {"velocity x [m/s]", "velocity y [m/s]", "velocity z [m/s]",
                             "pressure [Pa]", "filled [-]"})
      columns.push_back(probe.name + ' ' + what);
  return table(path, columns, schedule, [probes = std::move(probes)](const auto& sim) {
    DynArray<double> row{sim.time()};
    for (const auto& p : probes) {
      const auto at = liquid_at(detail::liquid_of(sim), p.place);
      row.insert(row.end(), {at.velocity.x, at.velocity.y, at.velocity.z, at.pressure, at.filled});
    }
    return row;
  });
}

/// Writes the level [m] of the free surface on lines along gravity through points, one row per
/// time, to the table `path`, as wave gauges do; see liquid_level(). Not a number where there is no
/// liquid.
///
///   sim.run(1.0, silt::liquid_levels("levels.csv", {{"left", {0.1, 0, 0}}}, silt::every(0.01)));
inline auto liquid_levels(const std::string& path, DynArray<LiquidProbe> gauges,
                          Schedule schedule) {
  detail::check_liquid_probes("liquid_levels", path, gauges);
  DynArray<std::string> columns{"time [s]"};
  for (const auto& gauge : gauges) columns.push_back(gauge.name + " level [m]");
  return table(path, columns, schedule, [gauges = std::move(gauges)](const auto& sim) {
    DynArray<double> row{sim.time()};
    for (const auto& g : gauges) row.push_back(liquid_level(detail::liquid_of(sim), g.place));
    return row;
  });
}

}  // namespace silt
