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

/// A measured number with its name and unit.
struct StudyNumber {
  std::string name;
  double value;
  std::string unit;
};

/// What a study found out about one variant.
struct StudyRow {
  std::string name;
  bool control = false;                  // only there to compare others with
  std::vector<double> costs = {};        // [s] of one run: one entry a round
  std::size_t runs = 0;                  // [-] in all rounds; several a round if one run is short
  std::vector<StudyNumber> errors = {};  // >= 0
  std::vector<StudyNumber> notes = {};   // not judged
  std::string failure = {};              // the sentence that stopped it; empty: it ran

  bool failed() const { return !failure.empty(); }
  bool judged() const { return !failed() && !control; }
  double least_cost() const { return *std::min_element(costs.begin(), costs.end()); }     // [s]
  double greatest_cost() const { return *std::max_element(costs.begin(), costs.end()); }  // [s]
  /// The median of the rounds [s].
  double cost() const {
    std::vector<double> sorted = costs;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    return 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
  }
  /// Between the dearest and the cheapest round, over the median [-].
  double spread() const { return (greatest_cost() - least_cost()) / cost(); }
  /// An error by its name; nullptr if there is none.
  const StudyNumber* error(std::string_view wanted) const { return find(errors, wanted); }
  const StudyNumber* note(std::string_view wanted) const { return find(notes, wanted); }

 private:
  static const StudyNumber* find(const std::vector<StudyNumber>& all, std::string_view wanted) {
    for (const auto& number : all)
      if (number.name == wanted) return &number;
    return nullptr;
  }
};

/// The largest error of this name that is accepted.
struct StudyBound {
  std::string error;
  double limit;
};

/// What a study found out.
struct StudyResults {
  std::string name;
  std::string clock;       // what costs are measured with
  std::size_t rounds = 0;  // [-]
  std::vector<StudyBound> bounds = {};
  std::vector<StudyRow> rows = {};         // one a variant, in the order in which they were given
  std::optional<StudyRow> reference = {};  // run once
  std::optional<std::size_t> recommended = {};  // row
  std::string why = {};  // a sentence: what is recommended and why, or why none

  /// The first variant that ran: all give the same errors, in the same order. nullptr: none ran.
  const StudyRow* first() const {
    for (const auto& row : rows)
      if (!row.failed()) return &row;
    return nullptr;
  }
  /// The error that the front is drawn for: the first bounded one, else the first there is.
  std::string judged_by() const {
    if (!bounds.empty()) return bounds.front().error;
    return first() ? first()->errors.front().name : "";
  }
  /// The rows on the Pareto front of cost and this error, by rising cost.
  std::vector<std::size_t> front(std::string_view error) const {
    std::vector<std::size_t> ran;
    const auto points = points_of(error, ran);
    std::vector<std::size_t> out;
    for (const std::size_t k : pareto_front(points)) out.push_back(ran[k]);
    return out;
  }

  /// Sets `recommended` and `why`: of the variants that keep all bounds the cheapest; without
  /// bounds the knee of the front.
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
                 ", at once the cheapest and that of the "
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
