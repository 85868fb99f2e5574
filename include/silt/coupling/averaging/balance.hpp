// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/averaging/stencils.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Sets to 1 all cells within `reach` cells, in each direction, of a cell that is not 0.
inline void widen(CellField& marks, const std::array<int, 3>& reach) {
  const Grid& g = marks.grid();
  const auto& n = g.cells();
  DynArray<double> line;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t a = (d + 1) % 3, b = (d + 2) % 3;
    const bool wraps = g.periodic(static_cast<int>(d));
    line.resize(static_cast<std::size_t>(n[d]));
    for (int v = 0; v < n[b]; ++v)
      for (int u = 0; u < n[a]; ++u) {
        std::array<int, 3> at{};
        at[a] = u, at[b] = v;
        const auto value = [&](int m) -> double& {
          at[d] = (m % n[d] + n[d]) % n[d];
          return marks(at[0], at[1], at[2]);
        };
        for (int m = 0; m < n[d]; ++m) line[static_cast<std::size_t>(m)] = value(m);
        for (int m = 0; m < n[d]; ++m) {
          if (line[static_cast<std::size_t>(m)] == 0) continue;
          const int most = std::min(reach[d], n[d]);
          for (int s = m - most; s <= m + most; ++s)
            if (wraps || (s >= 0 && s < n[d])) value(s) = 1;
        }
      }
  }
}

/// Factors b on the open shares o of cells that keep a uniform cloud uniform at walls.
///
/// With weights normalised per particle, phi_pc o_c / sum_c phi_pc o_c, cells at walls get a
/// quarter too little, because fewer particles have them in range. With b
///
///   w_pc = phi_pc o_c b_c / sum_c phi_pc o_c b_c,   sum_s V_s w_sc = V o_c                   (1)
///
/// also for the samples s of a uniform cloud: eight per cell, each with the open volume V_s of its
/// octant, interpolated linearly between cells; one per cell if weights extend over several cells.
/// The two conditions are satisfied alternately. Cells far from walls have b = 1.
/// Source: R. Sinkhorn, P. Knopp, Pacific J. Math. 21 (1967) 343.
/// Tests:  tests/coupling/averaging_walls.cpp.
class Balance {
 public:
  static constexpr int turns = 4;
  static constexpr double least = 0.1;  // bound of b and 1/b, for corners that no iteration would
                                        // fill

  /// Opens the cells of `on`. `fine`: open share of the fluid's cells; `open`: of the cells of
  /// `on`, which may be another grid. source_of(particles) is the argument of Stencils::place;
  /// `diameter` [m] of particles. Returns b; the weights of cells are then o b.
  template <class SourceOf>
  static CellField open(Stencils& on, const CellField& fine, const CellField& open, double diameter,
                        const SourceOf& source_of, const Team& team) {
    on.open(open);
    Balance balance(fine, open, diameter);
    if (!balance.find_near(source_of)) return balance.b_;
    const Grid& g = open.grid();
    Stencils stencils(g);
    CellField all(g), sum(g);
    balance.add_samples(true, stencils, source_of, all, team);
    for (int turn = 0; turn < turns; ++turn) {
      stencils.weigh(balance.weights());
      balance.add_samples(false, stencils, source_of, sum, team);
      for_cells(g, [&](int i, int j, int k) {
        if (balance.cells_(i, j, k) > 0 && sum(i, j, k) > 0)
          balance.b_(i, j, k) = std::clamp(all(i, j, k) / sum(i, j, k), least, 1 / least);
      });
    }
    on.weigh(balance.weights());
    return balance.b_;
  }

 private:
  Balance(const CellField& fine, const CellField& open, double diameter)
      : fine_(fine),
        open_(open),
        radius_(0.5 * diameter),
        b_(open.grid(), 1),
        cells_(open.grid()),
        sampled_(open.grid()) {}

  template <class Use>
  static void for_cells(const Grid& g, const Use& use) {
    for (int k = 0; k < g.nz(); ++k)
      for (int j = 0; j < g.ny(); ++j)
        for (int i = 0; i < g.nx(); ++i) use(i, j, k);
  }
  CellField weights() const {
    CellField w = open_;
    for_cells(w.grid(), [&](int i, int j, int k) { w(i, j, k) *= b_(i, j, k); });
    return w;
  }
  static constexpr int eighths = 8;
  static Vec3d eighth(int n) {
    return {n & 1 ? 0.25 : -0.25, n & 2 ? 0.25 : -0.25, n & 4 ? 0.25 : -0.25};
  }
  Vec3d place(int i, int j, int k, int n) const {
    if (samples_ == 1) return fine_.grid().centre(i, j, k);
    const Vec3d &h = fine_.grid().h(), by = eighth(n);
    return fine_.grid().centre(i, j, k) + Vec3d{by.x * h.x, by.y * h.y, by.z * h.z};
  }

  /// Cells with a factor, and the cells of samples in their range; returns whether there are any.
  template <class SourceOf>
  bool find_near(const SourceOf& source_of) {
    std::array<int, 3> reach{};
    for (int n = 0; n < eighths; ++n) {
      const Vec3d x[] = {place(0, 0, 0, n)};
      const AveragedParticles one{x, std::span(&radius_, 1)};
      std::array<AxisRange, 3> r;
      source_of(one).ranges(0, r);
      for (std::size_t d = 0; d < 3; ++d) reach[d] = std::max({reach[d], -r[d].low, r[d].high});
    }
    if (std::min({reach[0], reach[1], reach[2]}) > 3) samples_ = 1;
    const Grid& g = open_.grid();
    for_cells(g, [&](int i, int j, int k) { cells_(i, j, k) = open_(i, j, k) < 1 - 1e-12; });
    widen(cells_, {2 * reach[0], 2 * reach[1], 2 * reach[2]});
    bool any = false;
    for_cells(g, [&](int i, int j, int k) {
      if (!(open_(i, j, k) > 0)) cells_(i, j, k) = 0;
      any |= cells_(i, j, k) > 0;
    });
    sampled_ = cells_;
    widen(sampled_, reach);
    return any;
  }

  /// Open volume of each octant of a cell, in cells.
  std::array<double, eighths> open_eighths(int i, int j, int k) const {
    const Grid& g = fine_.grid();
    std::array<double, eighths> part{};
    double sum = 0;
    for (int n = 0; n < eighths; ++n) {
      const auto c = static_cast<std::size_t>(n);
      for (int m = 0; m < 8; ++m) {
        double weight = 1;
        int to[3] = {i, j, k};
        for (int d = 0; d < 3; ++d) {
          const bool next = m >> d & 1;
          weight *= next ? 0.25 : 0.75;
          const int cells = g.cells()[static_cast<std::size_t>(d)];
          if (next) to[d] += n >> d & 1 ? 1 : -1;
          to[d] = g.periodic(d) ? (to[d] + cells) % cells : std::clamp(to[d], 0, cells - 1);
        }
        part[c] += weight * fine_(to[0], to[1], to[2]);
      }
      sum += part[c];
    }
    for (double& p : part) p *= fine_(i, j, k) / sum;
    return part;
  }

  /// sum_s V_s phi_sc / seen_s over the samples, in volumes of a fine cell; `all`: as without
  /// walls.
  template <class SourceOf>
  void add_samples(bool all, Stencils& stencils, const SourceOf& source_of, CellField& sum,
                   const Team& team) const {
    constexpr std::size_t at_once = std::size_t{1} << 17;
    const Grid &f = fine_.grid(), &g = open_.grid();
    DynArray<Vec3d> places;
    DynArray<double> amounts;
    CellField part(g);
    sum.fill(0);
    const auto add = [&] {
      const DynArray<double> radii(places.size(), radius_);
      const AveragedParticles samples{places, radii};
      stencils.place(places.size(), source_of(samples), team);
      const std::span<const double> from[] = {amounts};
      CellField* const to[] = {&part};
      stencils.spread(from, to, team);
      for_cells(g, [&](int i, int j, int k) { sum(i, j, k) += part(i, j, k); });
      places.clear(), amounts.clear();
    };
    const auto coarse = [&](int at, std::size_t d) {
      return static_cast<int>((at + 0.5) * g.cells()[d] / f.cells()[d]);
    };
    for_cells(f, [&](int i, int j, int k) {
      if (sampled_(coarse(i, 0), coarse(j, 1), coarse(k, 2)) == 0) return;
      if (!all && !(fine_(i, j, k) > 0)) return;
      std::array<double, eighths> amount;
      amount.fill(1.0 / samples_);
      if (!all && fine_(i, j, k) < 1) {
        if (samples_ == 1)
          amount[0] = fine_(i, j, k);
        else
          amount = open_eighths(i, j, k);
      }
      for (int n = 0; n < samples_; ++n)
        places.push_back(place(i, j, k, n)), amounts.push_back(amount[static_cast<std::size_t>(n)]);
      if (places.size() >= at_once) add();
    });
    if (!places.empty()) add();
  }

  const CellField &fine_, &open_;
  double radius_;
  int samples_ = eighths;  // of a cell
  CellField b_, cells_, sampled_;
};

}  // namespace silt::inline SILT_TARGET::detail
