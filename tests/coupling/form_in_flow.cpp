// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <silt/coupling/drag/form_in_flow.hpp>

#include "near.hpp"

namespace form_in_flow_test {

using silt::Compound;
using silt::form_in_flow;
using silt::MultiSphere;
using silt::Polyhedron;
using silt::SuperEllipsoid;
using silt::Vec3d;

namespace {

constexpr double pi = std::numbers::pi;

/// Largest relative difference of the table from silhouettes, over n directions on a spiral.
template <class Area>
double table_error(const silt::FormInFlow& form, int n, const Area& area) {
  double worst = 0;
  for (int k = 0; k < n; ++k) {
    const double z = (2 * k + 1.0) / n - 1, r = std::sqrt(1 - z * z);
    const double angle = k * pi * (3 - std::sqrt(5));
    const Vec3d u{r * std::cos(angle), r * std::sin(angle), z};
    worst = std::max(worst, std::abs(form.area(u) / area(u) - 1));
  }
  return worst;
}
/// Of a shape whose frame is the principal one.
template <class S>
double table_error(const S& shape) {
  const double r = std::cbrt(0.75 * shape.mass_properties().volume / pi);
  return table_error(form_in_flow(shape), 300, [&](const Vec3d& u) {
    return silhouette(shape, normalised(u)).area / (pi * r * r);
  });
}
Polyhedron hull(const std::vector<Vec3d>& points) { return Polyhedron::from_points(points); }
Polyhedron box(double a, double b, double c) {
  std::vector<Vec3d> points;
  for (int k = 0; k < 8; ++k) points.push_back({k & 1 ? a : -a, k & 2 ? b : -b, k & 4 ? c : -c});
  return hull(points);
}

}  // namespace

TEST_CASE("form_in_flow: the table of silhouettes is exact for ellipsoids and boxes") {
  CHECK(table_error(SuperEllipsoid{3, 2, 1}) < 1e-12);
  CHECK(table_error(SuperEllipsoid{10, 1, 1}) < 1e-12);
  CHECK(table_error(SuperEllipsoid{1, 5, 5}) < 1e-12);
  // The axes of a box in its principal frame may be in another order: by the extremes.
  const auto form = form_in_flow(box(3, 2, 1));
  const double disc = pi * std::pow(0.75 * 48 / pi, 2.0 / 3);
  std::vector<double> faces{form.area({1, 0, 0}), form.area({0, 1, 0}), form.area({0, 0, 1})};
  std::sort(faces.begin(), faces.end());
  CHECK(faces[0] == near(8 / disc).epsilon(1e-12));
  CHECK(faces[1] == near(12 / disc).epsilon(1e-12));
  CHECK(faces[2] == near(24 / disc).epsilon(1e-12));
  for (const Vec3d& u : {Vec3d{1, 2, 3}, Vec3d{-3, 1, 0.2}, Vec3d{0.1, -2, -0.3}}) {
    const Vec3d n = normalised(u);
    const Vec3d a{form.area({1, 0, 0}), form.area({0, 1, 0}), form.area({0, 0, 1})};
    CHECK(form.area(n) ==
          near(std::abs(n.x * a.x) + std::abs(n.y * a.y) + std::abs(n.z * a.z)).epsilon(1e-12));
  }
}

TEST_CASE("form_in_flow: other shapes to the error that its head names") {
  CHECK(table_error(SuperEllipsoid{5, 1, 1, 8, 2}) < 0.02);
  CHECK(table_error(MultiSphere{{{{0, 0, -0.7}, 1}, {{0, 0, 0.7}, 1}}}) < 0.02);
  CHECK(table_error(hull({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})) <
        0.025);
}

TEST_CASE("form_in_flow: the numbers of drag laws are those of shape_in_flow") {
  const SuperEllipsoid body{2.5, 1, 1};
  const auto form = form_in_flow(body);
  for (const Vec3d& u : {Vec3d{1, 0, 0}, Vec3d{0, 0.6, 0.8}, Vec3d{0.6, 0, -0.8}}) {
    const auto exact = silt::shape_in_flow(body, u), table = form.along(u);
    CHECK(table.sphericity == near(exact.sphericity).epsilon(1e-9));
    CHECK(table.crosswise == near(exact.crosswise).epsilon(1e-9));
    CHECK(table.lengthwise == near(exact.lengthwise).epsilon(1e-3));
  }
  CHECK(form.symmetry_axis() == 0);
  CHECK(form.aspect_ratio() == near(2.5).epsilon(1e-6));
  CHECK(form_in_flow(SuperEllipsoid{1, 1, 1}).symmetry_axis() == -1);
  CHECK(form_in_flow(silt::Sphere{}).along({1, 0, 0}).crosswise == 1);
}

TEST_CASE("form_in_flow: a compound is the union of its parts") {
  // Two balls that overlap, beside the same as a MultiSphere, whose silhouettes are exact.
  const SuperEllipsoid ball{1, 1, 1};
  const Compound<SuperEllipsoid> two{.parts = {{ball, {0, 0, -0.7}}, {ball, {0, 0, 0.7}}}};
  const MultiSphere same{{{{0, 0, -0.7}, 1}, {{0, 0, 0.7}, 1}}};
  for (const Vec3d& u : {Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, Vec3d{0.6, 0, 0.8}})
    CHECK(silt::detail::area_seen(two, u) == near(silhouette(same, u).area).epsilon(2e-3));
  const auto a = form_in_flow(two), b = form_in_flow(same);
  CHECK(a.sphericity == near(b.sphericity).epsilon(0.01));
  CHECK(a.aspect_ratio() == near(b.aspect_ratio()).epsilon(0.01));
  // A box of two boxes has that box's surface and silhouettes.
  const Compound<Polyhedron> halves{
      .parts = {{box(1, 1, 1), {-0.9, 0, 0}}, {box(1, 1, 1), {0.9, 0, 0}}}};
  const double V = 3.8 * 4, S = 8 + 4 * 3.8 * 2, d = std::cbrt(6 * V / pi);
  const auto long_box = form_in_flow(halves);
  CHECK(long_box.sphericity == near(pi * d * d / S).epsilon(0.01));
  const silt::Mix<silt::Sphere, SuperEllipsoid> mixed(SuperEllipsoid{2, 1, 1});
  CHECK(form_in_flow(mixed).aspect_ratio() == near(2));
}

TEST_CASE("form_in_flow: resistance of spheroids") {
  // S. Kim, S. J. Karrila, Microhydrodynamics (1991), table 3.4; and of a disc about an axis
  // across, 32/3 mu c^3, in the limit.
  const auto rod = form_in_flow(SuperEllipsoid{2, 1, 1});
  const double e = std::sqrt(0.75), L = std::log((1 + e) / (1 - e)), r3 = 2;  // r^3 = a b c
  const double along = 4.0 / 3 * e * e * e * (1 - e * e) / (2 * e - (1 - e * e) * L) * 8 / r3;
  const double across = 4.0 / 3 * e * e * e * (2 - e * e) / (-2 * e + (1 + e * e) * L) * 8 / r3;
  CHECK(rod.spin_resistance.x == near(along).epsilon(1e-6));
  CHECK(rod.spin_resistance.y == near(across).epsilon(1e-6));
  CHECK(rod.spin_resistance.z == near(across).epsilon(1e-6));
  const double slip_along = 8.0 / 3 * e * e * e / (-2 * e + (1 + e * e) * L) * 2 / std::cbrt(r3);
  CHECK(rod.slip_resistance.x == near(slip_along).epsilon(1e-6));
  CHECK(rod.strain_share.z == near(0.6));  // (r^2 - 1)/(r^2 + 1)
  const auto disc = form_in_flow(SuperEllipsoid{1, 1, 1e-2});
  CHECK(disc.spin_resistance.x * 8 * pi * 1e-2 == near(32.0 / 3).epsilon(0.02));
}

}  // namespace form_in_flow_test
