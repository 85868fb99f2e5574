// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/target.hpp>
#include <silt/core/threads.hpp>
#include <silt/fluid/components.hpp>
#include <silt/fluid/double_rows.hpp>
#include <silt/fluid/grid.hpp>
#include <silt/fluid/level.hpp>

namespace silt::inline SILT_TARGET::fluid_detail {

/// Coefficients of PressureSolver in the caller's fields, in double; converts them to those of the
/// finest level, times a power of two that fits them into floats.
class PressureCoefficients {
 public:
  /// Takes and checks the fields, which must outlive this object; sets a, d and the inverse of
  /// `level`.
  void set(const std::array<const CellField*, 4>& fields, Level& level, const Team& team) {
    fields_ = fields;
    const double largest = convert(level, team);
    if (largest > 0 && !(largest * scale_ >= 1e-3 && largest * scale_ <= 1e3)) {
      scale_ = std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1000, 1000));
      convert(level, team);
    }
  }
  /// Ratio of a coefficient of the finest level to that of the fields.
  double scale() const { return scale_; }

  /// Connected sets of cells; computed again only if a face or a cell has opened or closed.
  const Components& components() {
    if (changed_) components_.find(openings_, grid().cells());
    changed_ = false;
    return components_;
  }

  /// r of plane k of `level` = scale (b - A p); returns |b - A p|^2 of the plane.
  double residual_plane(int k, const CellField& b, const CellField& p, double scale,
                        Level& level) const {
    double sum = 0;
    for (int j = 0; j < grid().ny(); ++j) {
      const int low_j = level.before(1, j), high_j = level.after(1, j);
      const int low_k = level.before(2, k), high_k = level.after(2, k);
      const auto face = [&](std::size_t c, int i, int row_j, int row_k) {
        const bool open = level.n[c] > 1 && (i > 0 || level.wraps[c]);
        return open ? fields_[c]->row(row_j, row_k) : nullptr;
      };
      const DoubleRows rows{fields_[0]->row(j, k),
                            {face(1, j, j, k), face(1, high_j, high_j, k), face(2, k, j, k),
                             face(2, high_k, j, high_k)},
                            fields_[3]->row(j, k),
                            p.row(j, k),
                            {p.row(low_j, k), p.row(high_j, k), p.row(j, low_k), p.row(j, high_k)}};
      sum += residual_row(grid().nx(), level.wraps[0], rows, b.row(j, k), scale,
                          level.r.data() + level.begin(j, k), level.half);
    }
    return sum;
  }

 private:
  struct Plane {
    double largest = 0;
    bool changed = false, valid = true;
  };
  const Grid& grid() const { return fields_[0]->grid(); }

  /// Returns the largest coefficient.
  double convert(Level& level, const Team& team) {
    if (openings_.empty()) openings_.assign(grid().size(), 0);
    planes_.assign(static_cast<std::size_t>(grid().nz()), {});
    team.for_parts(planes_.size(),
                   [&](std::size_t k) { convert_plane(static_cast<int>(k), level); });
    double largest = 0;
    for (const Plane& plane : planes_) changed_ |= plane.changed;
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      if (!planes_[k].valid) refuse_plane(static_cast<int>(k), level);
      largest = std::max(largest, planes_[k].largest);
    }
    team.for_parts(planes_.size(),
                   [&](std::size_t k) { level.invert_diagonal(static_cast<int>(k)); });
    return largest;
  }

  void convert_plane(int k, Level& level) {
    Plane& plane = planes_[static_cast<std::size_t>(k)];
    std::array<double, 4> sums{};
    const int n = grid().nx();
    DynArray<float> rows(4 * static_cast<std::size_t>(n));  // ax, ay, az, d in the order of i
    for (int j = 0; j < grid().ny(); ++j) {
      const std::size_t at = level.begin(j, k);
      const bool closed[4] = {false, j == 0 && !level.wraps[1], k == 0 && !level.wraps[2], false};
      for (std::size_t c = 0; c < 4; ++c) {
        float* to = rows.data() + c * static_cast<std::size_t>(n);
        if (closed[c])
          std::fill(to, to + n, 0.0f);
        else
          convert_row(n, c == 0 && !level.wraps[0], scale_, fields_[c]->row(j, k), to, sums[c],
                      plane.largest, plane.valid);
        split_halves(n, to, (c < 3 ? level.a[c] : level.d).data() + at, level.half);
      }
      level.wrap_row(level.a[0].data() + at);
      const std::size_t cell = static_cast<std::size_t>(n) * level.row_number(j, k);
      plane.changed |= mark_openings(n, rows.data(), openings_.data() + cell);
    }
    level.plane_sums[static_cast<std::size_t>(k)] = {sums[0], sums[1], sums[2]};
  }

  /// Reports the wrong coefficient of plane k.
  [[gnu::cold]] void refuse_plane(int k, const Level& level) const {
    constexpr const char* names[4] = {"ax", "ay", "az", "d"};
    for (std::size_t f = 0; f < 4; ++f)
      for (int j = 0; j < grid().ny(); ++j)
        for (int i = 0; i < grid().nx(); ++i) {
          const int at[3] = {i, j, k};
          if (f < 3 && at[f] == 0 && !level.wraps[f]) continue;
          const double v = (*fields_[f])(i, j, k);
          require(v >= 0 && std::isfinite(v), "PressureSolver: coefficient ", names[f], "(", i,
                  ", ", j, ", ", k, ") = ", v, " must be finite and not negative");
        }
  }

  std::array<const CellField*, 4> fields_{};  // ax, ay, az, d
  DynArray<Plane> planes_;
  Openings openings_;
  Components components_;
  double scale_ = 1;
  bool changed_ = true;
};

}  // namespace silt::inline SILT_TARGET::fluid_detail
