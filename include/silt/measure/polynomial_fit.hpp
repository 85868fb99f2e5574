// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include <silt/core/error.hpp>
#include <silt/core/random.hpp>

namespace silt::inline SILT_TARGET {

/// Quantile of Student's t distribution for the share `p` with `freedom` degrees of freedom.
///
///   t = z + g1/n + g2/n^2 + g3/n^3 + g4/n^4,  z the normal quantile
///
/// Source: R. A. Fisher, E. A. Cornish, Technometrics 2 (1960) 209 (recalled).
/// Valid:  freedom >= 3: 0.12 % at 3, 5e-5 from 6 on, for p from 0.025 to 0.975 (tests).
inline double student_quantile(double p, double freedom) {
  require(p > 0 && p < 1, "student_quantile: p = ", p, " [-] must be between 0 and 1");
  require(freedom >= 3, "student_quantile: freedom = ", freedom, " [-] must be at least 3");
  const double z = detail::normal_quantile(p), z2 = z * z, n = 1 / freedom;
  const double g1 = z * (z2 + 1) / 4, g2 = z * ((5 * z2 + 16) * z2 + 3) / 96;
  const double g3 = z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / 384;
  const double g4 = z * ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) / 92160;
  return z + n * (g1 + n * (g2 + n * (g3 + n * g4)));
}

/// Least-squares polynomial of degree D through points, with vertical distances:
///
///   y = sum a_k t^k,  t = (x - centre)/scale,  s^2 = sum of squares/(n - D - 1)
///   band of the curve   q s sqrt(p' C p),      p = (1, t, ...), C = (X' X)^-1                (1)
///   band of the points  q s sqrt(1 + p' C p),  q = Student's t                               (2)
///
/// With 95 %, in 95 of 100 samples (1) contains the true curve at a given x, and (2) contains one
/// more point. Correlated points, such as frames of a film in close succession, are fewer
/// independent ones than are counted; (1) is then too narrow.
/// Errors: InputError for fewer than D + 4 points, numbers that are not finite, too few different
///         x.
/// Tests:  tests/measure/polynomial_fit.cpp
template <int D>
struct PolynomialFit {
  static constexpr std::size_t terms = D + 1;
  double centre = 0, scale = 1;                           // of x
  std::array<double, terms> a{};                          // of powers of t
  std::array<std::array<double, terms>, terms> spread{};  // C
  double deviation = 0;                                   // s, of the points
  std::size_t points = 0;

  double at(double x) const {
    const double t = (x - centre) / scale;
    double y = 0;
    for (std::size_t k = terms; k-- > 0;) y = y * t + a[k];
    return y;
  }
  /// Coefficients in x itself: y = sum b_k x^k.
  std::array<double, terms> coefficients() const {
    std::array<double, terms> b{};
    for (std::size_t k = terms; k-- > 0;) {  // b <- b (x - centre)/scale + a_k
      for (std::size_t m = terms; m-- > 0;) b[m] = ((m > 0 ? b[m - 1] : 0) - centre * b[m]) / scale;
      b[0] += a[k];
    }
    return b;
  }
  /// Half width of the band of the curve at x (1), and of the points (2).
  double band_of_curve(double x, double share = 0.95) const { return band(x, share, 0); }
  double band_of_points(double x, double share = 0.95) const { return band(x, share, 1); }

 private:
  double band(double x, double share, double own) const {
    require(share > 0 && share < 1, "PolynomialFit: share = ", share,
            " [-] of a band must be between 0 and 1");
    const double t = (x - centre) / scale;
    double sum = own, row = 1;
    for (std::size_t k = 0; k < terms; ++k, row *= t) {
      double column = 1;
      for (std::size_t m = 0; m < terms; ++m, column *= t) sum += row * spread[k][m] * column;
    }
    const double q = student_quantile(0.5 * (1 + share), static_cast<double>(points) - terms);
    return q * deviation * std::sqrt(std::max(sum, 0.0));
  }
};

template <int D>
PolynomialFit<D> fit_polynomial(std::span<const double> x, std::span<const double> y) {
  using Fit = PolynomialFit<D>;
  constexpr std::size_t N = Fit::terms;
  require(x.size() == y.size() && x.size() >= N + 3, "fit_polynomial: ", x.size(), " x and ",
          y.size(), " y were given; a polynomial of degree ", D,
          " needs as many of both, and at least ", N + 3);
  Fit fit;
  fit.points = x.size();
  const double n = static_cast<double>(fit.points);
  for (std::size_t i = 0; i < x.size(); ++i) {
    require(std::isfinite(x[i]) && std::isfinite(y[i]), "fit_polynomial: point ", i, " is (", x[i],
            ", ", y[i], "); both must be finite");
    fit.centre += x[i] / n;
  }
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  const double width = 0.5 * (*most - *least);
  require(width > 0, "fit_polynomial: all points have x = ", *least);
  fit.scale = width;

  // X' X with a column of 1, and X' y: inverted by Gauss-Jordan elimination with pivoting.
  std::array<std::array<double, 2 * N + 1>, N> m{};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double t = (x[i] - fit.centre) / fit.scale;
    std::array<double, N> p{};
    p[0] = 1;
    for (std::size_t k = 1; k < N; ++k) p[k] = p[k - 1] * t;
    for (std::size_t k = 0; k < N; ++k) {
      for (std::size_t l = 0; l < N; ++l) m[k][l] += p[k] * p[l];
      m[k][2 * N] += p[k] * y[i];
    }
  }
  for (std::size_t k = 0; k < N; ++k) m[k][N + k] = 1;
  for (std::size_t k = 0; k < N; ++k) {
    std::size_t best = k;
    for (std::size_t l = k; l < N; ++l)
      if (std::abs(m[l][k]) > std::abs(m[best][k])) best = l;
    require(std::abs(m[best][k]) > 1e-12 * n, "fit_polynomial: the points have fewer than ", N,
            " different x");
    std::swap(m[k], m[best]);
    const double pivot = m[k][k];
    for (double& v : m[k]) v /= pivot;
    for (std::size_t l = 0; l < N; ++l) {
      const double by = m[l][k];
      if (l == k || by == 0) continue;
      for (std::size_t c = 0; c < 2 * N + 1; ++c) m[l][c] -= by * m[k][c];
    }
  }
  for (std::size_t k = 0; k < N; ++k) {
    fit.a[k] = m[k][2 * N];
    for (std::size_t l = 0; l < N; ++l) fit.spread[k][l] = m[k][N + l];
  }
  double squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = y[i] - fit.at(x[i]);
    squares += off * off;
  }
  fit.deviation = std::sqrt(squares / (n - static_cast<double>(N)));
  return fit;
}

}  // namespace silt
