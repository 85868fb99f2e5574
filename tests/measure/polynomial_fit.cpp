// silt - BSD-3-Clause, see LICENSE
//
// Polynomials through points, and bands that hold the curve, or one more point, as often as they
// say.
#include <array>
#include <cmath>
#include <vector>

#include "near.hpp"
#include "refusal.hpp"

#include <silt/core/random.hpp>
#include <silt/measure/polynomial_fit.hpp>

namespace polynomial_fit_test {

using silt_test::has;
using silt_test::refusal;

TEST_CASE(
    "student_quantile: printed values to 0.15 % from 3 degrees of freedom on, 2e-4 from 6 on") {
  // Tables of Student's t at 0.975 (recalled; 1.96 would be 38 % off at 3).
  constexpr std::array<std::array<double, 3>, 6> table{{{3, 3.18245, 1.5e-3},
                                                        {6, 2.44691, 2e-4},
                                                        {10, 2.22814, 1e-4},
                                                        {30, 2.04227, 1e-4},
                                                        {100, 1.98397, 1e-4},
                                                        {1e6, 1.95997, 1e-5}}};
  for (const auto& [freedom, t, tolerance] : table) {
    CHECK(near_relative(silt::student_quantile(0.975, freedom), t, tolerance));
    CHECK(silt::student_quantile(0.025, freedom) ==
          near(-silt::student_quantile(0.975, freedom)).epsilon(1e-9));
  }
  CHECK(has(refusal([] { silt::student_quantile(0.9, 2); }), "freedom = 2"));
  CHECK(has(refusal([] { silt::student_quantile(1, 9); }), "p = 1"));
}

TEST_CASE("fit_polynomial: points of a parabola give its coefficients to 1e-9, also far from 0") {
  std::vector<double> x, y;
  for (int k = 0; k < 12; ++k) {
    x.push_back(100 + 0.1 * k * k), y.push_back(3 - 2 * x.back() + 0.5 * x.back() * x.back());
  }
  const auto fit = silt::fit_polynomial<2>(x, y);
  const auto b = fit.coefficients();
  CHECK(b[0] == near(3).epsilon(1e-6));  // at x = 0, 20 times the points' width away
  CHECK(b[1] == near(-2).epsilon(1e-8));
  CHECK(b[2] == near(0.5).epsilon(1e-9));
  CHECK(fit.at(103) == near(3 - 206 + 0.5 * 103 * 103).epsilon(1e-12));
  CHECK(fit.deviation < 1e-9);
  CHECK(fit.points == 12);
  const auto line = silt::fit_polynomial<1>(x, y);  // least squares: no other line is nearer
  const auto squares = [&](double up, double tilt) {
    double sum = 0;
    for (std::size_t k = 0; k < x.size(); ++k)
      sum += std::pow(y[k] - line.at(x[k]) - up - tilt * (x[k] - 105), 2);
    return sum;
  };
  for (const double up : {-0.1, 0.1})
    for (const double tilt : {-0.1, 0.0, 0.1}) CHECK(squares(up, tilt) > squares(0, 0));
}

TEST_CASE("fit_polynomial: bands of 95 % hold 95 % of curves and points, within 4 sigma of 4000") {
  // 8 points: with the normal law's 1.96 instead of Student's 2.57, 89 % would be held.
  silt::Random random(7);
  const auto curve = [](double x) { return 0.3 - x + 2 * x * x; };
  const int tries = 4000;
  for (const double at : {0.1, 0.5, 1.3}) {
    int curves = 0, points = 0;
    for (int n = 0; n < tries; ++n) {
      std::vector<double> x, y;
      for (int k = 0; k < 8; ++k)
        x.push_back(k / 7.0), y.push_back(curve(x.back()) + 0.2 * random.normal());
      const auto fit = silt::fit_polynomial<2>(x, y);
      curves += std::abs(fit.at(at) - curve(at)) <= fit.band_of_curve(at);
      points += std::abs(fit.at(at) - curve(at) - 0.2 * random.normal()) <= fit.band_of_points(at);
    }
    const double sigma = std::sqrt(0.95 * 0.05 / tries);
    CHECK(std::abs(1.0 * curves / tries - 0.95) < 4 * sigma);
    CHECK(std::abs(1.0 * points / tries - 0.95) < 4 * sigma);
  }
}

TEST_CASE("fit_polynomial: what is refused") {
  const std::vector<double> one{1, 1, 1, 1, 1, 1}, two{1, 2, 1, 2, 1, 2}, y{1, 2, 3, 4, 5, 6};
  CHECK(has(refusal([&] { silt::fit_polynomial<1>(one, y); }), "all points have x = 1"));
  CHECK(has(refusal([&] { silt::fit_polynomial<2>(two, y); }), "fewer than 3 different x"));
  CHECK(has(refusal([&] {
              silt::fit_polynomial<2>(std::vector<double>{1, 2, 3}, std::vector<double>{1, 2, 3});
            }),
            "at least 6"));
  auto wrong = y;
  wrong[2] = std::nan("");
  CHECK(has(refusal([&] { silt::fit_polynomial<1>(y, wrong); }), "point 2"));
  CHECK(has(refusal([&] { silt::fit_polynomial<1>(y, y).band_of_curve(1, 1.5); }), "share = 1.5"));
}

}  // namespace polynomial_fit_test
