// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <silt/study/calibrate.hpp>

/// The calibrations of `./run calibrate NAME`: one file each, which registers itself.
namespace calibrate {

/// Options of a case.
struct Setting {
  bool quick;   // a smaller one of the same physics
  int threads;  // of a run
};

/// A scene as a function of parameters, and the measured values.
struct Case {
  std::vector<silt::CalibrationParameter> parameters;
  std::vector<silt::CalibrationTarget> targets;
  silt::Calibration::Scene scene;
  silt::CalibrationOptions options;  // budget, repeats
  std::vector<double> planted = {};  // where what was measured is silt's own; else empty
};

struct Entry {
  std::string name, about;
  std::function<Case(const Setting&)> make;
};
inline std::vector<Entry>& all() {
  static std::vector<Entry> entries;
  return entries;
}

/// const calibrate::Registered here{"heap", "what is found from what, in one line", make};
struct Registered {
  Registered(const std::string& name, const std::string& about,
             std::function<Case(const Setting&)> make) {
    all().push_back({name, about, std::move(make)});
  }
};

/// Sets the measured values of a case to the mean of the scene's outputs at the planted parameters
/// over `runs` runs, each with a random error of its own deviation: a calibration whose true answer
/// is known.
inline void plant(Case& c, std::vector<double> parameters, std::uint64_t seed, int runs) {
  silt::Random random(seed);
  for (int run = 0; run < runs; ++run) {
    const auto outputs = c.scene(parameters, random.bits());
    for (std::size_t t = 0; t < c.targets.size(); ++t)
      c.targets[t].measured += outputs.at(t) / runs;
  }
  for (auto& t : c.targets) t.measured += t.error * random.normal();
  c.planted = std::move(parameters);
}

}  // namespace calibrate
