// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/core/random.hpp>
#include <silt/fill/region.hpp>

#include "near.hpp"

namespace region_test {

using silt::Box;
using silt::CylinderRegion;
using silt::MeshRegion;
using silt::TriangleMesh;
using silt::Vec3d;
using Soup = std::vector<std::array<Vec3d, 3>>;

namespace {

Vec3d point_in(const Box& box, silt::Random& random) {
  Vec3d p;
  p.x = random.uniform(box.min.x, box.max.x);
  p.y = random.uniform(box.min.y, box.max.y);
  p.z = random.uniform(box.min.z, box.max.z);
  return p;
}

/// A quadrilateral as two triangles.
void add_face(Soup& soup, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  soup.push_back({a, b, c});
  soup.push_back({a, c, d});
}

/// The sides of a box, normals outwards.
Soup box_soup(const Vec3d& p, const Vec3d& q) {
  Soup soup;
  add_face(soup, {p.x, p.y, p.z}, {p.x, q.y, p.z}, {q.x, q.y, p.z}, {q.x, p.y, p.z});
  add_face(soup, {p.x, p.y, q.z}, {q.x, p.y, q.z}, {q.x, q.y, q.z}, {p.x, q.y, q.z});
  add_face(soup, {p.x, p.y, p.z}, {q.x, p.y, p.z}, {q.x, p.y, q.z}, {p.x, p.y, q.z});
  add_face(soup, {p.x, q.y, p.z}, {p.x, q.y, q.z}, {q.x, q.y, q.z}, {q.x, q.y, p.z});
  add_face(soup, {p.x, p.y, p.z}, {p.x, p.y, q.z}, {p.x, q.y, q.z}, {p.x, q.y, p.z});
  add_face(soup, {q.x, p.y, p.z}, {q.x, q.y, p.z}, {q.x, q.y, q.z}, {q.x, p.y, q.z});
  return soup;
}

Soup turned_inside_out(Soup soup) {
  for (auto& [a, b, c] : soup) std::swap(b, c);
  return soup;
}

}  // namespace

TEST_CASE("region: a box takes a sphere that touches its walls and none that crosses them") {
  const silt::BoxRegion box{{{0, 0, 0}, {0.3, 0.3, 0.3}}};
  CHECK(box.fits({0.1, 0.1, 0.1}, 0.1));
  CHECK(box.fits({0.2, 0.2, 0.2}, 0.1));  // 0.2 + 0.1 > 0.3 in doubles: within rounding
  CHECK(box.fits({0.15, 0.15, 0.15}, 0.15));
  CHECK_FALSE(box.fits({0.15, 0.15, 0.15}, 0.1500001));
  for (int axis = 0; axis < 3; ++axis)
    for (const double at : {0.0999999, 0.2000001}) {
      Vec3d p{0.15, 0.15, 0.15};
      (axis == 0 ? p.x : axis == 1 ? p.y : p.z) = at;
      CHECK_FALSE(box.fits(p, 0.1));
    }
  CHECK(box.volume() == near(0.027));
  CHECK(box.describe() == "the box from (0, 0, 0) to (0.3, 0.3, 0.3) m");
}

TEST_CASE("region: an oblique cylinder takes exactly the spheres that its surface clears") {
  const CylinderRegion cylinder{.from = {1, 2, 3}, .to = {2, 4, 1}, .radius = 0.5};
  const Vec3d n = silt::normalised(cylinder.to - cylinder.from);
  CHECK(cylinder.volume() == near(std::acos(-1.0) * 0.25 * 3));
  CHECK(cylinder.fits({1.5, 3, 2}, 0.4999999));
  CHECK_FALSE(cylinder.fits({1.5, 3, 2}, 0.5000001));
  CHECK(cylinder.fits(cylinder.from + 0.2 * n, 0.2));
  CHECK_FALSE(cylinder.fits(cylinder.from + 0.1999999 * n, 0.2));
  CHECK(cylinder.fits(cylinder.to - 0.2 * n, 0.2));
  CHECK_FALSE(cylinder.fits(cylinder.to - 0.1999999 * n, 0.2));
  CHECK(cylinder.describe() == "the cylinder from (1, 2, 3) to (2, 4, 1) m of radius 0.5 m");
}

TEST_CASE("region: the bounds of an oblique cylinder are touched on every side") {
  const CylinderRegion cylinder{.from = {1, 2, 3}, .to = {2, 4, 1}, .radius = 0.5};
  const Vec3d n = silt::normalised(cylinder.to - cylinder.from);
  const Vec3d u = silt::normalised(cross(n, Vec3d{0, 0, 1})), v = cross(n, u);
  Box rims;
  const int steps = 100000;
  for (int i = 0; i < steps; ++i) {
    const double angle = 2 * std::acos(-1.0) * i / steps;
    const Vec3d radial = 0.5 * (std::cos(angle) * u + std::sin(angle) * v);
    rims.include(cylinder.from + radial);
    rims.include(cylinder.to + radial);
  }
  // the extreme of the rim lies at most half a step away: 0.5 (1 - cos(pi / steps)) < 1e-9
  const Box bounds = cylinder.bounds();
  CHECK(norm(bounds.min - rims.min) < 1e-8);
  CHECK(norm(bounds.max - rims.max) < 1e-8);
}

TEST_CASE("region: a closed mesh of a box takes the same spheres as the box, turned either way") {
  const Box box{{0.1, 0.2, 0.3}, {1.1, 1.7, 0.9}};
  const silt::BoxRegion region{box};
  for (const bool outwards : {true, false}) {
    const auto soup = box_soup(box.min, box.max);
    const TriangleMesh mesh(outwards ? soup : turned_inside_out(soup));
    const MeshRegion in_mesh(mesh);
    CHECK(in_mesh.volume() == near(box.volume()));
    silt::Random random(1);
    int fitted = 0, different = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3d p = point_in(box.grown(0.2), random);
      const double radius = random.uniform(0.001, 0.3);
      fitted += region.fits(p, radius);
      different += region.fits(p, radius) != in_mesh.fits(p, radius);
    }
    CHECK(fitted > 1000);
    CHECK(different == 0);
  }
}

TEST_CASE("region: a mesh with a hollow takes no sphere in the hollow") {
  // a box within a box, turned inwards: what is remembered of one side must not serve the other
  auto soup = box_soup({0, 0, 0}, {3, 3, 3});
  const auto hollow = turned_inside_out(box_soup({1, 1, 1}, {2, 2, 2}));
  soup.insert(soup.end(), hollow.begin(), hollow.end());
  const TriangleMesh mesh(soup);
  const MeshRegion region(mesh);
  CHECK(region.volume() == near(26));
  silt::Random random(2);
  int fitted = 0, in_hollow = 0, wrong = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d p = point_in({{-0.5, -0.5, -0.5}, {3.5, 3.5, 3.5}}, random);
    const double radius = random.uniform(0.001, 0.1);
    std::vector<std::uint32_t> touched;
    mesh.triangles_near(p, radius, touched);
    const bool fits = touched.empty() && mesh.contains(p);
    fitted += fits;
    in_hollow += touched.empty() && Box{{1, 1, 1}, {2, 2, 2}}.contains(p);
    wrong += fits != region.fits(p, radius);
  }
  CHECK(fitted > 1000);
  CHECK(in_hollow > 100);
  CHECK(wrong == 0);
}

TEST_CASE("region: a mesh with a gap is refused") {
  auto soup = box_soup({0, 0, 0}, {1, 1, 1});
  soup.pop_back();
  const TriangleMesh mesh(soup);
  CHECK_THROWS_WITH_AS(MeshRegion{mesh},
                       doctest::Contains("the mesh between (0, 0, 0) and (1, 1, 1) m has gaps"),
                       silt::InputError);
}

namespace {

struct NotARegion {
  Box bounds() const { return {}; }
  double volume() const { return 1; }
};
static_assert(!silt::Region<NotARegion>);
static_assert(silt::Region<MeshRegion<TriangleMesh>>);

}  // namespace

}  // namespace region_test
