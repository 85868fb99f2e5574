// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "support/example.hpp"

/// The table of the stability suite: scenes, each with its criterion of stability, and their rows.
/// A row is one complete run, or several of the same kind.
namespace stability {

/// A measured value and its largest allowed value.
struct Measure {
  std::string name;
  double error;  // [-]; not a number: never within the bound
  double bound;  // [-]
};
using Measures = std::vector<Measure>;

/// Allowed ends of a row. Tame rows must be stable, all at the time step that silt chooses except
/// where the scene is meant to exceed a limit of the guard. Extreme rows may also be stopped by a
/// limit of the guard, but by no other error.
enum class Setting { Tame, Extreme };

enum class Verdict {
  Stable,   // every measure within its bound
  Stopped,  // by a sentence of silt
  Alarm,    // a tame one that was stopped, or another by a sentence that is not of it
  Wrong     // it went on to its end, and a measure is out of its bound
};

struct Row {
  std::string scene, name;
  Verdict verdict;
  Measure worst;         // the one that comes nearest to its bound, or exceeds it most
  std::string sentence;  // why it was stopped
  double seconds;
};

class Table {
 public:
  explicit Table(bool is_quick) : quick(is_quick) {}
  const bool quick;

  /// Starts a scene. `stable`: the criterion for its rows, stated before they run.
  void scene(const std::string& name, const std::string& stable);
  /// Runs a row: `run` returns the measures or throws silt's error.
  void row(const std::string& name, Setting setting, const std::function<Measures()>& run);
  /// Runs a row that must be stopped, by a message with these words.
  void stops(const std::string& name, const std::string& words,
             const std::function<Measures()>& run);

  const std::vector<Row>& rows() const { return rows_; }
  int count(Verdict verdict) const;
  bool holds() const { return count(Verdict::Alarm) + count(Verdict::Wrong) == 0; }
  void print_end() const;
  void write_csv(const std::string& path) const;
  void add_to(example::Summary& summary) const;

 private:
  void add(const std::string& name, Setting setting, const std::string* words,
           const std::function<Measures()>& run);
  std::string scene_;
  std::vector<Row> rows_;
};

/// A point of the picture: the result of an impact with a time step above the limit.
struct StepPoint {
  std::string law;
  double share;  // [-] of the limit
  double error;  // [-] worst of the phases, of the speed after an impact over that before
  double most;   // [-] the limit of that error
  bool stopped;  // by the guard, with the time step's own limit lifted (error: with all limits
                 // lifted)
};

// The scenes, a few per file.
std::vector<StepPoint> time_steps(Table& table);
void impacts(Table& table);
void several(Table& table);
void packed(Table& table);
void walls(Table& table);
void moving_walls(Table& table);
void rough(Table& table);
void bodies(Table& table);
void spins(Table& table);
void sticky(Table& table);
void light(Table& table);
void bonds(Table& table);
void breakage(Table& table);
void sph(Table& table);
void no_numbers(Table& table);

}  // namespace stability
