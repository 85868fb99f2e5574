// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

inline double polynomial(const double (&c)[8], double x) {
  double sum = c[7];
  for (int k = 6; k >= 0; --k) sum = sum * x + c[k];
  return sum;
}

/// Quantile z with P(Z < z) = p of the standard normal distribution; -inf at p <= 0, +inf at p >=
/// 1.
/// Source: Wichura, Applied Statistics 37 (1988) 477, algorithm AS 241, PPND16 (relative error of
/// about 1e-16).
inline double normal_quantile(double p) {
  static constexpr double a[] = {
      3.3871328727963666080, 133.14166789178437745, 1971.5909503065514427, 13731.693765509461125,
      45921.953931549871457, 67265.770927008700853, 33430.575583588128105, 2509.0809287301226727};
  static constexpr double b[] = {1.0,
                                 42.313330701600911252,
                                 687.18700749205790830,
                                 5394.1960214247511077,
                                 21213.794301586595867,
                                 39307.895800092710610,
                                 28729.085735721942674,
                                 5226.4952788528545610};
  static constexpr double c[] = {1.42343711074968357734,   4.63033784615654529590,
                                 5.76949722146069140550,   3.64784832476320460504,
                                 1.27045825245236838258,   0.241780725177450611770,
                                 0.0227238449892691845833, 7.74545014278341407640e-4};
  static constexpr double d[] = {1.0,
                                 2.05319162663775882187,
                                 1.67638483018380384940,
                                 0.689767334985100004550,
                                 0.148103976427480074590,
                                 0.0151986665636164571966,
                                 5.47593808499534494600e-4,
                                 1.05075007164441684324e-9};
  static constexpr double e[] = {6.65790464350110377720,    5.46378491116411436990,
                                 1.78482653991729133580,    0.296560571828504891230,
                                 0.0265321895265761230930,  0.00124266094738807843860,
                                 2.71155556874348757815e-5, 2.01033439929228813265e-7};
  static constexpr double f[] = {1.0,
                                 0.599832206555887937690,
                                 0.136929880922735805310,
                                 0.0148753612908506148525,
                                 7.86869131145613259100e-4,
                                 1.84631831751005468180e-5,
                                 1.42151175831644588870e-7,
                                 2.04426310338993978564e-15};
  if (p <= 0) return -HUGE_VAL;
  if (p >= 1) return HUGE_VAL;
  const double q = p - 0.5;
  if (std::abs(q) <= 0.425) {
    const double s = 0.180625 - q * q;
    return q * polynomial(a, s) / polynomial(b, s);
  }
  const double t = std::sqrt(-std::log(q < 0 ? p : 1 - p));
  const double z = t <= 5 ? polynomial(c, t - 1.6) / polynomial(d, t - 1.6)
                          : polynomial(e, t - 5) / polynomial(f, t - 5);
  return q < 0 ? -z : z;
}

/// P(Z < z) of the standard normal distribution, the inverse of normal_quantile.
inline double normal_probability_below(double z) {
  return 0.5 * std::erfc(-z * std::numbers::sqrt2 / 2);
}

}  // namespace detail

/// Random numbers, equal on every machine: SplitMix64 as a hash of a counter,
///
///   bits(n) = mix(seed + n * 0x9e3779b97f4a7c15),   n = 1, 2, ...
///
/// Seed and counter are the whole state: a checkpoint stores two integers.
/// Source: Steele, Lea, Flood, OOPSLA 2014, doi:10.1145/2660193.2660195 (passes BigCrush).
/// Valid:  period 2^64 per seed; not for cryptography. Equal everywhere, bit for bit: `bits`,
///         `uniform()`, `open_uniform`, `index`. `uniform(a, b)` and `normal` may differ in the
///         last digits if the compiler fuses a product and a sum, or if log is rounded differently.
class Random {
 public:
  struct State {
    std::uint64_t seed = 1;
    std::uint64_t counter = 0;  // of numbers drawn so far
    friend bool operator==(const State&, const State&) = default;
  };

  explicit Random(std::uint64_t seed) : state_{seed, 0} {}
  explicit Random(const State& state) : state_(state) {}

  const State& state() const { return state_; }

  /// 64 random bits.
  std::uint64_t bits() {
    std::uint64_t z = state_.seed + ++state_.counter * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Uniform in (0, 1), never 0 or 1: for logarithms and quantiles.
  double open_uniform() { return (static_cast<double>(bits() >> 12) + 0.5) * 0x1p-52; }

  /// Uniform between `a` and `b`; rounding may reach `b`.
  double uniform(double a, double b) { return a + (b - a) * uniform(); }

  /// Normal with mean 0 and standard deviation 1, limited by the 53 bits to 8.2; draws one number.
  double normal() { return detail::normal_quantile(open_uniform()); }

  /// Uniform among 0, 1, ..., n - 1, without bias.
  std::uint64_t index(std::uint64_t n) {
    require(n > 0, "Random::index(0): n must be at least 1");
    const std::uint64_t surplus =
        (0 - n) % n;  // 2^64 mod n: values that would favour small numbers
    std::uint64_t drawn = bits();
    while (drawn < surplus) drawn = bits();
    return drawn % n;
  }

 private:
  State state_;
};

}  // namespace silt
