// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>

namespace silt::inline SILT_TARGET {

/// A sum of doubles whose rounding does not grow with the number of terms: the sum and what it
/// lacks. Source: A. Neumaier, ZAMM 54 (1974) 39 (recalled).
class CompensatedSum {
 public:
  CompensatedSum() = default;
  CompensatedSum(double sum, double rest) : sum_(sum), rest_(rest) {}
  void add(double x) {
    const double next = sum_ + x;
    rest_ += std::abs(sum_) >= std::abs(x) ? (sum_ - next) + x : (x - next) + sum_;
    sum_ = next;
  }
  double value() const { return sum_ + rest_; }
  double sum() const { return sum_; }
  double rest() const { return rest_; }

 private:
  double sum_ = 0, rest_ = 0;
};

}  // namespace silt
