// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>

#include <silt/core/lanes.hpp>
#include <silt/core/target.hpp>

/// Prevents inlining, for one machine code of a function: compilers may fuse a product and a sum in
/// one copy and not in another, and results would depend on the caller, hence on threads.
#if defined(__clang__)
#define SILT_ONE_COPY inline __attribute__((noinline))
#elif defined(__GNUC__)
#define SILT_ONE_COPY inline __attribute__((noinline, noclone))
#else
#define SILT_ONE_COPY inline
#endif

/// Operations on single rows of a level of the multigrid: floats, whole packs of lanes.
///
/// A row contains its cells of even i and, `half` values further, those of odd i: cells of one
/// colour of a row are then consecutive, and all lanes of a pack are used. Both halves begin on a
/// 64-byte boundary and are padded to multiples of 16. Padding may be read and written; there the
/// inverse diagonal is 0, and unknowns stay 0.
namespace silt::inline SILT_TARGET::fluid_detail {

using Pack = Lanes<DefaultArch, float>::Real;
inline constexpr int lanes = static_cast<int>(Lanes<DefaultArch, float>::width);
inline constexpr int room = 16;  // rows are padded to a multiple of this

/// Number of cells of a row of n with even i (half 0) or odd i (half 1).
constexpr int cells_of_half(int n, int h) { return (n + 1 - h) / 2; }

/// Row (j, k) of the operator: coefficients of the six faces of its cells. `y_up` is y_low of row
/// (j+1, k), z_up z_low of (j, k+1); the upper face of x is that of the next cell.
struct FaceRows {
  const float *x, *y_low, *y_up, *z_low, *z_up;
  const float* diagonal;  // d of the row, or null where it is zero
};
/// Row (j, k) of an unknown, with its values of i = -1 and n set, and its four neighbours.
template <class Float>
struct NeighbourRows {
  Float* at;
  const float *y_low, *y_up, *z_low, *z_up;
};

/// Positions of the lower and upper neighbours in x of the cells of a half, and coefficients of
/// their upper faces: those of even i are between odd ones, and vice versa.
struct Sides {
  std::ptrdiff_t own, lower, upper;
  Sides(int h, std::ptrdiff_t half)
      : own(h == 0 ? 0 : half), lower(h == 0 ? half - 1 : 0), upper(h == 0 ? half : 1) {}
};

/// Gauss-Seidel for the cells of one half: x = (r + sum a x_neighbour) / diagonal.
SILT_ONE_COPY void relax_row(int n, int h, std::ptrdiff_t half, const FaceRows& a,
                             const float* inverse, const float* r, const NeighbourRows<float>& x) {
  const Sides side(h, half);
  const int count = cells_of_half(n, h);
  for (int m = 0; m < count; m += lanes) {
    const std::ptrdiff_t i = side.own + m;
    Pack s =
        multiply_add(load<Pack>(a.x + i), load_any<Pack>(x.at + side.lower + m), load<Pack>(r + i));
    Pack t = load_any<Pack>(a.x + side.upper + m) * load_any<Pack>(x.at + side.upper + m);
    s = multiply_add(load<Pack>(a.y_low + i), load<Pack>(x.y_low + i), s);
    t = multiply_add(load<Pack>(a.y_up + i), load<Pack>(x.y_up + i), t);
    s = multiply_add(load<Pack>(a.z_low + i), load<Pack>(x.z_low + i), s);
    t = multiply_add(load<Pack>(a.z_up + i), load<Pack>(x.z_up + i), t);
    store(x.at + i, (s + t) * load<Pack>(inverse + i));
  }
}

/// The same for only the m-th cell of even i.
inline void relax_cell(int m, std::ptrdiff_t half, const FaceRows& a, const float* inverse,
                       const float* r, const NeighbourRows<float>& x) {
  const std::ptrdiff_t lower = half - 1 + m, upper = half + m;
  x.at[m] = inverse[m] *
            (r[m] + a.x[m] * x.at[lower] + a.x[upper] * x.at[upper] + a.y_low[m] * x.y_low[m] +
             a.y_up[m] * x.y_up[m] + a.z_low[m] * x.z_low[m] + a.z_up[m] * x.z_up[m]);
}

/// First sweep, with a zero unknown: x = r / diagonal for the cells of one half.
inline void relax_row_from_zero(int n, int h, std::ptrdiff_t half, const float* inverse,
                                const float* r, float* x) {
  const std::ptrdiff_t own = h == 0 ? 0 : half;
  for (int m = 0; m < cells_of_half(n, h); m += lanes)
    store(x + own + m, load<Pack>(r + own + m) * load<Pack>(inverse + own + m));
}

/// A x of a pack of cells from the m-th of a half on, by differences: rounding errors are then
/// small compared with a |x - x_neighbour|.
SILT_INLINE Pack apply_pack(int m, const Sides& side, const FaceRows& a,
                            const NeighbourRows<const float>& x) {
  const std::ptrdiff_t i = side.own + m;
  const Pack own = load<Pack>(x.at + i);
  Pack s = load<Pack>(a.x + i) * (own - load_any<Pack>(x.at + side.lower + m));
  Pack t = load_any<Pack>(a.x + side.upper + m) * (own - load_any<Pack>(x.at + side.upper + m));
  s = multiply_add(load<Pack>(a.y_low + i), own - load<Pack>(x.y_low + i), s);
  t = multiply_add(load<Pack>(a.y_up + i), own - load<Pack>(x.y_up + i), t);
  s = multiply_add(load<Pack>(a.z_low + i), own - load<Pack>(x.z_low + i), s);
  t = multiply_add(load<Pack>(a.z_up + i), own - load<Pack>(x.z_up + i), t);
  if (a.diagonal) s = multiply_add(load<Pack>(a.diagonal + i), own, s);
  return s + t;
}

/// q = A p; returns p . q. Nothing beyond the cells is written.
SILT_ONE_COPY double apply_row(int n, std::ptrdiff_t half, const FaceRows& a,
                               const NeighbourRows<const float>& p, float* q) {
  double total = 0;
  for (const int h : {0, 1}) {
    const Sides side(h, half);
    const int count = cells_of_half(n, h), whole = count / lanes * lanes;
    Pack sum(0.0f);
    for (int m = 0; m < whole; m += lanes) {
      const Pack product = apply_pack(m, side, a, p);
      store(q + side.own + m, product);
      sum = multiply_add(product, load<Pack>(p.at + side.own + m), sum);
    }
    total += static_cast<double>(sum_of(sum));
    if (whole == count) continue;
    alignas(64) float last[lanes];
    store(last, apply_pack(whole, side, a, p));
    for (int m = whole; m < count; ++m) {
      q[side.own + m] = last[m - whole];
      total += static_cast<double>(q[side.own + m] * p.at[side.own + m]);
    }
  }
  return total;
}

/// Adds r - A x of `count` cells of a half from the m-th on to `sum`; whole packs.
SILT_ONE_COPY void add_residual(int from, int count, const Sides& side, const FaceRows& a,
                                const float* r, const NeighbourRows<const float>& x, float* sum) {
  for (int m = 0; m < count; m += lanes)
    store(sum + m, load<Pack>(sum + m) +
                       (load<Pack>(r + side.own + from + m) - apply_pack(from + m, side, a, x)));
}

/// u . v of rows of n values, both halves with padding; there one factor is 0.
SILT_ONE_COPY double dot_row(std::size_t n, const float* u, const float* v) {
  Pack sum(0.0f);
  for (std::size_t i = 0; i < n; i += lanes)
    sum = multiply_add(load<Pack>(u + i), load<Pack>(v + i), sum);
  return static_cast<double>(sum_of(sum));
}

/// r -= alpha q; returns r . r.
SILT_ONE_COPY double subtract_row(std::size_t n, float alpha, const float* q, float* r) {
  Pack sum(0.0f);
  for (std::size_t i = 0; i < n; i += lanes) {
    const Pack v = multiply_add(Pack(-alpha), load<Pack>(q + i), load<Pack>(r + i));
    store(r + i, v);
    sum = multiply_add(v, v, sum);
  }
  return static_cast<double>(sum_of(sum));
}

/// p = z + beta p.
SILT_ONE_COPY void direction_row(std::size_t n, float beta, const float* z, float* p) {
  for (std::size_t i = 0; i < n; i += lanes)
    store(p + i, multiply_add(Pack(beta), load<Pack>(p + i), load<Pack>(z + i)));
}

/// sum += alpha p in double.
SILT_ONE_COPY void add_scaled_row(std::size_t n, double alpha, const float* __restrict p,
                                  double* __restrict sum) {
  for (std::size_t i = 0; i < n; i += 8)
    for (std::size_t lane = 0; lane < 8; ++lane)
      sum[i + lane] += alpha * static_cast<double>(p[i + lane]);
}

/// A row in the order of i from its halves, from cell 2 m on, and the reverse.
inline void join_halves(int cells, const float* __restrict even, std::ptrdiff_t half,
                        float* __restrict to) {
  for (int m = 0; m < cells / 2; ++m) {
    to[2 * m] = even[m];
    to[2 * m + 1] = even[half + m];
  }
  if (cells % 2 == 1) to[cells - 1] = even[cells / 2];
}
inline void split_halves(int cells, const float* __restrict from, float* __restrict even,
                         std::ptrdiff_t half) {
  for (int m = 0; m < cells / 2; ++m) {
    even[m] = from[2 * m];
    even[half + m] = from[2 * m + 1];
  }
  if (cells % 2 == 1) even[cells / 2] = from[cells - 1];
}

}  // namespace silt::inline SILT_TARGET::fluid_detail
