// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <numbers>
#include <string_view>
#include <utility>
#include <variant>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/random.hpp>

namespace silt::inline SILT_TARGET {

/// Volume of a sphere of `radius` [m], in [m3].
inline double sphere_volume(double radius) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

namespace detail {

/// [m] diameter of the sphere of this volume [m3].
inline double equal_volume_diameter(double volume) {
  return std::cbrt(6 / std::numbers::pi * volume);
}

struct UniformSizes {
  double min, max;  // [m]
  double sample(Random& random) const { return random.uniform(min, max); }
};

inline double normal_probability(double lower, double upper) {
  // From the side where the two numbers are small, to avoid cancellation.
  return lower > 0 ? normal_probability_below(-lower) - normal_probability_below(-upper)
                   : normal_probability_below(upper) - normal_probability_below(lower);
}

/// Standard normal variable Z conditioned on lower <= Z <= upper; drawn by inversion.
struct TruncatedNormal {
  double lower, upper;
  double below = normal_probability_below(lower);
  double inside = normal_probability(lower, upper);
  double sample(Random& random) const {
    return normal_quantile(below + inside * random.open_uniform());
  }
};

struct NormalSizes {
  double mean, deviation;  // [m]
  TruncatedNormal z;
  double sample(Random& random) const { return mean + deviation * z.sample(random); }
};

struct LogNormalSizes {
  double log_median, log_deviation;  // of the radius in [m]
  TruncatedNormal z;
  double sample(Random& random) const {
    return std::exp(log_median + log_deviation * z.sample(random));
  }
};

struct SizeClasses {
  DynArray<double> radius;  // [m]
  DynArray<double> up_to;   // cumulative fraction by number up to this class
  double sample(Random& random) const {
    const auto at = std::upper_bound(up_to.begin(), up_to.end(), random.uniform());
    return radius[std::min<std::size_t>(at - up_to.begin(), radius.size() - 1)];
  }
};

}  // namespace detail

/// Distribution of sphere radii, by number. A single double is one size. Made by `uniform`,
/// `normal`, `log_normal` and `table` below; sizes are radii [m] throughout.
class SizeDistribution {
 public:
  using Law = std::variant<detail::UniformSizes, detail::NormalSizes, detail::LogNormalSizes,
                           detail::SizeClasses>;

  /// Not given: bodies have the size of their form; spheres are refused.
  SizeDistribution() : SizeDistribution(detail::UniformSizes{0, 0}, 0, 0, 0) {}
  SizeDistribution(double radius)  // implicit: {.radius = 1e-3}
      : SizeDistribution(detail::UniformSizes{radius, radius}, radius, radius,
                         radius * radius * radius) {
    require_positive("radius", radius, "m");
  }
  /// For the functions below, which check their arguments; mean_cube [m3] is the mean of radius^3.
  template <std::convertible_to<Law> OneLaw>
  SizeDistribution(OneLaw law, double min, double max, double mean_cube)
      : law_(std::move(law)), min_(min), max_(max), mean_cube_(mean_cube) {}

  /// A random radius [m], never outside [min(), max()].
  double sample(Random& random) const {
    const double radius = std::visit([&](const auto& law) { return law.sample(random); }, law_);
    return std::clamp(radius, min_, max_);  // only rounding can leave the interval
  }
  bool is_given() const { return max_ > 0; }
  double min() const { return min_; }  // [m]
  double max() const { return max_; }  // [m]
  /// Mean volume of a sphere [m3], by number: n spheres have the volume n * mean_volume().
  double mean_volume() const { return 4.0 / 3.0 * std::numbers::pi * mean_cube_; }

 private:
  Law law_;
  double min_, max_;  // [m]
  double mean_cube_;  // [m3]
};

namespace detail {

inline void require_size_range(std::string_view law, double r_min, double r_max) {
  require_positive(text(law, ": r_min"), r_min, "m");
  require_positive(text(law, ": r_max"), r_max, "m");
  require(r_min <= r_max, law, ": r_min = ", r_min, " [m] is greater than r_max = ", r_max, " [m]");
}

inline TruncatedNormal truncated(std::string_view law, double lower, double upper, double r_min,
                                 double r_max) {
  const TruncatedNormal z{lower, upper};
  require(z.inside >= 1e-6, law, ": only a fraction of ", z.inside,
          " of the untruncated law lies between r_min = ", r_min, " and r_max = ", r_max,
          " [m], which must be at least 1e-6; widen the interval or move the centre of the law");
  return z;
}

}  // namespace detail

/// Uniform distribution of the radius between `r_min` and `r_max` [m] (by number, not by mass).
inline SizeDistribution uniform(double r_min, double r_max) {
  detail::require_size_range("uniform", r_min, r_max);
  const double mean_cube = 0.25 * (r_min + r_max) * (r_min * r_min + r_max * r_max);
  return {detail::UniformSizes{r_min, r_max}, r_min, r_max, mean_cube};
}

/// Normal distribution of the radius, by number, truncated to [r_min, r_max]: `mean` and
/// `standard_deviation` [m] are those before truncation.
inline SizeDistribution normal(double mean, double standard_deviation, double r_min, double r_max) {
  require_positive("normal: mean", mean, "m");
  require_positive("normal: standard_deviation", standard_deviation, "m");
  detail::require_size_range("normal", r_min, r_max);
  const double m = mean, s = standard_deviation, a = (r_min - m) / s, b = (r_max - m) / s;
  const auto z = detail::truncated("normal", a, b, r_min, r_max);
  // Moments E[Z^k] of the truncated distribution: E[Z^k] = (k - 1) E[Z^(k-2)] + [-z^(k-1)
  // density]_a^b.
  const auto density = [&](double x) {
    return std::exp(-0.5 * x * x) / (std::sqrt(2 * std::numbers::pi) * z.inside);
  };
  const double da = density(a), db = density(b);
  const double z1 = da - db, z2 = 1 + a * da - b * db, z3 = 2 * z1 + a * a * da - b * b * db;
  const double mean_cube = m * m * m + 3 * m * m * s * z1 + 3 * m * s * s * z2 + s * s * s * z3;
  return {detail::NormalSizes{m, s, z}, r_min, r_max, mean_cube};
}

/// Log-normal distribution of the radius, by number, truncated to [r_min, r_max]. `median` [m] and
/// `geometric_standard_deviation` [-] (d84/d50 of the number distribution) are those before
/// truncation.
inline SizeDistribution log_normal(double median, double geometric_standard_deviation, double r_min,
                                   double r_max) {
  require_positive("log_normal: median", median, "m");
  require(std::isfinite(geometric_standard_deviation) && geometric_standard_deviation > 1,
          "log_normal: geometric_standard_deviation = ", geometric_standard_deviation,
          " [-] must be finite and greater than 1 (for a single size give only the radius)");
  detail::require_size_range("log_normal", r_min, r_max);
  const double s = std::log(geometric_standard_deviation);
  const double a = std::log(r_min / median) / s, b = std::log(r_max / median) / s;
  const auto z = detail::truncated("log_normal", a, b, r_min, r_max);
  // Weighting by r^3 shifts the distribution by 3 s.
  const double mean_cube = median * median * median * std::exp(4.5 * s * s) *
                           detail::normal_probability(a - 3 * s, b - 3 * s) / z.inside;
  return {detail::LogNormalSizes{std::log(median), s, z}, r_min, r_max, mean_cube};
}

/// Whether fractions are by number or by mass (all of one density).
enum class By { Number, Mass };

/// A radius and its fraction, for table().
struct SizeClass {
  double radius;    // [m]
  double fraction;  // [-]
};

/// Discrete sizes with their fractions, which must sum to 1 within 1e-6 (and are then normalised):
/// `table({{1e-3, 0.7}, {2e-3, 0.3}}, By::Mass)`. A class of fraction 0 is left out.
inline SizeDistribution table(const DynArray<SizeClass>& classes, By by) {
  double sum = 0, number = 0;
  for (std::size_t k = 0; k < classes.size(); ++k) {
    const auto& [radius, fraction] = classes[k];
    require_positive(text("table: radius of class ", k + 1), radius, "m");
    require_not_negative(text("table: fraction of class ", k + 1), fraction, "-");
    sum += fraction;
    number += by == By::Mass ? fraction / (radius * radius * radius) : fraction;
  }
  require(std::abs(sum - 1) <= 1e-6, "table: the fractions of the ", classes.size(),
          " classes sum to ", sum, " [-], which must be 1 within 1e-6");
  detail::SizeClasses law;
  double mean_cube = 0, up_to = 0;
  for (const auto& [radius, fraction] : classes) {
    if (fraction == 0) continue;
    const double cube = radius * radius * radius;
    const double share = (by == By::Mass ? fraction / cube : fraction) / number;
    law.radius.push_back(radius);
    law.up_to.push_back(up_to += share);
    mean_cube += share * cube;
  }
  const auto [least, most] = std::minmax_element(law.radius.begin(), law.radius.end());
  const double r_min = *least, r_max = *most;
  return {std::move(law), r_min, r_max, mean_cube};
}

}  // namespace silt
