// silt - BSD-3-Clause, see LICENSE
#include <silt/boundary/triangle_mesh.hpp>

#include <set>

#include <silt/boundary/finite_walls.hpp>

#include "support.hpp"

namespace triangle_mesh_test {

using namespace boundary_test;
using silt::TriangleMesh;

namespace {

/// Plain closest point on a triangle, by regions of its Voronoi diagram (Ericson, Real-Time
/// Collision Detection, 2005, section 5.1.5): independent of the code under test.
double brute_force_distance(const std::array<Vec3d, 3>& triangle, const Vec3d& p) {
  const auto& [a, b, c] = triangle;
  const Vec3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (d1 <= 0 && d2 <= 0) return gap(p, a);
  if (d3 >= 0 && d4 <= d3) return gap(p, b);
  if (d6 >= 0 && d5 <= d6) return gap(p, c);
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return gap(p, a + d1 / (d1 - d3) * ab);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return gap(p, a + d2 / (d2 - d6) * ac);
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return gap(p, b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b));
  return gap(p, a + vb / (va + vb + vc) * ab + vc / (va + vb + vc) * ac);
}

/// Triangles of very different sizes in the unit cube.
Soup random_soup(std::mt19937_64& random, int count) {
  Soup soup;
  for (int n = 0; n < count; ++n) {
    const double size = std::pow(10, uniform(random, -3, 0));
    const Vec3d a = random_point(random, 0, 1);
    soup.push_back(
        {a, a + random_point(random, -size, size), a + random_point(random, -size, size)});
  }
  return soup;
}

Soup turned_inside_out(Soup soup) {
  for (auto& t : soup) std::swap(t[0], t[1]);
  return soup;
}

}  // namespace

TEST_CASE("triangle_mesh: distance_to equals brute force on random triangles and points") {
  std::mt19937_64 random(1);
  const auto soup = random_soup(random, 100);
  const TriangleMesh mesh(soup);
  REQUIRE(mesh.triangles().size() == soup.size());
  double worst = 0;
  for (int n = 0; n < 200; ++n) {
    const Vec3d p = random_point(random, -0.5, 1.5);
    for (std::uint32_t t = 0; t < soup.size(); ++t)
      worst = std::max(worst, std::abs(mesh.distance_to(t, p) - brute_force_distance(soup[t], p)));
  }
  CHECK(worst < 1e-11);  // brute force loses digits in thin triangles
}

TEST_CASE("triangle_mesh: triangles_near are exactly those nearer than reach, ascending") {
  std::mt19937_64 random(2);
  const auto soup = random_soup(random, 300);
  const TriangleMesh mesh(soup);
  std::vector<std::uint32_t> found{99};
  std::size_t total = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec3d p = random_point(random, -0.2, 1.2);
    const double reach = std::pow(10, uniform(random, -3, 0.3));
    std::vector<std::uint32_t> expected;
    for (std::uint32_t t = 0; t < soup.size(); ++t)
      if (brute_force_distance(soup[t], p) < reach) expected.push_back(t);
    mesh.triangles_near(p, reach, found);
    CHECK(found == expected);
    total += expected.size();
  }
  CHECK(total > 1000);
  mesh.triangles_near({0.5, 0.5, 0.5}, 0, found);
  CHECK(found.empty());
  mesh.triangles_near({0.5, 0.5, 0.5}, infinity, found);
  CHECK(found.size() == soup.size());
}

TEST_CASE("triangle_mesh: the deepest contact is at the brute-force distance of the surface") {
  std::mt19937_64 random(3);
  const auto soup = random_soup(random, 200);
  const TriangleMesh mesh(soup);
  std::vector<std::uint32_t> near;
  for (int n = 0; n < 300; ++n) {
    const Vec3d p = random_point(random, 0, 1);
    const double reach = 0.3;
    double nearest = infinity;
    for (const auto& t : soup) nearest = std::min(nearest, brute_force_distance(t, p));
    mesh.triangles_near(p, reach, near);
    SurfacePoint found[TriangleMesh::max_contacts];
    const int count = mesh.contacts(p, reach, near, found);
    REQUIRE((count > 0) == (nearest < reach));
    if (count == 0) continue;
    CHECK(std::abs(found[0].distance - nearest) < 1e-11);
    for (int k = 0; k < count; ++k) {
      CHECK(std::abs(silt::norm(found[k].normal) - 1) < 1e-14);
      CHECK(found[k].distance < reach);
      if (k > 0) CHECK(found[k].distance >= found[k - 1].distance);
    }
  }
}

TEST_CASE("triangle_mesh: area, volume and bounds of a box, whose 36 corners weld to 8") {
  const TriangleMesh mesh(box_soup({1, 2, 3}, {2, 4, 6}));
  CHECK(mesh.vertices().size() == 8);
  CHECK(mesh.triangles().size() == 12);
  CHECK(mesh.dropped_triangles() == 0);
  CHECK(mesh.is_closed());
  CHECK(mesh.area() == doctest::Approx(22).epsilon(1e-15));
  CHECK(mesh.volume() == doctest::Approx(6).epsilon(1e-15));
  CHECK(mesh.bounds().min == Vec3d{1, 2, 3});
  CHECK(mesh.bounds().max == Vec3d{2, 4, 6});
  CHECK(TriangleMesh(turned_inside_out(box_soup({0, 0, 0}, {1, 1, 1}))).volume() ==
        doctest::Approx(-1).epsilon(1e-15));
}

TEST_CASE("triangle_mesh: corners weld within 1e-9 of the diagonal and not at 1e-6") {
  std::mt19937_64 random(4);
  for (const double noise : {1e-11, 1e-6}) {
    auto soup = box_soup({0, 0, 0}, {1, 1, 1});
    for (auto& t : soup)
      for (auto& corner : t) corner += random_point(random, -noise, noise);
    const TriangleMesh mesh(soup);
    CHECK(mesh.vertices().size() == (noise < 1e-9 ? 8 : 36));
    CHECK(mesh.is_closed() == (noise < 1e-9));
  }
}

TEST_CASE("triangle_mesh: degenerate triangles are dropped and counted") {
  auto soup = box_soup({0, 0, 0}, {1, 1, 1});
  soup.push_back({Vec3d{0, 0, 0}, Vec3d{0, 0, 0}, Vec3d{1, 0, 0}});
  soup.push_back({Vec3d{0, 0, 0}, Vec3d{0.5, 0, 0}, Vec3d{1, 0, 0}});
  const TriangleMesh mesh(soup);
  CHECK(mesh.dropped_triangles() == 2);
  CHECK(mesh.triangles().size() == 12);
  CHECK(mesh.area() == doctest::Approx(6).epsilon(1e-15));
}

TEST_CASE("triangle_mesh: a needle that fills a T-junction keeps the mesh closed") {
  auto soup = box_soup({0, 0, 0}, {1, 1, 1});
  const auto [a, b, c] = soup.back();
  soup.pop_back();
  const Vec3d middle = 0.5 * (a + b);
  soup.push_back({a, middle, c}), soup.push_back({middle, b, c});
  CHECK(!TriangleMesh(soup).is_closed());
  CHECK(std::isnan(TriangleMesh(soup).volume()));  // it would depend on the origin
  soup.push_back({a, b, middle});
  const TriangleMesh mesh(soup);
  CHECK(mesh.is_closed());
  CHECK(mesh.dropped_triangles() == 1);
  CHECK(mesh.contains({0.5, 0.5, 0.5}));
  CHECK(!mesh.contains({0.5, 0.5, 1.5}));
}

TEST_CASE("triangle_mesh: closed means no gap and one way round") {
  auto soup = box_soup({0, 0, 0}, {1, 1, 1});
  std::swap(soup[3][0], soup[3][1]);
  CHECK(!TriangleMesh(soup).is_closed());
  std::swap(soup[3][0], soup[3][1]);
  soup.pop_back();
  CHECK(!TriangleMesh(soup).is_closed());
  soup = box_soup({0, 0, 0}, {1, 1, 1});
  const auto second = box_soup({1, 1, 0}, {2, 2, 1});  // shares an edge with the first
  soup.insert(soup.end(), second.begin(), second.end());
  const TriangleMesh both(soup);
  CHECK(both.is_closed());
  CHECK(both.contains({0.5, 0.5, 0.5}));
  CHECK(both.contains({1.5, 1.5, 0.5}));
  CHECK(!both.contains({1.5, 0.5, 0.5}));
}

TEST_CASE("triangle_mesh: contains tells inside from outside of a ball, either way round") {
  const auto soup = ball_soup(3);  // 512 triangles, inscribed: edges of at most 0.26
  std::mt19937_64 random(5);
  for (const auto& triangles : {soup, turned_inside_out(soup)}) {
    const TriangleMesh ball(triangles);
    REQUIRE(ball.is_closed());
    for (int n = 0; n < 2000; ++n) {
      const Vec3d p = random_point(random, -1.1, 1.1);
      const double r = silt::norm(p);
      if (r > 0.97 && r <= 1) continue;  // facets are up to 1 - cos(0.15 rad) = 0.012 inside
      CHECK(ball.contains(p) == (r < 0.98));
    }
  }
}

TEST_CASE("triangle_mesh: contains holds where the ray meets vertices, edges and faces edge-on") {
  const TriangleMesh ball(ball_soup(2));
  CHECK(ball.contains({0, 0, 0}));
  CHECK(ball.contains({-0.9, 0, 0}));
  CHECK(!ball.contains({-1.0001, 0, 0}));
  CHECK(ball.contains({0.1, 0.2, 0}));
  const TriangleMesh box(box_soup({0, 0, 0}, {1, 1, 1}));
  for (const double x : {0.25, 0.5, 0.75})
    for (const double y : {0.25, 0.5, 0.75})
      for (const double z : {0.25, 0.5, 0.75}) {
        CHECK(box.contains({x, y, z}));
        CHECK(!box.contains({x - 1, y, z}));
        CHECK(!box.contains({x, y, z + 1}));
      }
  CHECK(!box.contains({0.5, 1.5, 0.5}));
}

TEST_CASE("triangle_mesh: a hollow in a solid is outside") {
  auto soup = box_soup({0, 0, 0}, {3, 3, 3});
  const auto hollow = turned_inside_out(box_soup({1, 1, 1}, {2, 2, 2}));
  soup.insert(soup.end(), hollow.begin(), hollow.end());
  const TriangleMesh mesh(soup);
  CHECK(mesh.volume() == doctest::Approx(26).epsilon(1e-14));
  CHECK(mesh.contains({0.4, 1.6, 1.3}));
  CHECK(!mesh.contains({1.4, 1.6, 1.3}));
  CHECK(!mesh.contains({1.5, 1.5, 1.5}));  // the rays meet diagonals
}

// Patches begin at the largest triangles. Of equal ones rounding chose, so that a cube on a vertex
// had another number of contacts elsewhere in space.
TEST_CASE("triangle_mesh: a mesh has the same patches wherever it is") {
  const auto at = [](const Vec3d& centre) { return silt::sphere_mesh(centre, 5e-3, 2).patches(); };
  const auto first = at({0, 0, 0});
  CHECK(std::set<std::uint32_t>(first.begin(), first.end()).size() > 5);
  for (const Vec3d& centre : {Vec3d{0.25, 0.5, -0.125}, Vec3d{0.013, -0.777, 0.3}})
    CHECK(at(centre) == first);
}

TEST_CASE("triangle_mesh: refuses what makes no surface, by name") {
  using silt::InputError;
  const auto soup = box_soup({0, 0, 0}, {1, 1, 1});
  refuses<InputError>([] { TriangleMesh mesh(Soup{}); }, "TriangleMesh: 0 triangles given");
  refuses<InputError>([] { TriangleMesh mesh(Soup(2)); }, "all 2 triangles are degenerate");
  refuses<InputError>(
      [] {
        TriangleMesh mesh(Soup{{Vec3d{0, 0, 0}, Vec3d{1, 1, 1}, Vec3d{3, 3, 3}}});
      },
      "all 1 triangles are degenerate");
  for (const double bad : {not_a_number, infinity}) {
    auto broken = soup;
    broken[7][1].y = bad;
    refuses<InputError>([&] { TriangleMesh mesh(broken); }, "triangle 7 (counted from 0)");
  }
  for (const double angle : {-0.1, 1.6, not_a_number})
    refuses<InputError>([&] { TriangleMesh mesh(soup, angle); }, "TriangleMesh: smooth_angle = ");
  auto open = soup;
  open.pop_back();
  refuses<InputError>(
      [&] {
        (void)TriangleMesh(open).contains({0.5, 0.5, 0.5});
      },
      "the mesh is not closed");
}

}  // namespace triangle_mesh_test
