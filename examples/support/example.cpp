// silt - BSD-3-Clause, see LICENSE

#include "support/example.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/files/atomic_file.hpp>

namespace example {

struct Command::Parser {
  explicit Parser(const std::string& description) : app(description) {}
  CLI::App app;
};

Command::Command(const std::string& description, Kind kind, const std::string& default_out)
    : parser_(std::make_unique<Parser>(description)) {
  options.out = default_out;
  options.threads = silt::default_threads();
  auto& app = parser_->app;
  app.add_option("--out", options.out, "Folder for results")->capture_default_str();
  app.add_flag("--quick", options.quick, "A smaller run of the same physics, in seconds");
  if (kind == Kind::Study) return;
  app.add_option("--threads", options.threads, "Number of threads; results do not depend on it")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  if (kind == Kind::Run)
    app.add_option("--restart", options.restart, "Continue from this checkpoint");
}
Command::~Command() = default;

void Command::add(const std::string& name, double& value, double least, double most,
                  const std::string& help) {
  parser_->app.add_option(name, value, help)->check(CLI::Range(least, most))->capture_default_str();
}
void Command::add(const std::string& name, std::size_t& value, std::size_t least, std::size_t most,
                  const std::string& help) {
  parser_->app.add_option(name, value, help)->check(CLI::Range(least, most))->capture_default_str();
}
void Command::add(const std::string& name, std::vector<std::size_t>& values, std::size_t least,
                  std::size_t most, const std::string& help) {
  parser_->app.add_option(name, values, help)->check(CLI::Range(least, most));
}
void Command::add(const std::string& name, std::string& value,
                  const std::vector<std::string>& choices, const std::string& help) {
  parser_->app.add_option(name, value, help)->check(CLI::IsMember(choices))->capture_default_str();
}
void Command::add_flag(const std::string& name, bool& value, const std::string& help) {
  parser_->app.add_flag(name, value, help);
}
void Command::leave_out(const std::string& name) {
  parser_->app.remove_option(parser_->app.get_option(name));
}
bool Command::given(const std::string& name) const { return parser_->app.count(name) > 0; }

int Command::run(int argc, char** argv, const std::function<int()>& body) {
  try {
    parser_->app.parse(argc, argv);
  } catch (const CLI::CallForHelp& e) {
    return parser_->app.exit(e);
  } catch (const CLI::ParseError& e) {
    std::fprintf(stderr, "%s; --help lists the options\n", e.what());
    return 2;
  }
  try {
    return body();
  } catch (const silt::Error& e) {
    std::fprintf(stderr, "\n%s\n", e.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "\nthis machine's memory does not suffice; use fewer particles\n");
    return 2;
  }
}

void Summary::check_at_most(const std::string& name, double value, double limit) {
  checks_.push_back({name, "<=", value, limit, value <= limit});
}
void Summary::check_at_least(const std::string& name, double value, double limit) {
  checks_.push_back({name, ">=", value, limit, value >= limit});
}
void Summary::check_within(const std::string& name, double value, double reference,
                           double tolerance, const std::string& reason) {
  checks_.push_back({name, "within", value, tolerance, std::abs(value - reference) <= tolerance,
                     reference, reason});
}
bool Summary::all_hold() const {
  return std::all_of(checks_.begin(), checks_.end(), [](const Check& c) { return c.holds; });
}

void Summary::write(const std::string& path) const {
  const auto object = [](const std::vector<Entry>& entries) {
    nlohmann::ordered_json out = nlohmann::ordered_json::object();
    for (const auto& e : entries) std::visit([&](const auto& v) { out[e.name] = v; }, e.value);
    return out;
  };
  nlohmann::ordered_json all;
  all["inputs"] = object(inputs_);
  all["versions"] = {{"silt", SILT_VERSION}, {"compiler", __VERSION__}, {"processor", processor()}};
  all["results"] = object(results_);
  all["checks"] = nlohmann::ordered_json::array();
  for (const auto& c : checks_) {
    nlohmann::ordered_json check{
        {"name", c.name}, {"value", c.value}, {"must_be", c.relation}, {"limit", c.limit}};
    if (!c.reason.empty()) {
      check["reference"] = c.reference;
      check["deviation"] = c.value - c.reference;
      check["reason"] = c.reason;
    }
    check["holds"] = c.holds;
    all["checks"].push_back(check);
  }
  silt::AtomicFile file(path);
  file.write(all.dump(2) + "\n");
  file.commit();
}

void Summary::print_checks() const {
  for (const auto& c : checks_) {
    std::printf("  %s %-36s %.4g ", c.holds ? "ok  " : "FAIL", c.name.c_str(), c.value);
    if (c.reason.empty())
      std::printf("(must be %s %.4g)\n", c.relation.c_str(), c.limit);
    else
      std::printf("(%.4g off %.4g, at most %.4g)\n", c.value - c.reference, c.reference, c.limit);
  }
}

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  std::map<std::string, std::string> found;
  for (std::string line; std::getline(file, line) && !line.empty();) {
    const auto colon = line.find(':');
    if (colon == std::string::npos) continue;
    const auto end = line.find_last_not_of(" \t", colon - 1);
    const auto from = line.find_first_not_of(' ', colon + 1);
    found[line.substr(0, end + 1)] = from == std::string::npos ? "" : line.substr(from);
  }
  if (!found.count("model name")) return "unknown processor";
  const std::string flags = ' ' + found["flags"] + ' ';
  const auto has = [&](const char* flag) { return flags.find(flag) != std::string::npos; };
  return found["model name"] + ", family " + found["cpu family"] + " model " + found["model"] +
         ", " +
         (has(" avx512f ") ? "AVX-512"
          : has(" avx2 ")  ? "AVX2"
                           : "SSE2");
}

bool draw(const std::vector<std::string>& arguments) {
  return run_script(SILT_PYTHON_PACKAGE, arguments);
}

bool run_script(const std::string& script, const std::vector<std::string>& arguments) {
  // Debian installs numpy and matplotlib for /usr/bin/python3, whatever `python3` is; `python3` is
  // used where that one lacks them.
  std::string command =
      "python=/usr/bin/python3; \"$python\" -c 'import sys; from importlib.util import find_spec; "
      "sys.exit(not (find_spec(\"numpy\") and find_spec(\"matplotlib\")))' 2>/dev/null || "
      "python=python3; \"$python\" '" +
      script + "'";
  for (const auto& a : arguments) {
    std::string quoted;
    for (const char c : a) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    command += " '" + quoted + "'";
  }
  std::fflush(stdout);
  return std::system(command.c_str()) == 0;
}

}  // namespace example
