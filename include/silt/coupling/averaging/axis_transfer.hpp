// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/averaging/axis_range.hpp>

namespace silt::inline SILT_TARGET {

/// Transfer from coarse cells to fine cells of the same total length in one direction: fine cell f
/// gets the share T_fc of coarse cell c. sum_f T_fc = 1 (conservation); sum_c T_fc is the ratio of
/// their sizes (a uniform field remains uniform). Any numbers of cells with at least as many fine
/// as coarse ones.
///
///   constant  T_fc = the part of c that is in f
///   linear    T_fc = integral over f of the hat function of c, over its own; folded at walls,
///             constant beyond the last centre
///
/// With equal numbers of cells T is 1 in both cases.
struct AxisTransfer {
  struct Part {
    int coarse;
    double weight;
  };
  int fine_cells, coarse_cells;
  DynArray<int> first;   // first part of each fine cell, and their number
  DynArray<Part> parts;  // by fine cell
  DynArray<int> first_of_coarse;
  struct FinePart {
    int fine;
    double weight;
  };
  DynArray<FinePart> fine_parts;  // the same, by coarse cell

  AxisTransfer(int fine, int coarse, bool periodic, bool linear)
      : fine_cells(fine), coarse_cells(coarse) {
    const double ratio = static_cast<double>(coarse) / fine;
    DynArray<double> row(static_cast<std::size_t>(coarse));
    DynArray<DynArray<FinePart>> columns(row.size());
    for (int f = 0; f < fine; ++f) {
      const double low = f * ratio, high = (f + 1) * ratio;
      first.push_back(static_cast<int>(parts.size()));
      std::fill(row.begin(), row.end(), 0.0);
      const bool hat = linear && fine != coarse;
      const double beyond = hat ? 0.5 : 0;
      const AxisRange range(static_cast<int>(std::floor(low - beyond)),
                            static_cast<int>(std::ceil(high + beyond)) - 1, coarse, periodic);
      for (int c = range.low; c <= range.high; ++c) {
        const double u = low - c - 0.5, v = high - c - 0.5;
        const double w = fine == coarse ? (c == f ? 1.0 : 0.0)
                         : hat          ? hat_integral(v) - hat_integral(u)
                                        : std::max(0.0, std::min(v, 0.5) - std::max(u, -0.5));
        row[static_cast<std::size_t>(range.start + range.place(c)) % row.size()] += w;
      }
      for (std::size_t c = 0; c < row.size(); ++c)
        if (row[c] > 0) {
          parts.push_back({static_cast<int>(c), row[c]});
          columns[c].push_back({f, row[c]});
        }
    }
    first.push_back(static_cast<int>(parts.size()));
    for (const auto& column : columns) {
      first_of_coarse.push_back(static_cast<int>(fine_parts.size()));
      fine_parts.insert(fine_parts.end(), column.begin(), column.end());
    }
    first_of_coarse.push_back(static_cast<int>(fine_parts.size()));
  }

  /// Calls use(coarse, weight) for fine cell f, and use(fine, weight) for coarse cell c.
  template <class Use>
  void of_fine(int f, const Use& use) const {
    const auto n = static_cast<std::size_t>(f);
    for (int m = first[n]; m < first[n + 1]; ++m)
      use(parts[static_cast<std::size_t>(m)].coarse, parts[static_cast<std::size_t>(m)].weight);
  }
  template <class Use>
  void of_coarse(int c, const Use& use) const {
    const auto n = static_cast<std::size_t>(c);
    for (int m = first_of_coarse[n]; m < first_of_coarse[n + 1]; ++m)
      use(fine_parts[static_cast<std::size_t>(m)].fine,
          fine_parts[static_cast<std::size_t>(m)].weight);
  }

 private:
  /// Integral of the hat 1 - |t| from -1 to u.
  static double hat_integral(double u) {
    const double x = std::clamp(u, -1.0, 1.0);
    return 0.5 + x - 0.5 * x * std::abs(x);
  }
};

}  // namespace silt
