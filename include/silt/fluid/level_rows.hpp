// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <silt/core/lanes.hpp>
#include <silt/core/target.hpp>

/// Operations on single rows of a level of the multigrid: floats, whole packs of lanes.
///
/// Rows begin on a boundary of 64 bytes; up to a multiple of 16 beyond the last cell there are
/// values that may be read and written. There the inverse diagonal is 0, so that unknowns stay 0.
namespace silt::inline SILT_TARGET::fluid_detail {

using Pack = Lanes<DefaultArch, float>::Real;
inline constexpr int lanes = static_cast<int>(Lanes<DefaultArch, float>::width);
inline constexpr int room = 16;  // rows have room for a multiple of this

/// a b + c.
template <class Real>
SILT_INLINE Real multiply_add(const Real& a, const Real& b, const Real& c) {
  if constexpr (is_batch<Real>)
    return xsimd::fma(a, b, c);
  else
    return a * b + c;
}
/// The sum over the lanes, in their order.
template <class Real>
SILT_INLINE ScalarOf<Real> sum_of(const Real& a) {
  if constexpr (is_batch<Real>) {
    alignas(64) ScalarOf<Real> values[Real::size];
    store(values, a);
    ScalarOf<Real> sum = 0;
    for (const auto v : values) sum += v;
    return sum;
  } else {
    return a;
  }
}

/// Row (j, k) of the operator: coefficients of the six faces of its cells. `y_up` is y_low of row
/// (j+1, k), z_up z_low of (j, k+1); the upper face of x is that of the next cell.
struct FaceRows {
  const float *x, *y_low, *y_up, *z_low, *z_up;
  const float* diagonal;  // d of the row, or null where it is zero
};
/// Row (j, k) of an unknown, whose x[-1] and x[n] are set, and its four neighbours.
template <class Float>
struct NeighbourRows {
  Float* at;
  const float *y_low, *y_up, *z_low, *z_up;
};

/// 1, 0, 1, 0 ... : a pack loaded here, or one place on, chooses one colour of a row.
inline const float* colour_row(int odd) {
  alignas(64) static constexpr auto row = [] {
    std::array<float, 32> values{};
    for (std::size_t i = 0; i < values.size(); i += 2) values[i] = 1;
    return values;
  }();
  return row.data() + odd;
}

/// Gauss-Seidel for the cells of one colour (i + odd even): x = (r + sum a x_neighbour) / diagonal.
inline void relax_row(int n, int odd, const FaceRows& a, const float* inverse, const float* r,
                      const NeighbourRows<float>& x) {
  const auto chosen = load_any<Pack>(colour_row(odd)) > Pack(0.5f);
  Pack left = load_any<Pack>(x.at - 1);
  for (int i = 0; i < n; i += lanes) {
    const Pack own = load<Pack>(x.at + i);
    const Pack right = load_any<Pack>(x.at + i + 1);
    const Pack next_left = load_any<Pack>(x.at + i + lanes - 1);  // before own is stored
    Pack s = multiply_add(load<Pack>(a.x + i), left, load<Pack>(r + i));
    Pack t = load_any<Pack>(a.x + i + 1) * right;
    s = multiply_add(load<Pack>(a.y_low + i), load<Pack>(x.y_low + i), s);
    t = multiply_add(load<Pack>(a.y_up + i), load<Pack>(x.y_up + i), t);
    s = multiply_add(load<Pack>(a.z_low + i), load<Pack>(x.z_low + i), s);
    t = multiply_add(load<Pack>(a.z_up + i), load<Pack>(x.z_up + i), t);
    store(x.at + i, select(chosen, (s + t) * load<Pack>(inverse + i), own));
    left = next_left;
  }
}

/// The first of the sweeps, where the unknown is zero: x = r / diagonal for the cells of one
/// colour, 0 for the others.
inline void relax_row_from_zero(int n, int odd, const float* inverse, const float* r, float* x) {
  const auto chosen = load_any<Pack>(colour_row(odd)) > Pack(0.5f);
  for (int i = 0; i < n; i += lanes)
    store(x + i, select(chosen, load<Pack>(r + i) * load<Pack>(inverse + i), Pack(0.0f)));
}

/// (A x)_i, by differences: what is lost to rounding is then small against a |x - x_neighbour|.
SILT_INLINE Pack apply_pack(int i, const FaceRows& a, const NeighbourRows<const float>& x) {
  const Pack own = load<Pack>(x.at + i);
  Pack s = load<Pack>(a.x + i) * (own - load_any<Pack>(x.at + i - 1));
  Pack t = load_any<Pack>(a.x + i + 1) * (own - load_any<Pack>(x.at + i + 1));
  s = multiply_add(load<Pack>(a.y_low + i), own - load<Pack>(x.y_low + i), s);
  t = multiply_add(load<Pack>(a.y_up + i), own - load<Pack>(x.y_up + i), t);
  s = multiply_add(load<Pack>(a.z_low + i), own - load<Pack>(x.z_low + i), s);
  t = multiply_add(load<Pack>(a.z_up + i), own - load<Pack>(x.z_up + i), t);
  if (a.diagonal) s = multiply_add(load<Pack>(a.diagonal + i), own, s);
  return s + t;
}

/// q = A p; returns p . q. Beyond the row p must be 0.
inline double apply_row(int n, const FaceRows& a, const NeighbourRows<const float>& p, float* q) {
  Pack sum(0.0f);
  const int whole = n / lanes * lanes;
  for (int i = 0; i < whole; i += lanes) {
    const Pack product = apply_pack(i, a, p);
    store(q + i, product);
    sum = multiply_add(product, load<Pack>(p.at + i), sum);
  }
  double total = sum_of(sum);
  if (whole < n) {
    alignas(64) float last[lanes];
    store(last, apply_pack(whole, a, p));
    for (int i = whole; i < n; ++i) {
      q[i] = last[i - whole];
      total += q[i] * p.at[i];
    }
  }
  return total;
}

/// Adds r - A x of cells from ... from+count-1 (a multiple of the lanes) to `sum`.
inline void add_residual(int from, int count, const FaceRows& a, const float* r,
                         const NeighbourRows<const float>& x, float* sum) {
  for (int i = 0; i < count; i += lanes)
    store(sum + i, load<Pack>(sum + i) + (load<Pack>(r + from + i) - apply_pack(from + i, a, x)));
}

/// u . v of n values; beyond them one of both is 0.
inline double dot_row(int n, const float* u, const float* v) {
  Pack sum(0.0f);
  for (int i = 0; i < n; i += lanes) sum = multiply_add(load<Pack>(u + i), load<Pack>(v + i), sum);
  return sum_of(sum);
}

/// r -= alpha q; returns r . r.
inline double subtract_row(int n, float alpha, const float* q, float* r) {
  Pack sum(0.0f);
  for (int i = 0; i < n; i += lanes) {
    const Pack v = multiply_add(Pack(-alpha), load<Pack>(q + i), load<Pack>(r + i));
    store(r + i, v);
    sum = multiply_add(v, v, sum);
  }
  return sum_of(sum);
}

/// p = z + beta p.
inline void direction_row(int n, float beta, const float* z, float* p) {
  for (int i = 0; i < n; i += lanes)
    store(p + i, multiply_add(Pack(beta), load<Pack>(p + i), load<Pack>(z + i)));
}

/// x += alpha p in double, of n values and no more.
inline void add_scaled_row(int n, double alpha, const float* __restrict p, double* __restrict x) {
  int i = 0;
  for (; i + 8 <= n; i += 8)
    for (int lane = 0; lane < 8; ++lane) x[i + lane] += alpha * static_cast<double>(p[i + lane]);
  for (; i < n; ++i) x[i] += alpha * static_cast<double>(p[i]);
}

}  // namespace silt::inline SILT_TARGET::fluid_detail
