// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/study/calibration_runs.hpp>

namespace silt::inline SILT_TARGET {

/// Options of a calibration.
struct CalibrationOptions {
  std::string folder = {};   // of its files, from which it continues; empty: none
  std::size_t design = 0;    // [-] initial points; 0: 4 for each parameter and 2
  std::size_t budget = 60;   // [-] total number of runs of the scene
  std::size_t repeats = 1;   // [-] runs per point, with different seeds
  std::uint64_t seed = 1;    // of everything random
  double least_gain = 0.01;  // [-] stop below this expected gain, relative to max(chi^2, 1)
  std::size_t patience = 5;  // [-] stop after as many proposals without such a gain; 0: never
  bool confirm = true;       // run the scene with the recommended values
  double credible = 0.95;    // [-] level of the intervals
  /// Called after each run made by this program.
  std::function<void(const CalibrationRun&)> watch = {};
};

namespace detail {

/// Refuses invalid settings.
inline void check_calibration(const CalibrationOptions& options,
                              const std::vector<CalibrationParameter>& parameters,
                              const std::vector<CalibrationTarget>& targets) {
  require(!parameters.empty(), "Calibration: there are no parameters to find");
  require(!targets.empty(), "Calibration: there are no targets to reach");
  std::vector<std::string> names;
  for (const auto& p : parameters) {
    require(std::isfinite(p.least) && std::isfinite(p.most) && p.least < p.most,
            "Calibration: parameter '", p.name, "' has bounds ", p.least, " and ", p.most,
            "; the first must be smaller");
    require(!p.logarithmic || p.least > 0, "Calibration: parameter '", p.name,
            "' is logarithmic, hence its bound least = ", p.least, " must be above 0");
    names.push_back(p.name);
  }
  for (const auto& t : targets) {
    require(std::isfinite(t.measured), "Calibration: target '", t.name,
            "': measured = ", t.measured, " must be finite");
    require(std::isfinite(t.error) && t.error > 0, "Calibration: target '", t.name,
            "': error = ", t.error,
            ", the standard deviation of what was measured, must be "
            "finite and greater than 0");
    names.push_back(t.name);
  }
  for (const auto& name : names) {
    require(!name.empty() && name.find_first_of("\n\r") == name.npos,
            "Calibration: each parameter and target needs a name, in one line");
    require(std::count(names.begin(), names.end(), name) == 1,
            "Calibration: two parameters or targets are named '", name, "'");
  }
  require(options.repeats > 0, "CalibrationOptions.repeats = 0 [-] must be at least 1");
  require(options.design >= parameters.size() + 3, "CalibrationOptions.design = ", options.design,
          " [-] must be at least ", parameters.size() + 3, " for ", parameters.size(),
          " parameters");
  const std::size_t least = (options.design + (options.confirm ? 1 : 0)) * options.repeats;
  require(options.budget >= least, "CalibrationOptions.budget = ", options.budget,
          " [-] is less than the ", least, " runs of the design",
          options.confirm ? " and the confirmation" : "");
  require_in("CalibrationOptions.credible", options.credible, "-", 0.01, 0.9999);
  require_not_negative("CalibrationOptions.least_gain", options.least_gain, "-");
}

/// Settings that the runs depend on, as text: a folder with other settings is refused.
inline std::string calibration_settings(const CalibrationOptions& options,
                                        const std::vector<CalibrationParameter>& parameters,
                                        const std::vector<CalibrationTarget>& targets) {
  std::string out = text("runs of silt::Calibration, design ", options.design, ", repeats ",
                         options.repeats, ", seed ", options.seed, '\n');
  for (const auto& p : parameters)
    out += text("parameter ", p.name, ", from ", p.least, " to ", p.most,
                p.logarithmic ? ", logarithmic\n" : "\n");
  for (const auto& t : targets)
    out += text("target ", t.name, ", measured ", t.measured, ", error ", t.error, '\n');
  return out;
}

}  // namespace detail
}  // namespace silt
