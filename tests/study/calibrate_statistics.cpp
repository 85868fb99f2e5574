// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/study/calibrate.hpp>

#include "near.hpp"

#ifndef SILT_COVERAGE_SCENES
#define SILT_COVERAGE_SCENES 20  // more: how well the level is kept
#endif

namespace calibrate_statistics_test {

namespace {

using namespace silt;

Eigen::VectorXd at(std::initializer_list<double> x) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(x.size()));
  Eigen::Index k = 0;
  for (const double c : x) v[k++] = c;
  return v;
}

}  // namespace

TEST_CASE("calibrate: expected improvement of one target is its integral, to 1e-6") {
  const double cases[][3] = {{1, 0, 1},  {4, 1.5, 0.5}, {0.3, 2, 0.4},
                             {9, -4, 1}, {2, 1, 1e-3},  {5, 1, 40}};
  for (const auto& [c, mean, deviation] : cases) {
    // Simpson's rule over where z^2 < c, and within 12 deviations.
    const double from = std::max(-std::sqrt(c), mean - 12 * deviation);
    const double to = std::min(std::sqrt(c), mean + 12 * deviation);
    constexpr int n = 20000;
    double sum = 0;
    for (int k = 0; k <= n; ++k) {
      const double z = from + (to - from) * k / n, t = (z - mean) / deviation;
      const double density = std::exp(-0.5 * t * t) / (deviation * std::sqrt(2 * std::numbers::pi));
      sum += (k == 0 || k == n ? 1 : k % 2 ? 4 : 2) * (c - z * z) * density;
    }
    sum *= (to - from) / (3 * n);
    CHECK(near_relative(silt::detail::mean_below(c, mean, deviation), sum, 1e-6));
  }
  CHECK(silt::detail::mean_below(-1, 0, 1) == 0);
  CHECK(silt::detail::mean_below(3, 1, 0) == 2);
}

TEST_CASE("calibrate: expected improvement of several targets is that of sampling") {
  const std::vector<silt::detail::Wanted> wanted{{10, 2}, {3, 0.5}, {-1, 1}};
  const silt::detail::Misfit misfit(wanted);
  Random random(3);
  const silt::detail::Misfit::Known cases[] = {{{11, 1}, {3.2, 0.04}, {-1.5, 0.2}},
                                               {{13, 4}, {3.4, 0.09}, {-0.5, 0.5}},
                                               {{10, 0.01}, {3, 1}, {-1, 1}}};
  for (const auto& y : cases) {
    constexpr int n = 400000;
    double sum = 0, squares = 0, mean = 0;
    for (int k = 0; k < n; ++k) {
      double chi2 = 0;
      for (std::size_t t = 0; t < 3; ++t) {
        const double z = y[t].mean + std::sqrt(y[t].variance) * random.normal();
        chi2 += std::pow((z - wanted[t].measured) / wanted[t].error, 2);
      }
      const double gain = std::max(0.0, 2.5 - chi2);
      sum += gain / n, squares += gain * gain / n, mean += chi2 / n;
    }
    const double error = std::sqrt((squares - sum * sum) / n);
    MESSAGE("by sampling " << sum << " +- " << error << ", "
                           << misfit.expected_improvement(y, 2.5));
    // 128 evenly spread points over two targets: within 4 %, and 5 errors of the sampling.
    CHECK(std::abs(misfit.expected_improvement(y, 2.5) - sum) < 0.04 * sum + 5 * error);
    CHECK(near_relative(misfit.mean(y), mean, 0.02));
  }
}

TEST_CASE("calibrate: the walkers draw a normal density that a side of the cube cuts off") {
  // x about 0.1 with deviation 0.2, of which 31 % would lie below 0; y given x about x, 0.05.
  const auto density = [](const Eigen::VectorXd& u) {
    return -0.5 * (std::pow((u[0] - 0.1) / 0.2, 2) + std::pow((u[1] - u[0]) / 0.05, 2));
  };
  Random random(5);
  const auto sample = silt::detail::sample_in_cube(density, 2, {}, random, 1200);
  double x = 0, y = 0, xx = 0, wx = 0, wxx = 0, w = 0, wy = 0;
  for (const auto& u : sample) {
    const auto n = static_cast<double>(sample.size());
    x += u[0] / n, y += u[1] / n, xx += u[0] * u[0] / n;
  }
  for (int i = 0; i < 1000; ++i)
    for (int j = 0; j < 1000; ++j) {
      const auto u = at({(i + 0.5) / 1000, (j + 0.5) / 1000});
      const double p = std::exp(density(u));
      w += p, wx += p * u[0], wxx += p * u[0] * u[0], wy += p * u[1];
    }
  // 9000 points of 40 walkers, every fourth round: as 1000 independent ones, a deviation of 0.13
  // gives 0.004 of error; 4 of them.
  CHECK(std::abs(x - wx / w) < 0.016);
  CHECK(std::abs(y - wy / w) < 0.016);
  CHECK(near_relative(std::sqrt(xx - x * x), std::sqrt(wxx / w - std::pow(wx / w, 2)), 0.1));
}

TEST_CASE("calibrate: a Latin hypercube has one point in each row and column, far apart") {
  Random random(2);
  const auto all = silt::detail::latin_hypercube(12, 3, random);
  for (Eigen::Index k = 0; k < 3; ++k) {
    std::vector<int> seen(12, 0);
    for (const auto& u : all) ++seen[static_cast<std::size_t>(u[k] * 12)];
    CHECK(std::count(seen.begin(), seen.end(), 1) == 12);
  }
  double nearest = 1;
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, (all[i] - all[j]).norm());
  CHECK(nearest > 0.25);  // of one at random about 0.15
}

TEST_CASE("calibrate: planted parameters lie in their 90 % intervals in 90 % of the cases") {
  // 20 noisy scenes of two parameters and three targets, planted anywhere in the bounds, measured
  // with errors drawn anew. 40 intervals, of which 36 are expected to hold the planted value with a
  // standard deviation of 1.9 if they are independent and 2.7 if the two of a scene always agree:
  // at least 29, 2.6 of the latter. Intervals that are half as wide as they should be hold 59 %.
  std::size_t inside = 0, wide = 0, scenes = SILT_COVERAGE_SCENES;
  double width = 0;
  std::size_t runs = 0;
  for (std::size_t k = 0; k < scenes; ++k) {
    Random random(1000 + k);
    const auto outputs = [](const std::vector<double>& p) {
      return std::vector<double>{20 + 30 * std::sqrt(p[1]) + 5 * p[0] * p[0],
                                 40 * std::tanh(2 * p[0] * p[1]) + 10 * p[0],
                                 std::exp(2 * p[0]) - 3 * p[1]};
    };
    const std::vector<double> planted{random.uniform(0.3, 0.9), random.uniform(0.1, 0.8)};
    const double errors[] = {1, 1.5, 0.3};
    std::vector<CalibrationTarget> targets;
    const auto exact = outputs(planted);
    for (std::size_t t = 0; t < 3; ++t)
      targets.push_back({text("t", t), exact[t] + errors[t] * random.normal(), errors[t]});
    Calibration cal{
        {.budget = 40, .repeats = 2, .seed = k + 1, .credible = 0.9},
        {{.name = "e", .least = 0.3, .most = 0.9}, {.name = "mu", .least = 0.1, .most = 0.8}},
        targets};
    const auto& result = cal.run([&](const std::vector<double>& p, std::uint64_t seed) {
      Random noise(seed);
      auto y = outputs(p);
      for (std::size_t t = 0; t < 3; ++t) y[t] += 0.5 * errors[t] * noise.normal();
      return y;
    });
    runs += result.runs.size();
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& p = result.parameters[i];
      inside += p.low <= planted[i] && planted[i] <= p.high;
      width += (p.high - p.low) / (i == 0 ? 0.6 : 0.7);
      wide += p.low > p.median || p.median > p.high;
    }
  }
  const auto all = static_cast<double>(2 * scenes);
  MESSAGE(inside << " of " << all << " inside, mean width " << width / all << " of the bounds, "
                 << runs / scenes << " runs a scene");
  CHECK(static_cast<double>(inside) >= 29.0 / 40 * all);
  CHECK(width / all < 0.5);  // else they would hold everything
  CHECK(wide == 0);
}

}  // namespace calibrate_statistics_test
