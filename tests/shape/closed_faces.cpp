// silt - BSD-3-Clause, see LICENSE
// Polyhedra of corners and faces that come from elsewhere: the same numbers, or a sentence.
#include "bodies.hpp"

#include <near.hpp>
#include <refusal.hpp>

#include <silt/fill/bodies.hpp>
#include <silt/shape/laguerre_cells.hpp>

namespace closed_faces_test {

using namespace shape_test;
using silt::ConvexFaces;
using silt_test::has, silt_test::refusal;

namespace {

std::string refused(const ConvexFaces& body) {
  return refusal([&] { (void)Polyhedron::from_faces(body); });
}
ConvexFaces cube() { return box({1, 1, 1}).convex_faces(); }
/// The same corners moved, behind those of `body`: two bodies.
ConvexFaces with_another(ConvexFaces body, const ConvexFaces& other, const Vec3d& way) {
  const auto first = static_cast<std::uint32_t>(body.vertices.size());
  for (const Vec3d& v : other.vertices) body.vertices.push_back(v + way);
  for (auto face : other.faces) {
    for (auto& v : face) v += first;
    body.faces.push_back(face);
  }
  return body;
}
/// Joins corner `from` to corner `to`.
ConvexFaces joined(ConvexFaces body, std::uint32_t from, std::uint32_t to) {
  for (auto& face : body.faces)
    for (auto& v : face) {
      if (v == from) v = to;
      if (v > from) --v;
    }
  body.vertices.erase(body.vertices.begin() + from);
  return body;
}
/// A square ring with a square hole: closed, all faces flat, each corner in three faces and more.
ConvexFaces ring() {
  ConvexFaces out;
  for (const double z : {0.0, 1.0})
    for (const double size : {2.0, 1.0})
      for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        out.vertices.push_back({size * x, size * y, z});
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    out.faces.push_back({k, next, 8 + next, 8 + k});            // outside
    out.faces.push_back({4 + next, 4 + k, 12 + k, 12 + next});  // of the hole
    out.faces.push_back({8 + k, 8 + next, 12 + next, 12 + k});  // above
    out.faces.push_back({next, k, 4 + k, 4 + next});            // below
  }
  return out;
}

}  // namespace

TEST_CASE("closed_faces: cells, and cells of cells, come back with the same numbers") {
  silt::Random random(1);
  Random shapes(5);
  std::size_t cells = 0;
  for (int k = 0; k < 40; ++k) {
    const std::vector<double> shares{0.4, 0.3, 0.1, 0.1, 0.05, 0.04, 0.009, 0.001};
    for (const auto& cell : laguerre_cells(shapes.hull(14), shares, random))
      for (const auto& part : laguerre_cells(cell, shares, random)) {
        const auto again = Polyhedron::from_faces(part.convex_faces());
        const silt::BodyForm<Polyhedron> a(part), b(again);
        bool same = again == part && a.mass == b.mass && again.core_area() == part.core_area() &&
                    again.edge_turning() == part.edge_turning() && a.radius == b.radius &&
                    a.lever == b.lever && a.spots.size() == b.spots.size();
        for (std::size_t f = 0; f < part.faces().size() && same; ++f)
          same = part.faces()[f].normal == again.faces()[f].normal &&
                 part.faces()[f].offset == again.faces()[f].offset;
        for (std::size_t s = 0; s < a.spots.size() && same; ++s)
          same = a.spots[s].radius == b.spots[s].radius &&
                 a.spots[s].lightness == b.spots[s].lightness;
        CHECK(same);
        ++cells;
      }
  }
  CHECK(cells == 40 * 64);
}

TEST_CASE("closed_faces: a scaled body made anew is that of its corners") {
  const auto body = Random(3).hull(20).scaled(1.0 / 3);
  const auto anew = body.made_anew();
  CHECK(anew == body);
  CHECK(Polyhedron::from_faces(body.convex_faces()).core_volume() == anew.core_volume());
  CHECK(anew.core_volume() == near(body.core_volume()).epsilon(1e-13));
}

TEST_CASE("closed_faces: what bounds no convex body is refused, each with its sentence") {
  CHECK_NOTHROW(Polyhedron::from_faces(cube()));
  auto body = cube();
  body.faces.resize(3);
  has(refused(body), "8 corners and 3 faces; a body has 4 of each at least");
  body = cube();
  body.vertices[5].y = std::nan("");
  has(refused(body), "corner 5 is ");
  body = cube();
  body.faces[2].resize(2);
  has(refused(body), "face 2 has 2 corners; three are the least");
  body = cube();
  body.faces[1][2] = 8;
  has(refused(body), "face 1 has corner 8 of 8");
  body = cube();
  body.faces[4][1] = body.faces[4][3];
  has(refused(body), "face 4 has a corner twice");
  body = cube();
  std::reverse(body.faces[3].begin(), body.faces[3].end());
  has(refused(body), "the same way round");
  body = cube();
  body.faces.pop_back();
  has(refused(body), ": the faces do not close");
  body = cube();
  body.vertices.push_back({0, 0, 0});
  has(refused(body), "corner 8 is in 0 faces");
  has(refused(with_another(cube(), cube(), {3, 0, 0})), "not joined to the others by edges");
  // Two cubes that are one in a corner: around it the faces are two rings.
  has(refused(joined(with_another(cube(), cube(), {3, 0, 0}), 8, 0)), "touch in corner 0 alone");
  has(refused(ring()), "the faces have a handle: 16 corners, 32 edges and 16 faces");
}

TEST_CASE("closed_faces: closed surfaces that are not convex, flat or the right way out") {
  auto body = cube();
  for (auto& face : body.faces) std::reverse(face.begin(), face.end());
  has(refused(body), "the body is not convex, or its faces are reversed");
  body = cube();
  for (Vec3d& v : body.vertices) v = {0, 0, 0};
  has(refused(body), "face 0 has no area");
  body = cube();
  body.vertices[3].z += 1e-3;
  has(refused(body), "is not flat");
  body = cube();
  body.vertices[3].z += 1e-9;  // as cells of a convex hull may be
  CHECK_NOTHROW(Polyhedron::from_faces(body));
  // A corner pushed in, all faces triangles.
  auto octahedron =
      Polyhedron::from_points({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
          .convex_faces();
  for (Vec3d& v : octahedron.vertices)
    if (v.z > 0.5) v.z = -0.2;
  has(refused(octahedron), "the body is not convex");
  // A face whose corners turn twice around.
  std::vector<Vec3d> points;
  for (int k = 0; k < 5; ++k)
    for (const double z : {0.0, 1.0})
      points.push_back({std::cos(0.4 * pi * k), std::sin(0.4 * pi * k), z});
  const auto prism = Polyhedron::from_points(points).convex_faces();
  auto star = prism;
  std::vector<std::uint32_t> number(10);
  for (std::uint32_t v = 0; v < 10; ++v)  // corner k of a ring goes to place 2 k
    for (std::uint32_t w = 0; w < 10; ++w) {
      const Vec3d &a = prism.vertices[v], &b = prism.vertices[w];
      const double x = a.x * a.x - a.y * a.y, y = 2 * a.x * a.y;
      if (a.z == b.z && std::abs(b.x - x) + std::abs(b.y - y) < 1e-9) number[v] = w;
    }
  for (std::uint32_t v = 0; v < 10; ++v) star.vertices[v] = prism.vertices[number[v]];
  has(refused(star), "Polyhedron: ");
  has(refusal([] { (void)Polyhedron::from_faces(cube(), -1); }), "Polyhedron: radius = -1");
}

}  // namespace closed_faces_test
