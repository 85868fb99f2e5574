// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/target.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// A box divided into nx x ny x nz equal cells, periodic or not in each direction: mesh of the
/// built-in flow solver, and memory layout of all its fields.
///
/// Cell (i, j, k) extends from box.min + (i, j, k) h to box.min + (i+1, j+1, k+1) h. Values of a
/// cell field are at the cell centres. Value (i, j, k) of a face field of one direction is at the
/// LOWER face of that cell in that direction; n is the index of the uppermost face. i runs fastest.
/// There are `ghost` layers of cells beyond each side. Rows (all i of one j, k) begin on a 64-byte
/// boundary and are padded to whole vectors of 8 doubles.
///
/// Errors: InputError for a box without volume or not finite, for no cells, or too many.
/// Tests:  tests/fluid/grid.cpp.
class Grid {
 public:
  static constexpr int ghost = 2;                  // layers of cells beyond each side [-]
  static constexpr std::size_t vector = 8;         // doubles in 64 bytes [-]
  static constexpr int most_cells_across = 65536;  // in one direction [-]

  Grid(const Box& box, const std::array<int, 3>& cells, const std::array<bool, 3>& periodic = {})
      : box_(box), cells_(cells), periodic_(periodic) {
    constexpr const char* names = "xyz";
    const Vec3d extent = box.extent();
    const double lengths[3] = {extent.x, extent.y, extent.z};
    double count = 1;
    for (std::size_t d = 0; d < 3; ++d) {
      require(cells[d] >= 1 && cells[d] <= most_cells_across, "Grid: the number of cells in ",
              names[d], " = ", cells[d], " must be in [1, ", most_cells_across, "]");
      const double h = lengths[d] / cells[d];
      require(std::isfinite(lengths[d]) && std::isnormal(h) && h > 0, "Grid: the box from ",
              box.min, " to ", box.max, " [m] cut into ", cells[d], " cells in ", names[d],
              " gives cells of ", h, " [m]; give a finite box whose max is above its min");
      count *= cells[d] + 2.0 * ghost;
    }
    require(count < 2e9, "Grid: ", cells[0], " x ", cells[1], " x ", cells[2],
            " cells are more than 2e9 with their ghosts; use fewer");
    h_ = {extent.x / cells[0], extent.y / cells[1], extent.z / cells[2]};
    stride_ = (static_cast<std::size_t>(cells[0]) + vector - 1) / vector * vector + vector;
    plane_ = stride_ * static_cast<std::size_t>(cells[1] + 2 * ghost + 1);
  }

  const Box& box() const { return box_; }
  int nx() const { return cells_[0]; }
  int ny() const { return cells_[1]; }
  int nz() const { return cells_[2]; }
  const std::array<int, 3>& cells() const { return cells_; }
  bool periodic(int direction) const { return periodic_[static_cast<std::size_t>(direction)]; }
  /// Size of a cell [m].
  const Vec3d& h() const { return h_; }
  double cell_volume() const { return h_.x * h_.y * h_.z; }  // [m3]
  /// Number of cells without ghosts.
  std::size_t size() const {
    return static_cast<std::size_t>(nx()) * static_cast<std::size_t>(ny()) *
           static_cast<std::size_t>(nz());
  }
  /// Centre of cell (i, j, k) [m].
  Vec3d centre(int i, int j, int k) const {
    return {box_.min.x + (i + 0.5) * h_.x, box_.min.y + (j + 0.5) * h_.y,
            box_.min.z + (k + 0.5) * h_.z};
  }

  /// @name Layout of a field
  /// @{
  /// Number of values from row (j, k) to (j + 1, k), and from (j, k) to (j, k + 1).
  std::size_t row_stride() const { return stride_; }
  std::size_t plane_stride() const { return plane_; }
  /// Position of value (i, j, k); each index from -ghost to n + ghost: on faces, of which there is
  /// one more than cells, this gives equal numbers of ghosts at both ends.
  std::size_t index(int i, int j, int k) const {
    const auto at = static_cast<std::ptrdiff_t>(vector) + i;
    return static_cast<std::size_t>(at) + static_cast<std::size_t>(j + ghost) * stride_ +
           static_cast<std::size_t>(k + ghost) * plane_;
  }
  /// Number of values of a field. A row's upper ghosts may overlap the next row's lower ones in
  /// memory.
  std::size_t storage() const {
    return plane_ * static_cast<std::size_t>(nz() + 2 * ghost + 1) + 2 * vector;
  }
  /// @}

  friend bool operator==(const Grid& a, const Grid& b) {
    const auto same = [](const Vec3d& u, const Vec3d& v) {
      return u.x == v.x && u.y == v.y && u.z == v.z;
    };
    return a.cells_ == b.cells_ && a.periodic_ == b.periodic_ && same(a.box_.min, b.box_.min) &&
           same(a.box_.max, b.box_.max);
  }

 private:
  Box box_;
  std::array<int, 3> cells_;
  std::array<bool, 3> periodic_;
  Vec3d h_;
  std::size_t stride_, plane_;
};

/// One number per cell, or per face of one direction, in the layout of a Grid, including ghosts.
class CellField {
 public:
  explicit CellField(const Grid& grid, double value = 0)
      : grid_(grid), values_(grid.storage(), value) {}

  const Grid& grid() const { return grid_; }
  double& operator()(int i, int j, int k) { return values_[grid_.index(i, j, k)]; }
  double operator()(int i, int j, int k) const { return values_[grid_.index(i, j, k)]; }
  /// Value i = 0 of row (j, k), on a 64-byte boundary; other i precede and follow.
  double* row(int j, int k) { return values_.data() + grid_.index(0, j, k); }
  const double* row(int j, int k) const { return values_.data() + grid_.index(0, j, k); }
  /// All numbers in memory order, including ghosts and padding.
  std::span<double> values() { return values_; }
  std::span<const double> values() const { return values_; }
  void fill(double value) { std::fill(values_.begin(), values_.end(), value); }

  /// Fills the ghosts of every periodic direction from the other side, including edges and corners.
  /// Ghosts of other directions do not change.
  void wrap_ghosts() {
    constexpr int g = Grid::ghost;
    const int nx = grid_.nx(), ny = grid_.ny(), nz = grid_.nz();
    const auto wrapped = [](int at, int n) { return (at % n + n) % n; };
    if (grid_.periodic(0))
      for (int k = -g; k < nz + g; ++k)
        for (int j = -g; j < ny + g; ++j) {
          double* values = row(j, k);
          for (int i = 1; i <= g; ++i) {
            values[-i] = values[wrapped(-i, nx)];
            values[nx + i - 1] = values[wrapped(i - 1, nx)];
          }
        }
    const auto copy = [&](int to_j, int to_k, int j, int k) {
      const double* from = row(j, k);
      std::copy(from - g, from + nx + g, row(to_j, to_k) - g);
    };
    if (grid_.periodic(1))
      for (int k = -g; k < nz + g; ++k)
        for (int j = 1; j <= g; ++j) {
          copy(-j, k, wrapped(-j, ny), k);
          copy(ny + j - 1, k, wrapped(j - 1, ny), k);
        }
    if (grid_.periodic(2))
      for (int j = -g; j < ny + g; ++j)
        for (int k = 1; k <= g; ++k) {
          copy(j, -k, j, wrapped(-k, nz));
          copy(j, nz + k - 1, j, wrapped(k - 1, nz));
        }
  }

 private:
  Grid grid_;
  AlignedVector<double> values_;
};

}  // namespace silt
