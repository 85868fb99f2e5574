// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/shape/power_cells.hpp>

/// Weights of a power diagram that give its cells prescribed volumes.
///
/// The volumes are the gradient of a concave function of the weights (semi-discrete optimal
/// transport). Newton's method solves L delta = wanted - V with L of (2) in power_cells.hpp, a
/// graph Laplacian of the neighbours, by L D L^T with the weight of the largest cell fixed. A step
/// is halved until two conditions hold: every cell has at least half of the smallest volume of all
/// cells, initial or prescribed; and the error decreases by the factor 1 - step/2. This converges
/// from all weights without empty cells.
///
/// Source: J. Kitagawa, Q. Merigot, B. Thibert, J. Eur. Math. Soc. 21 (2019) 2603-2651, algorithm
///         1.
/// Tests:  tests/shape/laguerre_cells.cpp

namespace silt::inline SILT_TARGET::detail {

/// Solves A x = b for a symmetric positive definite matrix of dense rows; the lower half is read
/// and overwritten. A pivot lost to rounding keeps its unknown at 0.
inline void solve_definite(DynArray<double>& a, DynArray<double>& b) {
  const std::size_t n = b.size();
  DynArray<double> column(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double pivot = a[k * n + k];
    const double inverse = pivot > 0 ? 1 / pivot : 0;
    for (std::size_t i = k + 1; i < n; ++i) column[i] = a[i * n + k];
    for (std::size_t i = k + 1; i < n; ++i) {
      const double l = column[i] * inverse;
      if (l == 0) continue;
      for (std::size_t j = k + 1; j <= i; ++j) a[i * n + j] -= l * column[j];
      a[i * n + k] = l, b[i] -= l * b[k];
    }
    b[k] *= inverse;
  }
  for (std::size_t k = n; k-- > 0;)
    for (std::size_t j = 0; j < k; ++j) b[j] -= a[k * n + j] * b[k];
}

class VolumeWeights {
 public:
  VolumeWeights(const Polyhedron& body, const DynArray<double>& wanted)
      : wanted_(wanted), all_(body.core_volume()), cells_(body, wanted.size()) {
    held_ =
        static_cast<std::size_t>(std::max_element(wanted.begin(), wanted.end()) - wanted.begin());
  }

  /// Changes weights until all volumes are right to `part` of their own; false if impossible.
  bool fit(PowerSites& sites, double part) {
    if (!start(sites)) return false;
    least_ = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < wanted_.size(); ++i)
      least_ = std::min({least_, 0.5 * wanted_[i], 0.5 * cells_.cells()[i].volume});
    for (int step = 0; step < 100 && worst(part) > part; ++step)
      if (!step_from(sites, 1e-9)) return false;
    return worst(part) <= part;
  }
  /// Fits to rounding: each full step squares the error.
  bool fit(PowerSites& sites) {
    if (!fit(sites, 1e-6)) return false;
    for (int step = 0; step < 2 && step_from(sites, 1);) ++step;
    return true;
  }
  PowerCells& cells() { return cells_; }

 private:
  /// Moves weights towards 0 (Voronoi), where no cell is empty if the sites are inside the body.
  bool start(PowerSites& sites) {
    for (int k = 0; k < 30; ++k) {
      if (cells_.measure(sites, std::numeric_limits<double>::min())) return true;
      for (double& w : sites.weight) w *= k < 29 ? 0.7 : 0;
    }
    return cells_.measure(sites, std::numeric_limits<double>::min());
  }

  /// Largest relative error [-] of a volume. Small volumes count as 1e-6 of the body, whose
  /// rounding they have; in a rough fit as 1e-2 `part` of it.
  double worst(double part) const {
    const double small = std::max(0.01 * part, 1e-6) * all_;
    double most = 0;
    for (std::size_t i = 0; i < wanted_.size(); ++i)
      most = std::max(
          most, std::abs(cells_.cells()[i].volume - wanted_[i]) / std::max(wanted_[i], small));
    return most;
  }
  double error() const {
    double sum = 0;
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      const double e = cells_.cells()[i].volume - wanted_[i];
      sum += e * e;
    }
    return std::sqrt(sum);
  }

  /// A step, halved down to `least_part`; if none is accepted, nothing changes.
  bool step_from(PowerSites& sites, double least_part) {
    const double before = error();
    const auto delta = newton(sites);
    const auto from = sites.weight;
    for (double part = 1; part >= least_part; part *= 0.5) {
      for (std::size_t i = 0; i < from.size(); ++i) sites.weight[i] = from[i] + part * delta[i];
      if (cells_.measure(sites, least_) && error() <= (1 - 0.5 * part) * before) return true;
    }
    sites.weight = from;
    cells_.measure(sites, 0);
    return false;
  }

  DynArray<double> newton(const PowerSites& sites) const {
    const std::size_t n = wanted_.size() - 1;
    const auto row = [&](std::size_t i) { return i < held_ ? i : i - 1; };
    DynArray<double> matrix(n * n, 0), rest(n);
    for (std::size_t i = 0; i <= n; ++i) {
      const auto& cell = cells_.cells()[i];
      if (i != held_) rest[row(i)] = wanted_[i] - cell.volume;
      for (const auto& [j, area] : cell.neighbours) {
        if (j > i) continue;  // each face once, as the later cell has it
        const double slope = area / (2 * norm(sites.at[j] - sites.at[i]));
        if (i != held_) matrix[row(i) * n + row(i)] += slope;
        if (j != held_) matrix[row(j) * n + row(j)] += slope;
        if (i != held_ && j != held_) matrix[row(i) * n + row(j)] -= slope;
      }
    }
    solve_definite(matrix, rest);
    rest.insert(rest.begin() + static_cast<std::ptrdiff_t>(held_), 0.0);
    return rest;
  }

  const DynArray<double> wanted_;  // [m3]
  double all_;                     // [m3] the body's volume
  double least_ = 0;               // [m3] lower bound of all cells
  std::size_t held_;               // the cell with the fixed weight
  PowerCells cells_;
};

}  // namespace silt::detail
