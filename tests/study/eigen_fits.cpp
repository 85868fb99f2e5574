// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <limits>
#include <vector>

#include <silt/eigen.hpp>

#include "near.hpp"

namespace eigen_fits_test {

using silt::InputError;
using silt::Vec3d;

namespace {

bool near(const Vec3d& a, const Vec3d& b, double eps) { return norm(a - b) < eps; }

const std::vector<Vec3d> no_numbers{
    {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::numeric_limits<double>::quiet_NaN()}};

}  // namespace

TEST_CASE("eigen_fits: vectors, quaternions and tensors go to Eigen and back") {
  const Vec3d v{1, -2, 3};
  CHECK(silt::to_silt(silt::to_eigen(v)) == v);
  const auto q = silt::rotation_about({0, 0, 1}, 0.7);
  CHECK(silt::to_silt(silt::to_eigen(q)) == q);
  // Both turn a vector the same way, to the rounding of some products.
  CHECK(near(silt::to_silt(silt::to_eigen(q) * silt::to_eigen(v)), rotate(q, v), 1e-15 * 8));
  const auto t = silt::to_eigen(silt::dyad({1, 2, 3}, {4, 5, 6}));
  CHECK(t(0, 2) == 6);
  CHECK(t(2, 0) == 12);
  const auto s = silt::to_eigen(silt::Symmetric3{1, 2, 3, 4, 5, 6});
  CHECK(s(0, 1) == 4);
  CHECK(s(2, 1) == 5);
  CHECK(s(0, 2) == 6);
}

TEST_CASE("eigen_fits: positions are seen without a copy, in both layouts") {
  std::vector<Vec3d> points{{1, 2, 3}, {4, 5, 6}};
  const auto view = silt::columns_of(points);
  points[1].y = 7;
  CHECK(view(1, 1) == 7);
  const std::vector<silt::PositionRow> rows{{1, 2, 3, 9}, {4, 5, 6, 9}};
  const auto strided = silt::columns_of(rows);
  CHECK(strided.cols() == 2);
  CHECK(strided(2, 1) == 6);
  CHECK(strided.data() == &rows[0].x);
}

TEST_CASE("eigen_fits: principal axes ascend and are those of a shear, which are known") {
  const auto p = silt::principal_axes(silt::Symmetric3{2, 2, 5, 1, 0, 0});  // 1, 3, 5
  const double eps = 1e-14;  // some roundings of values of a few
  CHECK(std::abs(p.values[0] - 1) < eps);
  CHECK(std::abs(p.values[1] - 3) < eps);
  CHECK(std::abs(p.values[2] - 5) < eps);
  CHECK(std::abs(p.directions(0, 0) + p.directions(1, 0)) < eps);  // (1, -1, 0)/sqrt(2)
  CHECK(std::abs(p.directions.determinant() - 1) < eps);
  // Of the symmetric part.
  CHECK(std::abs(silt::principal_axes(silt::Tensor3{0, 2, 0, 0, 0, 0, 0, 0, 0}).values[2] - 1) <
        eps);
  CHECK_THROWS_AS(silt::principal_axes(silt::Symmetric3{.xx = no_numbers[3].z}), InputError);
}

TEST_CASE("eigen_fits: a line, a plane and a sphere are found again") {
  const std::vector<Vec3d> on_line{{1, 0, 1}, {2, 0, 2}, {4, 0, 4}};
  const auto line = silt::fit_line(on_line);
  CHECK(norm(cross(line.direction, Vec3d{1, 0, 1})) < 1e-7);  // a root of rounding in squares
  CHECK(line.deviation < 1e-7);
  const std::vector<Vec3d> square{{0, 0, 1}, {1, 0, -1}, {1, 1, 1}, {0, 1, -1}};
  const std::vector<Vec3d> large{{0, 0, 1e-3}, {1, 0, -1e-3}, {1, 1, 1e-3}, {0, 1, -1e-3}};
  const auto plane = silt::fit_plane(large);
  CHECK(std::abs(std::abs(plane.normal.z) - 1) < 1e-14);
  CHECK(std::abs(plane.deviation - 1e-3) < 1e-12);
  CHECK(near(plane.point, {0.5, 0.5, 0}, 1e-15));
  // Of a cube's corners the sphere around it; one of a tetrahedron far from the origin.
  const auto around = silt::fit_sphere(square);
  CHECK(near(around.centre, {0.5, 0.5, 0}, 1e-14));
  CHECK(std::abs(around.radius - std::sqrt(1.5)) < 1e-14);
  CHECK(around.deviation < 1e-14);
  std::vector<Vec3d> cap;
  for (int k = 0; k < 12; ++k) {
    const double a = 0.5 * k, b = 0.1 + 0.03 * k;
    cap.push_back(Vec3d{100, -50, 20} +
                  2.0 * Vec3d{std::cos(a) * std::sin(b), std::sin(a) * std::sin(b), std::cos(b)});
  }
  const auto sphere = silt::fit_sphere(cap);
  CHECK(near(sphere.centre, {100, -50, 20}, 1e-10));  // 1e-14 of 100 m, times 100 for a small cap
  CHECK(std::abs(sphere.radius - 2) < 1e-10);
}

TEST_CASE("eigen_fits: too few points, points without spread and no numbers are refused") {
  const auto first = [](std::size_t n) {
    return std::vector<Vec3d>(no_numbers.begin(),
                              no_numbers.begin() + static_cast<std::ptrdiff_t>(n));
  };
  CHECK_THROWS_WITH_AS(silt::fit_line(first(1)),
                       doctest::Contains("fit_line: 1 points are too few; it needs 2"), InputError);
  CHECK_THROWS_WITH_AS(silt::fit_plane(first(2)),
                       doctest::Contains("fit_plane: 2 points are too few; it needs 3"),
                       InputError);
  CHECK_THROWS_WITH_AS(silt::fit_sphere(first(3)),
                       doctest::Contains("fit_sphere: 3 points are too few; it needs 4"),
                       InputError);
  CHECK_THROWS_WITH_AS(silt::fit_sphere(no_numbers), doctest::Contains("fit_sphere: point 3 = "),
                       InputError);
  const std::vector<Vec3d> one(5, Vec3d{1, 2, 3}), row{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},
      flat{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  CHECK_THROWS_WITH_AS(silt::fit_line(one), doctest::Contains("all points are one"), InputError);
  CHECK_THROWS_WITH_AS(silt::fit_plane(row), doctest::Contains("all points are on one line"),
                       InputError);
  CHECK_THROWS_WITH_AS(silt::fit_sphere(flat), doctest::Contains("all points are in one plane"),
                       InputError);
}

// NIST's reference data set "Norris" (StRD, linear regression), with its certified values. Data and
// values are recalled; that they agree to 10 digits confirms both. It would catch errors that
// belong to another coefficient, or a scatter over n instead of n - 2.
TEST_CASE("eigen_fits: a straight line has NIST's certified coefficients and standard errors") {
  const std::vector<double> y{0.1,   338.8, 118.1, 888.0, 9.2,   228.1, 668.5, 998.5, 449.1,
                              778.9, 559.2, 0.3,   0.1,   778.1, 668.8, 339.3, 448.9, 10.8,
                              557.7, 228.3, 998.0, 888.8, 119.6, 0.3,   0.6,   557.6, 339.3,
                              888.0, 998.5, 778.9, 10.2,  117.6, 228.9, 668.4, 449.2, 0.2};
  const std::vector<double> x{0.2,   337.4, 118.2, 884.6, 10.1,  226.5, 666.3, 996.3, 448.6,
                              777.0, 558.2, 0.4,   0.6,   775.5, 666.9, 338.0, 447.5, 11.6,
                              556.0, 228.1, 995.8, 887.6, 120.2, 0.3,   0.3,   556.8, 339.1,
                              887.2, 999.0, 779.0, 11.1,  118.3, 229.2, 669.1, 448.9, 0.5};
  const auto line = silt::fit_straight_line(x, y);
  CHECK(near_relative(line.intercept, -0.262323073774029, 1e-10));
  CHECK(near_relative(line.slope, 1.00211681802045, 1e-12));
  CHECK(near_relative(line.intercept_error, 0.232818234301152, 1e-10));
  CHECK(near_relative(line.slope_error, 0.429796848199937e-3, 1e-10));
}

TEST_CASE("eigen_fits: coefficients keep their order where one column is far larger") {
  // y = 3 a - 2 b exactly, columns of 1 and 1e6: the decomposition takes the larger first.
  Eigen::MatrixXd x(5, 2);
  Eigen::VectorXd y(5);
  for (Eigen::Index k = 0; k < 5; ++k) {
    const double a = std::cos(static_cast<double>(k)), b = 1e6 * std::sin(2 * static_cast<double>(k));
    x.row(k) << a, b;
    y[k] = 3 * a - 2 * b + (k == 2 ? 1e-3 : 0);
  }
  const auto fit = silt::fit_linear(x, y);
  CHECK(std::abs(fit.value[0] - 3) < 4e-3);
  CHECK(std::abs(fit.value[1] + 2) < 4e-9);
  // The textbook's covariance, scatter^2 (X^T X)^-1.
  const Eigen::MatrixXd inverse = (x.transpose() * x).inverse();
  for (Eigen::Index k = 0; k < 2; ++k)
    CHECK(near_relative(fit.error[k], fit.scatter * std::sqrt(inverse(k, k)), 1e-8));
}

TEST_CASE("eigen_fits: a fit without enough points or with dependent regressors is refused") {
  const std::vector<double> one{1}, two{1, 2}, same{3, 3, 3}, three{1, 2, 3};
  CHECK_THROWS_WITH_AS(silt::fit_straight_line(one, one),
                       doctest::Contains("1 points are too few for 2 coefficients"), InputError);
  CHECK_THROWS_WITH_AS(silt::fit_straight_line(three, two),
                       doctest::Contains("3 rows of regressors for 2 values"), InputError);
  CHECK_THROWS_WITH_AS(silt::fit_straight_line(same, three),
                       doctest::Contains("depend linearly on each other (rank 1 of 2)"),
                       InputError);
  const std::vector<double> none{1, 2, std::numeric_limits<double>::infinity()};
  CHECK_THROWS_WITH_AS(silt::fit_straight_line(three, none),
                       doctest::Contains("all values must be finite"), InputError);
  CHECK(silt::fit_straight_line(two, two).slope_error == 0);
}

}  // namespace eigen_fits_test
