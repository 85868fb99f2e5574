// silt - BSD-3-Clause, see LICENSE
//
// Special functions and quadrature against Boost.Math.

#include <doctest/doctest.h>

#if defined(SILT_TEST_BOOST_MATH)
#include <boost/math/distributions/lognormal.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/weibull.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_2.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include <cmath>
#include <numbers>

#include <silt/bond/scatter.hpp>
#include <silt/breakage/strength.hpp>
#include <silt/breakage/t10_sizes.hpp>
#include <silt/core/gauss_rule.hpp>
#include <silt/core/random.hpp>
#include <silt/shape/super_ellipsoid.hpp>

#include "near.hpp"

namespace boost_math_test {

namespace {

namespace math = boost::math;

/// A polynomial of degree 2 N - 1, which a rule of N nodes integrates exactly, and sin.
template <int N>
void check_rule() {
  const silt::detail::GaussRule<N> rule;
  const auto f = [](double x) { return std::sin(3 * x) + std::pow(x, 2 * N - 1); };
  double sum = 0;
  for (std::size_t k = 0; k < N; ++k) sum += rule.weight[k] * f(rule.at[k]);
  CHECK(sum == near(math::quadrature::gauss<double, N>::integrate(f, 0.0, 1.0)).epsilon(1e-14));
}

}  // namespace

TEST_CASE("Boost.Math: quantiles of the normal distribution, to both ends") {
  const math::normal normal;
  for (const double p : {1e-300, 1e-30, 1e-9, 1e-3, 0.1, 0.3, 0.5, 0.77, 0.99, 1 - 1e-9}) {
    CAPTURE(p);
    const double z = math::quantile(normal, p);
    // Near 1/2 the difference p - 1/2 has lost digits; near 1 so has 1 - p, in both.
    CHECK(std::abs(silt::detail::normal_quantile(p) - z) < 4e-15 * std::max(1.0, std::abs(z)));
    CHECK(silt::detail::normal_probability_below(z) == near(p).epsilon(1e-12));
  }
}

TEST_CASE("Boost.Math: strengths by Weibull and log-normal distributions") {
  const silt::WeibullStrength weibull{
      .scale = 3, .at_diameter = 2e-3, .exponent = 0, .modulus = 2.7};
  const silt::LogNormalStrength log_normal{
      .median = 3, .at_diameter = 2e-3, .exponent = 0, .deviation = 0.4};
  const math::weibull of_weibull(2.7, 3);
  const math::lognormal of_normal(std::log(3.0), 0.4);
  for (const double rank : {1e-9, 0.01, 0.2, 0.5, 0.9, 0.9999}) {
    CAPTURE(rank);
    const double weak = math::quantile(of_weibull, rank), low = math::quantile(of_normal, rank);
    CHECK(weibull.strength(2e-3, 1, rank) == near(weak).epsilon(1e-13));
    CHECK(weibull.weaker(weak, 2e-3, 1) == near(rank).epsilon(1e-12));
    CHECK(log_normal.strength(2e-3, 1, rank) == near(low).epsilon(1e-13));
    CHECK(log_normal.weaker(low, 2e-3, 1) == near(rank).epsilon(1e-12));
  }
  // Bonds: of mean 1.
  const math::weibull of_bonds(5, 1 / math::tgamma(1.2));
  CHECK(silt::weibull_factor(0.3, 5) == near(math::quantile(of_bonds, 0.3)).epsilon(1e-13));
}

TEST_CASE("Boost.Math: incomplete beta function, of the exponents of t10 and far from them") {
  for (const double a : {0.1, 0.51, 1.03, 2.7, 5.0, 40.0})
    for (const double b : {0.2, 0.76, 1.0, 9.4, 11.95, 60.0})
      for (const double x : {1e-6, 0.01, 0.1, 0.35, 0.5, 0.9, 0.999}) {
        CAPTURE(a);
        CAPTURE(b);
        CAPTURE(x);
        const double expected = math::ibeta(a, b, x);
        // "error about 1e-14": of the whole, and of small shares relatively.
        CHECK(std::abs(silt::detail::incomplete_beta(x, a, b) - expected) <
              1e-13 * std::min(1.0, 30 * expected) + 1e-300);
      }
}

TEST_CASE("Boost.Math: volume, inertia and area of super-ellipsoids") {
  const auto B = [](double x, double y) { return math::beta(x, y); };
  const double a = 2e-3, b = 3e-3, c = 1.2e-3;
  for (const double s1 : {2.0, 2.5, 4.0, 8.0})
    for (const double s2 : {2.0, 3.3, 6.0}) {
      CAPTURE(s1);
      CAPTURE(s2);
      const silt::SuperEllipsoid body{a, b, c, s1, s2};
      const double e1 = 2 / s1, e2 = 2 / s2;
      // Barr's integrals (Jaklic, Leonardis, Solina 2000, ch. 2).
      CHECK(body.volume() ==
            near(2 * a * b * c * e1 * e2 * B(e1 / 2 + 1, e1) * B(e2 / 2, e2 / 2)).epsilon(1e-12));
      const double in_plane = B(1.5 * e2, 0.5 * e2) * B(0.5 * e1, 2 * e1 + 1);
      const double along = B(0.5 * e2, 0.5 * e2 + 1) * B(1.5 * e1, e1 + 1);
      const double factor = 0.5 * a * b * c * e1 * e2;
      CHECK(body.inertia().x ==
            near(factor * (b * b * in_plane + 4 * c * c * along)).epsilon(1e-12));
      CHECK(body.inertia().z == near(factor * (a * a + b * b) * in_plane).epsilon(1e-12));
    }
  // An ellipsoid of axes p > q > r: Legendre's formula.
  const double p = 3e-3, q = 2e-3, r = 1.2e-3;
  const double phi = std::acos(r / p);
  const double k = std::sqrt(p * p * (q * q - r * r) / (q * q * (p * p - r * r)));
  const double area =
      2 * std::numbers::pi * r * r + 2 * std::numbers::pi * p * q / std::sin(phi) *
                                         (math::ellint_2(k, phi) * std::pow(std::sin(phi), 2) +
                                          math::ellint_1(k, phi) * std::pow(std::cos(phi), 2));
  const silt::SuperEllipsoid ellipsoid{p, q, r, 2, 2};
  CHECK(ellipsoid.surface_area() == near(area).epsilon(1e-6));  // "error about 1e-6"
}

TEST_CASE("Boost.Math: Gauss quadrature") {
  check_rule<7>();
  check_rule<10>();
  check_rule<20>();
}

}  // namespace boost_math_test
#endif
