// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/io/atomic_file.hpp>

/// What every example program offers: options, summary.json, checks, pictures, exit status.
namespace example {

/// The options that all examples share.
struct Options {
  std::string out = "out";
  std::string restart;  // checkpoint to go on from
  bool quick = false;
  int threads = silt::default_threads();
};

inline void add_options(CLI::App& app, Options& o) {
  app.add_option("--out", o.out, "Folder for results")->capture_default_str();
  app.add_flag("--quick", o.quick, "A smaller run of the same physics, in seconds");
  app.add_option("--threads", o.threads, "Threads; results do not depend on it")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--restart", o.restart, "Go on from this checkpoint");
}

/// Inputs, results and checks of a run; ends as summary.json.
class Summary {
 public:
  nlohmann::ordered_json inputs, results;

  void check(const std::string& name, double value, const std::string& relation, double limit) {
    const bool holds = relation == "<=" ? value <= limit : value >= limit;
    checks_.push_back({{"name", name}, {"value", value}, {"must_be", relation}, {"limit", limit},
                       {"holds", holds}});
    all_hold_ = all_hold_ && holds;
  }
  bool all_hold() const { return all_hold_; }

  void write(const std::string& path) const {
    nlohmann::ordered_json all;
    all["inputs"] = inputs;
    all["versions"] = {{"silt", "0.1.0"}, {"compiler", __VERSION__}};
    all["results"] = results;
    all["checks"] = checks_;
    silt::AtomicFile file(path);
    file.write(all.dump(2) + "\n");
    file.commit();
  }
  /// The checks as lines of text.
  void print_checks() const {
    for (const auto& c : checks_)
      std::printf("  %s %-34s %.4g (must be %s %.4g)\n", c["holds"].get<bool>() ? "ok  " : "FAIL",
                  c["name"].get<std::string>().c_str(), c["value"].get<double>(),
                  c["must_be"].get<std::string>().c_str(), c["limit"].get<double>());
  }

 private:
  nlohmann::ordered_json checks_ = nlohmann::ordered_json::array();
  bool all_hold_ = true;
};

/// Runs draw.py with these arguments; false if there is no Python with numpy and matplotlib.
inline bool draw(const std::vector<std::string>& arguments) {
  std::string command = "/usr/bin/python3 '" SILT_DRAW_SCRIPT "'";
  for (const auto& a : arguments) {
    std::string quoted;
    for (const char c : a) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    command += " '" + quoted + "'";
  }
  std::fflush(stdout);
  return std::system(command.c_str()) == 0;
}

/// Seconds since it was made.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Runs `body`; a sentence on stderr and status 2 for what was refused or went wrong.
template <class Body>
int run(CLI::App& app, int argc, char** argv, const Body& body) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    std::fprintf(stderr, "%s; --help lists the options\n", e.what());
    return 2;
  }
  try {
    return body();
  } catch (const silt::Error& e) {
    std::fprintf(stderr, "\n%s\n", e.what());
    return 2;
  }
}

}  // namespace example
