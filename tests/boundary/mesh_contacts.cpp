// silt - BSD-3-Clause, see LICENSE
#include <silt/boundary/triangle_mesh.hpp>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

#include "support.hpp"

namespace {
std::atomic<long> allocations = 0;
}
// Counts. Not inlined, or GCC 12 takes malloc here and free there for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace mesh_contacts_test {

using namespace boundary_test;
using silt::TriangleMesh;

namespace {

std::vector<SurfacePoint> contacts(const TriangleMesh& mesh, const Vec3d& centre, double reach) {
  std::vector<std::uint32_t> near;
  mesh.triangles_near(centre, reach, near);
  std::vector<SurfacePoint> found(TriangleMesh::max_contacts);
  found.resize(static_cast<std::size_t>(mesh.contacts(centre, reach, near, found.data())));
  return found;
}

// The floor z = 0, x and y from 0 to 1, cut into triangles in different ways.

Soup two_triangles() {
  Soup soup;
  add_quad(soup, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  return soup;
}

/// 10 x 10 squares, inner vertices moved about, diagonals at random: 200 triangles.
Soup jittered(std::mt19937_64& random) {
  Vec3d at[11][11];
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j) {
      at[i][j] = {i / 10.0, j / 10.0, 0};
      if (i > 0 && i < 10) at[i][j].x += uniform(random, -0.03, 0.03);
      if (j > 0 && j < 10) at[i][j].y += uniform(random, -0.03, 0.03);
    }
  Soup soup;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) {
      const Vec3d &a = at[i][j], &b = at[i + 1][j], &c = at[i + 1][j + 1], &d = at[i][j + 1];
      if (random() % 2)
        soup.push_back({a, b, c}), soup.push_back({a, c, d});
      else
        soup.push_back({a, b, d}), soup.push_back({b, c, d});
    }
  return soup;
}

/// Squares cut into four or not at random, without regard to their neighbours: hanging nodes.
void add_quadtree(Soup& soup, std::mt19937_64& random, const Vec3d& corner, double size,
                  int levels) {
  if (levels == 0 || (levels < 3 && random() % 2)) {
    add_quad(soup, corner, {size, 0, 0}, {0, size, 0});
    return;
  }
  const double half = size / 2;
  for (const double x : {0.0, half})
    for (const double y : {0.0, half})
      add_quadtree(soup, random, corner + Vec3d{x, y, 0}, half, levels - 1);
}

/// Patches side by side whose strips (of different number) share no vertices along the seams.
Soup separate_patches() {
  Soup soup;
  const auto patch = [&](double low, double width, int strips) {
    for (int k = 0; k < strips; ++k)
      add_quad(soup, {low, double(k) / strips, 0}, {width, 0, 0}, {0, 1.0 / strips, 0});
  };
  patch(0, 0.25, 3), patch(0.25, 0.25, 7), patch(0.5, 0.25, 1), patch(0.75, 0.25, 10);
  return soup;
}

struct Floor {
  std::string name;
  Soup soup;
};
std::vector<Floor> floors() {
  std::mt19937_64 random(1);
  std::vector<Floor> all{{"two triangles", two_triangles()},
                         {"jittered", jittered(random)},
                         {"quadtree", {}},
                         {"separate patches", separate_patches()},
                         {"every triangle twice", jittered(random)}};
  add_quadtree(all[2].soup, random, {0, 0, 0}, 1, 5);
  auto& twice = all[4].soup;
  for (auto& t : Soup(twice)) twice.push_back({t[2], t[1], t[0]});
  return all;
}

/// Points over the floor where something could go wrong, at least 0.15 from its border: along
/// lines, over vertices and edges, and beside them by 1e-3 ... 1e-16.
std::vector<Vec3d> places_on_floor(const Soup& soup, std::mt19937_64& random) {
  std::vector<Vec3d> places;
  const auto add = [&](Vec3d p) {
    if (p.x > 0.15 && p.x < 0.85 && p.y > 0.15 && p.y < 0.85) places.push_back(p);
  };
  for (int k = 0; k <= 200; ++k) {
    add({k / 200.0, k / 200.0, 0}), add({k / 200.0, 0.5, 0}), add({0.25, k / 200.0, 0});
    add({k / 200.0, 0.3 + 0.37 * k / 200.0, 0});
  }
  for (int n = 0; n < 60; ++n) {
    const auto& t = soup[random() % soup.size()];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d vertex = t[k], edge = t[(k + 1) % 3] - t[k];
      const Vec3d on_edge = vertex + uniform(random, 0, 1) * edge;
      const double angle = uniform(random, 0, 2 * pi);
      add(vertex), add(on_edge);
      for (double step = 1e-3; step > 1e-17; step /= 10) {
        const Vec3d aside = step * Vec3d{std::cos(angle), std::sin(angle), 0};
        add(vertex + aside), add(on_edge + aside);
      }
    }
  }
  return places;
}

/// Checks one contact, and that of the plane through `base` with the unit `normal`.
void check_single(const TriangleMesh& mesh, const Vec3d& base, const Vec3d& normal, double height,
                  double reach, double tolerance, int& wrong) {
  const auto found = contacts(mesh, base + height * normal, reach);
  if (found.size() == 1 && gap(found[0].normal, height > 0 ? normal : -normal) <= tolerance &&
      std::abs(found[0].distance - std::abs(height)) <= tolerance * std::abs(height))
    return;
  if (++wrong > 3) return;  // enough to see what is wrong
  INFO("base ", base.x, " ", base.y, " ", base.z, ", height ", height, ", reach ", reach);
  REQUIRE(found.size() == 1);
  CHECK(gap(found[0].normal, height > 0 ? normal : -normal) <= tolerance);
  CHECK(std::abs(found[0].distance - std::abs(height)) <= tolerance * std::abs(height));
}

/// A drum of `facets` flat strips around the z axis, its facets' middles at radius 1.
Soup drum(int facets) {
  Soup soup;
  const double r = 1 / std::cos(pi / facets);
  const auto at = [&](int k) {
    return Vec3d{r * std::cos(2 * pi * k / facets), r * std::sin(2 * pi * k / facets), -1};
  };
  for (int k = 0; k < facets; ++k) add_quad(soup, at(k), at(k + 1) - at(k), {0, 0, 2});
  return soup;
}

}  // namespace

TEST_CASE(
    "mesh_contacts: a flat floor gives one contact, the plane's to 1e-14, however it is cut") {
  std::mt19937_64 random(2);
  for (const auto& floor : floors())
    for (const double smooth_angle : {pi / 6, 0.0}) {
      INFO("floor: ", floor.name, ", smooth_angle ", smooth_angle);
      const TriangleMesh mesh(floor.soup, smooth_angle);
      int wrong = 0;
      for (const auto& place : places_on_floor(floor.soup, random))
        for (const double height : {0.095, 0.06, 0.01, 1e-4, -0.095, -0.01})
          check_single(mesh, place, {0, 0, 1}, height, 0.1, 1e-14, wrong);
      CHECK(wrong == 0);
    }
}

TEST_CASE("mesh_contacts: so does a tilted floor, to round-off of its corners") {
  std::mt19937_64 random(3);
  const auto turn = silt::rotation_about(normalised({1, 2, 3}), 0.8);
  const auto tilted = [&](const Vec3d& p) { return rotate(turn, p) + Vec3d{0.3, -0.2, 0.5}; };
  for (auto floor : floors()) {
    INFO("floor: ", floor.name);
    const auto places = places_on_floor(floor.soup, random);
    for (auto& t : floor.soup)
      for (auto& corner : t) corner = tilted(corner);
    const TriangleMesh mesh(floor.soup);
    int wrong = 0;
    // Corners are rounded to 1e-16, smallest triangle height 0.02, smallest distance 0.01.
    for (const auto& place : places)
      for (const double height : {0.095, 0.01, -0.06})
        check_single(mesh, tilted(place), rotate(turn, {0, 0, 1}), height, 0.1, 1e-13, wrong);
    CHECK(wrong == 0);
  }
}

TEST_CASE("mesh_contacts: so does a tilted floor whose corners were rounded to float") {
  std::mt19937_64 random(4);
  const auto turn = silt::rotation_about(normalised({1, 2, 3}), 0.8);
  for (auto floor : floors())
    for (const double smooth_angle : {pi / 6, 0.01}) {
      INFO("floor: ", floor.name, ", smooth_angle ", smooth_angle);
      const auto places = places_on_floor(floor.soup, random);
      auto soup = floor.soup;
      for (auto& t : soup)
        for (auto& corner : t) {
          corner = rotate(turn, corner);
          corner = {rounded_to_float(corner.x), rounded_to_float(corner.y),
                    rounded_to_float(corner.z)};
        }
      const TriangleMesh mesh(soup, smooth_angle);
      int wrong = 0;
      // Float rounds to 6e-8: over heights of 0.02 of the smallest triangles, 1e-5 in the normal.
      for (const auto& place : places)
        for (const double height : {0.095, 0.06, -0.06})
          check_single(mesh, rotate(turn, place), rotate(turn, {0, 0, 1}), height, 0.1, 2e-5,
                       wrong);
      CHECK(wrong == 0);
    }
}

TEST_CASE("mesh_contacts: a right-angled valley gives two contacts, a box corner three") {
  Soup valley;
  for (const double y : {0.0, 0.5}) {  // finer floor than wall: hanging nodes in the crease
    add_quad(valley, {0, y, 0}, {1, 0, 0}, {0, 0.5, 0});
    add_quad(valley, {0, y, 0}, {0, 0.5, 0}, {0, 0, 1});
  }
  for (const bool welded : {true, false}) {
    auto soup = valley;
    if (!welded)
      add_quad(soup, {0, 0, 0}, {0, 1.0 / 3, 0}, {0, 0, 1});  // another wall in the same plane
    const TriangleMesh mesh(soup);
    for (const double y : {0.25, 0.37, 0.5, 0.5 + 1e-12, 0.7}) {
      const auto found = contacts(mesh, {0.08, y, 0.09}, 0.1);
      REQUIRE(found.size() == 2);
      CHECK(found[0].distance == doctest::Approx(0.08).epsilon(1e-14));
      CHECK(gap(found[0].normal, {1, 0, 0}) < 1e-14);
      CHECK(found[1].distance == doctest::Approx(0.09).epsilon(1e-14));
      CHECK(gap(found[1].normal, {0, 0, 1}) < 1e-14);
      CHECK(found[0].feature != found[1].feature);
    }
  }
  const TriangleMesh box(box_soup({0, 0, 0}, {1, 1, 1}));
  const auto found = contacts(box, {0.07, 0.08, 0.09}, 0.1);
  REQUIRE(found.size() == 3);
  CHECK(gap(found[0].normal, {1, 0, 0}) < 1e-14);
  CHECK(gap(found[1].normal, {0, 1, 0}) < 1e-14);
  CHECK(gap(found[2].normal, {0, 0, 1}) < 1e-14);
}

TEST_CASE("mesh_contacts: a ridge and a corner from outside give one contact, without a jump") {
  const TriangleMesh box(box_soup({0, 0, 0}, {1, 1, 1}));
  const auto edge = contacts(box, {1.03, 0.5, 1.04}, 0.1);
  REQUIRE(edge.size() == 1);
  CHECK(edge[0].distance == doctest::Approx(0.05).epsilon(1e-14));
  CHECK(gap(edge[0].normal, {0.6, 0, 0.8}) < 1e-13);
  const auto corner = contacts(box, {1.02, 1.03, 1.06}, 0.1);
  REQUIRE(corner.size() == 1);
  CHECK(corner[0].distance == doctest::Approx(0.07).epsilon(1e-14));
  CHECK(gap(corner[0].normal, Vec3d{2, 3, 6} * (1 / 7.)) < 1e-13);
  // Along a line past the ridge, and one past the corner: distance and normal are continuous.
  for (const double y : {0.5, 1.01}) {
    auto last = contacts(box, {0.9, y, 1.05}, 0.2);
    for (int k = 1; k <= 2000; ++k) {
      const auto now = contacts(box, {0.9 + k * 1e-4, y, 1.05}, 0.2);
      REQUIRE(now.size() == 1);
      CHECK(std::abs(now[0].distance - last[0].distance) <= 1e-4 + 1e-12);
      CHECK(gap(now[0].normal, last[0].normal) <= 1e-4 / 0.05 + 1e-12);
      last = now;
    }
  }
}

TEST_CASE("mesh_contacts: a ridge whose flanks share no vertices gives one contact") {
  for (const double smooth_angle : {pi / 6, 0.0}) {
    Soup soup;  // a roof with its ridge along y at height 0
    for (int k = 0; k < 3; ++k) add_quad(soup, {0, k / 3.0, 0}, {1, 0, -1}, {0, 1 / 3.0, 0});
    for (int k = 0; k < 7; ++k) add_quad(soup, {0, k / 7.0, 0}, {-1, 0, -1}, {0, 1 / 7.0, 0});
    for (auto& t : soup)
      if (t[0].x + t[1].x + t[2].x < 0)
        for (auto& p : t) p.y += 3e-8;  // within float round-off, too far to weld
    const TriangleMesh mesh(soup, smooth_angle);
    for (int k = 0; k <= 600; ++k)
      for (const double x : {0.0, 1e-12, 0.004, -0.01}) {
        const double y = 0.2 + k * 1e-3;
        const auto found = contacts(mesh, {x, y, 0.03}, 0.1);
        REQUIRE(found.size() == 1);
        CHECK(found[0].distance == doctest::Approx(std::hypot(x, 0.03)).epsilon(1e-12));
        CHECK(gap(found[0].normal, normalised({x, 0, 0.03})) < 1e-5);
      }
  }
}

TEST_CASE("mesh_contacts: a convex body touches a sphere outside of it in exactly one place") {
  std::mt19937_64 random(8);
  for (const auto& soup :
       {ball_soup(0), ball_soup(2), box_soup({-0.5, -0.4, -0.3}, {0.5, 0.4, 0.3})}) {
    const TriangleMesh body(soup, 0);
    for (int n = 0; n < 1000; ++n) {
      const Vec3d centre = random_point(random, -2, 2);
      if (body.contains(centre)) continue;
      double distance = infinity;
      for (std::uint32_t t = 0; t < soup.size(); ++t)
        distance = std::min(distance, body.distance_to(t, centre));
      // No further: the inner side of the far faces, at least 0.6 behind, has minima of its own.
      const auto found = contacts(body, centre, distance + 0.5);
      REQUIRE(found.size() == 1);
      CHECK(std::abs(found[0].distance - distance) < 1e-14);
      // The touched point is on the body, and the plane across the normal keeps all of it behind.
      const Vec3d touched = centre - found[0].distance * found[0].normal;
      double nearest = infinity, furthest = -infinity;
      for (std::uint32_t t = 0; t < soup.size(); ++t) {
        nearest = std::min(nearest, body.distance_to(t, touched));
        for (const auto& corner : soup[t])
          furthest = std::max(furthest, dot(corner - touched, found[0].normal));
      }
      CHECK(nearest < 1e-13);
      CHECK(furthest < 1e-12);
    }
  }
}

TEST_CASE("mesh_contacts: the order of the triangles changes no contact") {
  std::mt19937_64 random(9);
  auto soup = separate_patches();
  add_quad(soup, {0, 0, 0}, {0, 1, 0}, {0.3, 0, 1});
  const TriangleMesh mesh(soup);
  std::shuffle(soup.begin(), soup.end(), random);
  const TriangleMesh shuffled(soup);
  int two = 0;
  for (int n = 0; n < 500; ++n) {
    const Vec3d centre{uniform(random, 0.03, 0.2), uniform(random, 0.2, 0.8), 0.095};
    const auto a = contacts(mesh, centre, 0.1), b = contacts(shuffled, centre, 0.1);
    REQUIRE(a.size() == b.size());
    two += a.size() == 2;
    for (std::size_t k = 0; k < a.size(); ++k) {
      CHECK(std::abs(a[k].distance - b[k].distance) < 1e-15);
      CHECK(gap(a[k].normal, b[k].normal) < 1e-14);
    }
  }
  CHECK(two > 100);
}

TEST_CASE("mesh_contacts: a drum of 36 facets is one smooth wall from inside and outside") {
  const TriangleMesh mesh(drum(36));
  std::mt19937_64 random(6);
  for (const double r : {0.905, 0.91, 1.09})  // a ball of radius 0.1, overlap up to 10 %
    for (int n = 0; n < 720; ++n) {
      const double angle = n % 2 ? pi / 360 * n : uniform(random, 0, 2 * pi);
      const Vec3d radial{std::cos(angle), std::sin(angle), 0};
      const auto found = contacts(mesh, r * radial + Vec3d{0, 0, uniform(random, -0.5, 0.5)}, 0.1);
      REQUIRE(found.size() == 1);
      const double turned = std::acos(std::min(1.0, std::abs(dot(found[0].normal, radial))));
      CHECK(turned <= pi / 36 + 1e-9);  // half a facet
    }
}

TEST_CASE("mesh_contacts: smooth_angle decides whether a shallow crease is one contact or two") {
  const double slope = 20 * pi / 180;
  Soup soup;
  add_quad(soup, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_quad(soup, {0, 0, 0}, {0, 1, 0}, {-std::cos(slope), 0, std::sin(slope)});
  const Vec3d centre{std::tan(slope / 2) * 0.095, 0.5, 0.095};  // equally far from both
  CHECK(contacts(TriangleMesh(soup), centre, 0.1).size() == 1);
  CHECK(contacts(TriangleMesh(soup, slope * 1.01), centre, 0.1).size() == 1);
  CHECK(contacts(TriangleMesh(soup, slope * 0.99), centre, 0.1).size() == 2);
  CHECK(contacts(TriangleMesh(soup, 0), centre, 0.1).size() == 2);
}

TEST_CASE("mesh_contacts: of six walls the four deepest are kept, deepest first") {
  const TriangleMesh box(box_soup({0, 0, 0}, {1, 1.1, 1.3}));
  const auto found = contacts(box, {0.46, 0.5, 0.6}, 1);  // distances 46 54, 50 60, 60 70
  REQUIRE(found.size() == 4);
  const std::array<Vec3d, 3> normals{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{-1, 0, 0}};
  for (std::size_t k = 0; k < 3; ++k) CHECK(gap(found[k].normal, normals[k]) < 1e-14);
  CHECK(found[3].distance == doctest::Approx(0.6).epsilon(1e-14));
}

TEST_CASE("mesh_contacts: a centre exactly on the surface has distance 0 and the face's normal") {
  std::mt19937_64 random(7);
  const TriangleMesh mesh(jittered(random));
  for (const auto& place : {Vec3d{0.33, 0.41, 0}, mesh.vertices()[100], mesh.vertices()[60]}) {
    const auto found = contacts(mesh, place, 0.1);
    REQUIRE(found.size() == 1);
    CHECK(found[0].distance == 0);
    CHECK(gap(found[0].normal, {0, 0, 1}) < 1e-15);
  }
}

TEST_CASE("mesh_contacts: many small facets in reach are one contact") {
  Soup soup;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j)
      add_quad(soup, {i / 40.0, j / 40.0, 0}, {1 / 40.0, 0, 0}, {0, 1 / 40.0, 0});
  int wrong = 0;
  const TriangleMesh mesh(soup, 0);
  check_single(mesh, {0.5, 0.5, 0}, {0, 0, 1}, 0.1, 0.4, 1e-14, wrong);
  check_single(mesh, {0.512, 0.487, 0}, {0, 0, 1}, 0.39, 0.4, 1e-14, wrong);
}

TEST_CASE("mesh_contacts: candidates out of reach change nothing, and nothing is allocated") {
  const TriangleMesh box(box_soup({0, 0, 0}, {1, 1, 1}));
  std::vector<std::uint32_t> near, all;
  const Vec3d centre{0.07, 0.08, 0.5};
  box.triangles_near(centre, 0.1, near);
  box.triangles_near(centre, infinity, all);
  REQUIRE(near.size() < all.size());
  SurfacePoint a[TriangleMesh::max_contacts], b[TriangleMesh::max_contacts];
  const long before = allocations;
  const int from_near = box.contacts(centre, 0.1, near, a);
  const int from_all = box.contacts(centre, 0.1, all, b);
  CHECK(allocations == before);
  REQUIRE(from_near == 2);
  REQUIRE(from_all == 2);
  for (int k = 0; k < 2; ++k) {
    CHECK(a[k].distance == b[k].distance);
    CHECK(a[k].normal == b[k].normal);
    CHECK(a[k].feature == b[k].feature);
  }
}

TEST_CASE("mesh_contacts: features number faces, then edges, then vertices") {
  const TriangleMesh box(box_soup({0, 0, 0}, {1, 1, 1}));  // 12 faces, 18 edges, 8 vertices
  CHECK(contacts(box, {0.2, 0.6, 1.05}, 0.1)[0].feature < 12);
  const auto edge = contacts(box, {1.05, 0.5, 1.05}, 0.1)[0].feature;
  CHECK((edge >= 12 && edge < 30));
  const auto vertex = contacts(box, {1.05, 1.05, 1.05}, 0.1)[0].feature;
  CHECK((vertex >= 30 && vertex < 38));
}

}  // namespace mesh_contacts_test
