// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <silt/breakage/concept.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Continued fraction of the incomplete beta function, by Lentz' method, for x below (a + 1)/(a + b
/// + 2), where it converges fast.
inline double beta_fraction(double x, double a, double b) {
  constexpr double tiny = 1e-300;
  const auto kept = [](double value) { return std::abs(value) < tiny ? tiny : value; };
  double c = 1, d = 1 / kept(1 - (a + b) * x / (a + 1)), h = d;
  for (int m = 1; m <= 500; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / kept(1 + even * d), c = kept(1 + even / c), h *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / kept(1 + odd * d), c = kept(1 + odd / c), h *= d * c;
    if (std::abs(d * c - 1) < 1e-15) break;
  }
  return h;
}

/// Regularised incomplete beta function I_x(a, b) [-], for a, b in (0, 80].
/// Source: Abramowitz and Stegun 26.5.8; W. J. Lentz, Appl. Opt. 15 (1976) 668. Error about 1e-14.
inline double incomplete_beta(double x, double a, double b) {
  if (!(x > 0)) return 0;
  if (x >= 1) return 1;
  const double front =
      std::tgamma(a + b) / (std::tgamma(a) * std::tgamma(b)) * std::pow(x, a) * std::pow(1 - x, b);
  if (x < (a + 1) / (a + b + 2)) return front / a * beta_fraction(x, a, b);
  return 1 - front / b * beta_fraction(1 - x, b, a);
}

}  // namespace detail

/// Breakage function by t10, the share of mass finer than a tenth of the parent:
///
///   t10 = limit (1 - exp(-rate E/E50))                                                   (1)
///   t_n = I_t10(alpha_n, beta_n), the share finer than d/n                               (2)
///   E/E50 = load/strength of energies, (load/strength)^(5/3) of forces                   (3)
///
/// Between the sizes d/n of the table B is a power of x; below d/75 the power of the last interval
/// continues. (3) uses the strength of the breaking particle in place of the median E50.
///
/// Source: (1), (2) and the values of `ore`: Tavares and Carvalho 2009, Carvalho and Tavares 2013
///         (all recalled, for a copper ore: check them before use in publications). (3) Hertz.
/// Valid:  limit in (0, 1]. The t_n are independent fits: check_sizes refuses sets in which they
///         cross; those of `ore` cross by 2e-7 of the mass at t10 = 0.63.
/// Units:  [-].
/// Errors: check() throws InputError naming field, value, unit and allowed range.
/// Tests:  tests/breakage/sizes.cpp.
struct T10Sizes {
  struct Share {
    double n;            // [-] > 1
    double alpha, beta;  // [-] of (2), in (0, 40]
  };
  using Shares = std::array<Share, 7>;
  static constexpr Shares ore{{{1.2, 0.51, 11.95},
                               {1.5, 1.07, 13.87},
                               {2, 1.01, 8.09},
                               {4, 1.08, 3.03},
                               {25, 1.01, 0.53},
                               {50, 1.03, 0.36},
                               {75, 1.03, 0.30}}};

  double limit;         // [-] A in (0, 1]
  double rate;          // [-] b' > 0
  LoadUnit unit;        // of strength and load
  Shares shares = ore;  // by ascending n: four below 10, three above

  double t10(const Broken& parent) const {
    const double ratio = parent.load / parent.strength;
    return -limit *
           std::expm1(-rate * (unit == LoadUnit::Force ? std::pow(ratio, 5.0 / 3.0) : ratio));
  }
  double finer(double x, const Broken& parent) const {
    if (x >= parent.diameter) return 1;
    if (!(x > 0)) return 0;
    const double n = parent.diameter / x, t = t10(parent);
    // The interval [d/n_2, d/n_1] of the table that contains x; rank 0 is d, 5 is t10.
    std::size_t k = 1;
    while (k < 8 && n > n_at(k)) ++k;
    const double n1 = n_at(k - 1), n2 = n_at(k), t1 = share_at(k - 1, t), t2 = share_at(k, t);
    if (!(t2 > 0)) return 0;
    return t2 * std::pow(n2 / n, std::log(t1 / t2) / std::log(n2 / n1));
  }
  double largest(const Broken& parent) const { return parent.diameter; }
  void check() const {
    require(limit > 0 && limit <= 1, "T10Sizes.limit = ", limit, " [-] must be in (0, 1]");
    require_positive("T10Sizes.rate", rate, "-");
    for (std::size_t k = 0; k < shares.size(); ++k) {
      const auto& [n, alpha, beta] = shares[k];
      const double above = k == 0 ? 1 : k == 4 ? 10 : shares[k - 1].n;
      require(std::isfinite(n) && n > above && (k > 3 || n < 10), "T10Sizes.shares[", k,
              "].n = ", n, " [-] must be greater than ", above, k > 3 ? "" : " and less than 10");
      require(alpha > 0 && alpha <= 40, "T10Sizes.shares[", k, "].alpha = ", alpha,
              " [-] must be in (0, 40]");
      require(beta > 0 && beta <= 40, "T10Sizes.shares[", k, "].beta = ", beta,
              " [-] must be in (0, 40]");
    }
  }

 private:
  double n_at(std::size_t k) const {
    return k == 0 ? 1 : k == 5 ? 10 : shares[k < 5 ? k - 1 : k - 2].n;
  }
  double share_at(std::size_t k, double t) const {
    if (k == 0) return 1;
    if (k == 5) return t;
    const auto& [n, alpha, beta] = shares[k < 5 ? k - 1 : k - 2];
    return detail::incomplete_beta(t, alpha, beta);
  }
};

static_assert(BreakageFunction<T10Sizes>);

}  // namespace silt
