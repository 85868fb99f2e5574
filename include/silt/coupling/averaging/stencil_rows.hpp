// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

#include <silt/core/lanes.hpp>
#include <silt/core/target.hpp>

/// Inner loops of averaging: one particle's stencil on rows of fields, with packs along x.
///
/// A product stencil has factors wx, wy, wz; those of x are padded by zeros to whole packs. Fields
/// are padded for a pack that begins at their last cell; values there are unchanged or unused.
namespace silt::inline SILT_TARGET::detail {

/// At most 4 lanes: most stencils are 4 to 13 cells across, and wider packs would be mostly
/// padding.
inline constexpr std::size_t stencil_width = std::min<std::size_t>(Lanes<DefaultArch>::width, 4);
using StencilPack = PackOf<stencil_width>::type;
inline constexpr int stencil_lanes = static_cast<int>(stencil_width);
inline constexpr int stencil_pad = 8;  // factors of x are padded to a multiple of this
static_assert(stencil_pad % stencil_lanes == 0);

constexpr int padded(int n) { return (n + stencil_pad - 1) / stencil_pad * stencil_pad; }

/// Calls body(first, done, count) for the one or two runs of cells of a range of `count` cells from
/// `start` on, on a periodic axis of n: from cell `first` on, after `done` cells of the stencil.
template <class Body>
SILT_INLINE void for_runs(int start, int count, int n, const Body& body) {
  const int before = std::min(count, n - start);
  body(start, 0, before);
  if (before < count) body(0, before, count - before);
}

/// Position of a block of planes and rows of several fields, and its factors.
struct ProductBlock {
  double* const* fields;         // their origins
  const double* const* columns;  // of particles
  std::size_t count, particle;   // of fields; index of the particle
  std::size_t at, row, plane;    // first cell from the origins; strides
  const double *wx, *wy, *wz;
  int rows, planes;
};

/// field[at + k plane + j row + i] += q wx[i] wy[j] wz[k] for Packs packs of i.
template <int Packs>
void add_packs(const ProductBlock& b) {
  StencilPack x[Packs];
#pragma GCC unroll 4
  for (int s = 0; s < Packs; ++s) x[s] = load_any<StencilPack>(b.wx + s * stencil_lanes);
  for (std::size_t n = 0; n < b.count; ++n) {
    double* of_plane = b.fields[n] + b.at;
    const double q = b.columns[n][b.particle];
    for (int k = 0; k < b.planes; ++k, of_plane += b.plane) {
      const double of_rows = q * b.wz[k];
      double* row = of_plane;
      for (int j = 0; j < b.rows; ++j, row += b.row) {
        const StencilPack w(of_rows * b.wy[j]);
#pragma GCC unroll 4
        for (int s = 0; s < Packs; ++s) {
          double* at = row + s * stencil_lanes;
          store_any(at, multiply_add(x[s], w, load_any<StencilPack>(at)));
        }
      }
    }
  }
}
inline void add_product(ProductBlock b, int nx) {
  constexpr int most = 4;
  for (; nx > most * stencil_lanes; nx -= most * stencil_lanes) {
    add_packs<most>(b);
    b.at += most * stencil_lanes, b.wx += most * stencil_lanes;
  }
  const int packs = (nx + stencil_lanes - 1) / stencil_lanes;
  if (packs == 1)
    add_packs<1>(b);
  else if (packs == 2)
    add_packs<2>(b);
  else if (packs == 3)
    add_packs<3>(b);
  else
    add_packs<4>(b);
}

/// Sums w[j] f_q[j stride + i] of several fields and packs over rows; then times wx[i].
template <int Fields, int Packs>
struct RowSums {
  StencilPack sum[Fields][Packs];

  RowSums() {
    for (auto& of : sum)
      for (auto& s : of) s = StencilPack(0.0);
  }
  SILT_INLINE void add(const double* const* fields, std::size_t at, std::size_t stride, double wz,
                       const double* wy, int rows) {
    for (int j = 0; j < rows; ++j, at += stride) {
      const StencilPack w(wz * wy[j]);
#pragma GCC unroll 4
      for (int f = 0; f < Fields; ++f)
#pragma GCC unroll 4
        for (int s = 0; s < Packs; ++s)
          sum[f][s] =
              multiply_add(w, load_any<StencilPack>(fields[f] + at + s * stencil_lanes), sum[f][s]);
    }
  }
  /// Where wx is 0 a pack may contain any value.
  SILT_INLINE void close(const double* wx, double* to) const {
#pragma GCC unroll 4
    for (int f = 0; f < Fields; ++f) {
      double total = 0;
#pragma GCC unroll 4
      for (int s = 0; s < Packs; ++s) {
        const auto w = load_any<StencilPack>(wx + s * stencil_lanes);
        total += sum_of(select(w > StencilPack(0.0), StencilPack(w * sum[f][s]), 0.0));
      }
      to[f] += total;
    }
  }
};

/// row[i] += q w[i] for n cells.
SILT_INLINE void add_dense(double* row, double q, const double* w, int n) {
  int i = 0;
  if (n >= stencil_lanes)
    for (; i + stencil_lanes <= n; i += stencil_lanes)
      store_any(row + i, multiply_add(load_any<StencilPack>(w + i), StencilPack(q),
                                      load_any<StencilPack>(row + i)));
  for (; i < n; ++i) row[i] += q * w[i];
}
/// Sum of w[i] f[i].
SILT_INLINE double dot_dense(const double* f, const double* w, int n) {
  double total = 0;
  int i = 0;
  if (n >= stencil_lanes) {
    StencilPack sum(0.0);
    for (; i + stencil_lanes <= n; i += stencil_lanes)
      sum = multiply_add(load_any<StencilPack>(w + i), load_any<StencilPack>(f + i), sum);
    total = sum_of(sum);
  }
  for (; i < n; ++i) total += w[i] * f[i];
  return total;
}

}  // namespace silt::inline SILT_TARGET::detail
