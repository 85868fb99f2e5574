// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/study/calibration_runs.hpp>
#include <silt/study/study_files.hpp>
#include <silt/study/study_table.hpp>

namespace silt::inline SILT_TARGET {

/// Result of a calibration.
struct CalibrationResult {
  struct Parameter {
    std::string name;
    double recommended;        // the most probable value
    double low, median, high;  // shortest interval with the probability `credible`; median
    double weight;             // [-] total Sobol' index, mean of all targets, as a share of the sum
  };
  struct Target {
    std::string name;
    double measured, error;
    double predicted, deviation;       // by the surrogate at the recommended values; its
                                       // uncertainty
    double noise;                      // standard deviation of one run
    double confirmed;                  // mean of runs there; NaN without runs
    std::vector<double> first, total;  // [-] Sobol' indices, one per parameter
  };
  /// chi^2 by the surrogate over two parameters (or one: y is empty), others at recommended values.
  struct Surface {
    std::size_t first = 0, second = 0;              // numbers of the parameters
    std::vector<double> x = {}, y = {}, chi2 = {};  // chi2[i * y.size() + j]
  };
  std::vector<Parameter> parameters;
  std::vector<Target> targets;
  double credible = 0.95;    // [-]
  double chi2 = 0;           // [-] at the recommended values: confirmed, else by the surrogate
  double best_chi2 = 0;      // [-] smallest value of a point's mean outputs
  std::vector<double> best;  // its parameters
  std::vector<std::vector<double>> samples, correlation;  // of the posterior
  std::vector<Surface> surfaces;
  std::vector<CalibrationRun> runs;
  std::size_t earlier = 0;  // those of an earlier program
  std::string why;          // it stopped
  std::vector<std::string> notes;

  std::size_t failures() const {
    return static_cast<std::size_t>(
        std::count_if(runs.begin(), runs.end(), [](const auto& run) { return run.failed(); }));
  }
  std::vector<double> recommended() const {
    std::vector<double> out;
    for (const auto& p : parameters) out.push_back(p.recommended);
    return out;
  }
};

namespace detail {

inline std::string four_digits(double number) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", number);
  return std::isnan(number) ? "-" : buffer;
}

/// Readable table: values with intervals, targets with the present outputs, sensitivities.
inline std::string calibration_table(const CalibrationResult& r) {
  const std::string level = four_digits(100 * r.credible);
  std::vector<std::vector<std::string>> rows{
      {"parameter", "recommended", "median", level + " % from", "to", "weight"}};
  for (const auto& p : r.parameters)
    rows.push_back({p.name, four_digits(p.recommended), four_digits(p.median), four_digits(p.low),
                    four_digits(p.high), four_digits(std::round(100 * p.weight)) + " %"});
  std::string out = aligned(rows, 1) + '\n';
  rows = {{"target", "measured", "error", "surrogate", "+-", "run", "noise", "off [errors]"}};
  for (const auto& p : r.parameters) rows[0].push_back("S " + p.name.substr(0, p.name.find(" [")));
  for (const auto& t : r.targets) {
    const double now = std::isnan(t.confirmed) ? t.predicted : t.confirmed;
    rows.push_back({t.name, four_digits(t.measured), four_digits(t.error), four_digits(t.predicted),
                    three_digits(t.deviation), four_digits(t.confirmed), three_digits(t.noise),
                    three_digits((now - t.measured) / t.error)});
    for (std::size_t k = 0; k < t.total.size(); ++k)
      rows.back().push_back(three_digits(std::round(100 * t.first[k]) / 100) + " / " +
                            three_digits(std::round(100 * t.total[k]) / 100));
  }
  out += aligned(rows, 1);
  out += "S: Sobol' index of first order / total. chi^2 at the recommended values: " +
         three_digits(r.chi2) + " of " + text(r.targets.size(), " targets; smallest of a point: ") +
         three_digits(r.best_chi2) + ".\n";
  out += text(r.runs.size(), r.runs.size() == 1 ? " run" : " runs");
  if (r.earlier > 0) out += text(", ", r.earlier, " of them of an earlier program");
  out += ". " + r.why + '\n';
  for (const auto& note : r.notes) out += "Note: " + note + '\n';
  return out;
}

inline std::string json_number(double x) { return std::isfinite(x) ? text(x) : "null"; }
inline std::string json_list(const std::vector<double>& all) {
  return json_joined("[", "]", all, json_number);
}

inline std::string calibration_json(const CalibrationResult& r,
                                    const std::vector<CalibrationParameter>& given) {
  std::size_t k = 0;
  const auto words = [](const std::string& s) { return json_quoted(s); };
  std::string out = "{\n  \"parameters\": ";
  out += json_joined("[", "\n  ]", r.parameters, [&](const CalibrationResult::Parameter& p) {
    const auto& g = given[k++];
    return "\n    {\"name\": " + words(p.name) +
           text(", \"least\": ", g.least, ", \"most\": ", g.most,
                ", \"logarithmic\": ", g.logarithmic ? "true" : "false",
                ", \"recommended\": ", p.recommended, ", \"low\": ", p.low,
                ", \"median\": ", p.median, ", \"high\": ", p.high, ", \"weight\": ", p.weight,
                "}");
  });
  out += ",\n  \"targets\": ";
  out += json_joined("[", "\n  ]", r.targets, [&](const CalibrationResult::Target& t) {
    return "\n    {\"name\": " + words(t.name) +
           text(", \"measured\": ", t.measured, ", \"error\": ", t.error,
                ", \"predicted\": ", t.predicted, ", \"deviation\": ", t.deviation,
                ", \"noise\": ", t.noise) +
           ", \"confirmed\": " + json_number(t.confirmed) + ", \"first\": " + json_list(t.first) +
           ", \"total\": " + json_list(t.total) + "}";
  });
  out += text(",\n  \"credible\": ", r.credible, ",\n  \"chi2\": ", r.chi2,
              ",\n  \"best_chi2\": ", r.best_chi2) +
         ",\n  \"best\": " + json_list(r.best) +
         ",\n  \"correlation\": " + json_joined("[", "]", r.correlation, json_list) +
         text(",\n  \"runs\": ", r.runs.size(), ",\n  \"failures\": ", r.failures()) +
         ",\n  \"why\": " + words(r.why) +
         ",\n  \"notes\": " + json_joined("[", "]", r.notes, words);
  out += ",\n  \"surfaces\": ";
  out += json_joined("[", "\n  ]", r.surfaces, [](const CalibrationResult::Surface& s) {
    return text("\n    {\"first\": ", s.first, ", \"second\": ", s.second) +
           ", \"x\": " + json_list(s.x) + ", \"y\": " + json_list(s.y) +
           ", \"chi2\": " + json_list(s.chi2) + "}";
  });
  return out + "\n}\n";
}

/// Sample of the posterior, one point per row.
inline std::string posterior_csv(const CalibrationResult& r) {
  std::string out;
  for (const auto& p : r.parameters) out += (out.empty() ? "" : ",") + csv_cell(p.name);
  out += '\n';
  for (const auto& s : r.samples)
    for (std::size_t k = 0; k < s.size(); ++k)
      out += text(k > 0 ? "," : "", s[k], k + 1 == s.size() ? "\n" : "");
  return out;
}

/// calibrate.py is beside this header, at its place when the program was compiled.
inline std::string calibration_script() {
  const std::string here = __FILE__;
  return here.substr(0, here.rfind('/') + 1) + "calibrate.py";
}

}  // namespace detail
}  // namespace silt
