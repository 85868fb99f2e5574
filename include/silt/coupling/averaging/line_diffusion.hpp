// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/averaging/concept.hpp>
#include <silt/coupling/averaging/stencil_rows.hpp>

namespace silt::inline SILT_TARGET {

/// Implicit diffusion of cell fields, direction by direction (locally one-dimensional). A step is
///
///   f <- (s + k L_z)^-1 s (s + k L_y)^-1 s (s + k L_x)^-1 s f,   k = D dt / h^2 of the direction
///   (1)
///
/// with s the open share of each cell, and L the second difference without flux through walls and
/// blocked cells, wrapped in periodic directions. Each factor keeps uniform fields uniform, is
/// positive, and is symmetric in the product sum s f g; therefore it conserves the sum of s f. The
/// adjoint of the whole product in it is the product in the opposite order. A line is solved by
/// elimination; in periodic directions the closing term k w w^T with w = e_first - e_last is added
/// by the Sherman-Morrison formula.
///
/// Source: N. N. Yanenko, The method of fractional steps (1971). Values in ghosts are lost.
/// Tests:  tests/coupling/averaging_diffusion.cpp.
class LineDiffusion {
 public:
  /// `spread2` [m2]: D dt of one step.
  LineDiffusion(const Grid& grid, double spread2) : grid_(grid) {
    const double h[3] = {grid.h().x, grid.h().y, grid.h().z};
    for (std::size_t d = 0; d < 3; ++d) k_[d] = spread2 / (h[d] * h[d]);
    make(nullptr);
  }
  void open(const CellField& cells) { make(&cells); }

  void step(CellFields f, const Team& team) const {
    for_planes(team, [&](int k) {
      for (CellField* field : f) along_x(*field, k), along_y(*field, k);
    });
    for_rows(team, [&](int j) {
      for (CellField* field : f) along_z(*field, j);
    });
  }
  void adjoint_step(CellFields f, const Team& team) const {
    for_rows(team, [&](int j) {
      for (CellField* field : f) along_z(*field, j);
    });
    for_planes(team, [&](int k) {
      for (CellField* field : f) along_y(*field, k), along_x(*field, k);
    });
  }

 private:
  using Pack = detail::StencilPack;

  /// For the cells: f_i inverse + lower f_(i-1), then + upper f_(i+1), then - closing (f_0 -
  /// f_last). Rows of all x; common to all lines, or one per line.
  struct Axis {
    AlignedVector<double> inverse, lower, upper, closing;
    std::size_t of_j = 0, of_k = 0;  // from row to row
    bool periodic = false;
  };
  struct LineCell {
    double inverse, lower, upper, closing;
  };

  /// Coefficients of one line of n cells with the open shares share(m).
  template <class Share, class Set>
  static void factorise(int n, bool periodic, double k, const Share& share, const Set& set) {
    const auto open = [&](int m) { return share(m) > 0; };
    DynArray<LineCell> c(static_cast<std::size_t>(n));
    const auto at = [&](int m) -> LineCell& { return c[static_cast<std::size_t>(m)]; };
    const auto bond = [&](int m) { return m > 0 && m < n && open(m) && open(m - 1) ? k : 0.0; };
    for (int m = 0; m < n; ++m) {
      const double before = bond(m), after = bond(m + 1);
      double middle = (open(m) ? share(m) : 1) + before + after;
      if (m > 0) middle -= before * before * at(m - 1).inverse;
      at(m) = {1 / middle, before / middle, after / middle, 0};
    }
    if (periodic && n > 1 && open(0) && open(n - 1)) {
      // z = A^-1 w, k/(1 + k w.z) z
      for (int m = 0; m < n; ++m)
        at(m).closing = ((m == 0) - (m == n - 1)) * at(m).inverse +
                        (m > 0 ? at(m).lower * at(m - 1).closing : 0);
      for (int m = n - 2; m >= 0; --m) at(m).closing += at(m).upper * at(m + 1).closing;
      const double scale = k / (1 + k * (at(0).closing - at(n - 1).closing));
      for (auto& cell : c) cell.closing *= scale;
    }
    for (int m = 0; m < n; ++m) {
      if (open(m)) at(m).inverse *= share(m);
      set(m, at(m));
    }
  }

  void make(const CellField* cells) {
    const std::size_t row = static_cast<std::size_t>(detail::padded(grid_.nx()));
    const int n[3] = {grid_.nx(), grid_.ny(), grid_.nz()};
    for (int d = 0; d < 3; ++d) {
      Axis& axis = axes_[static_cast<std::size_t>(d)];
      axis.periodic = grid_.periodic(d) && n[d] > 1;
      const bool each = cells != nullptr;
      axis.of_j = each || d == 1 ? row : 0;
      axis.of_k = each ? row * static_cast<std::size_t>(n[1]) : d == 2 ? row : 0;
      const std::size_t size = each ? row * static_cast<std::size_t>(n[1] * n[2])
                                    : row * static_cast<std::size_t>(d == 0 ? 1 : n[d]);
      for (auto* a : {&axis.inverse, &axis.lower, &axis.upper, &axis.closing}) a->assign(size, 0.0);
      // Lines of d; those of the other directions once if they are all equal.
      const int e = (d + 1) % 3, g = (d + 2) % 3;
      for (int b = 0; b < (each || g == 0 ? n[g] : 1); ++b)
        for (int a = 0; a < (each || e == 0 ? n[e] : 1); ++a) {
          int at[3];
          at[e] = a, at[g] = b;
          factorise(
              n[d], axis.periodic, k_[static_cast<std::size_t>(d)],
              [&](int m) {
                at[d] = m;
                return cells ? (*cells)(at[0], at[1], at[2]) : 1.0;
              },
              [&](int m, const LineCell& c) {
                at[d] = m;
                const std::size_t i = static_cast<std::size_t>(at[0]) +
                                      static_cast<std::size_t>(at[1]) * axis.of_j +
                                      static_cast<std::size_t>(at[2]) * axis.of_k;
                axis.inverse[i] = c.inverse, axis.lower[i] = c.lower;
                axis.upper[i] = c.upper, axis.closing[i] = c.closing;
              });
        }
    }
  }

  template <class Body>
  void for_planes(const Team& team, const Body& body) const {
    team.for_parts(static_cast<std::size_t>(grid_.nz()),
                   [&](std::size_t k) { body(static_cast<int>(k)); });
  }
  template <class Body>
  void for_rows(const Team& team, const Body& body) const {
    team.for_parts(static_cast<std::size_t>(grid_.ny()),
                   [&](std::size_t j) { body(static_cast<int>(j)); });
  }
  static std::size_t place(const Axis& a, int j, int k) {
    return static_cast<std::size_t>(j) * a.of_j + static_cast<std::size_t>(k) * a.of_k;
  }

  /// Rows in blocks: each depends only on its own last result.
  void along_x(CellField& f, int k) const {
    if (grid_.nx() < 2 || k_[0] == 0) return;
    constexpr int block = 8;
    int j = 0;
    for (; j + block <= grid_.ny(); j += block) rows_along_x<block>(f, j, k);
    for (; j < grid_.ny(); ++j) rows_along_x<1>(f, j, k);
  }
  template <int Rows>
  void rows_along_x(CellField& f, int j, int k) const {
    const Axis& a = axes_[0];
    const int n = grid_.nx();
    double* v = f.row(j, k);
    const std::size_t stride = grid_.row_stride();
    const std::size_t at = place(a, j, k);
    const double *inverse = &a.inverse[at], *lower = &a.lower[at], *upper = &a.upper[at];
    double last[Rows] = {};
    for (int i = 0; i < n; ++i)
#pragma GCC unroll 8
      for (int r = 0; r < Rows; ++r) {
        const auto c = static_cast<std::size_t>(r) * a.of_j + static_cast<std::size_t>(i);
        double& value = v[static_cast<std::size_t>(r) * stride + static_cast<std::size_t>(i)];
        value = last[r] = value * inverse[c] + lower[c] * last[r];
      }
    for (int r = 0; r < Rows; ++r) last[r] = 0;
    for (int i = n - 1; i >= 0; --i)
#pragma GCC unroll 8
      for (int r = 0; r < Rows; ++r) {
        const auto c = static_cast<std::size_t>(r) * a.of_j + static_cast<std::size_t>(i);
        double& value = v[static_cast<std::size_t>(r) * stride + static_cast<std::size_t>(i)];
        value = last[r] = value + upper[c] * last[r];
      }
    if (!a.periodic) return;
    for (int r = 0; r < Rows; ++r) {
      double* row = v + static_cast<std::size_t>(r) * stride;
      const double* closing = &a.closing[at + static_cast<std::size_t>(r) * a.of_j];
      const Pack jump(row[0] - row[n - 1]);
      for (int i = 0; i < n; i += detail::stencil_lanes)
        store(row + i, load<Pack>(row + i) - load<Pack>(closing + i) * jump);
    }
  }

  void along_y(CellField& f, int k) const {
    if (grid_.ny() > 1)
      along_rows(
          axes_[1], grid_.ny(), [&](int j) { return f.row(j, k); },
          [&](int j) { return place(axes_[1], j, k); });
  }
  void along_z(CellField& f, int j) const {
    if (grid_.nz() > 1)
      along_rows(
          axes_[2], grid_.nz(), [&](int k) { return f.row(j, k); },
          [&](int k) { return place(axes_[2], j, k); });
  }
  template <class Row, class Place>
  void along_rows(const Axis& a, int n, const Row& row, const Place& at) const {
    const int nx = grid_.nx();
    for (int m = 0; m < n; ++m) {
      double* v = row(m);
      const double *before = m > 0 ? row(m - 1) : v, *inverse = &a.inverse[at(m)],
                   *lower = &a.lower[at(m)];
      for (int i = 0; i < nx; i += detail::stencil_lanes) {
        const Pack own = load<Pack>(v + i) * load<Pack>(inverse + i);
        store(v + i, multiply_add(load<Pack>(lower + i), load<Pack>(before + i), own));
      }
    }
    for (int m = n - 2; m >= 0; --m) {
      double* v = row(m);
      const double *after = row(m + 1), *upper = &a.upper[at(m)];
      for (int i = 0; i < nx; i += detail::stencil_lanes)
        store(v + i, multiply_add(load<Pack>(upper + i), load<Pack>(after + i), load<Pack>(v + i)));
    }
    if (!a.periodic) return;
    const double *first = row(0), *last = row(n - 1);
    for (int i = 0; i < nx; i += detail::stencil_lanes) {
      const Pack jump = load<Pack>(first + i) - load<Pack>(last + i);
      for (int m = 0; m < n; ++m) {
        double* v = row(m) + i;
        store(v, load<Pack>(v) - load<Pack>(&a.closing[at(m)] + i) * jump);
      }
    }
  }

  Grid grid_;
  std::array<double, 3> k_{};
  std::array<Axis, 3> axes_;
};

}  // namespace silt
