// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/study/gaussian_process.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace gaussian_process_test {

namespace {

using namespace silt;
using silt_test::has, silt_test::refusal;

/// Runs of a function at `n` points that fill the cube, each `repeats` times.
template <class Function>
GaussianProcessData runs_of(const Function& f, std::size_t n, std::size_t d, double noise = 0,
                            std::size_t repeats = 1, std::uint64_t seed = 1) {
  Random random(seed);
  const auto rows = static_cast<Eigen::Index>(n), columns = static_cast<Eigen::Index>(d);
  GaussianProcessData data{Eigen::MatrixXd(rows, columns), Eigen::VectorXd(rows),
                           Eigen::VectorXd::Constant(rows, static_cast<double>(repeats)), 0};
  const double shift = random.uniform();
  for (std::size_t k = 0; k < n; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    data.points.row(i) = silt::detail::evenly_spread(k, d, shift);
    std::vector<double> y;
    double mean = 0;
    for (std::size_t r = 0; r < repeats; ++r) {
      y.push_back(f(data.points.row(i).transpose().eval()) + noise * random.normal());
      mean += y.back() / static_cast<double>(repeats);
    }
    data.means[i] = mean;
    for (const double v : y) data.scatter += (v - mean) * (v - mean);
  }
  return data;
}

Eigen::VectorXd at(std::initializer_list<double> x) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(x.size()));
  Eigen::Index k = 0;
  for (const double c : x) v[k++] = c;
  return v;
}

double matern(double h) {
  const double a = std::sqrt(5.0) * std::abs(h);
  return (1 + a + a * a / 3) * std::exp(-a);
}

}  // namespace

TEST_CASE("gaussian_process: predictions are those of kriging solved directly, to 1e-9") {
  // Independent formulas: the system of universal kriging with multipliers of the trend,
  // [K F; F' 0], by a dense LU of the whole; the variance of its error from the same weights.
  const auto f = [](const Eigen::VectorXd& x) { return std::sin(3 * x[0]) + x[1] * x[1] * x[0]; };
  auto data = runs_of(f, 9, 2, 0.1, 3);
  data.repeats[4] = 1;
  const GaussianProcessLengths given{at({0.4, 0.9}), 0.05};
  const GaussianProcess gp(data, given);
  const Eigen::Index n = 9, p = 3;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + p, n + p);
  const auto corr = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    return matern((a[0] - b[0]) / 0.4) * matern((a[1] - b[1]) / 0.9);
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd a = data.points.row(i);
    for (Eigen::Index j = 0; j < n; ++j) A(i, j) = corr(a, data.points.row(j));
    A(i, i) += 0.05 / data.repeats[i];
    A.block(i, n, 1, p) << 1, a[0], a[1];
    A.block(n, i, p, 1) = A.block(i, n, 1, p).transpose();
  }
  // s^2: generalised least squares in full, and the scatter of the repeats.
  const Eigen::MatrixXd K = A.topLeftCorner(n, n), F = A.topRightCorner(n, p);
  const Eigen::MatrixXd inverse = K.inverse();
  const Eigen::VectorXd b =
      (F.transpose() * inverse * F).inverse() * F.transpose() * inverse * data.means;
  const Eigen::VectorXd e = data.means - F * b;
  const double s2 = (e.dot(inverse * e) + data.scatter / 0.05) / (data.repeats.sum() - 3);
  CHECK(near_relative(gp.process_variance(), s2, 1e-7));
  for (const auto& x : {at({0.3, 0.6}), at({0.95, 0.05}), at({0, 1})}) {
    Eigen::VectorXd right(n + p);
    for (Eigen::Index i = 0; i < n; ++i) right[i] = corr(x, data.points.row(i));
    right.tail(p) << 1, x[0], x[1];
    const Eigen::VectorXd w = A.fullPivLu().solve(right);
    const auto seen = gp.predict(x);
    CHECK(std::abs(seen.mean - w.head(n).dot(data.means)) < 1e-8);
    CHECK(near_relative(seen.variance, s2 * (1 - w.dot(right)), 1e-6));
  }
}

TEST_CASE("gaussian_process: without noise it goes through its points, and is sure of them") {
  const auto f = [](const Eigen::VectorXd& x) { return std::exp(x[0]) * std::cos(4 * x[1]); };
  const auto data = runs_of(f, 30, 2);
  const GaussianProcess gp(data, nullptr);
  double worst = 0;
  for (Eigen::Index i = 0; i < 30; ++i) {
    const auto seen = gp.predict(data.points.row(i).transpose());
    CHECK(std::abs(seen.mean - data.means[i]) < 1e-4);
    CHECK(std::sqrt(seen.variance) < 1e-2);
  }
  for (std::size_t k = 0; k < 50; ++k) {
    const auto x = silt::detail::evenly_spread(k, 2, 0.123);
    worst = std::max(worst, std::abs(gp.predict(x).mean - f(x)));
  }
  CHECK(worst < 0.05);  // of a function between -2.7 and 2.7
}

TEST_CASE(
    "gaussian_process: its variance is that of its errors, over samples of processes like it") {
  // 100 functions drawn from the model itself with known lengths, 12 predictions of each, by
  // lengths and noise that are fitted to 25 noisy points. Of 400 functions the errors have 1.61
  // times the predicted variance and 11 % are outside of 95 %: lengths are taken as known
  // (plug-in). Bounds: what a variance wrong by a factor of 2 would not keep, and the trend's share
  // of it left out.
  Random random(7);
  double squares = 0;
  std::size_t count = 0, outside = 0;
  for (int k = 0; k < 100; ++k) {
    const auto design = runs_of([](const Eigen::VectorXd&) { return 0.0; }, 37, 2, 0, 1,
                                static_cast<std::uint64_t>(k) + 1);
    Eigen::MatrixXd K(37, 37);
    for (Eigen::Index i = 0; i < 37; ++i)
      for (Eigen::Index j = 0; j < 37; ++j)
        K(i, j) = matern((design.points(i, 0) - design.points(j, 0)) / 0.5) *
                      matern((design.points(i, 1) - design.points(j, 1)) / 0.3) +
                  (i == j ? 1e-10 : 0);
    Eigen::VectorXd z(37);
    for (Eigen::Index i = 0; i < 37; ++i) z[i] = random.normal();
    const Eigen::VectorXd y = K.llt().matrixL() * z;
    GaussianProcessData data{design.points.topRows(25), y.head(25), Eigen::VectorXd::Ones(25), 0};
    for (Eigen::Index i = 0; i < 25; ++i) data.means[i] += 0.1 * random.normal();
    const GaussianProcess gp(data, nullptr);  // lengths and noise from 25 points
    for (Eigen::Index i = 25; i < 37; ++i) {
      const auto seen = gp.predict(design.points.row(i).transpose());
      const double off = (seen.mean - y[i]) / std::sqrt(seen.variance);
      squares += off * off, ++count, outside += std::abs(off) > 1.96;
    }
  }
  const double ratio = squares / static_cast<double>(count);
  const double share = static_cast<double>(outside) / static_cast<double>(count);
  MESSAGE("variance of errors over predicted: " << ratio << ", outside of 95 %: " << share);
  CHECK(ratio > 1.0);
  CHECK(ratio < 2.2);
  CHECK(share < 0.16);
}

TEST_CASE("gaussian_process: repeats give the noise of a run") {
  const auto f = [](const Eigen::VectorXd& x) { return 3 + std::sin(5 * x[0]); };
  // 20 points of 4 runs: 60 degrees of freedom, so that the deviation is known to 9 %: 4 of it.
  const GaussianProcess gp(runs_of(f, 20, 1, 0.3, 4), nullptr);
  CHECK(near_relative(std::sqrt(gp.noise_variance()), 0.3, 0.37));
  // Without repeats from the roughness alone.
  const GaussianProcess alone(runs_of(f, 80, 1, 0.3), nullptr);
  CHECK(near_relative(std::sqrt(alone.noise_variance()), 0.3, 0.37));
}

TEST_CASE("gaussian_process: repeats that agree change nothing") {
  // With a least noise that is a share of the process, 3 repeats without scatter made the lengths
  // short and the function wavy between its points: by some 20 % of its range.
  const auto f = [](const Eigen::VectorXd& x) { return 1 / (0.1 + x[0]); };
  const auto once = runs_of(f, 12, 2), thrice = runs_of(f, 12, 2, 0, 3);
  const GaussianProcess a(once, nullptr), b(thrice, nullptr);
  for (std::size_t k = 0; k < 20; ++k) {
    const auto x = silt::detail::evenly_spread(k, 2, 0.4);
    CHECK(near_relative(b.predict(x).mean, a.predict(x).mean, 1e-6));
  }
}

TEST_CASE("gaussian_process: Sobol' indices of Ishigami's function are the published ones") {
  const auto ishigami = [](const Eigen::VectorXd& u) {
    const double pi = std::numbers::pi;
    const auto x = [&](Eigen::Index k) { return pi * (2 * u[k] - 1); };
    return std::sin(x(0)) + 7 * std::pow(std::sin(x(1)), 2) +
           0.1 * std::pow(x(2), 4) * std::sin(x(0));
  };
  const auto indices = GaussianProcess(runs_of(ishigami, 160, 3), nullptr).sobol_indices();
  const double first[] = {0.3139, 0.4424, 0}, total[] = {0.5576, 0.4424, 0.2437};
  for (Eigen::Index k = 0; k < 3; ++k) {
    MESSAGE("S" << k + 1 << " = " << indices.first[k] << ", total " << indices.total[k]);
    CHECK(std::abs(indices.first[k] - first[k]) < 0.02);
    CHECK(std::abs(indices.total[k] - total[k]) < 0.02);
  }
  CHECK(near_relative(indices.variance, 13.8446, 0.03));
}

TEST_CASE("gaussian_process: Sobol' indices of its mean are those of sampling it") {
  const auto f = [](const Eigen::VectorXd& x) {
    return x[0] + 2 * x[0] * x[1] + std::sin(6 * x[1]);
  };
  const GaussianProcess gp(runs_of(f, 25, 2), nullptr);
  const auto indices = gp.sobol_indices();
  // Brute force on a grid of 60 x 60: means along each direction.
  constexpr int n = 60;
  double rows[n] = {}, columns[n] = {};
  double mean = 0, square = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double y = gp.predict(at({(i + 0.5) / n, (j + 0.5) / n})).mean;
      mean += y / (n * n), square += y * y / (n * n), rows[i] += y / n, columns[j] += y / n;
    }
  const double V = square - mean * mean;
  double of_rows = -mean * mean, of_columns = -mean * mean;
  for (int i = 0; i < n; ++i)
    of_rows += rows[i] * rows[i] / n, of_columns += columns[i] * columns[i] / n;
  CHECK(near_relative(indices.variance, V, 2e-3));
  CHECK(near_relative(indices.first[0], of_rows / V, 2e-3));
  CHECK(near_relative(indices.first[1], of_columns / V, 2e-3));
  CHECK(near_relative(indices.total[0], 1 - of_columns / V, 2e-3));
}

TEST_CASE("gaussian_process: what does not fit together is refused; a constant is no trouble") {
  const auto zero = [](const Eigen::VectorXd&) { return 4.0; };
  auto data = runs_of(zero, 4, 2);
  CHECK(has(refusal([&] { GaussianProcess(data, nullptr); }),
            "4 points are too few for a trend in 2"));
  data = runs_of(zero, 8, 2);
  CHECK(has(refusal([&] { GaussianProcess(data, {at({1}), 0.1}); }), "1 lengths for 2 parameters"));
  data.means[3] = std::nan("");
  CHECK(has(refusal([&] { GaussianProcess(data, nullptr); }), "must be finite"));
  data.means.resize(3);
  CHECK(has(refusal([&] { GaussianProcess(data, nullptr); }), "must be as many"));
  const GaussianProcess flat(runs_of(zero, 8, 2), nullptr);
  CHECK(near_relative(flat.predict(at({0.3, 0.3})).mean, 4, 1e-6));
  CHECK(flat.sobol_indices().total.maxCoeff() == 0);
}

TEST_CASE(
    "gaussian_process: the simplex finds the bottom of a curved valley, and stays in its box") {
  bool inside = true;
  const auto valley = [&](const Eigen::VectorXd& x) {
    inside = inside && x.minCoeff() >= -1 && x.maxCoeff() <= 2;
    return 100 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1 - x[0], 2);
  };
  const auto low = at({-1, -1}), high = at({2, 2});
  const auto found =
      silt::detail::minimise_in_box(valley, at({-0.8, 2}), low, high, 0.1, 2000, 1e-7);
  CHECK((found.first - at({1, 1})).norm() < 1e-4);
  CHECK(inside);
  const auto plane = [](const Eigen::VectorXd& x) { return x[0] - x[1]; };
  const auto corner = silt::detail::minimise_in_box(plane, at({0.5, 0.5}), low, high, 0.1, 500);
  CHECK((corner.first - at({-1, 2})).norm() < 1e-2);
}

}  // namespace gaussian_process_test
