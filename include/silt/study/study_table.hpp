// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/study/study_results.hpp>

/// Results of a study as a table, readable and as CSV.
namespace silt::inline SILT_TARGET::detail {

/// Three digits: more would be noise in a cost, and of errors the size is of interest.
inline std::string three_digits(double number) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", number);
  return buffer;
}

inline bool contains(const std::vector<std::size_t>& all, std::size_t wanted) {
  return std::find(all.begin(), all.end(), wanted) != all.end();
}

/// Notes of all variants, each name once, in the order of first appearance.
inline std::vector<StudyNumber> notes_of(const StudyResults& results) {
  std::vector<StudyNumber> all;
  const auto include = [&](const StudyRow& row) {
    for (const auto& note : row.notes)
      if (std::none_of(all.begin(), all.end(),
                       [&](const StudyNumber& n) { return n.name == note.name; }))
        all.push_back(note);
  };
  for (const auto& row : results.rows) include(row);
  if (results.reference) include(*results.reference);
  return all;
}
inline std::vector<StudyNumber> errors_of(const StudyResults& results) {
  const auto* first = results.first();
  return first ? first->errors : std::vector<StudyNumber>{};
}
inline std::vector<std::size_t> front_of(const StudyResults& results) {
  return results.first() ? results.front(results.judged_by()) : std::vector<std::size_t>{};
}

/// Unit in which the cheapest variant costs at least 1, at most seconds.
struct CostUnit {
  double seconds;
  const char* name;
};
inline CostUnit cost_unit(const StudyResults& results) {
  double least = 1;
  for (const auto& row : results.rows)
    if (!row.failed()) least = std::min(least, row.cost());
  if (least < 1e-3) return {1e-6, "us"};
  if (least < 1) return {1e-3, "ms"};
  return {1, "s"};
}

/// Rows of equally many cells, each column as wide as its widest cell; the first `left` columns
/// left aligned.
inline std::string aligned(const std::vector<std::vector<std::string>>& rows, std::size_t left) {
  std::vector<std::size_t> width(rows.front().size(), 0);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  std::string out;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string fill(width[c] - row[c].size(), ' ');
      line += (c == 0 ? "" : "  ") + (c < left ? row[c] + fill : fill + row[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + '\n';
  }
  return out;
}

/// The readable table.
inline std::string study_table(const StudyResults& results) {
  const CostUnit unit = cost_unit(results);
  const auto errors = errors_of(results), notes = notes_of(results);
  std::vector<std::vector<std::string>> rows{
      {"", "variant", text("cost [", unit.name, "]"), "spread"}};
  for (const auto& e : errors) rows[0].push_back(text(e.name, " [", e.unit, "]"));
  for (const auto& n : notes) rows[0].push_back(text(n.name, " [", n.unit, "]"));
  std::string failures;
  const auto add = [&](const StudyRow& row, const char* mark) {
    const auto number = [](const StudyNumber* n) { return n ? three_digits(n->value) : "-"; };
    std::vector<std::string> cells{mark, row.name};
    cells.push_back(row.failed() ? "failed" : three_digits(row.cost() / unit.seconds));
    cells.push_back(row.costs.size() < 2 ? "-" : three_digits(100 * row.spread()) + " %");
    for (const auto& e : errors) cells.push_back(number(row.error(e.name)));
    for (const auto& n : notes) cells.push_back(number(row.note(n.name)));
    rows.push_back(std::move(cells));
    if (row.failed()) failures += text(row.name, " failed: ", row.failure, "\n");
  };
  const auto front = front_of(results);
  for (std::size_t k = 0; k < results.rows.size(); ++k)
    add(results.rows[k], results.recommended == k  ? "*"
                         : contains(front, k)      ? "+"
                         : results.rows[k].control ? "c"
                                                   : "");
  if (results.reference) add(*results.reference, "r");
  std::string out = text(results.name, "\n") + aligned(rows, 2);
  out += text("cost: ", results.clock, " of one run, median of ", results.rounds,
              results.rounds == 1 ? " round" : " rounds",
              "; spread: of the rounds, (largest - smallest)/median\n");
  if (results.first()) {
    const bool control = std::any_of(results.rows.begin(), results.rows.end(),
                                     [](const StudyRow& row) { return row.control; });
    out += text("* recommended, + on the front of cost and ", results.judged_by(),
                control ? ", c a control" : "", results.reference ? ", r the reference\n" : "\n");
  }
  return out + failures + results.why + '\n';
}

/// A cell of a CSV table (RFC 4180): in quotes if it needs them.
inline std::string csv_cell(std::string_view words) {
  if (words.find_first_of(",\"\n\r") == std::string_view::npos) return std::string(words);
  std::string out = "\"";
  for (const char c : words) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

/// The table for programs; a number that a variant does not have is an empty cell.
inline std::string study_csv(const StudyResults& results) {
  const auto errors = errors_of(results), notes = notes_of(results);
  std::string out = "variant,cost [s],cheapest round [s],dearest round [s],rounds [-],runs [-]";
  for (const auto& e : errors) out += ',' + csv_cell(text(e.name, " [", e.unit, "]"));
  for (const auto& n : notes) out += ',' + csv_cell(text(n.name, " [", n.unit, "]"));
  out += ",on the front [-],recommended [-],kind,failure\n";
  const auto add = [&](const StudyRow& row, bool on_front, bool recommended, const char* kind) {
    const auto number = [&](const StudyNumber* n) { out += n ? text(',', n->value) : ","; };
    out += csv_cell(row.name);
    out += row.failed() ? ",,,"
                        : text(',', row.cost(), ',', row.least_cost(), ',', row.greatest_cost());
    out += text(',', row.costs.size(), ',', row.runs);
    for (const auto& e : errors) number(row.error(e.name));
    for (const auto& n : notes) number(row.note(n.name));
    out += text(',', on_front ? 1 : 0, ',', recommended ? 1 : 0, ',', kind, ',');
    out += csv_cell(row.failure) + '\n';
  };
  const auto front = front_of(results);
  for (std::size_t k = 0; k < results.rows.size(); ++k)
    add(results.rows[k], contains(front, k), results.recommended == k,
        results.rows[k].control ? "control" : "variant");
  if (results.reference) add(*results.reference, false, false, "reference");
  return out;
}

}  // namespace silt::detail
