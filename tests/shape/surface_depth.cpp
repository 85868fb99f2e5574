// silt - BSD-3-Clause, see LICENSE
#include <silt/shape/narrow/surface_depth.hpp>

#include "grounds.hpp"

namespace surface_depth_test {

using namespace solid_test;

namespace {

constexpr int of = detail::SurfaceDepth::power;

/// A square, in one piece.
TriangleMesh square(double half) {
  Soup soup;
  add_quad(soup, {-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0});
  return TriangleMesh(soup);
}

/// The body with its contacts' overlap, of all together, brought to `overlap` by its height.
template <class Find>
PlacedPolyhedron pressed(PlacedPolyhedron body, double overlap, const Find& find) {
  double low = -1, high = 2;
  for (int k = 0; k < 60; ++k) {
    body.pose.position.z = 0.5 * (low + high);
    (find(body) > overlap ? low : high) = body.pose.position.z;
  }
  return body;
}
double deepest(const TriangleMesh& mesh, const PlacedPolyhedron& body) {
  const auto found = at(mesh, body);
  return found.empty() ? 0 : found[0].overlap;
}

}  // namespace

TEST_CASE("surface depth: a cube flat on a plane, a fin in a cube") {
  const Polyhedron cube = shape_test::box({1, 1, 1});
  const auto floor = square(3);
  for (const double d : {1e-6, 1e-3, 0.02, 0.1}) {
    // Of the square, what is nearer to a side than to the face: the integral over strips.
    double sum = std::pow(1 - 2 * d, 2) * std::pow(d, of);
    const int n = 20000;
    for (int k = 0; k < n; ++k) {
      const double s = d * (k + 0.5) / n;
      sum += 4 * (1 - 2 * s) * std::pow(s, of) * d / n;
    }
    const auto found = at(floor, place(cube, {0.3, 0.2, 0.5 - d}, {}));
    REQUIRE(found.size() == 1);
    const auto& c = found[0];
    CHECK(c.overlap == near(std::pow(sum, 1.0 / of)).epsilon(1e-8));
    CHECK(std::abs(c.overlap / d - 1) < 0.3 * d);
    CHECK(norm(c.normal - Vec3d{0, 0, 1}) < 1e-12);
    CHECK(norm(c.point - Vec3d{0.3, 0.2, 0}) < 1e-12);
    CHECK(std::abs(c.couple) < 1e-12);
  }
  // The fin x = 0.1, z < 0, on which the cube stands: of depth e it has a strip of length 1.
  Soup fin;
  add_quad(fin, {0.1, -2, 0}, {0.1, 2, 0}, {0.1, 2, -1}, {0.1, -2, -1});
  const double d = 0.01;
  const auto found = at(TriangleMesh(fin), place(cube, {0, 0, 0.5 - d}, {}));
  REQUIRE(found.size() == 1);
  // ... less the corners at its ends, where sides are nearer: 2 s long.
  double sum = 0;
  const int n = 20000;
  for (int k = 0; k < n; ++k) {
    const double s = d * (k + 0.5) / n;
    sum += ((1 - 2 * s) + 2 * (d - s)) * std::pow(s, of) * d / n;
  }
  CHECK(found[0].overlap == near(std::pow(sum, 1.0 / of)).epsilon(1e-8));
  CHECK(norm(found[0].normal - Vec3d{0, 0, 1}) < 1e-12);
  CHECK(found[0].point.x == near(0.1));
}

TEST_CASE("surface depth: does not depend on how a plane is cut, seams without corners included") {
  Draws r(1);
  const TriangleMesh whole(floor_of(r, 12, 3, [](double, double) { return 0.; }));
  const TriangleMesh halves = floor_with_seam(r), one = square(3);
  for (const auto patch : halves.patches()) CHECK(patch == 0);
  const Polyhedron die = shape_test::box({0.6, 0.5, 0.4}), stone = r.hull(30);
  for (int k = 0; k < 100; ++k)
    for (const auto* shape : {&die, &stone}) {
      auto body = place(*shape, {r.uniform(-0.9, 0.9), r.uniform(-0.9, 0.9), 0}, r.turn());
      body.pose.position.z = -dot(body.support({0, 0, -1}), Vec3d{0, 0, 1}) - r.uniform(0, 0.03);
      const auto exact = at(one, body);
      REQUIRE(exact.size() == 1);
      for (const auto* mesh : {&whole, &halves}) {
        const auto found = at(*mesh, body);
        REQUIRE(found.size() == 1);
        CHECK(std::abs(found[0].overlap - exact[0].overlap) < 1e-12);
        CHECK(norm(found[0].normal - exact[0].normal) < 1e-10);
        CHECK(norm(found[0].point - exact[0].point) < 1e-9);
      }
    }
}

TEST_CASE(
    "surface depth: on ground finer than the body the overlap is a potential and never jumps") {
  Draws r(2);
  const Polyhedron cube = shape_test::box({1, 1, 1}), stone = r.hull(20);
  for (const int facets : {4, 12, 24})  // 2, 1/1.5 and 1/3 of the cube
    for (const double rough : {0.02, 0.1}) {
      const double height = rough * 8 / facets;
      const TriangleMesh ground(
          floor_of(r, facets, 4, [&](double, double) { return r.uniform(-height, height); }));
      for (int k = 0; k < 3; ++k)
        for (const auto* shape : {&cube, &stone}) {
          const auto start = place(*shape, {-2, r.uniform(-1, 1), 0}, r.turn());
          for (int step = 0; step < 60; ++step) {
            auto body = moved(start, {4.0 * step / 60, 0, 0}, {});
            body = pressed(body, 2e-3, [&](const auto& b) { return deepest(ground, b); });
            const auto find = [&](const auto& b) { return at(ground, b); };
            // Central differences over 1e-7: rounding 1e-10, curvature less.
            CHECK(potential_error(body, find, 1e-7) < 1e-6);
            // No steeper than some slopes of the ground: 1e-6 aside changes it by no more.
            const double aside = deepest(ground, moved(body, {1e-6, 0, 0}, {}));
            CHECK(std::abs(aside - 2e-3) < 1e-5);
            // Deeper is more.
            CHECK(deepest(ground, moved(body, {0, 0, -1e-4}, {})) > 2e-3);
          }
        }
    }
}

TEST_CASE("surface depth: what has just touched rough ground has a contact") {
  Draws r(3);
  double least = 1;
  for (const double rough : {0.5, 0.1, 1e-3}) {
    const TriangleMesh mesh(
        floor_of(r, 10, 2, [&](double, double) { return r.uniform(0, rough); }));
    std::vector<TriangleSet> sets;
    for (const auto& t : mesh.triangles())
      sets.push_back({{mesh.vertices()[t[0]], mesh.vertices()[t[1]], mesh.vertices()[t[2]]}});
    for (int k = 0; k < 20; ++k) {
      const Polyhedron stone = r.hull(12);
      const auto body = place(stone, {r.uniform(-1, 1), r.uniform(-1, 1), 0}, r.turn());
      const auto touches = [&](double z) {
        const auto there = moved(body, {0, 0, z}, {});
        return std::any_of(sets.begin(), sets.end(), [&](const TriangleSet& set) {
          return gjk_distance(there, set, {0, 0, 1}, 0).overlapping;
        });
      };
      double low = 0, high = 2;
      for (int i = 0; i < 40; ++i) {
        const double mid = 0.5 * (low + high);
        (touches(mid) ? low : high) = mid;
      }
      CHECK(at(mesh, moved(body, {0, 0, high + 1e-6}, {})).empty());
      const double down = 1e-4;
      const auto found = at(mesh, moved(body, {0, 0, high - down}, {}));
      REQUIRE(!found.empty());
      CHECK(found[0].overlap < 1.001 * down);
      least = std::min(least, found[0].overlap / down);
    }
  }
  // A corner 1e-4 deep: (depth/size)^(2/16) = 0.34, times what a corner has of a face, some half.
  CHECK(least > 0.05);
  CHECK(least < 0.4);
}

TEST_CASE("surface depth: one contact with each wall of a box, on a step, and none in the air") {
  Soup soup;
  add_quad(soup, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0});
  add_quad(soup, {0, 0, 0}, {0, 2, 0}, {0, 2, 2}, {0, 0, 2});
  add_quad(soup, {0, 0, 0}, {0, 0, 2}, {2, 0, 2}, {2, 0, 0});
  const TriangleMesh box(soup);
  const Polyhedron die = shape_test::box({1, 1, 1});
  const auto three = at(box, place(die, {0.499, 0.498, 0.497}, {}));
  REQUIRE(three.size() == 3);
  // The walls end where the others begin: less of a rim than in the open.
  const double exact[3] = {0.003, 0.002, 0.001};
  for (std::size_t k = 0; k < 3; ++k) CHECK(three[k].overlap == near(exact[k]).epsilon(2e-3));
  CHECK(at(box, place(die, {0.501, 0.501, 0.501}, {})).empty());

  const TriangleMesh step = step_mesh();
  const Polyhedron small = shape_test::box({0.4, 0.4, 0.4});
  for (const double x : {0.05, -0.05}) {  // more or less than half of it over the edge
    const auto found = at(step, place(small, {x, 0, 0.199}, {}));
    REQUIRE(found.size() == 2);  // the riser's rim is in it too, and pushes up as well
    CHECK(found[0].overlap < 0.001);
    CHECK(found[0].overlap > 0.9e-3);
    for (const auto& c : found) CHECK(c.normal.z > 1 - 1e-3);
  }
  const auto foot = at(step, place(small, {-0.199, 0, -0.801}, {}));
  REQUIRE(foot.size() == 2);
  CHECK(foot[0].normal.x + foot[1].normal.x == near(-1).epsilon(1e-3));
  CHECK(foot[0].normal.z + foot[1].normal.z == near(1).epsilon(1e-3));
}

TEST_CASE("surface depth: patches of a mesh") {
  Draws r(5);
  const TriangleMesh ground(floor_of(r, 20, 2, [&](double, double) { return r.uniform(0, 0.02); }));
  for (const auto patch : ground.patches()) CHECK(patch == 0);
  Soup soup;
  for (const auto& face : shape_test::box({1, 1, 1}).triangles()) soup.push_back(face);
  const TriangleMesh cube(soup);
  CHECK(*std::max_element(cube.patches().begin(), cube.patches().end()) == 5);
  for (std::size_t a = 0; a < cube.triangles().size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      CHECK((cube.patches()[a] == cube.patches()[b]) ==
            (dot(cube.normals()[a], cube.normals()[b]) > 0.5));
}

}  // namespace surface_depth_test
