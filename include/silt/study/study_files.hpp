// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/study/study_results.hpp>
#include <silt/study/study_table.hpp>

/// Results of a study as files.
namespace silt::inline SILT_TARGET::detail {

inline std::string json_quoted(std::string_view words) {
  std::string out = "\"";
  for (const char c : words) {
    char escaped[8];
    if (static_cast<unsigned char>(c) < 0x20)
      std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c)), out += escaped;
    else
      out += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
  }
  return out + '"';
}

/// "begin a, b, c end" from the texts `item(x)` of a range.
template <class Range, class Item>
std::string json_joined(const char* begin, const char* end, const Range& range, const Item& item) {
  std::string out = begin;
  const char* separator = "";
  for (const auto& element : range) out += separator + item(element), separator = ", ";
  return out + end;
}

inline std::string json_numbers(const std::vector<StudyNumber>& numbers) {
  return json_joined("{", "}", numbers, [](const StudyNumber& n) {
    return json_quoted(n.name) + text(": ", n.value);
  });
}

inline std::string json_row(const StudyRow& row) {
  std::string out = "{\"name\": " + json_quoted(row.name);
  out += row.control ? ", \"control\": true" : "";
  if (row.failed()) return out + ", \"failure\": " + json_quoted(row.failure) + "}";
  out += text(", \"cost_s\": ", row.cost(), ", \"cheapest_round_s\": ", row.least_cost(),
              ", \"dearest_round_s\": ", row.greatest_cost(), ", \"runs\": ", row.runs);
  return out + ", \"errors\": " + json_numbers(row.errors) +
         ", \"notes\": " + json_numbers(row.notes) + "}";
}

inline std::string study_json(const StudyResults& results) {
  const auto name_of = [&](std::size_t k) { return json_quoted(results.rows[k].name); };
  const auto indented = [](const StudyRow& row) { return "\n      " + json_row(row); };
  const auto errors = errors_of(results);
  std::string out = "{\n  \"study\": " + json_quoted(results.name) + ",\n  \"inputs\": {";
  out += "\"clock\": " + json_quoted(results.clock) + text(", \"rounds\": ", results.rounds);
  out += ", \"accepted\": " + json_joined("{", "}", results.bounds, [](const StudyBound& b) {
           return json_quoted(b.error) + text(": ", b.limit);
         });
  out += "},\n  \"results\": {\n    \"recommended\": ";
  out += results.recommended ? name_of(*results.recommended) : "null";
  out += ",\n    \"why\": " + json_quoted(results.why);
  out += ",\n    \"judged_by\": " + json_quoted(results.judged_by());
  out += ",\n    \"units\": " + json_joined("{", "}", errors, [](const StudyNumber& e) {
           return json_quoted(e.name) + ": " + json_quoted(e.unit);
         });
  out +=
      ",\n    \"fronts\": " + json_joined("{", "}", errors, [&](const StudyNumber& e) {
        return json_quoted(e.name) + ": " + json_joined("[", "]", results.front(e.name), name_of);
      });
  out += ",\n    \"variants\": " + json_joined("[", "\n    ]", results.rows, indented);
  out += ",\n    \"reference\": " + (results.reference ? json_row(*results.reference) : "null");
  return out + "\n  }\n}\n";
}

inline void write_whole(const std::string& path, const std::string& content) {
  AtomicFile file(path);
  file.write(content);
  file.commit();
}

inline std::string shell_quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// pareto.py is beside this header, at its place when the program was compiled.
inline std::string study_script() {
  const std::string here = __FILE__;
  return here.substr(0, here.rfind('/') + 1) + "pareto.py";
}

/// Draws `folder`/pareto.png from `folder`/summary.json, or the picture of another script; false if
/// no Python could.
inline bool draw_study(const std::string& folder, const std::string& script = study_script(),
                       const std::string& picture = "pareto.png") {
  std::remove((folder + "/" + picture).c_str());  // of an earlier study
  std::fflush(stdout);
  for (const char* python : {"python3", "/usr/bin/python3"})
    if (std::system(
            text(python, " ", shell_quoted(script), " ", shell_quoted(folder), " >/dev/null 2>&1")
                .c_str()) == 0)
      return true;
  return false;
}

}  // namespace silt::detail
