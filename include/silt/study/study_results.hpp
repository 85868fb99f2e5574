// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/study/pareto.hpp>

namespace silt::inline SILT_TARGET {

/// A measured number with name and unit.
struct StudyNumber {
  std::string name;
  double value;
  std::string unit;
};

/// Results of one variant.
struct StudyRow {
  std::string name;
  bool control = false;                  // only for comparison
  std::vector<double> costs = {};        // [s] of one run: one entry per round
  std::size_t runs = 0;                  // [-] in all rounds; several per round if one run is short
  std::vector<StudyNumber> errors = {};  // >= 0
  std::vector<StudyNumber> notes = {};   // not judged
  std::string failure = {};              // message of the error; empty: it ran

  bool failed() const { return !failure.empty(); }
  bool judged() const { return !failed() && !control; }
  double least_cost() const { return *std::min_element(costs.begin(), costs.end()); }     // [s]
  double greatest_cost() const { return *std::max_element(costs.begin(), costs.end()); }  // [s]
  /// Median of the rounds [s].
  double cost() const {
    std::vector<double> sorted = costs;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    return 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
  }
  /// (Largest - smallest cost of the rounds)/median [-].
  double spread() const { return (greatest_cost() - least_cost()) / cost(); }
  /// Error with this name; nullptr if there is none.
  const StudyNumber* error(std::string_view wanted) const { return find(errors, wanted); }
  const StudyNumber* note(std::string_view wanted) const { return find(notes, wanted); }

 private:
  static const StudyNumber* find(const std::vector<StudyNumber>& all, std::string_view wanted) {
    for (const auto& number : all)
      if (number.name == wanted) return &number;
    return nullptr;
  }
};

/// Largest accepted error of this name.
struct StudyBound {
  std::string error;
  double limit;
};

/// Results of a study.
struct StudyResults {
  std::string name;
  std::string clock;       // name of the clock
  std::size_t rounds = 0;  // [-]
  std::vector<StudyBound> bounds = {};
  std::vector<StudyRow> rows = {};              // one per variant, in the order given
  std::optional<StudyRow> reference = {};       // run once
  std::optional<std::size_t> recommended = {};  // row
  std::string why = {};  // a sentence: the recommendation and its reason, or why there is none

  /// The first variant that ran; all give the same errors, in the same order. nullptr: none ran.
  const StudyRow* first() const {
    for (const auto& row : rows)
      if (!row.failed()) return &row;
    return nullptr;
  }
  /// Error of the front: the first with a bound, else the first.
  std::string judged_by() const {
    if (!bounds.empty()) return bounds.front().error;
    return first() ? first()->errors.front().name : "";
  }
  /// Rows on the Pareto front of cost and this error, by increasing cost.
  std::vector<std::size_t> front(std::string_view error) const {
    std::vector<std::size_t> ran;
    const auto points = points_of(error, ran);
    std::vector<std::size_t> out;
    for (const std::size_t k : pareto_front(points)) out.push_back(ran[k]);
    return out;
  }

  /// Sets `recommended` and `why`: the cheapest variant within all bounds; without bounds the knee
  /// of the front.
  void judge() {
    recommended.reset();
    if (std::none_of(rows.begin(), rows.end(), [](const StudyRow& r) { return r.judged(); }))
      why = "Nothing is recommended: every variant failed.";
    else if (bounds.empty())
      judge_by_knee();
    else
      judge_by_bounds();
  }

 private:
  std::vector<CostAndError> points_of(std::string_view error, std::vector<std::size_t>& ran) const {
    std::vector<CostAndError> points;
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (rows[k].judged())
        points.push_back({rows[k].cost(), rows[k].error(error)->value}), ran.push_back(k);
    return points;
  }

  std::string bounds_in_words() const {
    std::string out;
    for (const auto& b : bounds) {
      const std::string& unit = first()->error(b.error)->unit;
      out += text(out.empty() ? "" : " and ", b.error, " is at most ", b.limit,
                  unit == "-" ? "" : " " + unit);
    }
    return out;
  }
  bool keeps_bounds(const StudyRow& row) const {
    return row.judged() && std::all_of(bounds.begin(), bounds.end(), [&](const StudyBound& b) {
             return row.error(b.error)->value <= b.limit;
           });
  }

  void judge_by_bounds() {
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (keeps_bounds(rows[k]) && (!recommended || rows[k].cost() < rows[*recommended].cost()))
        recommended = k;
    if (!recommended) {
      why = text("Nothing is recommended: of no variant ", bounds_in_words(), ".");
      return;
    }
    const auto& best = rows[*recommended];
    why = text("Recommended: ", best.name, ", the cheapest of which ", bounds_in_words(), ".");
    std::string others;
    for (const auto& row : rows)
      if (&row != &best && keeps_bounds(row) && row.least_cost() <= best.greatest_cost())
        others += text(others.empty() ? "" : ", ", row.name);
    if (!others.empty()) why += text(" As cheap within the spread of the rounds: ", others, ".");
  }

  void judge_by_knee() {
    std::vector<std::size_t> ran;
    const auto points = points_of(judged_by(), ran);
    const auto on_front = pareto_front(points);
    std::vector<CostAndError> line;
    for (const std::size_t k : on_front) line.push_back(points[k]);
    if (line.size() == 1) {
      recommended = ran[on_front[0]];
      why = text("Recommended: ", rows[*recommended].name,
                 ", both the cheapest and that of the "
                 "least ",
                 judged_by(), ".");
    } else if (const auto knee = knee_of(line)) {
      recommended = ran[on_front[*knee]];
      why = text("Recommended: ", rows[*recommended].name, ", the knee of the front of cost and ",
                 judged_by(), ".");
    } else {
      why = text("Nothing is recommended: the front of cost and ", judged_by(),
                 " has no knee; accept(\"", judged_by(), "\", limit) says how much is enough.");
    }
  }
};

}  // namespace silt
