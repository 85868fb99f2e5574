// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <unistd.h>

#include <cstdio>
#include <string>
#include <vector>

#include <silt/study/study.hpp>

#include "support/example.hpp"

/// The studies of `./run study NAME`: one file each, which registers itself.
namespace studies {

/// Options of a study.
struct Setting {
  std::string out;      // folder of its results
  bool quick;           // a smaller one of the same physics
  std::size_t repeats;  // rounds
  // For `decomposition` only:
  std::size_t particles = 0;  // 0: as the study has it
  double latency = 2e-6;      // [s] of a message
  double bandwidth = 10e9;    // [bytes/s]
};

/// Runs a study, shows its progress on a terminal, and writes its results into a folder of
/// `setting.out`.
inline void run_and_report(silt::Study& study, const Setting& setting, const std::string& folder) {
  const bool terminal = ::isatty(STDERR_FILENO);
  silt::StudyOptions options{.repeats = setting.repeats};
  if (terminal)
    options.watch = [&](std::size_t round, const std::string& variant) {
      std::fprintf(stderr, "\r\033[Kround %zu of %zu: %s", round + 1, setting.repeats,
                   variant.c_str());
    };
  study.run(options);
  if (terminal) std::fprintf(stderr, "\r\033[K");
  study.report(setting.out + "/" + folder);
}

/// Fills the summary: inputs, results, checks.
using Function = void (*)(const Setting&, example::Summary&);

struct Entry {
  std::string name, about;
  Function function;
};
inline std::vector<Entry>& all() {
  static std::vector<Entry> entries;
  return entries;
}

/// Recommendations of a study, as results of the program's summary.
inline void add_recommendation(example::Summary& summary, const std::string& name,
                               const silt::Study& study) {
  const auto& results = study.results();
  summary.result("recommended_" + name,
                 results.recommended ? results.rows[*results.recommended].name : "none");
}

/// const studies::Registered here{"skin", "its question, in one line", skin};
struct Registered {
  Registered(const std::string& name, const std::string& about, Function function) {
    all().push_back({name, about, function});
  }
};

}  // namespace studies
