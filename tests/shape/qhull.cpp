// silt - BSD-3-Clause, see LICENSE
//
// Convex hulls against Qhull (Barber, Dobkin, Huhdanpaa, ACM Trans. Math. Softw. 22 (1996) 469).

#include <doctest/doctest.h>

#if defined(SILT_TEST_QHULL)
#include <libqhullcpp/Qhull.h>
#include <libqhullcpp/QhullVertexSet.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/shape/polyhedron.hpp>

#include "near.hpp"

namespace qhull_test {

namespace {

using silt::Vec3d;

struct Hull {
  std::vector<std::size_t> corners;  // numbers of points, ascending
  double volume, area;               // [m3], [m2]
  double merged = 0;                 // [m2] of faces that are no triangles
};
Hull by_qhull(const std::vector<Vec3d>& points) {
  std::vector<double> numbers;
  for (const Vec3d& p : points) numbers.insert(numbers.end(), {p.x, p.y, p.z});
  orgQhull::Qhull qhull("", 3, static_cast<int>(points.size()), numbers.data(), "");
  Hull out{{}, qhull.volume(), qhull.area()};
  for (const auto& vertex : qhull.vertexList())
    out.corners.push_back(static_cast<std::size_t>(vertex.point().id()));
  std::sort(out.corners.begin(), out.corners.end());
  return out;
}
/// silt's, whose corners are found among the points by their coordinates.
Hull by_silt(const std::vector<Vec3d>& points) {
  const auto body = silt::Polyhedron::from_points(points);
  Hull out{{}, body.volume(), body.area()};
  for (const Vec3d& corner : body.convex_faces().vertices) {
    const auto nearest = std::min_element(
        points.begin(), points.end(),
        [&](const Vec3d& p, const Vec3d& q) { return norm(p - corner) < norm(q - corner); });
    out.corners.push_back(static_cast<std::size_t>(nearest - points.begin()));
  }
  std::sort(out.corners.begin(), out.corners.end());
  const auto faces = body.convex_faces();
  for (const auto& face : faces.faces) {
    if (face.size() == 3) continue;
    const auto corner = [&](std::size_t k) { return faces.vertices[face[k]]; };
    for (std::size_t k = 2; k < face.size(); ++k)
      out.merged += 0.5 * norm(cross(corner(k - 1) - corner(0), corner(k) - corner(0)));
  }
  return out;
}

void compare(const std::vector<Vec3d>& points) {
  const Hull expected = by_qhull(points), got = by_silt(points);
  CHECK(got.corners == expected.corners);
  // Coordinates carry rounding errors: the surface is off by as much. Triangles that lie within
  // 1e-8 of the diagonal in one plane are one face (convex_hull.hpp).
  silt::Box box;
  for (const Vec3d& p : points) box.include(p);
  const double farthest = std::max(norm(box.min), norm(box.max));
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * farthest;
  CHECK(std::abs(got.volume - expected.volume) < rounding * expected.area +
                                                     1e-13 * expected.volume +
                                                     1e-8 * norm(box.extent()) * got.merged);
  CHECK(got.area == near(expected.area).epsilon(1e-12));
}

}  // namespace

// Catches: a corner that is lost or one too many, faces that are turned inside out or counted
// twice.
TEST_CASE("qhull: corners, volume and area of hulls of random clouds") {
  silt::Random random(11);
  const auto symmetric = [&] { return random.uniform(-1, 1); };
  for (int cloud = 0; cloud < 600; ++cloud) {
    CAPTURE(cloud);
    const std::size_t count = 4 + random.index(cloud < 500 ? 60 : 600);
    const Vec3d stretch{1, std::pow(10, random.uniform(-2, 0)),
                        std::pow(10, random.uniform(-2, 0))};
    const Vec3d away{random.uniform(-10, 10), 0, random.uniform(-1, 1)};
    const bool on_sphere = cloud % 3 == 0;
    std::vector<Vec3d> points;
    for (std::size_t k = 0; k < count; ++k) {
      Vec3d p{symmetric(), symmetric(), symmetric()};
      if (on_sphere) p *= 1 / norm(p);
      points.push_back(
          {away.x + stretch.x * p.x, away.y + stretch.y * p.y, away.z + stretch.z * p.z});
    }
    compare(points);
  }
}

}  // namespace qhull_test
#endif
