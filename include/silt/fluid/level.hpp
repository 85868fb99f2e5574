// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/target.hpp>
#include <silt/fluid/level_rows.hpp>

namespace silt::inline SILT_TARGET::fluid_detail {

/// Values of a level. Arrays start at different offsets within a page: a kernel reads a dozen
/// arrays at the same index, and a first-level cache holds only about eight lines with the same
/// offset.
template <class Scalar>
class LevelArray {
 public:
  LevelArray() = default;
  /// `number` of the array in the level.
  LevelArray(std::size_t values, std::size_t number)
      : skip_(number * 9 * 64 / sizeof(Scalar)), values_(values + skip_, Scalar(0)) {}
  Scalar* data() { return values_.data() + skip_; }
  const Scalar* data() const { return values_.data() + skip_; }
  Scalar& operator[](std::size_t i) { return values_[skip_ + i]; }
  Scalar operator[](std::size_t i) const { return values_[skip_ + i]; }
  void clear() { std::fill(values_.begin(), values_.end(), Scalar(0)); }

 private:
  std::size_t skip_ = 0;
  AlignedVector<Scalar> values_;
};

/// One grid of the multigrid: coefficients of faces and cells, unknown and right-hand side, in
/// float.
///
/// Every direction wraps; where the grid does not, the faces of index 0 are closed (a = 0).
struct Level {
  std::array<int, 3> n{};                // cells [-]
  std::array<bool, 3> wraps{};           // the last cell is coupled with the first
  std::array<bool, 3> halved{};          // directions in which the next level has half the cells
  std::array<DynArray<float>, 3> width;  // of the cells, in units of the finest [-]
  std::array<LevelArray<float>, 3> a;    // coefficients of the lower faces
  LevelArray<float> d, inverse, x, r;    // diagonal, 1 / (sum a + d) or 0, unknown, right-hand
                                         // side
  DynArray<std::uint8_t> row_has_d;
  DynArray<std::array<double, 3>> plane_sums;  // of a over each plane
  std::ptrdiff_t half = 0;            // from the cells of even i of a row to those of odd i
  std::size_t stride = 0, plane = 0;  // from row to row, from plane to plane

  Level(const std::array<int, 3>& cells, const std::array<bool, 3>& wrap) : n(cells), wraps(wrap) {
    const std::size_t most = pieces(static_cast<std::size_t>(n[0] + 1) / 2, room) * room;
    half = static_cast<std::ptrdiff_t>(most) + room;  // between them i = n and, from the other
                                                      // side, i = -1
    stride = 2 * most + room;
    constexpr std::size_t page = 1024, apart = 21 * 16;  // floats; see LevelArray
    plane = stride * static_cast<std::size_t>(n[1]);
    if (n[1] > 1 && n[2] > 1) plane += (page + apart - plane % page) % page;
    const std::size_t rows = static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(n[2]);
    for (std::size_t c = 0; c < 3; ++c) {
      a[c] = {values(), c};
      width[c].assign(static_cast<std::size_t>(n[c]), 1.0f);
    }
    d = {values(), 6};
    inverse = {values(), 3};
    x = {values(), 4};
    r = {values(), 5};
    row_has_d.assign(rows, 0);
    plane_sums.assign(static_cast<std::size_t>(n[2]), {});
  }
  static std::size_t pieces(std::size_t count, std::size_t size) {
    return (count + size - 1) / size;
  }
  std::size_t values() const { return plane * static_cast<std::size_t>(n[2]) + 2 * room; }
  std::size_t row_number(int j, int k) const {
    return static_cast<std::size_t>(j) +
           static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(k);
  }
  std::size_t begin(int j, int k) const {
    return room + stride * static_cast<std::size_t>(j) + plane * static_cast<std::size_t>(k);
  }
  std::size_t index(int i, int j, int k) const {
    return begin(j, k) + static_cast<std::size_t>(i / 2 + (i % 2) * half);
  }
  /// Cells of one colour are coupled: the last with the first of an odd number.
  bool has_seam() const {
    return (wraps[0] && n[0] % 2 == 1) || (wraps[1] && n[1] % 2 == 1) ||
           (wraps[2] && n[2] % 2 == 1);
  }
  int after(int c, int i) const { return i + 1 == n[static_cast<std::size_t>(c)] ? 0 : i + 1; }
  int before(int c, int i) const { return (i == 0 ? n[static_cast<std::size_t>(c)] : i) - 1; }

  FaceRows faces(int j, int k) const {
    const std::size_t at = begin(j, k);
    return {a[0].data() + at,
            a[1].data() + at,
            a[1].data() + begin(after(1, j), k),
            a[2].data() + at,
            a[2].data() + begin(j, after(2, k)),
            row_has_d[row_number(j, k)] ? d.data() + at : nullptr};
  }
  template <class Float>
  NeighbourRows<Float> neighbours(Float* v, int j, int k) const {
    return {v + begin(j, k), v + begin(before(1, j), k), v + begin(after(1, j), k),
            v + begin(j, before(2, k)), v + begin(j, after(2, k))};
  }
  /// Copies the values at the other end of a row.
  void wrap_row(float* row) const {
    if (!wraps[0]) return;
    const int last = n[0] - 1;
    row[half - 1] = row[last / 2 + (last % 2) * half];
    row[n[0] / 2 + (n[0] % 2) * half] = row[0];
  }
  /// Ratio of the distance of coarse cell centres to that of the fine face i.
  float distance(std::size_t c, int i) const {
    const auto at = [&](int of) { return width[c][static_cast<std::size_t>(of)]; };
    return 0.5f * (at(i) + at(before(static_cast<int>(c), i)));
  }
  /// Inverse of the whole diagonal, from a and d of plane k and of the next.
  void invert_diagonal(int k) {
    for (int j = 0; j < n[1]; ++j) {
      const FaceRows f = faces(j, k);
      const float* own = d.data() + begin(j, k);
      float* out = inverse.data() + begin(j, k);
      bool any = false;
      for (const int h : {0, 1}) {
        const Sides side(h, half);
        for (int m = 0; m < cells_of_half(n[0], h); ++m) {
          const std::ptrdiff_t i = side.own + m;
          const float sum = (f.x[i] + f.x[side.upper + m]) + (f.y_low[i] + f.y_up[i]) +
                            (f.z_low[i] + f.z_up[i]) + own[i];
          any |= own[i] > 0;
          out[i] = sum > 0 ? 1 / sum : 0.0f;
        }
      }
      row_has_d[row_number(j, k)] = any;
    }
  }
};

}  // namespace silt::inline SILT_TARGET::fluid_detail
