// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/io/schedule.hpp>
#include <silt/measure/passing_counter.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// See passing_series().
class PassingSeries {
 public:
  static constexpr bool reads_contacts = false;
  PassingSeries(std::string path, const Surfaces& surface, Schedule schedule,
                PassingOptions options)
      : path_(std::move(path)),
        schedule_(schedule),
        counter_("passing_series", surface, std::move(options)) {}

  /// The counts so far, those of the rows that a continued table has included.
  const PassingCounter& counter() const { return counter_; }

  template <class Sim>
  void begin(const Sim& sim, double end) {
    schedule_.begin(sim);
    end_ = end;
    const bool goes_on = counter_.started_ && PassingCounter::is_now(sim, counter_.seen_at_);
    counter_.begin(sim, end);
    if (sim.rank() == 0) open(sim);
    if (!goes_on) since_ = sim.time();
    if (begun_) return;
    // All ranks have the counts of the last row of rank 0.
    std::array<double, 6> row{};
    if (table_ && !table_->kept_row().empty())
      row[5] = 1, std::copy_n(table_->kept_row().begin(), 5, row.begin());
    sim.sum_over_ranks(std::span<double>(row));
    begun_ = true;
    if (row[5] == 0) return;
    written_at_ = row[0];
    counter_.forwards_ = {static_cast<std::uint64_t>(row[1]), row[3]};
    counter_.backwards_ = {static_cast<std::uint64_t>(row[2]), row[4]};
    number_ = counter_.net_number(), mass_ = counter_.net_mass();
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return schedule_.is_due(sim) || counter_.is_due(sim);
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    if (!schedule_.is_due(sim) || waits_for_end(sim)) return counter_.look(sim);
    write_row(sim);
    schedule_.mark(sim);
  }
  /// A checkpoint follows: the run that goes on from it finds the counts of this instant.
  template <class Sim>
  void before_saving(const Sim& sim) {
    write_row(sim);
  }
  template <class Sim>
  void end(const Sim& sim) {
    write_row(sim);
    schedule_.mark(sim);
  }

 private:
  template <class Sim>
  void open(const Sim& sim) {
    static const DynArray<std::string> columns{
        "time [s]",           "number forwards [-]", "number backwards [-]",
        "mass forwards [kg]", "mass backwards [kg]", "number rate [1/s]",
        "mass rate [kg/s]"};
    const bool has_begun = sim.has_begun(path_), continues = sim.continues(path_);
    if (table_) return;
    const auto table = std::make_shared<CsvTable>(
        continues ? CsvTable::resume(path_, columns, sim.time() + 0.5 * sim.step_length())
                  : CsvTable(path_, columns));
    if (!table->kept_row().empty()) check_row(sim, table->kept_row()[0], has_begun);
    table_ = table;
  }
  /// Whether the counts of the last row, at `last` [s], are those of this instant; `own`: a run of
  /// this simulation has written it.
  template <class Sim>
  void check_row(const Sim& sim, double last, bool own) const {
    require(!counter_.options_.once, "passing_series '", path_,
            "' counts each particle once, and a table does not tell which ones have passed: in "
            "several runs give the same observer, a variable of the program; after a restart "
            "another file, where each may count once more");
    require(own || PassingCounter::is_now(sim, last), "passing_series '", path_,
            "' has its last row at t = ", last, " s, and this run begins at t = ", sim.time(),
            " s: what has passed between is not known; save by silt::checkpoints in the same run, "
            "or behind a run with the series, or give the run that goes on another file");
  }
  /// Whether the run ends with the next step, and no other row is due before: one row is enough.
  template <class Sim>
  bool waits_for_end(const Sim& sim) const {
    struct NextStep {
      double now, length;  // [s]
      std::int64_t last;
      double time() const { return now + length; }
      double step_length() const { return length; }
      std::int64_t step() const { return last + 1; }
    };
    const double step = sim.step_length(), left = end_ - sim.time();
    Schedule after = schedule_;
    after.mark(sim);
    return left > 1e-6 * step && left < 1.001 * step &&
           !after.is_due(NextStep{sim.time(), step, sim.step()});
  }
  template <class Sim>
  void write_row(const Sim& sim) {
    if (PassingCounter::is_now(sim, written_at_)) return;
    counter_.look(sim);
    const double number = counter_.net_number(), mass = counter_.net_mass();
    const double duration = sim.time() - since_;  // [s]
    const double rate = duration > 0 ? 1 / duration : 0;
    const Passed &there = counter_.forwards(), &back = counter_.backwards();
    if (table_)
      table_->add_row({sim.time(), static_cast<double>(there.number),
                       static_cast<double>(back.number), there.mass, back.mass,
                       rate * (number - number_), rate * (mass - mass_)});
    written_at_ = since_ = sim.time(), number_ = number, mass_ = mass;
  }

  std::string path_;
  Schedule schedule_;
  PassingCounter counter_;
  std::shared_ptr<CsvTable> table_;  // of rank 0
  bool begun_ = false;
  double written_at_ = std::numeric_limits<double>::quiet_NaN();  // [s] the last row
  double end_ = 0;                                                // [s] of the run
  double since_ = 0, number_ = 0, mass_ = 0;                      // [s], [-], [kg] net, then
};

/// Writes to a CSV table what passes a surface: time, number and mass forwards (along the normal)
/// and backwards since the start, and the mean net rates since the last row. The particles are
/// looked at every ten steps in between (PassingCounter).
///
///   sim.run(1, silt::passing_series("orifice.csv", silt::disc({0, 0, 0}, {0, 0, -1}, 0.02),
///                                   silt::every(0.01)));
///
/// Each run ends with a row, and each checkpoint of silt::checkpoints has one. A table that
/// continues, after a restart or in a later run, goes on from its last row. Errors: InputError for
/// an unfit surface, for a file that another observer of the run writes, for a restart of which the
/// table lacks the time, or with `once`; FileError.
inline PassingSeries passing_series(std::string path, const Surfaces& surface, Schedule schedule,
                                    PassingOptions options = {}) {
  return {std::move(path), surface, schedule, std::move(options)};
}

}  // namespace silt
