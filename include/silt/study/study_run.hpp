// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <concepts>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <silt/core/target.hpp>
#include <silt/study/study_results.hpp>

namespace silt::inline SILT_TARGET {

/// One run of a variant: measures time and collects results. Errors and values are taken from the
/// first run of a variant (silt's results are equal bit for bit from run to run); later runs only
/// measure time.
class StudyRun {
 public:
  /// Executes `work` and adds its time to the cost of this run.
  template <std::invocable Work>
  void time(Work&& work) {
    const double start = (*now_)();
    std::forward<Work>(work)();
    timed_ += (*now_)() - start;
    has_timed_ = true;
  }
  /// An error, to be small in absolute value, e.g. the deviation from a closed form.
  void error(const std::string& name, double value, const std::string& unit = "-") {
    if (first_) errors_.push_back({name, std::abs(value), unit});
  }
  /// The same from a function that is called only in the first run, for expensive evaluations.
  template <std::invocable Measure>
  void error(const std::string& name, Measure&& measure, const std::string& unit = "-") {
    if (first_) error(name, static_cast<double>(std::forward<Measure>(measure)()), unit);
  }
  /// A value to compare with that of the reference: gives the error |value/reference - 1| with the
  /// name "error of <name>".
  void value(const std::string& name, double value, const std::string& unit = "-") {
    if (!first_) return;
    note(name, value, unit);
    values_.push_back({name, {value}});
  }
  /// The same for many numbers, such as a profile or all particle positions: root mean square
  /// difference over the root mean square of the reference.
  void value(const std::string& name, std::span<const double> values) {
    if (first_) values_.push_back({name, {values.begin(), values.end()}});
  }
  /// A number for the table that is not judged.
  void note(const std::string& name, double value, const std::string& unit = "-") {
    if (first_) notes_.push_back({name, value, unit});
  }

 private:
  friend class Study;
  struct Value {
    std::string name;
    std::vector<double> numbers;
  };
  StudyRun(const std::function<double()>& now, bool first) : now_(&now), first_(first) {}

  const std::function<double()>* now_;
  bool first_, has_timed_ = false;
  double timed_ = 0;  // [s]
  std::vector<StudyNumber> errors_, notes_;
  std::vector<Value> values_;
};

}  // namespace silt
