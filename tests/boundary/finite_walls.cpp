// silt - BSD-3-Clause, see LICENSE
// Walls of finite size: areas and volumes, contacts at faces, edges and corners, refusals.
#include <silt/boundary/finite_walls.hpp>

#include "support.hpp"

namespace finite_walls_test {

using namespace boundary_test;
using silt::Face;
using silt::TriangleMesh;

namespace {

/// Where a sphere first touches: normal and distance of the deepest contact.
SurfacePoint nearest(const TriangleMesh& mesh, const Vec3d& centre) {
  return mesh.nearest_point(centre);
}

}  // namespace

TEST_CASE("finite walls: areas and volumes are those of rectangle and box, exactly") {
  CHECK(silt::rectangle({1, 2, 3}, {2, 0, 0}, {0, 0, 3}).area() == doctest::Approx(6));
  const auto box = silt::box_mesh({-1, -2, -3}, {1, 2, 3});
  CHECK(box.is_closed());
  CHECK(box.volume() == doctest::Approx(48));  // positive: normals point outwards
  CHECK(box.area() == doctest::Approx(2 * (8 + 24 + 12)));
  const auto tub = silt::open_box({0, 0, 0}, {1, 2, 3});
  CHECK(!tub.is_closed());
  CHECK(tub.area() == doctest::Approx(2 * (2 + 3 + 6) - 2));
  CHECK(tub.bounds().max.z == 3);
  const auto duct = silt::open_box({0, 0, 0}, {1, 2, 3}, {Face::XLow, Face::XHigh});
  CHECK(duct.area() == doctest::Approx(2 * (2 + 3)));
}

TEST_CASE("finite walls: a disc and a cylinder are polygons of so many sides") {
  const double R = 0.5;
  for (const int n : {6, 64}) {
    const double polygon = 0.5 * n * R * R * std::sin(2 * pi / n);
    const auto disc = silt::disc({1, 0, 0}, {0, 1, 1}, R, n);
    CHECK(disc.area() == doctest::Approx(polygon));
    const auto solid = silt::capped_cylinder({0, 0, 1}, {0, 0, 3}, R, n);
    CHECK(solid.is_closed());
    CHECK(solid.volume() == doctest::Approx(2 * polygon));
    const auto bucket = silt::capped_cylinder({0, 0, 1}, {0, 0, 3}, R, n, true);
    CHECK(!bucket.is_closed());
    CHECK(bucket.area() == doctest::Approx(solid.area() - polygon));
    // The rim is inside the circle by up to the sagitta.
    double least = R;
    for (int k = 0; k < 1000; ++k) {
      const double phi = 2 * pi * k / 1000;
      const Vec3d out{3 * std::cos(phi), 3 * std::sin(phi), 2};
      least = std::min(least, 3 - nearest(solid, out).distance);
      CHECK(3 - nearest(solid, out).distance <= R * (1 + 1e-12));
    }
    CHECK(least >= R * std::cos(pi / n) * (1 - 1e-12));
  }
}

TEST_CASE("finite walls: a sphere's mesh is closed, turned outwards, and inside the sphere") {
  const double R = 0.5, ball = 4 * pi / 3 * R * R * R;
  const Vec3d centre{1, -2, 3};
  // 20 facets are the regular icosahedron.
  const double side = R / std::sin(0.4 * pi);
  CHECK(silt::sphere_mesh(centre, R, 1).volume() ==
        doctest::Approx(5 * (3 + std::sqrt(5.0)) / 12 * side * side * side));
  double before = 1;  // what the volume lacks
  for (const int parts : {1, 2, 4, 8}) {
    const auto mesh = silt::sphere_mesh(centre, R, parts);
    CHECK(mesh.triangles().size() == static_cast<std::size_t>(20 * parts * parts));
    CHECK(mesh.dropped_triangles() == 0);
    CHECK(mesh.vertices().size() == static_cast<std::size_t>(10 * parts * parts + 2));
    CHECK(mesh.is_closed());
    for (const Vec3d& v : mesh.vertices()) CHECK(norm(v - centre) == doctest::Approx(R));
    for (std::size_t t = 0; t < mesh.triangles().size(); ++t)
      CHECK(dot(mesh.normals()[t], mesh.vertices()[mesh.triangles()[t][0]] - centre) > 0.79 * R);
    const double lacks = 1 - mesh.volume() / ball;
    CHECK(lacks > 0);
    if (parts > 1) CHECK(lacks < (parts == 2 ? 0.4 : 0.3) * before);  // second order
    before = lacks;
  }
  // As the header says of 320 facets.
  const auto mesh = silt::sphere_mesh(centre, R);
  CHECK(1 - mesh.volume() / ball == doctest::Approx(0.034).epsilon(0.02));
  double deepest = 0;
  for (std::size_t t = 0; t < mesh.triangles().size(); ++t)
    deepest = std::max(
        deepest, 1 - dot(mesh.normals()[t], mesh.vertices()[mesh.triangles()[t][0]] - centre) / R);
  CHECK(deepest == doctest::Approx(0.018).epsilon(0.02));
}

TEST_CASE("finite walls: faces, edges and corners are as far as geometry says, from both sides") {
  const auto plate = silt::rectangle({0, 0, 0}, {2, 0, 0}, {0, 1, 0});
  for (const double side : {1.0, -1.0}) {
    CHECK(nearest(plate, {0.7, 0.2, side * 0.1}).distance == doctest::Approx(0.1));
    CHECK(nearest(plate, {0.7, 0.2, side * 0.1}).normal.z == doctest::Approx(side));
    const auto edge = nearest(plate, {2.3, 0.5, side * 0.4});
    CHECK(edge.distance == doctest::Approx(0.5));
    CHECK(edge.normal.x == doctest::Approx(0.6));
    const auto corner = nearest(plate, {-0.1, -0.2, side * 0.2});
    CHECK(corner.distance == doctest::Approx(0.3));
    CHECK(corner.normal.z == doctest::Approx(side * 2.0 / 3));
  }
  // A sphere in a corner of an open box touches three faces.
  const auto tub = silt::open_box({0, 0, 0}, {1, 1, 1});
  std::vector<std::uint32_t> near;
  tub.triangles_near({0.1, 0.1, 0.1}, 0.12, near);
  SurfacePoint points[TriangleMesh::max_contacts];
  CHECK(tub.contacts({0.1, 0.1, 0.1}, 0.12, near, points) == 3);
}

TEST_CASE("finite walls: what makes no surface is refused") {
  refuses<silt::InputError>([] { silt::rectangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0}); }, "no area");
  refuses<silt::InputError>(
      [] {
        silt::rectangle({0, 0, 0}, {1, 0, not_a_number}, {0, 1, 0});
      },
      "finite");
  refuses<silt::InputError>([] { silt::open_box({0, 0, 0}, {1, 0, 1}); }, "open_box: min");
  refuses<silt::InputError>(
      [] {
        silt::open_box({0, 0, 0}, {1, 1, 1},
                       {Face::XLow, Face::XHigh, Face::YLow, Face::YHigh, Face::ZLow, Face::ZHigh});
      },
      "all six faces are open");
  refuses<silt::InputError>([] { silt::disc({0, 0, 0}, {0, 0, 0}, 1); }, "disc: the axis");
  refuses<silt::InputError>([] { silt::disc({0, 0, 0}, {0, 0, 1}, -1); }, "disc: radius = -1");
  refuses<silt::InputError>([] { silt::disc({0, 0, 0}, {0, 0, 1}, 1, 2); }, "disc: facets = 2");
  refuses<silt::InputError>(
      [] {
        silt::capped_cylinder({0, 0, 1}, {0, 0, 1}, 1);
      },
      "capped_cylinder: the axis");
  refuses<silt::InputError>([] { silt::sphere_mesh({0, 0, 0}, 0); }, "sphere_mesh: radius = 0");
  refuses<silt::InputError>([] { silt::sphere_mesh({0, 0, 0}, 1, 0); }, "sphere_mesh: parts = 0");
  refuses<silt::InputError>(
      [] {
        silt::sphere_mesh({0, 0, std::nan("")}, 1);
      },
      "sphere_mesh: centre");
}

TEST_CASE("finite walls: a mesh's nearest point within a reach is the nearest of all, or none") {
  const auto drum = silt::capped_cylinder({0, 0, -1}, {0, 0, 1}, 0.7, 24);
  int found = 0, none = 0;
  for (int i = -6; i <= 6; ++i)
    for (int j = -6; j <= 6; ++j)
      for (int k = -6; k <= 6; ++k) {
        const Vec3d x{0.17 * i, 0.19 * j + 0.01, 0.23 * k};
        const SurfacePoint all = drum.nearest_point(x);
        for (const double reach : {0.1, 0.3, 1.0}) {
          if (std::abs(all.distance - reach) < 1e-6) continue;
          const auto near = drum.nearest_point(x, reach);
          CHECK(near.has_value() == (all.distance < reach));
          near ? ++found : ++none;
          if (near) CHECK(near->distance == doctest::Approx(all.distance));
        }
      }
  CHECK(found > 1000);
  CHECK(none > 1000);
}

}  // namespace finite_walls_test
