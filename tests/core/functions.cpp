// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <silt/core/error.hpp>
#include <silt/core/functions.hpp>

namespace functions_test {

namespace {

using Batch = typename silt::Lanes<silt::DefaultArch>::Real;

/// Largest difference of f on a pack and on doubles.
template <class F>
double lane_difference(double from, double to, const F& f) {
  constexpr std::size_t W = silt::Lanes<silt::DefaultArch>::width;
  double worst = 0;
  for (int k = 0; k < 1000; ++k) {
    alignas(64) double x[W], y[W];
    for (std::size_t w = 0; w < W; ++w)
      x[w] = from + (to - from) * (k + static_cast<double>(w) / W) / 1000;
    silt::store(y, f(silt::load<Batch>(x)));
    for (std::size_t w = 0; w < W; ++w)
      worst = std::max(worst, std::abs(y[w] - f(x[w])) / (std::abs(f(x[w])) + 1e-3));
  }
  return worst;
}

}  // namespace

TEST_CASE("text and sentence: all digits, and six") {
  const double third = 1.0 / 3;
  const silt::Vec3d place{0.1 + 0.2, -2e-7 / 3, 12345678};
  CHECK(silt::text("t = ", third, " s at ", place) ==
        "t = 0.3333333333333333 s at (0.30000000000000004, -6.666666666666667e-08, 12345678)");
  CHECK(silt::detail::sentence("t = ", third, " s at ", place) ==
        "t = 0.333333 s at (0.3, -6.66667e-08, 1.23457e+07)");
  CHECK(silt::detail::sentence("step ", 12345678, ", above ", 0.3) == "step 12345678, above 0.3");
}

TEST_CASE("require: input as it was given, computed numbers with six digits") {
  const auto shown = [](double x) {
    std::string sentence;
    try {
      silt::require(false, x);
    } catch (const silt::InputError& error) {
      sentence = error.what();
    }
    return sentence;
  };
  CHECK(shown(1.0000001) == "1.0000001");
  CHECK(shown(-0.000123456789) == "-0.000123456789");
  CHECK(shown(123456789) == "123456789");
  CHECK(shown(1e300) == "1e+300");
  CHECK(shown(1.1292541823325377e-05) == "1.12925e-05");
  CHECK(shown(-200.0 / 3) == "-66.6667");
  // What six digits only just miss keeps all of them: x must not be above itself.
  CHECK(shown(0.1 + 0.2) == "0.30000000000000004");
  CHECK(shown(std::nextafter(0.3, 0)) == "0.29999999999999993");
  CHECK(shown(NAN) == "nan");
  CHECK(shown(-INFINITY) == "-inf");
}

TEST_CASE("in_quotes: what is shown of any text is printable, and at most 60 characters of it") {
  CHECK(silt::in_quotes("") == "''");
  CHECK(silt::in_quotes("semi-axis c") == "'semi-axis c'");
  CHECK(silt::in_quotes("a\n\t\r\x1b[31m\x7f") == "'a\\n\\t\\r\\x1b[31m\\x7f'");
  CHECK(silt::in_quotes(std::string_view("a\0b", 3)) == "'a\\x00b'");
  CHECK(silt::in_quotes("H\xC3\xB6he \xE2\x82\xAC \xF0\x9F\x98\x80") ==
        "'H\xC3\xB6he \xE2\x82\xAC \xF0\x9F\x98\x80'");
  // Broken UTF-8, control characters of Latin-1, and what turns the direction of writing.
  CHECK(silt::in_quotes("\xC3") == "'\\xc3'");
  CHECK(silt::in_quotes("\xE2\x82") == "'\\xe2\\x82'");
  CHECK(silt::in_quotes("\xC2\x9B"
                        "31m") == "'\\xc2\\x9b31m'");
  CHECK(silt::in_quotes("\xE2\x80\xAE") == "'\\xe2\\x80\\xae'");
  CHECK(silt::in_quotes(std::string(60, 'x')) == "'" + std::string(60, 'x') + "'");
  CHECK(silt::in_quotes(std::string(61, 'x')) == "'" + std::string(60, 'x') + "'... (61 bytes)");
}

TEST_CASE("functions: cube root to 1e-15 from 1e-24 to 1e24") {
  for (double digits = -24; digits <= 24; digits += 0.01) {
    const double x = std::pow(10.0, digits);
    CAPTURE(x);
    CHECK(std::abs(silt::cube_root(x) / std::cbrt(x) - 1) < 2e-15);
    CHECK(std::abs(silt::cube_root(static_cast<float>(x)) / std::cbrt(static_cast<float>(x)) - 1) <
          1e-6f);
  }
  CHECK(silt::cube_root(0.0) == 0);
  CHECK(silt::cube_root(-1.0) == 0);
}

TEST_CASE("functions: cosine to 2e-15 from -pi to pi, tanh to 2e-15 everywhere") {
  for (double x = -std::numbers::pi; x <= std::numbers::pi; x += 1e-3)
    CHECK(std::abs(silt::cosine(x) - std::cos(x)) < 2e-15);
  for (double x = -30; x <= 30; x += 1e-2) {
    CAPTURE(x);
    CHECK(std::abs(silt::hyperbolic_tangent(x) - std::tanh(x)) <= 2e-15 * std::abs(std::tanh(x)));
  }
  CHECK(silt::hyperbolic_tangent(1e300) == 1);
  CHECK(silt::hyperbolic_tangent(-1e300) == -1);
  CHECK(silt::hyperbolic_tangent(1e-300) == 1e-300);
}

TEST_CASE("functions: arc tangent to 2e-15 everywhere, of float to 5e-7") {
  for (double digits = -300; digits <= 300; digits += 0.17) {
    const double x = std::pow(10.0, digits);
    CAPTURE(x);
    CHECK(std::abs(silt::arc_tangent(x) / std::atan(x) - 1) <= 2e-15);
    CHECK(silt::arc_tangent(-x) == -silt::arc_tangent(x));
  }
  for (float x = -300; x <= 300; x += 0.31f)
    CHECK(std::abs(silt::arc_tangent(x) - std::atan(static_cast<double>(x))) <= 5e-7);
  CHECK(silt::arc_tangent(0.0) == 0);
}

TEST_CASE("functions: a pack equals doubles to a few ulp") {
  CHECK(lane_difference(1e-6, 2, [](const auto& x) { return silt::cube_root(x); }) < 2e-15);
  CHECK(lane_difference(-3, 3, [](const auto& x) { return silt::cosine(x); }) < 1e-12);  // near 0
  CHECK(lane_difference(-300, 300, [](const auto& x) { return silt::arc_tangent(x); }) < 2e-15);
  CHECK(lane_difference(-9, 9, [](const auto& x) { return silt::hyperbolic_tangent(x); }) < 2e-15);
}

}  // namespace functions_test
