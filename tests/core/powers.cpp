// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>

#include <silt/core/powers.hpp>

#include "near.hpp"

namespace powers_test {

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
    CHECK(silt::exact_log2(1 + h) == near(std::log2(1 + h)).epsilon(1e-15));
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

TEST_CASE("powers: x^y, e^x and ln x to what the exponent allows, 1 - e^-x also for small x") {
  for (double digits = -20; digits <= 20; digits += 0.37)
    for (const double y : {-3.65, -0.343, 0.0, 1.0 / 3, 0.687, 3.7}) {
      const double x = std::pow(10.0, digits), exact = std::pow(x, y);
      const double allowed = 5e-16 + 3e-16 * std::abs(y * std::log2(x));
      CAPTURE(x);
      CAPTURE(y);
      CHECK(std::abs(silt::power(x, y) / exact - 1) <= allowed);
      CHECK(std::abs(in_lanes(x, [&](auto b) { return silt::power(b, Batch(y)); }) / exact - 1) <=
            allowed);
    }
  for (double x = -700; x <= 700; x += 0.73) {
    CAPTURE(x);
    CHECK(std::abs(silt::exponential(x) / std::exp(x) - 1) <= 5e-16 + 2e-16 * std::abs(x));
  }
  CHECK(silt::exponential(-1e9) < 1e-300);
  CHECK(silt::natural_log(7.5) == near(std::log(7.5)).epsilon(1e-15));
  for (double digits = -300; digits <= 6; digits += 0.031) {
    const double x = std::pow(10.0, digits), exact = -std::expm1(-x);
    CAPTURE(x);
    CHECK(std::abs(silt::one_minus_exponential(x) / exact - 1) <= 8e-16);
    CHECK(std::abs(in_lanes(x, [](auto b) { return silt::one_minus_exponential(b); }) / exact -
                   1) <= 8e-16);
  }
  CHECK(silt::one_minus_exponential(0.0) == 0);
}

TEST_CASE("powers: float and packs of float to 2e-7") {
  using Pack = typename silt::Lanes<silt::DefaultArch, float>::Real;
  constexpr std::size_t W = silt::Lanes<silt::DefaultArch, float>::width;
  const auto both = [](float x, double exact, double allowed, const auto& f) {
    CAPTURE(x);
    CHECK(std::abs(f(x) - exact) <= allowed);
    alignas(64) float y[W];
    silt::store(y, f(Pack(x)));
    for (const float lane : y) CHECK(std::abs(lane - exact) <= allowed);
  };
  for (double digits = -37; digits <= 37; digits += 0.37) {
    const auto x = static_cast<float>(std::pow(10.0, digits));
    const double exact = std::log2(static_cast<double>(x));
    both(x, exact, 2e-7 * (std::abs(exact) + 1), [](auto b) { return silt::exact_log2(b); });
  }
  for (float y = -120; y <= 120; y += 0.73f) {
    const double exact = std::exp2(static_cast<double>(y));
    both(y, exact, 2e-7 * exact, [](auto b) { return silt::exact_exp2(b); });
  }
  for (const float x : {1e-30f, 1e-4f, 0.3f, 5.f, 1e4f}) {
    const double exact = -std::expm1(-static_cast<double>(x));
    both(x, exact, 4e-7 * exact, [](auto b) { return silt::one_minus_exponential(b); });
  }
}

}  // namespace powers_test
