// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <silt/study/calibration_results.hpp>
#include <silt/study/calibration_surrogate.hpp>

/// Results of a calibration from its surrogates.
namespace silt::inline SILT_TARGET::detail {

/// Ends of the shortest interval that contains this share of the sorted numbers in [0, 1]. It
/// extends to a bound if the outermost number is its end and within a hundredth of the bound.
inline std::pair<double, double> shortest_interval(const std::vector<double>& sorted,
                                                   double share) {
  const auto n = sorted.size();
  const auto held =
      std::min(n - 1, static_cast<std::size_t>(std::ceil(share * static_cast<double>(n))));
  std::size_t from = 0;
  for (std::size_t k = 0; k + held < n; ++k)
    if (sorted[k + held] - sorted[k] < sorted[from + held] - sorted[from]) from = k;
  double low = sorted[from], high = sorted[from + held];
  if (low - sorted.front() < 0.01 && low < 0.01) low = 0;
  if (sorted.back() - high < 0.01 && high > 0.99) high = 1;
  return {low, high};
}

/// Recommended values, intervals, sample and correlation of the posterior.
inline void fill_parameters(CalibrationResult& r, const std::vector<CalibrationParameter>& given,
                            const Surrogate& model, const Eigen::VectorXd& recommended,
                            const std::vector<Eigen::VectorXd>& near, Random& random) {
  const auto sample = sample_in_cube(
      [&](const Eigen::VectorXd& u) { return model.log_posterior(u); }, given.size(), near, random);
  for (const auto& u : sample) {
    auto& values = r.samples.emplace_back();
    for (std::size_t k = 0; k < given.size(); ++k)
      values.push_back(given[k].value(u[static_cast<Eigen::Index>(k)]));
  }
  Eigen::MatrixXd all(static_cast<Eigen::Index>(sample.size()),
                      static_cast<Eigen::Index>(given.size()));
  for (std::size_t k = 0; k < given.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    std::vector<double> u;
    for (const auto& s : sample) u.push_back(s[column]);
    for (std::size_t i = 0; i < u.size(); ++i) all(static_cast<Eigen::Index>(i), column) = u[i];
    std::sort(u.begin(), u.end());
    const auto [low, high] = shortest_interval(u, r.credible);
    r.parameters.push_back({given[k].name, given[k].value(recommended[column]), given[k].value(low),
                            given[k].value(u[u.size() / 2]), given[k].value(high), 0});
  }
  const Eigen::MatrixXd centred = all.rowwise() - all.colwise().mean();
  const Eigen::MatrixXd covariance = centred.transpose() * centred;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    auto& row = r.correlation.emplace_back();
    for (Eigen::Index j = 0; j < covariance.rows(); ++j)
      row.push_back(covariance(i, j) /
                    std::sqrt(std::max(covariance(i, i) * covariance(j, j), 1e-300)));
  }
}

/// Targets by the surrogates, and weights of the parameters: their total Sobol' indices summed over
/// the targets.
inline void fill_targets(CalibrationResult& r, const std::vector<CalibrationTarget>& given,
                         const Surrogate& model, const Eigen::VectorXd& recommended,
                         const std::vector<double>& confirmed) {
  double whole = 0;
  for (std::size_t t = 0; t < given.size(); ++t) {
    const auto& gp = model.targets()[t];
    const auto seen = gp.predict(recommended);
    const auto indices = gp.sobol_indices();
    CalibrationResult::Target target{
        given[t].name,
        given[t].measured,
        given[t].error,
        seen.mean,
        std::sqrt(seen.variance),
        std::sqrt(gp.noise_variance()),
        confirmed.empty() ? std::numeric_limits<double>::quiet_NaN() : confirmed[t],
        {indices.first.begin(), indices.first.end()},
        {indices.total.begin(), indices.total.end()}};
    for (std::size_t k = 0; k < r.parameters.size(); ++k) {
      r.parameters[k].weight += target.total[k], whole += target.total[k];
    }
    const double now = confirmed.empty() ? seen.mean : confirmed[t];
    r.chi2 += std::pow((now - given[t].measured) / given[t].error, 2);
    r.targets.push_back(std::move(target));
  }
  for (auto& p : r.parameters) p.weight /= whole > 0 ? whole : 1;
}

/// chi^2 of the surrogates over each pair of the four parameters with the largest weights.
inline void fill_surfaces(CalibrationResult& r, const std::vector<CalibrationParameter>& given,
                          const Surrogate& model, const Eigen::VectorXd& recommended) {
  constexpr int steps = 40;
  std::vector<std::size_t> order(given.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return r.parameters[a].weight > r.parameters[b].weight;
  });
  order.resize(std::min<std::size_t>(order.size(), 4));
  std::sort(order.begin(), order.end());
  const auto share = [](int i) { return static_cast<double>(i) / steps; };
  const auto add = [&](std::size_t a, std::size_t b) {
    CalibrationResult::Surface s{.first = a, .second = b};
    Eigen::VectorXd u = recommended;
    for (int i = 0; i <= steps; ++i) {
      s.x.push_back(given[a].value(share(i)));
      if (a != b) s.y.push_back(given[b].value(share(i)));
      u[static_cast<Eigen::Index>(a)] = share(i);
      for (int j = 0; j <= (a == b ? 0 : steps); ++j) {
        if (a != b) u[static_cast<Eigen::Index>(b)] = share(j);
        s.chi2.push_back(model.chi2(u));
      }
    }
    r.surfaces.push_back(std::move(s));
  };
  if (order.size() == 1) add(0, 0);
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) add(order[i], order[j]);
}

/// Warnings for the use of the values.
inline void fill_notes(CalibrationResult& r, const std::vector<CalibrationParameter>& given,
                       const std::vector<CalibrationTarget>& targets) {
  const auto note = [&](std::string sentence) { r.notes.push_back(std::move(sentence)); };
  for (const auto& run : r.runs)
    if (run.failed()) {
      note(text(r.failures(), " of ", r.runs.size(), " runs failed; the first: ", run.failure));
      break;
    }
  // chi^2 for these degrees of freedom that is exceeded once in a thousand (Wilson and Hilferty).
  const std::size_t T = targets.size(), d = given.size();
  const double freedom = T > d ? static_cast<double>(T - d) : 1, w = 2 / (9 * freedom);
  const double most = freedom * std::pow(1 - w + 3.09 * std::sqrt(w), 3);
  if (std::min(r.chi2, r.best_chi2) > most)
    note(text("no values within the bounds reproduce the measurements: chi^2 = ",
              three_digits(std::min(r.chi2, r.best_chi2)), " where ", three_digits(most),
              " is exceeded once in a thousand; wider bounds, other parameters, or larger errors"));
  for (std::size_t k = 0; k < d; ++k) {
    const auto& p = r.parameters[k];
    const double wide = given[k].share(p.high) - given[k].share(p.low);
    const double u = given[k].share(p.recommended);
    if (wide > 0.75 * r.credible)
      note(text(p.name, " is not determined by these targets: its interval is ",
                std::round(100 * wide), " % of its bounds"));
    else if (u < 0.005 || u > 0.995)
      note(text(p.name, " is recommended at its bound ", u < 0.5 ? given[k].least : given[k].most,
                "; the best value may lie outside"));
  }
  for (std::size_t i = 0; i < d; ++i)
    for (std::size_t j = i + 1; j < d; ++j)
      if (const double c = r.correlation[i][j]; std::abs(c) > 0.9)
        note(text(r.parameters[i].name, " and ", r.parameters[j].name,
                  " are known together only (correlation ", three_digits(c),
                  "): another target would separate them"));
  for (const auto& t : r.targets)
    if (t.deviation > t.error)
      note(text("the surrogate of ", t.name, " is less certain (", three_digits(t.deviation),
                ") than the measurement (", three_digits(t.error),
                "); more runs or repeats make the intervals narrower"));
}

}  // namespace silt::detail
