// silt - BSD-3-Clause, see LICENSE
#pragma once

// Measured fronts and heights of collapsing columns, and how a computed front is compared with
// them. The original papers were not read.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace dam_break {

/// A table of T = t sqrt(2 g/a) and a length over its unit.
struct Curve {
  std::string name, file;
  std::vector<double> T, value;

  double at(double when) const {  // between the rows; before and after them the first and last
    const auto after =
        static_cast<std::size_t>(std::upper_bound(T.begin(), T.end(), when) - T.begin());
    if (after == 0) return value.front();
    if (after == T.size()) return value.back();
    const double share = (when - T[after - 1]) / (T[after] - T[after - 1]);
    return value[after - 1] + share * (value[after] - value[after - 1]);
  }
};

/// Z = x/a of the front, of a column with the width a and the height 2 a, a = 2.25 in.
/// Source: J. C. Martin, W. J. Moyce, Phil. Trans. R. Soc. Lond. A 244 (1952) 312, table 2, as
///   printed by others (Ocellaris, PySPH).
inline Curve martin_moyce_front() {
  return {
      "Martin and Moyce (1952)",
      "front_martin_moyce.csv",
      {0.41, 0.84, 1.19, 1.43, 1.63, 1.83, 1.98, 2.20, 2.32, 2.51, 2.65, 2.83, 2.98, 3.11, 3.33},
      {1.11, 1.22, 1.44, 1.67, 1.89, 2.11, 2.33, 2.56, 2.78, 3.00, 3.22, 3.44, 3.67, 3.89, 4.11}};
}
/// The same for a column of water 0.146 m wide.
/// Source: S. Koshizuka, Y. Oka, Nucl. Sci. Eng. 123 (1996) 421, as printed by others (PySPH).
inline Curve koshizuka_oka_front() {
  return {"Koshizuka and Oka (1996)",
          "front_koshizuka_oka.csv",
          {0.381, 0.769, 1.153, 1.537, 1.935, 2.323, 2.719, 3.096},
          {1.111, 1.252, 1.505, 1.892, 2.241, 2.615, 3.003, 3.624}};
}
/// H = z/(2 a) at the wall.
/// Source: Martin and Moyce, table 6, as printed by others (Ocellaris); its times are t sqrt(g/a).
inline Curve martin_moyce_height() {
  Curve c{"Martin and Moyce (1952)",
          "height_martin_moyce.csv",
          {0.56, 0.77, 0.93, 1.08, 1.28, 1.46, 1.66, 1.84, 2.0, 2.21, 2.45, 2.7, 3.06, 3.44},
          {.94, .89, .83, .78, .72, .67, .61, .56, .5, .44, .39, .33, .28, .22}};
  for (double& T : c.T) T *= std::sqrt(2.0);
  return c;
}

/// Rms difference of a computed curve and a measured one: over the measured values, and absolute.
struct Distance {
  double share = 0, plain = 0;  // [-]
};
/// The computed curve is evaluated at T - late.
inline Distance distance(const Curve& computed, const Curve& measured, double late) {
  Distance sum;
  double rows = 0;
  for (std::size_t k = 0; k < measured.T.size(); ++k) {
    if (measured.T[k] > computed.T.back()) continue;
    const double off = computed.at(measured.T[k] - late) - measured.value[k];
    sum.plain += off * off, sum.share += std::pow(off / measured.value[k], 2), rows += 1;
  }
  return {std::sqrt(sum.share / rows), std::sqrt(sum.plain / rows)};
}
/// Delay of the measured front: the one with the smallest difference.
inline double lateness(const Curve& computed, const Curve& measured) {
  double best = 0, least = std::numeric_limits<double>::infinity();
  for (double late = -0.5; late < 1; late += 0.001)
    if (const double d = distance(computed, measured, late).share; d < least)
      least = d, best = late;
  return best;
}

}  // namespace dam_break
