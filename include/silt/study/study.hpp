// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/study/clock.hpp>
#include <silt/study/study_files.hpp>
#include <silt/study/study_results.hpp>
#include <silt/study/study_run.hpp>
#include <silt/study/study_table.hpp>

namespace silt::inline SILT_TARGET {

/// Options of a study.
struct StudyOptions {
  std::size_t repeats = 5;       // [-] rounds; the cost is their median
  double least_time = 0.02;      // [s] smallest time per round: a short run is repeated
  std::size_t most_runs = 1000;  // [-] of a variant in a round
  StudyClock clock = processor_time();
  /// Called before each variant of each round (0, 1, ...), to show the progress of a long study.
  std::function<void(std::size_t round, const std::string& variant)> watch = {};
};

/// Cost and error of variants of one scene.
///
///   silt::Study study{"restitution over the time step"};
///   study.accept("restitution", 0.01);
///   for (const double steps : {10, 20, 40})
///     study.variant(silt::text("t_c/", steps), [=](silt::StudyRun& run) {
///       auto sim = scene(steps);
///       run.time([&] { sim.run(0.1); });
///       run.error("restitution", restitution_of(sim) / 0.8 - 1);  // against a closed form
///     });
///   study.run();
///   study.report("out/restitution");
///
/// To compare with the same scene at higher resolution: `study.reference("t_c/1000", function)`
/// and, in the functions, `run.value("height", h, "m")`. Costs are measured in rounds over all
/// variants, alternately forwards and backwards, which distributes disturbances of the machine
/// evenly. A variant that throws an Error of silt is listed in the table with its message, and the
/// study continues.
///
/// Recommended is the cheapest variant within all bounds of `accept`; without bounds the knee of
/// the Pareto front of cost and first error (study/pareto.hpp).
///
/// Errors: InputError for an invalid study (no variants, two of one name, numbers that are missing
///         or have no reference); FileError if `write` fails.
/// Tests:  tests/study/study.cpp.
class Study {
 public:
  using Variant = std::function<void(StudyRun&)>;

  explicit Study(std::string name) { results_.name = std::move(name); }

  void variant(const std::string& name, Variant function) { add(name, std::move(function), false); }
  /// A variant for comparison that is never recommended, for example the same scene with a small
  /// disturbance, which shows the scatter of many-particle systems.
  void control(const std::string& name, Variant function) { add(name, std::move(function), true); }
  /// Reference for values; it is run once and may be expensive.
  void reference(const std::string& name, Variant function) {
    require(!reference_, which(), "it has a reference already, '",
            reference_ ? reference_->name : "", "'");
    require(function != nullptr, which(), "reference '", name, "' has no function");
    reference_ = Named{name, std::move(function), true};
  }
  /// Largest error of this name (as in the table) of a recommended variant.
  void accept(const std::string& error, double limit) {
    require_not_negative(which() + "accept(\"" + error + "\")", limit, "as the error");
    results_.bounds.push_back({error, limit});
  }

  const StudyResults& run(const StudyOptions& options = {}) {
    require(
        std::any_of(variants_.begin(), variants_.end(), [](const Named& v) { return !v.control; }),
        which(), "there are no variants");
    require(options.repeats > 0, which(), "StudyOptions.repeats = 0 [-] must be at least 1");
    require(options.most_runs > 0, which(), "StudyOptions.most_runs = 0 [-] must be at least 1");
    require_not_negative("StudyOptions.least_time", options.least_time, "s");
    results_.clock = options.clock.name, results_.rounds = options.repeats;
    results_.rows.clear(), results_.reference.reset();
    run_reference(options);
    for (const auto& v : variants_) results_.rows.push_back({.name = v.name, .control = v.control});
    for (std::size_t round = 0; round < options.repeats; ++round)
      for (std::size_t n = 0; n < variants_.size(); ++n) {
        const std::size_t k = round % 2 == 0 ? n : variants_.size() - 1 - n;
        if (results_.rows[k].failed()) continue;
        if (options.watch) options.watch(round, variants_[k].name);
        time_round(variants_[k], results_.rows[k], options);
      }
    check_bounds();
    results_.judge();
    return results_;
  }

  const StudyResults& results() const { return results_; }
  std::string table() const { return detail::study_table(results_); }

  /// Writes table.txt, table.csv, summary.json and, if Python with matplotlib is available,
  /// pareto.png into `folder`; each file is complete or absent. Returns a sentence on the files
  /// written.
  std::string write(const std::string& folder) const {
    require(!results_.rows.empty(), which(), "there is nothing to write before run()");
    make_folder(folder);
    detail::write_whole(folder + "/table.txt", table());
    detail::write_whole(folder + "/table.csv", detail::study_csv(results_));
    detail::write_whole(folder + "/summary.json", detail::study_json(results_));
    std::string files = text("Look at ", folder, ": ");
    if (!results_.first()) return files + "table.csv, summary.json; nothing ran, so no picture.";
    if (detail::draw_study(folder)) return files + "pareto.png, table.csv, summary.json.";
    return files + text("table.csv, summary.json; no picture: python3 ", detail::study_script(),
                        " ", folder, " gives the reason.");
  }
  /// Prints the table and writes the files.
  void report(const std::string& folder) const {
    std::printf("%s", table().c_str());
    const std::string files = write(folder);
    std::printf("%s\n\n", files.c_str());
  }

 private:
  struct Named {
    std::string name;
    Variant function;
    bool control = false;
  };

  void add(const std::string& name, Variant function, bool control) {
    require(!name.empty(), which(), "a variant has no name");
    require(std::none_of(variants_.begin(), variants_.end(),
                         [&](const Named& v) { return v.name == name; }),
            which(), "there are two variants named '", name, "'");
    require(function != nullptr, which(), "variant '", name, "' has no function");
    variants_.push_back({name, std::move(function), control});
  }

  std::string which() const { return text("study '", results_.name, "': "); }

  void run_reference(const StudyOptions& options) {
    if (!reference_) return;
    StudyRow row{.name = reference_->name, .control = true};
    values_.clear();
    StudyRun run(options.clock.now, true);
    try {
      reference_->function(run);
    } catch (const std::runtime_error& e) {
      throw InputError(text(which(), "its reference '", reference_->name, "' failed: ", e.what()));
    }
    values_ = run.values_;
    for (const auto& v : values_) {
      double largest = 0;
      for (const double x : v.numbers) {
        require(std::isfinite(x), which(), "'", v.name, "' of the reference is not finite");
        largest = std::max(largest, std::abs(x));
      }
      require(largest > 0, which(), "'", v.name,
              "' of the reference is 0 and there is no "
              "relative error; give the error itself by StudyRun::error");
    }
    take(run, row);
    row.runs = 1, row.costs = {run.timed_};
    results_.reference = std::move(row);
  }

  /// Runs a variant until its measured time is long enough.
  void time_round(const Named& variant, StudyRow& row, const StudyOptions& options) {
    double timed = 0;
    std::size_t runs = 0;
    do {
      StudyRun run(options.clock.now, row.runs == 0);
      try {
        variant.function(run);
      } catch (const std::runtime_error& e) {
        row.failure = e.what();
        return;
      }
      if (run.first_) take(run, row);
      if (row.failed()) return;
      timed += run.timed_;
      ++runs, ++row.runs;
    } while (timed < options.least_time && runs < options.most_runs);
    require(timed > 0, which(), "'", row.name, "' takes less time than '", options.clock.name,
            "' can measure; time more work in one run");
    row.costs.push_back(timed / static_cast<double>(runs));
  }

  /// Takes the results of the first run.
  void take(const StudyRun& run, StudyRow& row) {
    row.errors = run.errors_, row.notes = run.notes_;
    for (const auto& v : run.values_)
      row.errors.push_back({"error of " + v.name, relative_error(v, row.name), "-"});
    require(run.has_timed_, which(), "'", row.name,
            "' measures no time: put the costly part into StudyRun::time");
    require(!row.errors.empty(), which(), "'", row.name,
            "' reports no error: call StudyRun::error or StudyRun::value");
    check_names(row);
    for (const auto* numbers : {&row.errors, &row.notes})
      for (const auto& n : *numbers)
        if (!std::isfinite(n.value))
          row.failure = text("its ", n.name, " = ", n.value, " [", n.unit, "] is not finite");
    check_like_first(row);
  }

  double relative_error(const StudyRun::Value& v, const std::string& row) const {
    require(
        reference_.has_value(), which(), "the value '", v.name, "' of '", row,
        "' has nothing to compare with: give Study::reference, or the error by StudyRun::error");
    for (const auto& wanted : values_) {
      if (wanted.name != v.name) continue;
      require(wanted.numbers.size() == v.numbers.size(), which(), "'", v.name, "' is ",
              v.numbers.size(), " numbers in '", row, "' and ", wanted.numbers.size(),
              " in the reference");
      double difference = 0, size = 0;
      for (std::size_t k = 0; k < v.numbers.size(); ++k) {
        const double d = v.numbers[k] - wanted.numbers[k];
        difference += d * d, size += wanted.numbers[k] * wanted.numbers[k];
      }
      return std::sqrt(difference / size);
    }
    throw InputError(text(which(), "the reference '", reference_->name, "' has no value '", v.name,
                          "', which '", row, "' has"));
  }

  /// No two numbers of one name.
  void check_names(const StudyRow& row) const {
    std::vector<std::string> names;
    for (const auto* numbers : {&row.errors, &row.notes})
      for (const auto& n : *numbers) names.push_back(n.name);
    std::sort(names.begin(), names.end());
    const auto twice = std::adjacent_find(names.begin(), names.end());
    require(twice == names.end(), which(), "'", row.name, "' has two numbers named '",
            twice == names.end() ? "" : *twice, "'");
  }

  /// All variants must give the same errors in the same units.
  void check_like_first(const StudyRow& row) const {
    const auto* first = results_.first();
    if (!first || first == &row || first->errors.empty()) return;
    const bool alike = std::equal(
        row.errors.begin(), row.errors.end(), first->errors.begin(), first->errors.end(),
        [](const auto& a, const auto& b) { return a.name == b.name && a.unit == b.unit; });
    require(alike, which(), "'", row.name, "' gives other errors than '", first->name,
            "': they must have the same names and units, in the same order");
  }

  void check_bounds() const {
    const auto* first = results_.first();
    if (!first) return;
    for (const auto& b : results_.bounds) {
      std::string names;
      for (const auto& e : first->errors) names += text(names.empty() ? "" : ", ", e.name);
      require(first->error(b.error) != nullptr, which(), "accept() names the error '", b.error,
              "', but there is ", names);
    }
  }

  std::vector<Named> variants_;
  std::optional<Named> reference_;
  std::vector<StudyRun::Value> values_;  // of the reference
  StudyResults results_;
};

}  // namespace silt
