// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <silt/core/random.hpp>

namespace random_test {

using silt::Random;

namespace {

/// Largest distance between the sample's distribution and `cdf`, times sqrt(n): exceeds 2.2 with
/// probability 2 exp(-2 2.2^2) = 1.2e-4 where the sample follows it (Kolmogorov, Smirnov).
template <class Cdf>
double ks_distance(std::vector<double> sample, const Cdf& cdf) {
  std::sort(sample.begin(), sample.end());
  const double n = static_cast<double>(sample.size());
  double d = 0;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const double f = cdf(sample[i]), k = static_cast<double>(i);
    d = std::max({d, f - k / n, (k + 1) / n - f});
  }
  return d * std::sqrt(n);
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double aa = 0, bb = 0, ab = 0;  // uniform numbers: mean 1/2
  for (std::size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - 0.5) * (a[i] - 0.5);
    bb += (b[i] - 0.5) * (b[i] - 0.5);
    ab += (a[i] - 0.5) * (b[i] - 0.5);
  }
  return ab / std::sqrt(aa * bb);
}

}  // namespace

TEST_CASE("random: the bits are those of SplitMix64 on every machine") {
  // first outputs of the reference implementation (Vigna, splitmix64.c) for seed 1234567
  Random random(1234567);
  CHECK(random.bits() == 6457827717110365317u);
  CHECK(random.bits() == 3203168211198807973u);
  CHECK(random.bits() == 9817491932198370423u);
  CHECK(random.bits() == 4593380528125082431u);
  CHECK(random.bits() == 16408922859458223821u);
}

TEST_CASE("random: a generator made from a stored state continues bit for bit") {
  Random random(42);
  for (int i = 0; i < 1000; ++i) random.normal(), random.uniform(), random.index(10);
  const Random::State stored{random.state().seed, random.state().counter};
  Random restored(stored);
  bool same = true;
  for (int i = 0; i < 1000; ++i)
    same = same && random.uniform() == restored.uniform() && random.normal() == restored.normal();
  CHECK(same);
  CHECK(random.state() == restored.state());
  CHECK(random.state().counter > stored.counter);
}

TEST_CASE("random: uniform numbers have the moments and the distribution of the uniform law") {
  const int n = 200000;
  for (const std::uint64_t seed : {0u, 1u, 2u, 123456789u}) {
    Random random(seed);
    std::vector<double> sample(n);
    double mean = 0, square = 0, least = 1, most = 0;
    for (auto& x : sample) {
      x = random.uniform();
      mean += x / n, square += x * x / n;
      least = std::min(least, x), most = std::max(most, x);
    }
    // 4 standard errors: variances of x and x^2 are 1/12 and 4/45
    CHECK(std::abs(mean - 0.5) < 4 * std::sqrt(1.0 / 12 / n));
    CHECK(std::abs(square - 1.0 / 3) < 4 * std::sqrt(4.0 / 45 / n));
    CHECK(least >= 0);
    CHECK(most < 1);
    CHECK(ks_distance(sample, [](double x) { return x; }) < 2.2);
  }
}

TEST_CASE("random: every one of the 64 bits is set half of the time") {
  const int n = 100000;
  Random random(7);
  std::vector<int> set(64);
  for (int i = 0; i < n; ++i) {
    const auto bits = random.bits();
    for (int b = 0; b < 64; ++b) set[b] += (bits >> b) & 1;
  }
  // 64 counts at once: 5 standard deviations sqrt(n)/2
  for (int b = 0; b < 64; ++b) CHECK(std::abs(set[b] - n / 2) < 2.5 * std::sqrt(n));
}

TEST_CASE("random: neighbouring counters and neighbouring seeds are not correlated") {
  const int n = 200000;
  const double limit = 4 / std::sqrt(n);  // 4 standard errors of a correlation of zero
  std::vector<double> a(n), next(n), other_seed(n), first_of_seed(n), first_of_next(n);
  Random random(10), seed_11(11);
  double last = random.uniform();
  for (int i = 0; i < n; ++i) {
    a[i] = last;
    next[i] = last = random.uniform();
    other_seed[i] = seed_11.uniform();
    first_of_seed[i] = Random(static_cast<std::uint64_t>(i)).uniform();
    first_of_next[i] = Random(static_cast<std::uint64_t>(i) + 1).uniform();
  }
  CHECK(std::abs(correlation(a, next)) < limit);
  CHECK(std::abs(correlation(a, other_seed)) < limit);
  CHECK(std::abs(correlation(first_of_seed, first_of_next)) < limit);
  CHECK(ks_distance(first_of_seed, [](double x) { return x; }) < 2.2);
}

TEST_CASE("random: uniform(a, b) stays between a and b and open_uniform never ends at 0 or 1") {
  Random random(3);
  bool inside = true;
  for (int i = 0; i < 100000; ++i) {
    const double x = random.uniform(-3, 5), u = random.open_uniform();
    inside = inside && x >= -3 && x <= 5 && u > 0 && u < 1;
  }
  CHECK(inside);
  CHECK(random.uniform(2, 2) == 2);
}

TEST_CASE("random: normal numbers have the moments and the distribution of the normal law") {
  const int n = 200000;
  Random random(5);
  std::vector<double> sample(n);
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0;
  for (auto& z : sample) {
    z = random.normal();
    m1 += z / n, m2 += z * z / n, m3 += z * z * z / n, m4 += z * z * z * z / n;
  }
  // 4 standard errors: variances of z, z^2, z^3, z^4 are 1, 2, 15, 96
  CHECK(std::abs(m1) < 4 * std::sqrt(1.0 / n));
  CHECK(std::abs(m2 - 1) < 4 * std::sqrt(2.0 / n));
  CHECK(std::abs(m3) < 4 * std::sqrt(15.0 / n));
  CHECK(std::abs(m4 - 3) < 4 * std::sqrt(96.0 / n));
  CHECK(ks_distance(sample, [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }) < 2.2);
}

TEST_CASE("random: the normal quantile inverts the normal distribution to 1e-13") {
  for (double z = -8; z <= 8; z += 1.0 / 64) {
    const double tail = 0.5 * std::erfc(std::abs(z) / std::sqrt(2.0));
    // the lower tail is exact to rounding; z of a tail p moves by dp / (p |z|) where |z| > 1
    CHECK(silt::detail::normal_quantile(tail) == doctest::Approx(-std::abs(z)).epsilon(1e-13));
  }
  CHECK(silt::detail::normal_quantile(0.5) == 0);
  // the upper half is the mirror image (1/4 and 3/4 are exact)
  CHECK(silt::detail::normal_quantile(0.75) == -silt::detail::normal_quantile(0.25));
  CHECK(silt::detail::normal_quantile(0.9375) == -silt::detail::normal_quantile(0.0625));
  CHECK(silt::detail::normal_quantile(0) == -HUGE_VAL);
  CHECK(silt::detail::normal_quantile(1) == HUGE_VAL);
}

TEST_CASE("random: index takes every number equally often") {
  const int n = 210000;
  Random random(9);
  std::vector<int> hits(7);
  for (int i = 0; i < n; ++i) ++hits.at(random.index(7));
  double chi2 = 0;
  for (const int h : hits) chi2 += (h - n / 7.0) * (h - n / 7.0) / (n / 7.0);
  CHECK(chi2 < 27.9);  // 6 degrees of freedom: exceeded with probability 1e-4
  CHECK(random.index(1) == 0);
  // a count just over 2^63, where a plain remainder would take half of the numbers twice as often
  const std::uint64_t half = std::uint64_t{1} << 63;
  int below_middle = 0;
  for (int i = 0; i < 10000; ++i) below_middle += random.index(half + half / 2) < half / 2;
  CHECK(std::abs(below_middle - 10000 / 3.0) < 4 * std::sqrt(10000 * 2.0 / 9));
}

TEST_CASE("random: index(0) is refused with a sentence") {
  Random random(1);
  CHECK_THROWS_WITH_AS(random.index(0), "Random::index(0): n must be at least 1", silt::InputError);
}

}  // namespace random_test
