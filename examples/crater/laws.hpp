// silt - BSD-3-Clause, see LICENSE
#pragma once

// Laws of the depth and of the force, fitted to all drops together.

#include <cmath>
#include <vector>

#include <silt/eigen.hpp>

#include "crater/measure.hpp"

namespace crater {

/// Depth [balls] at which a ball comes to rest that is `over` times as dense as the bed and has
/// fallen by `fall` [balls], its depth included: 0.14/mu over^(1/2) fall^(1/3), mu the tangent of
/// the angle of repose. J. S. Uehara, M. A. Ambroso, R. P. Ojha, D. J. Durian, Phys. Rev. Lett. 90
/// (2003) 194301; the exponents as in their abstract, the factor recalled.
inline double law_depth(double mu, double over, double fall) {
  return 0.14 / mu * std::sqrt(over) * std::cbrt(fall);
}

/// Fit of all drops: ln(depth/D) = c + n ln(H/D) + b ln(density of ball over bed).
inline silt::LinearFit fit_depths(const Scene& s, const Bed& bed, const std::vector<Outcome>& all) {
  const auto n = static_cast<Eigen::Index>(all.size());
  Eigen::MatrixXd x(n, 3);
  Eigen::VectorXd y(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Outcome& o = all[static_cast<std::size_t>(k)];
    x.row(k) << 1, std::log(o.total / s.body()), std::log(o.drop.density / bed.density());
    y[k] = std::log(o.depth / s.body());
  }
  return silt::fit_linear(x, y);
}

/// The force law of Katsuragi and Durian, F/m = v^2/d1 + k z, fitted to the way down of all drops
/// of one density.
struct ForceLaw {
  double density, d1, d1_error, k, k_error;  // [kg/m3], [m] and its standard error, [1/s2]

  ForceLaw(double of, const std::vector<Outcome>& all) : density(of) {
    std::vector<Eigen::Vector3d> points;  // v^2, z, F/m
    for (const Outcome& o : all)
      for (const Sample& p : o.samples)
        if (o.drop.density == of && p.depth > 0 && p.speed > 0.05 * o.drop.speed())
          points.emplace_back(p.speed * p.speed, p.depth, p.force / o.mass);
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(points.size()), 3);
    for (Eigen::Index row = 0; row < rows.rows(); ++row)
      rows.row(row) = points[static_cast<std::size_t>(row)];
    const silt::LinearFit fit = silt::fit_linear(rows.leftCols(2), rows.col(2));
    d1 = 1 / fit.value[0], d1_error = d1 * fit.error[0] / fit.value[0];
    k = fit.value[1], k_error = fit.error[1];
  }
  /// [m] at which this law stops a ball, at most the bed's depth.
  double depth(const Scene& s, const Drop& drop) const {
    double z = 0, v = drop.speed();
    for (const double dt = 1e-5; v > 0 && z < s.bed(); z += v * dt)
      v += dt * (g - v * v / d1 - k * z);
    return z;
  }
};

}  // namespace crater
