// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/study/gaussian_process.hpp>

/// Surrogates of a calibration: a Gaussian process for each target, and quantities derived from all
/// of them. Parameters u are in [0, 1] between their bounds.
namespace silt::inline SILT_TARGET::detail {

/// A target of the surrogates.
struct Wanted {
  double measured, error;  // [unit of the target], standard deviation
};

/// E[max(0, c - z^2)] for a normal z.
inline double mean_below(double c, double mean, double deviation) {
  if (!(c > 0)) return 0;
  if (!(deviation > 1e-12 * (1 + std::abs(mean)))) return std::max(0.0, c - mean * mean);
  const double a = (-std::sqrt(c) - mean) / deviation, b = (std::sqrt(c) - mean) / deviation;
  const auto density = [](double t) {
    return std::exp(-0.5 * t * t) / std::sqrt(2 * std::numbers::pi);
  };
  const double p = a > 0 ? normal_probability_below(-a) - normal_probability_below(-b)
                         : normal_probability_below(b) - normal_probability_below(a);
  const double pa = density(a), pb = density(b);
  return std::max(0.0, (c - mean * mean - deviation * deviation) * p -
                           2 * mean * deviation * (pa - pb) -
                           deviation * deviation * (a * pa - b * pb));
}

/// chi^2 = sum_t ((y_t - measured_t)/error_t)^2 where each y_t has a mean and a deviation.
class Misfit {
 public:
  explicit Misfit(std::vector<Wanted> wanted) : wanted_(std::move(wanted)) {
    constexpr std::size_t samples = 128;
    const std::size_t others = wanted_.size() - 1;
    for (std::size_t k = 0; others > 0 && k < samples; ++k) {
      auto z = evenly_spread(k, others);
      for (Eigen::Index i = 0; i < z.size(); ++i)
        z[i] = normal_quantile(std::clamp(z[i], 1e-9, 1 - 1e-9));
      normals_.push_back(std::move(z));
    }
  }

  using Known = std::vector<GaussianProcess::Prediction>;

  double mean(const Known& y) const {
    double sum = 0;
    for (std::size_t t = 0; t < y.size(); ++t) {
      const double off = y[t].mean - wanted_[t].measured, e = wanted_[t].error;
      sum += (off * off + y[t].variance) / (e * e);
    }
    return sum;
  }

  /// Expected improvement E[max(0, best - chi^2)]: in closed form over the most uncertain target,
  /// and by 128 quasi-random points over the others.
  /// Source: Jones, Schonlau, Welch (1998) for the criterion, recalled.
  double expected_improvement(const Known& y, double best) const {
    std::vector<std::pair<double, double>> z;  // mean and deviation of (y - measured)/error
    for (std::size_t t = 0; t < y.size(); ++t)
      z.emplace_back((y[t].mean - wanted_[t].measured) / wanted_[t].error,
                     std::sqrt(y[t].variance) / wanted_[t].error);
    std::stable_sort(z.begin(), z.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    if (normals_.empty()) return mean_below(best, z[0].first, z[0].second);
    double sum = 0;
    for (const auto& n : normals_) {
      double rest = best;
      for (std::size_t t = 1; t < z.size(); ++t) {
        const double other = z[t].first + z[t].second * n[static_cast<Eigen::Index>(t - 1)];
        rest -= other * other;
      }
      sum += mean_below(rest, z[0].first, z[0].second);
    }
    return sum / static_cast<double>(normals_.size());
  }

  /// Logarithm of the density of the measurements, given the predictions for these parameters; the
  /// surrogate's variance is added to that of the measurement.
  double log_likelihood(const Known& y) const {
    double sum = 0;
    for (std::size_t t = 0; t < y.size(); ++t) {
      const double off = y[t].mean - wanted_[t].measured;
      const double variance = wanted_[t].error * wanted_[t].error + y[t].variance;
      sum -= 0.5 * (off * off / variance + std::log(variance));
    }
    return sum;
  }

 private:
  std::vector<Wanted> wanted_;
  std::vector<Eigen::VectorXd> normals_;
};

/// Failed runs: share of failures near u, 0 far from all of them, by kriging with fixed lengths of
/// a quarter of the bounds.
class Failures {
 public:
  Failures() = default;
  Failures(Eigen::MatrixXd points, const Eigen::VectorXd& share) : points_(std::move(points)) {
    if (!(share.maxCoeff() > 0)) {
      points_.resize(0, 0);
      return;
    }
    const Eigen::Index n = points_.rows();
    Eigen::MatrixXd K = Eigen::MatrixXd::Identity(n, n) * 1.05;
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < i; ++j)
        K(i, j) = correlation(points_.row(i).transpose(), points_.row(j).transpose());
    weights_ = K.llt().solve(share);  // reads the lower half
  }
  double share(const Eigen::VectorXd& u) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < points_.rows(); ++i)
      sum += weights_[i] * correlation(u, points_.row(i).transpose());
    return std::clamp(sum, 0.0, 1.0);
  }

 private:
  static double correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return std::exp(-8 * (a - b).squaredNorm());  // length 1/4: exp(-h^2/(2 l^2))
  }
  Eigen::MatrixXd points_;
  Eigen::VectorXd weights_;
};

/// Surrogates of all targets.
class Surrogate {
 public:
  Surrogate(std::vector<GaussianProcess> targets, const std::vector<Wanted>& wanted,
            Failures failures)
      : targets_(std::move(targets)), misfit_(wanted), failures_(std::move(failures)) {}

  const std::vector<GaussianProcess>& targets() const { return targets_; }
  Misfit::Known predict(const Eigen::VectorXd& u) const {
    Misfit::Known out;
    for (const auto& t : targets_) out.push_back(t.predict(u));
    return out;
  }
  double chi2(const Eigen::VectorXd& u) const { return misfit_.mean(predict(u)); }
  double expected_improvement(const Eigen::VectorXd& u, double best) const {
    return misfit_.expected_improvement(predict(u), best) * (1 - failures_.share(u));
  }
  /// Logarithm of the posterior density, with a uniform prior.
  double log_posterior(const Eigen::VectorXd& u) const {
    return misfit_.log_likelihood(predict(u)) + std::log(std::max(1 - failures_.share(u), 1e-6));
  }

 private:
  std::vector<GaussianProcess> targets_;
  Misfit misfit_;
  Failures failures_;
};

/// The u with the largest `value` in the unit cube: some hundred points everywhere, some around
/// `near`, and a simplex search from the best few.
template <class Value>
std::pair<Eigen::VectorXd, double> largest_in_cube(const Value& value, std::size_t dimensions,
                                                   const std::vector<Eigen::VectorXd>& near,
                                                   Random& random, bool logarithmic) {
  const auto d = static_cast<Eigen::Index>(dimensions);
  std::vector<std::pair<double, Eigen::VectorXd>> tried;
  const auto attempt = [&](Eigen::VectorXd u) { tried.emplace_back(value(u), std::move(u)); };
  const double shift = random.uniform();
  for (std::size_t k = 0; k < 250 * dimensions; ++k) attempt(evenly_spread(k, dimensions, shift));
  for (const auto& centre : near) {
    attempt(centre);
    for (std::size_t k = 0; k < 40 * dimensions; ++k) {
      const double width = std::pow(10, random.uniform(-3, -0.7));
      Eigen::VectorXd u = centre;
      for (Eigen::Index i = 0; i < d; ++i)
        u[i] = std::clamp(u[i] + width * random.normal(), 0.0, 1.0);
      attempt(std::move(u));
    }
  }
  std::stable_sort(tried.begin(), tried.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  const Eigen::VectorXd low = Eigen::VectorXd::Zero(d), high = Eigen::VectorXd::Ones(d);
  auto best = tried[0];
  for (std::size_t k = 0; k < 3; ++k) {
    const auto found = minimise_in_box(
        [&](const Eigen::VectorXd& u) {
          return logarithmic ? -std::log(value(u) + 1e-300) : -value(u);
        },
        tried[k].second, low, high, 0.02, 60 * dimensions);
    Eigen::VectorXd u = found.first;
    for (auto& x : u) x = x < 1e-6 ? 0 : x > 1 - 1e-6 ? 1 : x;  // exactly on a bound
    const double there = value(u);
    if (there > best.first) best = {there, u};
  }
  return {best.second, best.first};
}

/// Sample of exp(log_density) in the unit cube by an ensemble of walkers, each moved along the line
/// through another one, starting from quasi-random points chosen by their density.
/// Source: Goodman, Weare, Comm. App. Math. Comp. Sci. 5 (2010) 65, the stretch move with a = 2.
template <class LogDensity>
std::vector<Eigen::VectorXd> sample_in_cube(const LogDensity& log_density, std::size_t dimensions,
                                            const std::vector<Eigen::VectorXd>& near,
                                            Random& random, std::size_t rounds = 300) {
  const std::size_t walkers = std::max<std::size_t>(40, 6 * dimensions);
  const auto d = static_cast<double>(dimensions);
  std::vector<std::pair<double, Eigen::VectorXd>> all;
  const auto add = [&](Eigen::VectorXd u) { all.emplace_back(log_density(u), std::move(u)); };
  for (std::size_t k = 0; k < 1000 * dimensions; ++k) add(evenly_spread(k, dimensions));
  for (const auto& centre : near)
    for (std::size_t k = 0; k < 5 * dimensions; ++k) {
      Eigen::VectorXd u = centre;
      for (auto& x : u) x = std::clamp(x + 0.01 * random.normal(), 0.0, 1.0);
      add(std::move(u));
    }
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& a : all) most = std::max(most, a.first);
  // Chosen in proportion to the density, with repetition.
  std::vector<double> sums;
  double sum = 0;
  for (const auto& a : all) sums.push_back(sum += std::exp(a.first - most));
  std::vector<std::pair<double, Eigen::VectorXd>> at;
  for (std::size_t k = 0; k < walkers; ++k) {
    const double wanted = sum * random.uniform();
    auto place =
        static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), wanted) - sums.begin());
    at.push_back(all[std::min(place, all.size() - 1)]);
    auto& u = at.back().second;  // no two at one point
    for (auto& x : u) x = std::clamp(x + 1e-3 * random.normal(), 0.0, 1.0);
    at.back().first = log_density(u);
  }
  std::vector<Eigen::VectorXd> out;
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < walkers; ++k) {
      const std::size_t half = walkers / 2;  // the partner is from the other half
      const std::size_t other = k < half ? half + random.index(walkers - half) : random.index(half);
      const double root = random.uniform(std::sqrt(0.5), std::sqrt(2.0)), z = root * root;
      const Eigen::VectorXd u = at[other].second + z * (at[k].second - at[other].second);
      const double draw = random.open_uniform();
      if (u.minCoeff() < 0 || u.maxCoeff() > 1) continue;
      const double there = log_density(u);
      if (std::log(draw) < (d - 1) * std::log(z) + there - at[k].first) at[k] = {there, u};
    }
    if (4 * round >= rounds && round % 4 == 0)
      for (const auto& a : at) out.push_back(a.second);
  }
  return out;
}

/// Latin hypercube: each parameter is in a different one of as many equal intervals at each point.
/// Of 200 such designs, the one with the largest smallest distance between points.
inline std::vector<Eigen::VectorXd> latin_hypercube(std::size_t points, std::size_t dimensions,
                                                    Random& random) {
  std::vector<Eigen::VectorXd> best;
  double farthest = -1;
  for (int attempt = 0; attempt < 200; ++attempt) {
    std::vector<Eigen::VectorXd> all(points,
                                     Eigen::VectorXd(static_cast<Eigen::Index>(dimensions)));
    for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(dimensions); ++k) {
      std::vector<std::size_t> order(points);
      for (std::size_t i = 0; i < points; ++i) {
        const std::size_t j = random.index(i + 1);
        order[i] = order[j], order[j] = i;
      }
      for (std::size_t i = 0; i < points; ++i)
        all[i][k] =
            (static_cast<double>(order[i]) + random.uniform()) / static_cast<double>(points);
    }
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points; ++i)
      for (std::size_t j = 0; j < i; ++j)
        nearest = std::min(nearest, (all[i] - all[j]).squaredNorm());
    if (nearest > farthest) farthest = nearest, best = std::move(all);
  }
  return best;
}

}  // namespace silt::detail
