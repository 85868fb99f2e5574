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

/// One run of a variant: what it times and tells. Errors and values are taken from the first run of
/// a variant (silt's results are the same bits from run to run); later ones are there for the
/// clock.
class StudyRun {
 public:
  /// Does `work` and adds the time it takes to the cost of this run.
  template <std::invocable Work>
  void time(Work&& work) {
    const double start = (*now_)();
    std::forward<Work>(work)();
    timed_ += (*now_)() - start;
    has_timed_ = true;
  }
  /// What is to be small, in absolute value: the deviation from a closed form, say.
  void error(const std::string& name, double value, const std::string& unit = "-") {
    if (first_) errors_.push_back({name, std::abs(value), unit});
  }
  /// The same from a function, which is called in the first run alone: for what takes long.
  template <std::invocable Measure>
  void error(const std::string& name, Measure&& measure, const std::string& unit = "-") {
    if (first_) error(name, static_cast<double>(std::forward<Measure>(measure)()), unit);
  }
  /// What is compared with the same of the reference: gives the error |value/reference - 1| under
  /// the name "error of <name>".
  void value(const std::string& name, double value, const std::string& unit = "-") {
    if (!first_) return;
    note(name, value, unit);
    values_.push_back({name, {value}});
  }
  /// The same for many numbers, a profile or the places of all particles: their root mean square
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
