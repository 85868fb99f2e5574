// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/core/random.hpp>
#include <silt/study/calibration_options.hpp>
#include <silt/study/calibration_results.hpp>
#include <silt/study/calibration_runs.hpp>
#include <silt/study/calibration_summary.hpp>
#include <silt/study/calibration_surrogate.hpp>
#include <silt/study/study_files.hpp>

namespace silt::inline SILT_TARGET {

/// Calibration: finds parameters of a scene that reproduce measurements.
///
///   silt::Calibration cal{{.folder = "out/drum"},
///                         {{.name = "restitution [-]", .least = 0.3, .most = 0.9},
///                          {.name = "friction [-]", .least = 0.1, .most = 0.8}},
///                         {{.name = "angle at 300 rpm [deg]", .measured = 43.25, .error = 1.5}}};
///   cal.run([](const std::vector<double>& p, std::uint64_t seed) {
///     return std::vector<double>{angle_of_drum(p[0], p[1], seed)};
///   });
///   cal.report();
///
/// The first runs are a maximin Latin hypercube. Then a Gaussian process is fitted to each target
/// (study/gaussian_process.hpp), and the scene is run where the expected improvement of chi^2, the
/// sum of ((output - measured)/error)^2 over all targets, is largest. The calibration stops when
/// this improvement is small, when proposals have not improved the result, or at the budget.
/// Recommended is the maximum of the posterior, with a uniform prior within the bounds and the
/// surrogates' uncertainty included; intervals come from a sample of the posterior.
///
/// A run that throws, or returns values that are not finite, is recorded as failed, and points near
/// it are proposed less often. Every run is written to calibration.csv before the next begins. A
/// program that was killed continues from there with the same proposals as without the interruption
/// (all follow from the rows and the seed). Runs are sequential.
///
/// Errors: InputError for invalid settings, a scene that returns another number of values, a folder
///         of another calibration, or too few successful runs; FileError.
/// Tests:  tests/study/calibrate.cpp, tests/study/calibrate_statistics.cpp.
class Calibration {
 public:
  /// Outputs in the order of the targets, as a function of the parameters and a seed for random
  /// parts.
  using Scene = std::function<std::vector<double>(const std::vector<double>&, std::uint64_t)>;

  Calibration(CalibrationOptions options, std::vector<CalibrationParameter> parameters,
              std::vector<CalibrationTarget> targets)
      : options_(std::move(options)),
        parameters_(std::move(parameters)),
        targets_(std::move(targets)) {
    if (options_.design == 0) options_.design = 4 * parameters_.size() + 2;
    detail::check_calibration(options_, parameters_, targets_);
  }

  const CalibrationResult& run(const Scene& scene) {
    require(scene != nullptr, "Calibration::run: there is no scene");
    detail::CalibrationJournal journal(
        options_.folder, parameters_, targets_,
        detail::calibration_settings(options_, parameters_, targets_));
    result_ = {}, points_.clear(), models_.clear(), searched_ = 0;
    scene_ = &scene, journal_ = &journal;
    Random random(options_.seed);
    for (const auto& u : detail::latin_hypercube(options_.design, parameters_.size(), random))
      run_point("design", u);
    while (true) {
      if (successes() < parameters_.size() + 3) {
        check_failures();
        run_point("filling", farthest_point());
        continue;
      }
      fit();
      const auto* next = recorded();
      if (next && next->kind != "confirmation") {
        run_point(next->kind, {});
        continue;
      }
      const auto proposal = propose();
      if (!proposal) break;
      run_point("proposal", *proposal);
    }
    const auto recommended = most_probable();
    if (options_.confirm) {
      run_point("confirmation", recommended);
      fit();
    }
    summarise(options_.confirm ? points_.back().u : recommended);
    return result_;
  }

  const CalibrationResult& result() const { return result_; }
  std::string table() const { return detail::calibration_table(result_); }

  /// Writes table.txt, calibration.json, posterior.csv and, if Python with matplotlib is available,
  /// calibration.png into the folder. Returns a sentence on the files written.
  std::string write() const {
    const auto& folder = options_.folder;
    require(!result_.runs.empty(), "Calibration::write: there is nothing to write before run()");
    require(!folder.empty(), "Calibration::write: CalibrationOptions.folder is empty");
    detail::write_whole(folder + "/table.txt", table());
    detail::write_whole(folder + "/calibration.json",
                        detail::calibration_json(result_, parameters_));
    detail::write_whole(folder + "/posterior.csv", detail::posterior_csv(result_));
    const auto script = detail::calibration_script();
    const bool drawn = detail::draw_study(folder, script, "calibration.png");
    return text(
        "Look at ", folder, ": ", drawn ? "calibration.png, " : "",
        "table.txt, calibration.csv, calibration.json, posterior.csv",
        drawn ? "." : text("; no picture: python3 ", script, " ", folder, " gives the reason."));
  }
  /// Prints the table and, if there is a folder, writes the files.
  void report() const {
    std::printf("%s", table().c_str());
    if (!options_.folder.empty()) std::printf("%s\n", write().c_str());
    std::printf("\n");
  }

 private:
  using Vector = Eigen::VectorXd;

  /// Runs of the scene with the same parameters.
  struct Point {
    std::string kind;
    Vector u;
    std::vector<std::size_t> runs = {};  // numbers of the successful ones
    std::size_t failures = 0;
    std::vector<double> means = {};                         // of the outputs
    double chi2 = std::numeric_limits<double>::infinity();  // of the means
  };

  /// The next recorded run of an earlier program; null if there is none.
  const CalibrationRun* recorded() const {
    const std::size_t number = result_.runs.size();
    return number < journal_->earlier().size() ? &journal_->earlier()[number] : nullptr;
  }

  void run_point(const std::string& kind, const Vector& u) {
    Point point{.kind = kind, .u = u};
    for (std::size_t repeat = 0; repeat < options_.repeats; ++repeat) {
      CalibrationRun run{.point = points_.size(), .repeat = repeat, .kind = kind};
      if (const auto* earlier = recorded()) {
        if (earlier->point != run.point || earlier->repeat != repeat)
          throw FileError(text("file '", options_.folder, "/calibration.csv', row ",
                               result_.runs.size(), " is of point ", earlier->point, ", repeat ",
                               earlier->repeat, " in place of point ", run.point, ", repeat ",
                               repeat, "; remove it and all rows after it"));
        run = *earlier;
        ++result_.earlier;
        point.kind = run.kind;
        point.u = shares(run.parameters);
      } else {
        for (std::size_t k = 0; k < parameters_.size(); ++k)
          run.parameters.push_back(parameters_[k].value(point.u[static_cast<Eigen::Index>(k)]));
        point.u = shares(run.parameters);  // the same bits as after reading
        make(run);
        journal_->add(result_.runs.size(), run);
        if (options_.watch) options_.watch(run);
      }
      if (run.failed())
        ++point.failures;
      else
        point.runs.push_back(result_.runs.size());
      result_.runs.push_back(std::move(run));
    }
    if (!point.runs.empty()) {
      point.means.assign(targets_.size(), 0);
      for (const auto n : point.runs)
        for (std::size_t t = 0; t < targets_.size(); ++t)
          point.means[t] += result_.runs[n].outputs[t] / static_cast<double>(point.runs.size());
      point.chi2 = chi2(point.means);
    }
    points_.push_back(std::move(point));
  }

  void make(CalibrationRun& run) const {
    const std::uint64_t seed =
        Random({options_.seed, 1000003 * (run.point + 1) + run.repeat}).bits() >> 1;
    const auto start = std::chrono::steady_clock::now();
    try {
      run.outputs = (*scene_)(run.parameters, seed);
    } catch (const std::exception& e) {
      run.failure = *e.what() ? e.what() : "an exception without words";
    }
    run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!run.failed()) {
      require(run.outputs.size() == targets_.size(), "Calibration: the scene returned ",
              run.outputs.size(), " values for ", targets_.size(),
              " targets; it must return one for each, in their order");
      for (std::size_t t = 0; t < targets_.size(); ++t)
        if (!std::isfinite(run.outputs[t]))
          run.failure = text(targets_[t].name, " = ", run.outputs[t], " is not finite");
    }
    for (char& c : run.failure)
      if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    if (run.failed())
      run.outputs.clear();
    else
      run.chi2 = chi2(run.outputs);
  }

  double chi2(const std::vector<double>& outputs) const {
    double sum = 0;
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      const double off = (outputs[t] - targets_[t].measured) / targets_[t].error;
      sum += off * off;
    }
    return sum;
  }
  Vector shares(const std::vector<double>& values) const {
    Vector u(static_cast<Eigen::Index>(values.size()));
    for (std::size_t k = 0; k < values.size(); ++k)
      u[static_cast<Eigen::Index>(k)] = parameters_[k].share(values[k]);
    return u;
  }
  std::size_t successes() const {
    return static_cast<std::size_t>(std::count_if(points_.begin(), points_.end(),
                                                  [](const Point& p) { return !p.runs.empty(); }));
  }

  void check_failures() const {
    std::string first;
    for (const auto& run : result_.runs)
      if (run.failed() && first.empty()) first = run.failure;
    require(successes() > 0, "Calibration: all ", result_.runs.size(),
            " runs of the design failed; the first: ", first);
    require(recorded() || result_.runs.size() + options_.repeats <= options_.budget,
            "Calibration: only ", successes(), " of ", points_.size(),
            " points have runs that succeed, too few for a surrogate, and the budget of ",
            options_.budget, " runs is spent; the first failure: ", first);
  }
  /// Of 200 random points, the one farthest from all previous points.
  Vector farthest_point() const {
    Random random = random_of(2);
    std::pair<double, Vector> best{-1, {}};
    for (int k = 0; k < 200; ++k) {
      Vector u(static_cast<Eigen::Index>(parameters_.size()));
      for (auto& x : u) x = random.uniform();
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& p : points_) nearest = std::min(nearest, (p.u - u).squaredNorm());
      if (nearest > best.first) best = {nearest, u};
    }
    return best.second;
  }
  /// Random numbers that depend on the seed and the number of points.
  Random random_of(std::uint64_t purpose) const {
    return Random(Random({options_.seed, purpose * 0x10000000 + points_.size()}).bits());
  }

  /// Fits the surrogates of all targets to all points so far. Lengths start from the previous ones;
  /// a global search is made whenever the number of points has grown by a quarter.
  void fit() {
    const auto n = static_cast<Eigen::Index>(successes());
    const auto d = static_cast<Eigen::Index>(parameters_.size());
    Eigen::MatrixXd at(n, d), all(static_cast<Eigen::Index>(points_.size()), d);
    Vector repeats(n), failed(all.rows());
    Eigen::Index row = 0, each = 0;
    for (const auto& p : points_) {
      all.row(each) = p.u;
      failed[each++] = static_cast<double>(p.failures) / static_cast<double>(options_.repeats);
      if (p.runs.empty()) continue;
      at.row(row) = p.u, repeats[row++] = static_cast<double>(p.runs.size());
    }
    const bool anew = models_.empty() || 4 * successes() >= 5 * searched_;
    if (anew) searched_ = successes();
    std::vector<GaussianProcess> now;
    std::vector<detail::Wanted> wanted;
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      GaussianProcessData data{at, Vector(n), repeats, 0};
      row = 0;
      for (const auto& p : points_) {
        if (p.runs.empty()) continue;
        data.means[row++] = p.means[t];
        for (const auto r : p.runs)
          data.scatter += std::pow(result_.runs[r].outputs[t] - p.means[t], 2);
      }
      now.emplace_back(data, anew ? nullptr : &models_[0].targets()[t].lengths());
      wanted.push_back({targets_[t].measured, targets_[t].error});
    }
    models_.clear();
    models_.emplace_back(std::move(now), wanted, detail::Failures(all, failed));
  }

  /// Points with the smallest misfit by the surrogates, and this misfit.
  std::pair<std::vector<Vector>, double> best_points() const {
    std::vector<std::pair<double, Vector>> all;
    for (const auto& p : points_)
      if (!p.runs.empty()) all.emplace_back(models_[0].chi2(p.u), p.u);
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Vector> out;
    for (std::size_t k = 0; k < std::min<std::size_t>(3, all.size()); ++k)
      out.push_back(all[k].second);
    return {out, all[0].first};
  }

  /// The next point to run; empty when it is time to stop.
  std::optional<Vector> propose() {
    // Significant gain over the best result so far.
    const auto counts = [&](double best) { return options_.least_gain * std::max(best, 1.0); };
    double best = std::numeric_limits<double>::infinity();
    std::size_t idle = 0;
    for (const auto& p : points_) {
      if (p.kind == "proposal") idle = best - p.chi2 > counts(best) ? 0 : idle + 1;
      best = std::min(best, p.chi2);
    }
    const std::size_t kept = options_.confirm ? options_.repeats : 0;
    if (result_.runs.size() + options_.repeats + kept > options_.budget) {
      result_.why = text("Stopped at the budget of ", options_.budget, " runs.");
      return {};
    }
    if (options_.patience > 0 && idle >= options_.patience) {
      result_.why = text("Stopped as ", idle, " proposals did not improve on the best point.");
      return {};
    }
    Random random = random_of(1);
    const auto [near, least] = best_points();
    const auto found = detail::largest_in_cube(
        [&, this, limit = least](const Vector& u) {
          return models_[0].expected_improvement(u, limit);
        },
        parameters_.size(), near, random, true);
    if (found.second < counts(least)) {
      result_.why =
          text("Stopped as chi^2 is expected to fall by no more than ",
               detail::three_digits(found.second), " from ", detail::three_digits(least), ".");
      return {};
    }
    return found.first;
  }

  Vector most_probable() const {
    Random random = random_of(3);
    return detail::largest_in_cube([&](const Vector& u) { return models_[0].log_posterior(u); },
                                   parameters_.size(), best_points().first, random, false)
        .first;
  }

  void summarise(const Vector& recommended) {
    Random random = random_of(4);
    auto near = best_points().first;
    near.push_back(recommended);
    for (const auto& p : points_)
      if (p.chi2 < result_.best_chi2 || result_.best.empty())
        if (!p.runs.empty())
          result_.best_chi2 = p.chi2, result_.best = result_.runs[p.runs[0]].parameters;
    result_.credible = options_.credible;
    detail::fill_parameters(result_, parameters_, models_[0], recommended, near, random);
    const auto& last = points_.back();
    for (std::size_t k = 0; options_.confirm && k < parameters_.size(); ++k)  // not rounded again
      result_.parameters[k].recommended = result_.runs.back().parameters[k];
    detail::fill_targets(result_, targets_, models_[0], recommended,
                         options_.confirm ? last.means : std::vector<double>{});
    detail::fill_surfaces(result_, parameters_, models_[0], recommended);
    detail::fill_notes(result_, parameters_, targets_);
  }

  CalibrationOptions options_;
  std::vector<CalibrationParameter> parameters_;
  std::vector<CalibrationTarget> targets_;
  CalibrationResult result_;
  std::vector<Point> points_;
  std::vector<detail::Surrogate> models_;  // none or one
  std::size_t searched_ = 0;               // points at the last global search of lengths
  const Scene* scene_ = nullptr;
  detail::CalibrationJournal* journal_ = nullptr;
};

}  // namespace silt
