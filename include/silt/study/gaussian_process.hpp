// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <silt/core/eigen.hpp>
#include <silt/core/error.hpp>
#include <silt/study/minimise.hpp>

namespace silt::inline SILT_TARGET {

/// Data for a Gaussian process: points of the unit cube, with the mean of some runs at each.
struct GaussianProcessData {
  Eigen::MatrixXd points;   // [-] a row each, in [0, 1]
  Eigen::VectorXd means;    // of the runs at each point
  Eigen::VectorXd repeats;  // [-] their number
  double scatter = 0;       // sum of (run - mean of its point)^2 over all runs
};

/// Correlation of a Gaussian process between points, and noise of a run.
struct GaussianProcessLengths {
  Eigen::VectorXd lengths;  // [-] of correlation, one per parameter
  double noise = 1e-6;      // [-] variance of a run's noise over that of the process
};

/// Gaussian process regression of a function of a few parameters in [0, 1] from noisy runs: kriging
/// with a linear trend,
///
///   y(x) = b0 + sum_k b_k (x_k - 1/2) + Z(x) + noise,  cov(Z(x), Z(x')) = s^2 prod_k r(h_k / l_k),
///   r(h) = (1 + a + a^2/3) exp(-a),  a = sqrt(5) |h|            (Matern 5/2)             (1)
///
/// whose trend has a flat prior (universal kriging). Lengths and noise maximise the restricted
/// likelihood of all runs, with s^2 in closed form; repeats at a point enter by their mean and
/// scatter. A weak prior on the lengths, log-normal about 0.5 with a factor e, prevents lengths of
/// 0 or infinity with few points.
/// Source: Rasmussen, Williams, "Gaussian Processes for Machine Learning" (2006), eq. 2.42, 5.8;
///         product of Matern correlations as in DiceKriging (Roustant et al. 2012), both recalled.
/// Valid:  up to some 300 points (time grows as points^3); a function of uniform roughness without
///         jumps.
/// Errors: InputError for inconsistent data, or too few for the trend.
/// Tests:  tests/study/gaussian_process.cpp (formulas by hand, coverage, noise, Ishigami).
class GaussianProcess {
 public:
  struct Prediction {
    double mean, variance;  // of the function, without the noise of a run
  };

  /// Lengths and noise by maximum likelihood: starting from `start`, or with a global search if
  /// that is null.
  GaussianProcess(const GaussianProcessData& data, const GaussianProcessLengths* start) {
    take(data);
    const Eigen::Index d = points_.cols();
    Eigen::VectorXd low(d + 1), high(d + 1);
    low << Eigen::VectorXd::Constant(d, std::log(0.05)), std::log(1e-8);
    high << Eigen::VectorXd::Constant(d, std::log(20.0)), std::log(1e2);
    const auto cost = [&](const Eigen::VectorXd& p) { return try_lengths(unpacked(p)); };
    std::vector<std::pair<Eigen::VectorXd, double>> starts;
    if (start) {
      Eigen::VectorXd p(d + 1);
      p << start->lengths.array().log().matrix(), std::log(start->noise);
      starts.emplace_back(p, 0);
    } else {
      for (std::size_t k = 0; k < 24; ++k) {
        const auto at = detail::evenly_spread(k, static_cast<std::size_t>(d) + 1);
        starts.emplace_back(low + at.cwiseProduct(high - low), 0);
        starts.back().second = cost(starts.back().first);
      }
      std::stable_sort(starts.begin(), starts.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
      starts.resize(3);
    }
    std::pair<Eigen::VectorXd, double> best{{}, std::numeric_limits<double>::infinity()};
    const auto most = static_cast<std::size_t>((start ? 25 : 60) * (d + 1));
    for (const auto& s : starts) {
      auto found =
          detail::minimise_in_box(cost, s.first, low, high, start ? 0.05 : 0.15, most, 2e-3);
      if (found.second < best.second || best.first.size() == 0) best = std::move(found);
    }
    try_lengths(unpacked(best.first));
    finish();
  }
  /// With given lengths and noise.
  GaussianProcess(const GaussianProcessData& data, const GaussianProcessLengths& given) {
    take(data);
    require(given.lengths.size() == points_.cols(), "GaussianProcess: there are ",
            given.lengths.size(), " lengths for ", points_.cols(), " parameters");
    try_lengths(given);
    finish();
  }

  Prediction predict(const Eigen::VectorXd& x) const {
    const Eigen::Index n = points_.rows();
    Eigen::VectorXd k(n);
    for (Eigen::Index i = 0; i < n; ++i) k[i] = correlation(x, points_.row(i).transpose());
    const double mean = trend(x).dot(coefficients_) + k.dot(weights_);
    factor_.matrixL().solveInPlace(k);  // L^-1 k
    const Eigen::VectorXd u = trend(x) - trends_in_factor_.transpose() * k;
    const double share = 1 - k.squaredNorm() + (trend_factor_.solve(u)).dot(u);
    return {middle_ + scale_ * mean, scale_ * scale_ * variance_ * std::max(share, 0.0)};
  }

  const GaussianProcessLengths& lengths() const { return lengths_; }
  double process_variance() const { return scale_ * scale_ * variance_; }
  /// Variance of one run about the function.
  double noise_variance() const { return lengths_.noise * process_variance(); }

  /// Sobol' indices of the mean function with all parameters uniform in [0, 1]: first order and
  /// total, one per parameter, and the total variance.
  struct Indices {
    Eigen::VectorXd first, total;
    double variance;
  };
  Indices sobol_indices() const;

 private:
  static GaussianProcessLengths unpacked(const Eigen::VectorXd& p) {
    const Eigen::Index d = p.size() - 1;
    return {p.head(d).array().exp().matrix(), std::exp(p[d])};
  }

  void take(const GaussianProcessData& data) {
    points_ = data.points, repeats_ = data.repeats;
    const Eigen::Index n = points_.rows(), d = points_.cols();
    require(d > 0 && data.means.size() == n && repeats_.size() == n,
            "GaussianProcess: points, means and repeats must be as many, of one parameter or more");
    require(n >= d + 3, "GaussianProcess: ", n, " points are too few for a trend in ", d,
            " parameters; it takes ", d + 3);
    require(data.means.allFinite() && points_.allFinite() && repeats_.minCoeff() >= 1 &&
                std::isfinite(data.scatter) && data.scatter >= 0,
            "GaussianProcess: all points, means and scatter must be finite, repeats at least 1");
    middle_ = data.means.mean();
    scale_ = std::sqrt((data.means.array() - middle_).square().mean());
    if (!(scale_ > 0)) scale_ = 1;
    values_ = (data.means.array() - middle_) / scale_;
    scatter_ = data.scatter / (scale_ * scale_);
    // Repeats that almost agree contain no relevant noise. Their likelihood, with a lower bound of
    // the noise relative to the process, would make the process itself small.
    if (scatter_ <= 1e-6 * (repeats_.sum() - static_cast<double>(n)))
      repeats_.setOnes(), scatter_ = 0;
    trends_.resize(n, d + 1);
    for (Eigen::Index i = 0; i < n; ++i) trends_.row(i) = trend(points_.row(i).transpose());
  }

  static Eigen::VectorXd trend(const Eigen::VectorXd& x) {
    Eigen::VectorXd f(x.size() + 1);
    f << 1, x.array() - 0.5;
    return f;
  }
  double correlation(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const {
    double sum = 0, product = 1;
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      const double a = std::abs(x[k] - y[k]) * inverse_[k];
      sum += a, product *= 1 + a + a * a / 3;
    }
    return product * std::exp(-sum);
  }

  /// -2 log of restricted likelihood and prior, up to a constant.
  double try_lengths(const GaussianProcessLengths& lengths) {
    lengths_ = lengths;
    inverse_ = std::sqrt(5.0) * lengths.lengths.cwiseInverse();
    const Eigen::Index n = points_.rows();
    const Eigen::MatrixXd columns = points_.transpose();
    Eigen::MatrixXd K(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      K(j, j) = 1 + lengths.noise / repeats_[j] + 1e-10;
      for (Eigen::Index i = j + 1; i < n; ++i) {
        double sum = 0, product = 1;
        for (Eigen::Index k = 0; k < columns.rows(); ++k) {
          const double a = std::abs(columns(k, i) - columns(k, j)) * inverse_[k];
          sum += a, product *= 1 + a + a * a / 3;
        }
        K(i, j) = product * std::exp(-sum);
      }
    }
    factor_.compute(K);
    if (factor_.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
    trends_in_factor_ = factor_.matrixL().solve(trends_);
    const Eigen::VectorXd y = factor_.matrixL().solve(values_);
    trend_factor_.compute(trends_in_factor_.transpose() * trends_in_factor_);
    if (trend_factor_.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
    coefficients_ = trend_factor_.solve(trends_in_factor_.transpose() * y);
    rest_ = y - trends_in_factor_ * coefficients_;
    const double runs = repeats_.sum(), points = static_cast<double>(n);
    const double free = runs - static_cast<double>(trends_.cols());
    variance_ = std::max((rest_.squaredNorm() + scatter_ / lengths.noise) / free, 1e-12);
    const auto log_det = [](const Eigen::LLT<Eigen::MatrixXd>& f) {
      return 2 * f.matrixLLT().diagonal().array().log().sum();
    };
    const double prior = (lengths.lengths.array() / 0.5).log().square().sum();
    return free * std::log(variance_) + log_det(factor_) + log_det(trend_factor_) +
           (runs - points) * std::log(lengths.noise) + prior;
  }
  void finish() { weights_ = factor_.matrixU().solve(rest_); }

  Eigen::MatrixXd points_, trends_, trends_in_factor_;
  Eigen::VectorXd repeats_, values_, inverse_, coefficients_, rest_, weights_;
  double middle_ = 0, scale_ = 1, scatter_ = 0, variance_ = 1;
  GaussianProcessLengths lengths_;
  Eigen::LLT<Eigen::MatrixXd> factor_, trend_factor_;
};

/// The mean is a sum of products of functions of one parameter each, c_j prod_k f_jk(x_k). Thus,
/// with I_jk the mean of f_jk and C_ijk that of f_ik f_jk,
///
///   V + m^2 = c' (prod_k C_k) c,   V_k + m^2 = c' (C_k prod_(l != k) I_l I_l') c              (1)
///
/// and as (1) with I and C exchanged for the joint variance of all others. Integrals by the
/// midpoint rule.
/// Source: Sobol' (1993), Homma and Saltelli (1996); Oakley and O'Hagan (2004) for the idea, all
///         recalled.
inline GaussianProcess::Indices GaussianProcess::sobol_indices() const {
  constexpr Eigen::Index nodes = 256;
  const Eigen::Index n = points_.rows(), d = points_.cols(), terms = n + d + 1;
  Eigen::VectorXd c(terms);
  c << coefficients_, weights_;
  std::vector<Eigen::MatrixXd> both, apart;  // C_k and I_k I_k'
  Eigen::VectorXd means = Eigen::VectorXd::Ones(terms);
  for (Eigen::Index k = 0; k < d; ++k) {
    Eigen::MatrixXd f = Eigen::MatrixXd::Ones(nodes, terms);
    for (Eigen::Index q = 0; q < nodes; ++q) {
      const double x = (static_cast<double>(q) + 0.5) / static_cast<double>(nodes);
      f(q, 1 + k) = x - 0.5;
      for (Eigen::Index i = 0; i < n; ++i) {
        const double a = std::abs(x - points_(i, k)) * inverse_[k];
        f(q, d + 1 + i) = (1 + a + a * a / 3) * std::exp(-a);
      }
    }
    const Eigen::VectorXd I = f.colwise().mean();
    both.push_back(f.transpose() * f / static_cast<double>(nodes));
    apart.push_back(I * I.transpose());
    means = means.cwiseProduct(I);
  }
  const double mean = c.dot(means);
  /// Variance of the mean of the function over all parameters except `of`.
  const auto variance = [&](const auto& of) {
    Eigen::MatrixXd product = Eigen::MatrixXd::Ones(terms, terms);
    for (Eigen::Index k = 0; k < d; ++k)
      product = product.cwiseProduct((of(k) ? both : apart)[static_cast<std::size_t>(k)]);
    return std::max(c.dot(product * c) - mean * mean, 0.0);
  };
  const double whole = variance([](Eigen::Index) { return true; });
  Indices out{Eigen::VectorXd::Zero(d), Eigen::VectorXd::Zero(d), scale_ * scale_ * whole};
  if (!(whole > 1e-14)) return out;
  for (Eigen::Index k = 0; k < d; ++k) {
    out.first[k] = variance([&](Eigen::Index l) { return l == k; }) / whole;
    out.total[k] = 1 - variance([&](Eigen::Index l) { return l != k; }) / whole;
  }
  out.total = out.total.cwiseMax(0.0);
  return out;
}

}  // namespace silt
