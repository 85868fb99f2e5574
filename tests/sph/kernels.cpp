// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include <silt/sph/kernels.hpp>

#include "near.hpp"

namespace sph_kernels_test {

using silt::CubicSpline;
using silt::WendlandC2;

namespace {
/// The integral of W over space, by the midpoint rule in r.
template <class Kernel>
double integral(int dimensions, double h) {
  const int n = 20000;
  const double dr = 2 * h / n, a = Kernel::normalisation(dimensions, h);
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    const double r = (k + 0.5) * dr,
                 shell = dimensions == 2 ? 2 * std::numbers::pi * r : 4 * std::numbers::pi * r * r;
    sum += shell * dr * a * Kernel::weight(r / h);
  }
  return sum;
}
template <class Kernel>
void check_slopes() {
  const double e = 1e-5;
  for (double q = 0.05; q < 2.3; q += 0.0703) {
    const double slope = (Kernel::weight(q + e) - Kernel::weight(q - e)) / (2 * e);
    CHECK(Kernel::slope(q) * q == doctest::Approx(slope).epsilon(1e-6).scale(1));
  }
  CHECK(Kernel::slope(2.0) == 0);
  CHECK(Kernel::slope(5.0) == 0);
  CHECK(Kernel::weight(5.0) == 0);
  CHECK(std::isfinite(Kernel::slope(0.0)));
}
}  // namespace

TEST_CASE("SPH kernels: their integral over space is 1, whatever h") {
  for (const double h : {1.0, 0.013}) {
    CHECK(integral<WendlandC2>(2, h) == near(1).epsilon(1e-7));
    CHECK(integral<WendlandC2>(3, h) == near(1).epsilon(1e-7));
    CHECK(integral<CubicSpline>(2, h) == near(1).epsilon(1e-7));
    CHECK(integral<CubicSpline>(3, h) == near(1).epsilon(1e-7));
  }
  // Values from elsewhere: 7/(4 pi), 21/(16 pi), 10/(7 pi), 1/pi.
  CHECK(WendlandC2::normalisation(2, 1) == near(0.557042).epsilon(1e-6));
  CHECK(WendlandC2::normalisation(3, 1) == near(0.417782).epsilon(1e-6));
  CHECK(CubicSpline::normalisation(2, 1) == near(0.454728).epsilon(1e-6));
  CHECK(CubicSpline::normalisation(3, 1) == near(0.318310).epsilon(1e-6));
}

TEST_CASE("SPH kernels: slope() is the derivative over q, and 0 beyond the support") {
  check_slopes<WendlandC2>();
  check_slopes<CubicSpline>();
}

}  // namespace sph_kernels_test
