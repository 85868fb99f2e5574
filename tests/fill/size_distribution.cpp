// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <silt/fill/size_distribution.hpp>

#include "near.hpp"

namespace size_distribution_test {

using silt::By;
using silt::Random;
using silt::SizeDistribution;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

std::vector<double> draw(const SizeDistribution& sizes, int n, std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<double> radii(n);
  for (auto& r : radii) r = sizes.sample(random);
  return radii;
}

/// Integral of f over [a, b] by Simpson's rule: error below 1e-12 for these smooth functions.
double integral(double a, double b, const std::function<double(double)>& f) {
  const int n = 20000;
  const double h = (b - a) / n;
  double sum = f(a) + f(b);
  for (int i = 1; i < n; ++i) sum += (i % 2 ? 4 : 2) * f(a + i * h);
  return sum * h / 3;
}

/// Checks samples and mean volume against a density over [a, b] that need not be normalised.
void check_against_density(const SizeDistribution& sizes, double a, double b,
                           const std::function<double(double)>& density) {
  const double all = integral(a, b, density);
  const auto mean_of = [&](const std::function<double(double)>& f) {
    return integral(a, b, [&](double r) { return f(r) * density(r); }) / all;
  };
  CHECK(sizes.min() == a);
  CHECK(sizes.max() == b);
  const double cube = mean_of([](double r) { return r * r * r; });
  // closed form against quadrature: both to rounding, which the moments amplify by up to 1e3
  CHECK(sizes.mean_volume() == near(4.0 / 3 * std::acos(-1.0) * cube).epsilon(1e-10));

  const int n = 100000;
  const auto radii = draw(sizes, n);
  CHECK(*std::min_element(radii.begin(), radii.end()) >= a);
  CHECK(*std::max_element(radii.begin(), radii.end()) <= b);
  for (const int power : {1, 2, 3}) {
    const double mean = mean_of([&](double r) { return std::pow(r, power); });
    const double square = mean_of([&](double r) { return std::pow(r, 2 * power); });
    double found = 0;
    for (const double r : radii) found += std::pow(r, power) / n;
    CAPTURE(power);
    CHECK(std::abs(found - mean) < 4 * std::sqrt((square - mean * mean) / n));  // 4 standard errors
  }
  for (const double at : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    const double r = a + at * (b - a), exact = integral(a, r, density) / all;
    const auto below = std::count_if(radii.begin(), radii.end(), [&](double x) { return x < r; });
    CAPTURE(at);
    CHECK(std::abs(static_cast<double>(below) / n - exact) <
          4 * std::sqrt(exact * (1 - exact) / n) + 1e-12);
  }
}

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const silt::InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

}  // namespace

TEST_CASE("size_distribution: a single number is one size") {
  const SizeDistribution sizes = 1.5e-3;
  for (const double r : draw(sizes, 100)) CHECK(r == 1.5e-3);
  CHECK(sizes.mean_volume() == near(silt::sphere_volume(1.5e-3)).epsilon(1e-15));
  CHECK(sizes.min() == 1.5e-3);
  CHECK(sizes.max() == 1.5e-3);
}

TEST_CASE("size_distribution: uniform has the moments and quantiles of the uniform law") {
  check_against_density(silt::uniform(1e-3, 3e-3), 1e-3, 3e-3, [](double) { return 1.0; });
  CHECK(silt::uniform(2e-3, 2e-3).mean_volume() == near(silt::sphere_volume(2e-3)).epsilon(1e-15));
}

TEST_CASE("size_distribution: normal has the moments and quantiles of the truncated law") {
  const auto check = [](double m, double s, double a, double b) {
    CAPTURE(a);
    check_against_density(silt::normal(m, s, a, b), a, b,
                          [=](double r) { return std::exp(-0.5 * (r - m) * (r - m) / (s * s)); });
  };
  check(2e-3, 0.3e-3, 1e-3, 3e-3);      // nearly whole
  check(2e-3, 1e-3, 1.5e-3, 2.2e-3);    // lopsided
  check(2e-3, 0.3e-3, 2.9e-3, 3.5e-3);  // upper tail alone
  check(2e-3, 0.3e-3, 0.5e-3, 1.1e-3);  // lower tail alone
}

TEST_CASE("size_distribution: log_normal has the moments and quantiles of the truncated law") {
  const auto check = [](double median, double gsd, double a, double b) {
    CAPTURE(a);
    check_against_density(silt::log_normal(median, gsd, a, b), a, b, [=](double r) {
      const double z = std::log(r / median) / std::log(gsd);
      return std::exp(-0.5 * z * z) / r;
    });
  };
  check(1e-3, 1.3, 0.5e-3, 2e-3);
  check(1e-3, 2.0, 0.2e-3, 4e-3);
  check(1e-3, 1.5, 2e-3, 5e-3);  // upper tail alone
}

TEST_CASE("size_distribution: a table by number gives the stated numbers") {
  const auto sizes = silt::table({{3e-3, 0.2}, {1e-3, 0.5}, {2e-3, 0.3}}, By::Number);
  CHECK(sizes.min() == 1e-3);
  CHECK(sizes.max() == 3e-3);
  const double cube = 0.2 * 27e-9 + 0.5 * 1e-9 + 0.3 * 8e-9;
  CHECK(sizes.mean_volume() == near(4.0 / 3 * std::acos(-1.0) * cube).epsilon(1e-14));
  const int n = 100000;
  std::map<double, double> found;
  for (const double r : draw(sizes, n)) found[r] += 1.0 / n;
  REQUIRE(found.size() == 3);
  for (const auto& [r, share] : std::map<double, double>{{1e-3, 0.5}, {2e-3, 0.3}, {3e-3, 0.2}})
    CHECK(std::abs(found[r] - share) < 4 * std::sqrt(share * (1 - share) / n));
}

TEST_CASE("size_distribution: a table by mass gives the stated masses") {
  const auto sizes = silt::table({{1e-3, 0.25}, {2e-3, 0.25}, {4e-3, 0.5}}, By::Mass);
  // numbers are as 0.25 / 1 : 0.25 / 8 : 0.5 / 64
  const double all = 0.25 + 0.25 / 8 + 0.5 / 64;
  CHECK(sizes.mean_volume() == near(silt::sphere_volume(1e-3) / all).epsilon(1e-14));
  const int n = 400000;
  std::map<double, double> mass;
  double total = 0;
  for (const double r : draw(sizes, n)) mass[r] += r * r * r, total += r * r * r;
  const double counts[] = {n * 0.25 / all, n * 0.25 / 8 / all, n * 0.5 / 64 / all};
  // the mass share moves with the counts: relative error at most 1/sqrt(count) of each class
  CHECK(std::abs(mass[1e-3] / total - 0.25) < 4 * 0.25 / std::sqrt(counts[2]));
  CHECK(std::abs(mass[2e-3] / total - 0.25) < 4 * 0.25 / std::sqrt(counts[2]));
  CHECK(std::abs(mass[4e-3] / total - 0.50) < 4 * 0.50 / std::sqrt(counts[2]));
}

TEST_CASE("size_distribution: a class of fraction 0 is never drawn nor counted in min and max") {
  const auto sizes = silt::table({{1e-3, 0}, {2e-3, 1}, {9e-3, 0}}, By::Number);
  CHECK(sizes.min() == 2e-3);
  CHECK(sizes.max() == 2e-3);
  for (const double r : draw(sizes, 1000)) CHECK(r == 2e-3);
}

TEST_CASE("size_distribution: the same seed draws the same radii, another seed others") {
  const auto sizes = silt::log_normal(1e-3, 1.4, 0.5e-3, 2e-3);
  CHECK(draw(sizes, 1000, 5) == draw(sizes, 1000, 5));
  CHECK(draw(sizes, 1000, 5) != draw(sizes, 1000, 6));
}

TEST_CASE("size_distribution: impossible values are refused by name") {
  const auto says = [](const std::function<void()>& action, const std::string& words) {
    const auto sentence = refusal(action);
    CAPTURE(sentence);
    CAPTURE(words);
    CHECK(sentence.find(words) != std::string::npos);
  };
  says([] { SizeDistribution{-1e-3}; }, "radius = -0.001 [m]");
  says([] { SizeDistribution{not_a_number}; }, "radius = nan [m]");
  says([] { silt::uniform(0, 1e-3); }, "uniform: r_min = 0 [m]");
  says([] { silt::uniform(2e-3, 1e-3); },
       "uniform: r_min = 0.002 [m] is greater than r_max = 0.001");
  says([] { silt::uniform(1e-3, not_a_number); }, "uniform: r_max = nan [m]");
  says([] { silt::normal(1e-3, 0, 1e-3, 2e-3); }, "normal: standard_deviation = 0 [m]");
  says([] { silt::normal(not_a_number, 1e-4, 1e-3, 2e-3); }, "normal: mean = nan [m]");
  says([] { silt::normal(1e-3, 1e-4, 3e-3, 4e-3); },
       "lies between r_min = 0.003 and r_max = 0.004");
  says([] { silt::normal(1e-3, 1e-4, 2e-3, 1e-3); }, "normal: r_min = 0.002 [m] is greater");
  says([] { silt::log_normal(-1, 1.5, 1e-3, 2e-3); }, "log_normal: median = -1 [m]");
  says([] { silt::log_normal(1e-3, 1, 1e-3, 2e-3); },
       "log_normal: geometric_standard_deviation = 1 [-]");
  says([] { silt::log_normal(1e-3, not_a_number, 1e-3, 2e-3); },
       "log_normal: geometric_standard_deviation = nan [-]");
  says([] { silt::log_normal(1e-3, 1.1, 5e-3, 6e-3); }, "lies between r_min = 0.005");
  says([] { silt::table({}, By::Number); }, "the fractions of the 0 classes sum to 0");
  says([] { silt::table({{1e-3, 0.5}, {2e-3, 0.4}}, By::Mass); }, "sum to 0.9 [-]");
  says(
      [] {
        silt::table({{1e-3, 1.5}, {2e-3, -0.5}}, By::Mass);
      },
      "fraction of class 2 = -0.5 [-]");
  says([] { silt::table({{1e-3, 0.5}, {0, 0.5}}, By::Number); }, "radius of class 2 = 0 [m]");
  says([] { silt::table({{1e-3, not_a_number}}, By::Number); }, "fraction of class 1 = nan [-]");
}

}  // namespace size_distribution_test
