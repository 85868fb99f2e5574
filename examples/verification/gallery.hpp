// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <silt/files/csv_table.hpp>

#include "support/example.hpp"

namespace verification {

/// Of many comparisons the one closest to its tolerance, or furthest beyond it.
class Worst {
 public:
  void compare(double value, double reference, double tolerance) {
    const double share = std::abs(value - reference) / tolerance;
    if (share <= share_) return;  // not so for what is not a number
    value_ = value, reference_ = reference, tolerance_ = tolerance;
    share_ = std::isnan(share) ? std::numeric_limits<double>::infinity() : share;
  }
  /// |value/reference - 1| <= tolerance
  void compare_relative(double value, double reference, double tolerance) {
    compare(value, reference, tolerance * std::abs(reference));
  }
  double value() const { return value_; }
  double reference() const { return reference_; }
  double tolerance() const { return tolerance_; }

 private:
  double value_ = std::nan(""), reference_ = 0, tolerance_ = 0;
  double share_ = -1;  // [-] of the tolerance
};

/// Output of a case: tables in a folder, results and checks in the summary.
struct Gallery {
  std::string folder;
  bool quick = false;
  int threads = 1;
  example::Summary summary{};

  silt::CsvTable table(const std::string& name, const std::vector<std::string>& columns) const {
    return {folder + "/" + name + ".csv", columns};
  }
  void check(const std::string& name, const Worst& worst, const std::string& reason) {
    summary.check_within(name, worst.value(), worst.reference(), worst.tolerance(), reason);
  }
};

// Each writes its tables and its checks.
void normal_impacts_of_chung_and_ooi(Gallery& gallery);  // their tests 1, 2, 3
void restitution_and_steps(Gallery& gallery);
void size_ratios(Gallery& gallery);
void softened_moduli(Gallery& gallery);
void oblique_impacts_of_chung_and_ooi(Gallery& gallery);   // their tests 4, 5
void spinning_impacts_of_chung_and_ooi(Gallery& gallery);  // their tests 6, 7, 8
void alumina_on_glass(Gallery& gallery);
void slopes(Gallery& gallery);
void from_slip_to_roll(Gallery& gallery);
void jkr_contact(Gallery& gallery);
void cooling_gas(Gallery& gallery);

}  // namespace verification
