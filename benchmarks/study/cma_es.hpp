// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <numeric>
#include <utility>
#include <vector>

#include <silt/core/eigen.hpp>
#include <silt/core/random.hpp>

/// The (mu/mu_w, lambda)-CMA-ES with default parameters in the unit cube, for comparison with
/// calibrations: the usual optimiser for functions known only by their values.
///
/// Source: Hansen, "The CMA Evolution Strategy: A Tutorial" (arXiv:1604.00772), eqs. 5 to 58 and
///         table 1 without negative weights (active CMA left out); restarts with a doubled
///         population (IPOP, Auger and Hansen 2005). Recalled.
/// Bounds: candidates outside are drawn again, up to 100 times, then put on the bound.
namespace cma_es {

struct Options {
  double step = 0.3;     // [-] first standard deviation, of the box
  std::size_t most = 0;  // evaluations
};

/// Minimises `f`, which is called for each candidate in turn and returns {value, stop}; ends when
/// stop is true or `most` evaluations are made.
template <class Function>
void minimise(const Function& f, std::size_t dimensions, const Options& options,
              silt::Random& random) {
  using Vector = Eigen::VectorXd;
  const auto n = static_cast<double>(dimensions);
  const auto d = static_cast<Eigen::Index>(dimensions);
  std::size_t evaluations = 0;
  double factor = 1;  // of the population
  for (;; factor *= 2) {
    const auto lambda = static_cast<std::size_t>(factor * (4 + std::floor(3 * std::log(n))));
    const std::size_t mu = lambda / 2;
    std::vector<double> w(mu);
    for (std::size_t i = 0; i < mu; ++i)
      w[i] = std::log((static_cast<double>(lambda) + 1) / 2) - std::log(static_cast<double>(i) + 1);
    const double sum = std::accumulate(w.begin(), w.end(), 0.0);
    double squares = 0;
    for (auto& x : w) x /= sum, squares += x * x;
    const double mu_eff = 1 / squares;
    const double c_sigma = (mu_eff + 2) / (n + mu_eff + 5);
    const double d_sigma = 1 + 2 * std::max(0.0, std::sqrt((mu_eff - 1) / (n + 1)) - 1) + c_sigma;
    const double c_c = (4 + mu_eff / n) / (n + 4 + 2 * mu_eff / n);
    const double c_1 = 2 / ((n + 1.3) * (n + 1.3) + mu_eff);
    const double c_mu =
        std::min(1 - c_1, 2 * (mu_eff - 2 + 1 / mu_eff) / ((n + 2) * (n + 2) + mu_eff));
    const double expected = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));

    Vector mean(d), p_sigma = Vector::Zero(d), p_c = Vector::Zero(d);
    for (auto& x : mean) x = random.uniform();
    double sigma = options.step;
    Eigen::MatrixXd C = Eigen::MatrixXd::Identity(d, d);
    std::deque<double> bests;  // of the last generations
    for (std::size_t generation = 0;; ++generation) {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(C);
      const Vector D = eigen.eigenvalues().cwiseMax(1e-300).cwiseSqrt();
      const Eigen::MatrixXd& B = eigen.eigenvectors();
      std::vector<std::pair<double, Vector>> all;
      for (std::size_t k = 0; k < lambda; ++k) {
        Vector x;
        for (int attempt = 0; attempt < 100; ++attempt) {
          Vector z(d);
          for (auto& v : z) v = random.normal();
          x = mean + sigma * (B * D.cwiseProduct(z));
          if (x.minCoeff() >= 0 && x.maxCoeff() <= 1) break;
        }
        x = x.cwiseMax(0.0).cwiseMin(1.0);
        const auto [value, stop] = f(x);
        ++evaluations;
        if (stop || evaluations >= options.most) return;
        all.emplace_back(value, std::move(x));
      }
      std::stable_sort(all.begin(), all.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      Vector step = Vector::Zero(d);
      for (std::size_t i = 0; i < mu; ++i) step += w[i] * (all[i].second - mean) / sigma;
      const Vector old = mean;
      mean += sigma * step;
      p_sigma = (1 - c_sigma) * p_sigma + std::sqrt(c_sigma * (2 - c_sigma) * mu_eff) *
                                              (B * (B.transpose() * step).cwiseQuotient(D));
      const double along =
          p_sigma.norm() /
          std::sqrt(1 - std::pow(1 - c_sigma, 2 * (static_cast<double>(generation) + 1)));
      const bool h = along < (1.4 + 2 / (n + 1)) * expected;
      p_c = (1 - c_c) * p_c + (h ? std::sqrt(c_c * (2 - c_c) * mu_eff) : 0.0) * step;
      Eigen::MatrixXd rank_mu = Eigen::MatrixXd::Zero(d, d);
      for (std::size_t i = 0; i < mu; ++i) {
        const Vector y = (all[i].second - old) / sigma;
        rank_mu += w[i] * y * y.transpose();
      }
      C = (1 - c_1 - c_mu + (h ? 0.0 : c_1 * c_c * (2 - c_c))) * C + c_1 * p_c * p_c.transpose() +
          c_mu * rank_mu;
      sigma *= std::exp(std::min(1.0, c_sigma / d_sigma * (p_sigma.norm() / expected - 1)));
      // The tutorial's reasons for a restart: no progress, too small steps, a degenerate matrix.
      bests.push_back(all[0].first);
      if (bests.size() > 10 + static_cast<std::size_t>(30 * n / static_cast<double>(lambda)))
        bests.pop_front();
      const auto [low, high] = std::minmax_element(bests.begin(), bests.end());
      const bool flat =
          bests.size() >= 10 + static_cast<std::size_t>(30 * n / static_cast<double>(lambda)) &&
          std::max(*high, all.back().first) - *low < 1e-12;
      const bool small = sigma * C.diagonal().cwiseSqrt().maxCoeff() < 1e-12 * options.step;
      const bool degenerate = D.maxCoeff() > 1e7 * D.minCoeff();  // condition 1e14
      if (flat || small || degenerate || !std::isfinite(sigma)) break;
    }
  }
}

}  // namespace cma_es
