// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>

#include <silt/core/eigen.hpp>
#include <silt/core/error.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/symmetric3.hpp>
#include <silt/core/tensor3.hpp>
#include <silt/core/vec3.hpp>

/// Eigen beside silt (optional; target `silt_eigen` in silt's own build): values of silt as
/// vectors and matrices of Eigen, principal axes of tensors, spheres, lines and planes through
/// points, linear least squares.
/// Tests: tests/study/eigen_fits.cpp

namespace silt::inline SILT_TARGET {

inline Eigen::Vector3d to_eigen(const Vec3d& v) { return {v.x, v.y, v.z}; }
inline Vec3d to_silt(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

inline Eigen::Quaterniond to_eigen(const Quaternion& q) { return {q.w, q.x, q.y, q.z}; }
inline Quaternion to_silt(const Eigen::Quaterniond& q) { return {q.w(), q.x(), q.y(), q.z()}; }

inline Eigen::Matrix3d to_eigen(const Tensor3& t) {
  Eigen::Matrix3d m;
  m << t.xx, t.xy, t.xz, t.yx, t.yy, t.yz, t.zx, t.zy, t.zz;
  return m;
}
inline Eigen::Matrix3d to_eigen(const Symmetric3& s) { return to_eigen(full(s)); }

/// Positions as the columns of a matrix, without a copy: the array must outlive the view. Columns
/// of Vec3d are contiguous, those of PositionRow have a stride of 4 doubles (the radius).
inline auto columns_of(std::span<const Vec3d> points) {
  static_assert(sizeof(Vec3d) == 3 * sizeof(double));
  return Eigen::Map<const Eigen::Matrix3Xd>(points.empty() ? nullptr : &points[0].x, 3,
                                            static_cast<Eigen::Index>(points.size()));
}
inline auto columns_of(std::span<const PositionRow> rows) {
  static_assert(sizeof(PositionRow) == 4 * sizeof(double));
  return Eigen::Map<const Eigen::Matrix3Xd, 0, Eigen::OuterStride<4>>(
      rows.empty() ? nullptr : &rows[0].x, 3, static_cast<Eigen::Index>(rows.size()));
}

/// Eigenvalues, ascending, and unit eigenvectors in the same order as columns, right-handed.
struct PrincipalAxes {
  Eigen::Vector3d values;
  Eigen::Matrix3d directions;
};
/// Of the symmetric part of a tensor: a stress, a fabric, an inertia.
/// Errors: InputError for one that is not finite.
inline PrincipalAxes principal_axes(const Eigen::Matrix3d& tensor) {
  require(tensor.allFinite(), "principal_axes: the tensor must be finite");
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(0.5 * (tensor + tensor.transpose()));
  PrincipalAxes out{solver.eigenvalues(), solver.eigenvectors()};
  if (out.directions.determinant() < 0) out.directions.col(0) *= -1;
  return out;
}
inline PrincipalAxes principal_axes(const Tensor3& t) { return principal_axes(to_eigen(t)); }
inline PrincipalAxes principal_axes(const Symmetric3& s) { return principal_axes(to_eigen(s)); }

namespace detail {

/// Centre of the points, and the principal axes of their scatter divided by their number.
struct Scatter {
  Eigen::Vector3d centre;
  PrincipalAxes axes;
};
inline Scatter scatter_of(std::string_view what, std::span<const Vec3d> points, std::size_t least) {
  require(points.size() >= least, what, ": ", points.size(), " points are too few; it needs ",
          least);
  for (std::size_t k = 0; k < points.size(); ++k)
    require(is_finite(points[k]), what, ": point ", k, " = ", points[k], " [m] must be finite");
  const auto p = columns_of(points);
  const Eigen::Vector3d centre = p.rowwise().mean();
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (Eigen::Index k = 0; k < p.cols(); ++k) {
    const Eigen::Vector3d d = p.col(k) - centre;
    sum += d * d.transpose();
  }
  return {centre, principal_axes(Eigen::Matrix3d(sum / static_cast<double>(points.size())))};
}
/// Checks that the scatter has this many directions, to the rounding of squares.
inline void require_spread(std::string_view what, const Scatter& s, int directions,
                           std::string_view fault) {
  require(s.axes.values[3 - directions] > 1e-14 * s.axes.values[2], what, ": ", fault);
}

}  // namespace detail

/// Line with the smallest sum of squared distances of the points.
struct LineFit {
  Vec3d point;       // [m] centre of the points
  Vec3d direction;   // [-] unit vector, of either sign
  double deviation;  // [m] root mean square of the distances
};
/// Errors: InputError for fewer than 2 points, one that is not finite, coincident points.
inline LineFit fit_line(std::span<const Vec3d> points) {
  const auto s = detail::scatter_of("fit_line", points, 2);
  detail::require_spread("fit_line", s, 1, "all points are one; give points apart");
  const auto& v = s.axes.values;
  return {to_silt(s.centre), to_silt(s.axes.directions.col(2)),
          std::sqrt(std::max(0.0, v[0]) + std::max(0.0, v[1]))};
}

/// Plane with the smallest sum of squared distances of the points.
struct PlaneFit {
  Vec3d point;       // [m] centre of the points
  Vec3d normal;      // [-] unit vector, of either sign
  double deviation;  // [m] root mean square of the distances
};
/// Errors: InputError for fewer than 3 points, one that is not finite, collinear points.
inline PlaneFit fit_plane(std::span<const Vec3d> points) {
  const auto s = detail::scatter_of("fit_plane", points, 3);
  detail::require_spread("fit_plane", s, 2, "all points are on one line; add points off the line");
  return {to_silt(s.centre), to_silt(s.axes.directions.col(0)),
          std::sqrt(std::max(0.0, s.axes.values[0]))};
}

/// Sphere through points, by linear least squares of |x|^2 = 2 c x + (r^2 - c^2): exact for points
/// on a sphere; for noisy points on a small cap the radius is too small.
struct SphereFitted {
  Vec3d centre;      // [m]
  double radius;     // [m]
  double deviation;  // [m] root mean square of the distances from the surface
};
/// Errors: InputError for fewer than 4 points, one that is not finite, coplanar points.
inline SphereFitted fit_sphere(std::span<const Vec3d> points) {
  const auto s = detail::scatter_of("fit_sphere", points, 4);
  detail::require_spread("fit_sphere", s, 3,
                         "all points are in one plane; add points off the plane");
  // About the centre of the points sum(x) = 0, which leaves 3 equations for c: S c = q/2.
  const auto p = columns_of(points);
  Eigen::Vector3d q = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < p.cols(); ++k) {
    const Eigen::Vector3d d = p.col(k) - s.centre;
    q += d.squaredNorm() * d;
  }
  const double n = static_cast<double>(points.size());
  const auto& axes = s.axes.directions;
  const Eigen::Vector3d along = (axes.transpose() * q / (2 * n)).cwiseQuotient(s.axes.values);
  const Eigen::Vector3d c = axes * along;
  SphereFitted out{to_silt(s.centre + c), std::sqrt(c.squaredNorm() + s.axes.values.sum()), 0};
  for (const Vec3d& x : points) {
    const double off = norm(x - out.centre) - out.radius;
    out.deviation += off * off / n;
  }
  out.deviation = std::sqrt(out.deviation);
  return out;
}

/// Coefficients of y = sum_k c_k x_k by least squares, with standard errors.
struct LinearFit {
  Eigen::VectorXd value, error;  // c_k and its standard error; 0 with as many points as
                                 // coefficients
  double scatter = 0;            // standard deviation of the points about the fit, in units of y
};
/// Ordinary least squares by QR decomposition. A row of `regressors` for each point: {1, x} for a
/// line, {U, U^2} for Ergun's pressure drop.
/// Errors: InputError for numbers of rows that differ, fewer points than coefficients, a value that
/// is not finite, regressors that depend linearly on each other.
inline LinearFit fit_linear(const Eigen::MatrixXd& regressors, const Eigen::VectorXd& y) {
  const auto n = regressors.rows(), unknowns = regressors.cols();
  require(n == y.size(), "fit_linear: ", n, " rows of regressors for ", y.size(),
          " values; give one row for each value");
  require(unknowns > 0 && n >= unknowns, "fit_linear: ", n, " points are too few for ", unknowns,
          " coefficients");
  require(regressors.allFinite() && y.allFinite(), "fit_linear: all values must be finite");
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(regressors);
  require(qr.rank() == unknowns, "fit_linear: the regressors depend linearly on each other (rank ",
          qr.rank(), " of ", unknowns, "); leave some out, or add points that separate them");
  LinearFit out{qr.solve(y), Eigen::VectorXd::Zero(unknowns), 0};
  if (n == unknowns) return out;
  out.scatter =
      std::sqrt((y - regressors * out.value).squaredNorm() / static_cast<double>(n - unknowns));
  // The covariance is scatter^2 (X^T X)^-1 = scatter^2 P R^-1 R^-T P^T: lengths of the rows of
  // R^-1.
  const Eigen::MatrixXd inverse = qr.matrixR()
                                      .topLeftCorner(unknowns, unknowns)
                                      .template triangularView<Eigen::Upper>()
                                      .solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
  const Eigen::VectorXd lengths = qr.colsPermutation() * inverse.rowwise().norm();
  out.error = out.scatter * lengths;
  return out;
}

/// The straight line y = intercept + slope x by least squares of the vertical distances.
struct StraightLine {
  double intercept = 0, slope = 0, intercept_error = 0, slope_error = 0;
};
/// Errors: those of fit_linear.
inline StraightLine fit_straight_line(std::span<const double> x, std::span<const double> y) {
  const auto view = [](std::span<const double> v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
  };
  Eigen::MatrixXd regressors(static_cast<Eigen::Index>(x.size()), 2);
  regressors.col(0).setOnes(), regressors.col(1) = view(x);
  const LinearFit fit = fit_linear(regressors, view(y));
  return {fit.value[0], fit.value[1], fit.error[0], fit.error[1]};
}

}  // namespace silt
