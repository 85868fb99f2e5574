// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <silt/coupling/drag/silhouette.hpp>

#include "near.hpp"

namespace silhouette_test {

using silt::MultiSphere;
using silt::Polyhedron;
using silt::PolySuperEllipsoid;
using silt::silhouette;
using silt::SuperEllipsoid;
using silt::Vec3d;

namespace {

constexpr double pi = std::numbers::pi;

/// Mean area seen from n directions all round, on a spiral.
template <class S>
double mean_area(const S& body, int n) {
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    const double z = (2 * k + 1.0) / n - 1, r = std::sqrt(1 - z * z);
    const double angle = k * pi * (3 - std::sqrt(5));
    sum += silhouette(body, {r * std::cos(angle), r * std::sin(angle), z}).area;
  }
  return sum / n;
}

Polyhedron box(double a, double b, double c, double radius = 0) {
  std::vector<Vec3d> points;
  for (int k = 0; k < 8; ++k) points.push_back({k & 1 ? a : 0, k & 2 ? b : 0, k & 4 ? c : 0});
  return Polyhedron::from_points(points, radius);
}

const Vec3d oblique = normalised(Vec3d{1, -2, 3});

}  // namespace

TEST_CASE("silhouette: a sphere and an ellipsoid in closed form") {
  const SuperEllipsoid ball{2, 2, 2};
  const auto round = silt::detail::ConvexOutline(ball, oblique).seen();
  CHECK(near_relative(round.area, 4 * pi, 1e-6));
  CHECK(near_relative(round.perimeter, 4 * pi, 1e-6));
  const auto flow = silt::shape_in_flow(ball, oblique);
  for (const double one : {flow.sphericity, flow.crosswise, flow.lengthwise, flow.circularity})
    CHECK(near_relative(one, 1, 3e-6));
  const SuperEllipsoid body{3, 2, 1};
  CHECK(near_relative(silhouette(body, {0, 0, 1}).area, 6 * pi, 1e-14));
  CHECK(near_relative(silhouette(body, {1, 0, 0}).area, 2 * pi, 1e-14));
  // Perimeter of the ellipse 3, 2: mpmath.
  CHECK(near_relative(silhouette(body, {0, 0, 1}).perimeter, 15.865439589290590, 1e-5));
  // The closed form beside support points, whose tangents know nothing of it.
  CHECK(near_relative(silt::detail::ConvexOutline(body, oblique).seen().area,
                      silt::ellipsoid_projected_area(3, 2, 1, oblique), 1e-5));
  const auto turned = silt::shape_in_flow(silt::Sphere(), oblique);
  CHECK(turned.sphericity == 1);
}

TEST_CASE("silhouette: boxes seen along an edge and a diagonal, dilated ones") {
  const auto cube = box(1, 1, 1);
  const double d = std::cbrt(6 / pi), disc = pi * d * d / 4;
  const auto face = silhouette(cube, {0, 0, 1}),
             corner = silhouette(cube, normalised(Vec3d{1, 1, 1}));
  CHECK(near_relative(face.area, 1, 1e-14));
  CHECK(near_relative(face.perimeter, 4, 1e-14));
  CHECK(near_relative(corner.area, std::sqrt(3), 1e-14));
  CHECK(near_relative(corner.perimeter, 6 * std::sqrt(2. / 3), 1e-14));
  const auto flow = silt::shape_in_flow(cube, {0, 0, 1}, 480);
  CHECK(std::abs(flow.sphericity - 0.8060) <= 5e-5);  // C3 of the physics reference
  CHECK(std::abs(flow.crosswise - 1.2090) <= 5e-5);
  CHECK(std::abs(flow.circularity - 0.8862) <= 5e-5);
  // Across the flow it shows |cos| + |sin|, 4/pi in the mean.
  CHECK(near_relative(flow.lengthwise, disc / (3 - 4 / pi), 1e-5));
  const double r = 0.2;
  const auto soft = silhouette(box(1, 2, 3, r), {0, 0, 1});
  CHECK(near_relative(soft.area, 2 + 6 * r + pi * r * r, 1e-14));
  CHECK(near_relative(soft.perimeter, 6 + 2 * pi * r, 1e-14));
  // A super-ellipsoid near the box: its corners are missing.
  const SuperEllipsoid near_cube{0.5, 0.5, 0.5, 40, 40};
  CHECK(near_relative(silhouette(near_cube, {0, 0, 1}).area, 1, 0.01));
  CHECK(near_relative(silhouette(near_cube, oblique).area, silhouette(cube, oblique).area, 0.04));
}

TEST_CASE("silhouette: of every convex body the mean area is a quarter of the surface (Cauchy)") {
  // The spiral of 400 is good to some 1e-4 of bodies with edges.
  const auto check = [](const auto& body, double allowed) {
    CHECK(near_relative(mean_area(body, 400), silt::surface_of_body(body) / 4, allowed));
  };
  check(box(1, 2, 3), 5e-4);
  check(box(1, 2, 3, 0.4), 5e-4);
  check(Polyhedron::from_points({{0, 0, 0}, {1, 0, 0}, {0.3, 1, 0}, {0.2, 0.3, 0.8}}), 5e-4);
  check(SuperEllipsoid{3, 2, 1}, 1e-4);
  check(SuperEllipsoid{1, 1, 2, 8, 2}, 5e-4);
  check(SuperEllipsoid{1, 0.7, 2, 40, 40}, 5e-4);
  check(PolySuperEllipsoid{{1, 2, 3}, {2, 1, 1.5}, 3, 4}, 5e-4);
  check(MultiSphere{{{{0, 0, 0}, 0.7}}}, 1e-6);
}

TEST_CASE("silhouette: spheres that overlap: circles' and caps' closed forms") {
  const double r = 0.5;
  const MultiSphere one{{{{1, 2, 3}, r}}};
  CHECK(near_relative(silhouette(one, oblique).area, pi * r * r, 1e-14));
  CHECK(near_relative(silt::sphericity_of(one), 1, 1e-4));  // volume by lines
  const MultiSphere two{{{{0, 0, 0}, r}, {{0.6, 0, 0}, r}}};
  const double half = std::acos(0.6);  // of the lens, from each centre
  const auto side = silhouette(two, {0, 0, 1}), end = silhouette(two, {1, 0, 0});
  CHECK(near_relative(side.area, 2 * pi * r * r - r * r * (2 * half - std::sin(2 * half)), 1e-14));
  CHECK(near_relative(side.perimeter, 2 * r * (2 * pi - 2 * half), 1e-14));
  CHECK(near_relative(end.area, pi * r * r, 1e-14));
  CHECK(near_relative(end.perimeter, 2 * pi * r, 1e-14));
  // Each loses a cap of height r - 0.3.
  CHECK(near_relative(silt::surface_of_body(two), 2 * (4 * pi * r * r - 2 * pi * r * 0.2), 1e-4));
  const MultiSphere twice{{{{0, 0, 0}, r}, {{0, 0, 0}, r}, {{0.1, 0, 0}, 0.2}}};
  CHECK(near_relative(silhouette(twice, oblique).area, pi * r * r, 1e-14));
  CHECK(near_relative(silt::surface_of_body(twice), 4 * pi * r * r, 1e-12));
  // A ring of six that touch: its hole belongs to the outline.
  MultiSphere ring;
  for (int k = 0; k < 6; ++k)
    ring.balls.push_back({{std::cos(k * pi / 3), std::sin(k * pi / 3), 0}, 0.5});
  CHECK(near_relative(silhouette(ring, {0, 0, 1}).area, 6 * pi / 4, 1e-12));
}

TEST_CASE("silhouette: refusals") {
  std::string said;
  try {
    silhouette(box(1, 1, 1), {0, 0, 2});
  } catch (const silt::InputError& error) {
    said = error.what();
  }
  CHECK(said.find("the direction (0, 0, 2) must be a unit vector") != std::string::npos);
  said.clear();
  try {
    silt::shape_in_flow(box(1, 1, 1), {0, 0, 1}, 0);
  } catch (const silt::InputError& error) {
    said = error.what();
  }
  CHECK(said.find("turns = 0 [-] must be at least 2") != std::string::npos);
}

}  // namespace silhouette_test
