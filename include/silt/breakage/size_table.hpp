// silt - BSD-3-Clause, see LICENSE
#pragma once
#include <vector>
namespace silt::inline SILT_TARGET {
struct SizeTable {
  double m = 0, n = 0;
  void add(double, double mass, double number, double) { m += mass, n += number; }
  double mass() const { return m; }
  std::vector<double> state() const { return {m, n}; }
  static bool is_state(const std::vector<double>& s) { return s.size() == 2; }
  void restore(const std::vector<double>& s) { m = s[0], n = s[1]; }
};
}
