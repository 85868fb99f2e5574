// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>

#include <silt/core/powers.hpp>

namespace {

using Batch = typename silt::Lanes<silt::DefaultArch>::Real;

/// The first lane of f on a pack whose lanes are all x, or minus 1e300 if the lanes differ.
template <class F>
double in_lanes(double x, const F& f) {
  constexpr std::size_t W = silt::Lanes<silt::DefaultArch>::width;
  alignas(64) double y[W];
  silt::store(y, f(Batch(x)));
  for (const double lane : y)
    if (lane != y[0]) return -1e300;
  return y[0];
}

}  // namespace

TEST_CASE("powers: logarithm of two to 3e-16 from 1e-300 to 1e300, also near 1") {
  for (double digits = -300; digits <= 300; digits += 0.37) {
    const double x = std::pow(10.0, digits), exact = std::log2(x);
    CAPTURE(x);
    CHECK(std::abs(silt::exact_log2(x) - exact) <= 3e-16 * (std::abs(exact) + 1));
    CHECK(std::abs(in_lanes(x, [](auto y) { return silt::exact_log2(y); }) - exact) <=
          3e-16 * (std::abs(exact) + 1));
    CHECK(std::abs(silt::rough_log2(x) - exact) <= 2e-7);
  }
  for (const double h : {1e-15, -1e-12, 1e-6, -1e-3, 0.2, -0.25})
    CHECK(silt::exact_log2(1 + h) == doctest::Approx(std::log2(1 + h)).epsilon(1e-15));
  CHECK(silt::exact_log2(1.0) == 0);
}

TEST_CASE("powers: power of two to two ulp from 2^-1000 to 2^1000") {
  for (double y = -1000; y <= 1000; y += 0.173) {
    CAPTURE(y);
    CHECK(std::abs(silt::exact_exp2(y) / std::exp2(y) - 1) <= 4.5e-16);
    CHECK(std::abs(in_lanes(y, [](auto x) { return silt::exact_exp2(x); }) / std::exp2(y) - 1) <=
          4.5e-16);
    CHECK(std::abs(silt::rough_exp2(y) / std::exp2(y) - 1) <= 2e-7);
  }
  CHECK(silt::exact_exp2(0.0) == 1);
}
