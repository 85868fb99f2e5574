// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

/// Common parts of all example programs: options, summary.json, checks, pictures, exit status. The
/// libraries used are included in example.cpp only and compile once.
namespace example {

/// The options that examples share.
struct Options {
  std::string out = "out";  // --out
  std::string restart;      // --restart: checkpoint to go on from
  bool quick = false;       // --quick
  int threads = 1;          // --threads; default: all of the machine
};

/// Kind of program: one run; several short ones, without --restart; timed ones, without --threads
/// too.
enum class Kind { Run, Cases, Study };

/// The command line of an example.
class Command {
 public:
  explicit Command(const std::string& description, Kind kind = Kind::Run,
                   const std::string& default_out = "out");
  ~Command();
  Options options;

  /// An option with a number in [least, most]; its default is the present `value`.
  void add(const std::string& name, double& value, double least, double most,
           const std::string& help);
  void add(const std::string& name, std::size_t& value, std::size_t least, std::size_t most,
           const std::string& help);
  /// Several numbers; for a name without dashes they are the positional arguments.
  void add(const std::string& name, std::vector<std::size_t>& values, std::size_t least,
           std::size_t most, const std::string& help);
  void add(const std::string& name, std::string& value, const std::vector<std::string>& choices,
           const std::string& help);
  void add_flag(const std::string& name, bool& value, const std::string& help);
  /// Removes one of the shared options that this program does not use.
  void leave_out(const std::string& name);
  /// True if the option was given.
  bool given(const std::string& name) const;

  /// Reads the arguments and runs `body`. An error is one sentence on stderr and exit status 2.
  int run(int argc, char** argv, const std::function<int()>& body);

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

/// Inputs, results and checks of a run; written as summary.json at the end.
class Summary {
 public:
  using Value = std::variant<double, std::string, bool>;

  void input(const std::string& name, Value value) { inputs_.push_back({name, std::move(value)}); }
  void result(const std::string& name, Value value) {
    results_.push_back({name, std::move(value)});
  }
  void check_at_most(const std::string& name, double value, double limit);
  void check_at_least(const std::string& name, double value, double limit);
  /// value - reference| <= tolerance, with the reason of the tolerance.
  void check_within(const std::string& name, double value, double reference, double tolerance,
                    const std::string& reason);
  bool all_hold() const;

  void write(const std::string& path) const;
  /// The checks as lines on stdout.
  void print_checks() const;

 private:
  struct Entry {
    std::string name;
    Value value;
  };
  struct Check {
    std::string name, relation;
    double value, limit;
    bool holds;
    double reference = 0;
    std::string reason = {};  // empty: the check has no reference
  };
  std::vector<Entry> inputs_, results_;
  std::vector<Check> checks_;
};

/// The processor's name, details that distinguish processors of the same name, and its widest
/// lanes; as in benchmarks/report.py.
std::string processor();

/// Runs `silt draw`, `silt curves` or `silt cells` (docs/python.md) with these arguments; false if
/// there is no Python with numpy and matplotlib.
bool draw(const std::vector<std::string>& arguments);
/// Runs a Python script of the example in the same way.
bool run_script(const std::string& script, const std::vector<std::string>& arguments);

/// Seconds since construction.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace example
