// silt - BSD-3-Clause, see LICENSE

#include "bodies.hpp"

#include <set>

#include <silt/boundary/stl.hpp>

namespace polyhedron_test {

using namespace shape_test;
using silt::mass_properties;

namespace {

Vec3d turned(const silt::RigidPose& pose, const Vec3d& p) { return pose.to_space(p); }

Soup moved(Soup soup, const RigidPose& pose) {
  for (auto& triangle : soup)
    for (auto& corner : triangle) corner = turned(pose, corner);
  return soup;
}

/// Two boxes that make an L; each wall of it one or two rectangles.
Soup prism_of_l(double height) {
  const std::vector<std::array<double, 2>> rim{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const auto at = [&](std::size_t k, double z) { return Vec3d{rim[k % 6][0], rim[k % 6][1], z}; };
  Soup out;
  for (std::size_t k = 0; k < 6; ++k) {
    out.push_back({at(k, 0), at(k + 1, 0), at(k + 1, height)});
    out.push_back({at(k, 0), at(k + 1, height), at(k, height)});
  }
  for (const auto& [i, j, k] :
       {std::array<std::size_t, 3>{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    out.push_back({at(i, height), at(j, height), at(k, height)});
    out.push_back({at(k, 0), at(j, 0), at(i, 0)});
  }
  return out;
}

/// Faces found the slow way: all planes through three points with no point beyond.
std::size_t faces_by_all_planes(const std::vector<Vec3d>& p) {
  std::set<std::vector<std::size_t>> faces;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = 0; j < p.size(); ++j)
      for (std::size_t k = j + 1; k < p.size(); ++k) {
        if (i >= j) continue;
        Vec3d n = cross(p[j] - p[i], p[k] - p[i]);
        if (norm(n) < 1e-9) continue;
        n = normalised(n);
        double low = 0, high = 0;
        std::vector<std::size_t> on;
        for (std::size_t q = 0; q < p.size(); ++q) {
          const double h = dot(n, p[q] - p[i]);
          low = std::min(low, h), high = std::max(high, h);
          if (std::abs(h) < 1e-8) on.push_back(q);
        }
        if (low > -1e-8 || high < 1e-8) faces.insert(on);
      }
  return faces.size();
}

}  // namespace

TEST_CASE("convex_hull: ends where triangles are so thin that their normals are rounding") {
  // A corner that stood above such a triangle was added for ever.
  const auto body = Polyhedron::from_points({
      {-0x1p-1, -0x1p-1, 0x1p-1},
      {-0x1p-1, -0x1p-1, 0x1.219e4638p-24},
      {-0x1.482c6fp-30, -0x1p-1, 0x1p-1},
      {-0x1.3f5d761a36d01p-23, -0x1p-1, 0x1.c40ce106ab62bp-25},
      {-0x1.fcea833b6527ep-24, 0x1.b67c931498fb1p-26, 0x1.305addeaca187p-23},
      {-0x1p-1, -0x1.9448888cddfa9p-25, 0x1p-1},
      {-0x1p-1, -0x1.743196ec95b85p-24, 0x1.5026c6149f26ep-23},
      {-0x1.22256de4fdcd6p-3, 0x1.e6f8054e8b6c3p-26, 0x1.395d4735f0566p-23},
      {-0x1.fcea7e665d8ecp-24, 0x1.3d07f8f84add4p-24, 0x1.980f469e19002p-23},
      {0x1.f2bec07adf2a9p-26, 0x1.6345a254e573ap-25, 0x1p-1},
      {-0x1.718595cadf4cfp-25, 0x1.e71551ab30363p-24, 0x1p-1},
      {-0x1.dbe71ac6864abp-25, 0x1.85c155b3305f5p-24, 0x1.b5ebd700baap-3},
  });
  CHECK(std::abs(body.core_volume() - 0.125) <= 1e-7);
}

TEST_CASE("mass_properties: box and tetrahedron to rounding, wherever they stand") {
  const double a = 1.3, b = 0.7, c = 2.1, v = a * b * c;
  const auto body = box({a, b, c});
  const auto m = mass_properties(body);
  CHECK(agree(m.volume, v, 1e-15));
  CHECK(norm(m.centroid) <= 1e-16);
  CHECK(agree(m.inertia.x, v / 12 * (b * b + c * c), 1e-15));
  CHECK(agree(m.inertia.y, v / 12 * (a * a + c * c), 1e-15));
  CHECK(agree(m.inertia.z, v / 12 * (a * a + b * b), 1e-15));
  CHECK(m.axes == Quaternion{});
  // Corner tetrahedron (0, a, b, c): V = abc/6, centroid/4, second moments a^2 V/10 and ab V/20
  // about the corner.
  const auto t =
      mass_properties(Polyhedron::from_points({{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, c}}));
  const auto i = inertia_of(t);
  const double w = v / 6;
  CHECK(agree(t.volume, w, 1e-15));
  CHECK(norm(t.centroid - 0.25 * Vec3d{a, b, c}) <= 1e-15);
  CHECK(
      agree(i.xx, w * (b * b + c * c) * (1.0 / 10 - 1.0 / 16), 4e-15));  // back from principal axes
  CHECK(agree(i.xy, -w * a * b * (1.0 / 20 - 1.0 / 16), 1e-14));
  // 1000 sizes away from zero, turned: 13 of 16 digits of position are left.
  Random random(1);
  const RigidPose pose{{1000, -2000, 500}, random.turn()};
  const auto far = mass_properties(moved(body.triangles(), pose));
  CHECK(agree(far.volume, v, 1e-11));
  std::array<double, 3> found{far.inertia.x, far.inertia.y, far.inertia.z};
  std::array<double, 3> expected{m.inertia.x, m.inertia.y, m.inertia.z};
  std::sort(found.begin(), found.end()), std::sort(expected.begin(), expected.end());
  for (std::size_t k = 0; k < 3; ++k) CHECK(agree(found[k], expected[k], 1e-11));
}

TEST_CASE("RigidPose: the matrix turns as the quaternion does, and back") {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const auto q = random.turn();
    const RigidPose pose{random.in_cube(1), q};
    const Vec3d p = random.in_cube(1);
    CHECK(norm(pose.to_space(p) - (pose.position + rotate(q, p))) <= 4e-15);
    CHECK(norm(pose.to_body(pose.to_space(p)) - p) <= 4e-15);  // a dozen roundings of 2
  }
}

TEST_CASE("convex_hull: all planes through three points agree; points in faces are dropped") {
  Random random(3);
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<Vec3d> points;
    const int n = 4 + trial % 14;
    for (int k = 0; k < n; ++k) points.push_back(random.in_cube(1));
    if (trial % 3 == 0)  // on a coarse grid: many coplanar, collinear and equal points
      for (auto& p : points)
        p = {std::round(2 * p.x) / 2, std::round(2 * p.y) / 2, std::round(2 * p.z) / 2};
    Polyhedron body = box({1, 1, 1});
    try {
      body = Polyhedron::from_points(points);
    } catch (const silt::InputError&) {  // a flat set is possible on the grid
      CHECK(trial % 3 == 0);
      continue;
    }
    CHECK(body.vertices().size() + body.faces().size() == body.edges().size() + 2);
    CHECK(body.graph().size() == 2 * body.faces().size() - 4);
    CHECK(body.faces().size() == faces_by_all_planes(points));
    for (const auto& face : body.faces())
      for (const auto& p : points) CHECK(dot(face.normal, p) <= face.offset + 1e-12);
  }
  std::vector<Vec3d> grid;
  for (int k = 0; k < 5 * 5 * 5; ++k) grid.push_back({k % 5 * 0.1, k / 5 % 5 * 0.3, k / 25 * 0.2});
  const auto body = Polyhedron::from_points(grid);
  CHECK(body.faces().size() == 6);
  CHECK(body.vertices().size() == 8);
  CHECK(agree(body.core_volume(), 0.4 * 1.2 * 0.8, 1e-14));
}

TEST_CASE("Polyhedron: support by climbing finds what a scan finds") {
  Random random(4);
  std::vector<Vec3d> points;
  for (int k = 0; k < 100; ++k) points.push_back(random.direction());
  const auto body = Polyhedron::from_points(points);
  REQUIRE(body.vertices().size() > 64);
  for (int trial = 0; trial < 1000; ++trial) {
    const auto n = random.direction();
    double most = -9;
    for (const auto& v : body.vertices()) most = std::max(most, dot(n, v));
    const auto hint = static_cast<std::uint32_t>(trial) % 100;
    CHECK(agree(dot(n, body.vertices()[body.support_vertex(n, hint)]), most, 1e-12));
    CHECK(agree(body.reach(n), most, 1e-12));
    double steepest = -9;
    for (const auto& f : body.faces()) steepest = std::max(steepest, dot(n, f.normal));
    CHECK(agree(dot(n, body.faces()[body.face_towards(n).face].normal), steepest, 1e-12));
  }
}

TEST_CASE("dilated polyhedron: Steiner's volume and area; a ball's inertia in the limit") {
  const double a = 0.8, r = 0.3;
  const auto cube = Polyhedron::from_points(box_corners({0, 0, 0}, {a, a, a}), r);
  const double volume = a * a * a + 6 * a * a * r + 3 * pi * a * r * r + 4 * pi / 3 * r * r * r;
  CHECK(agree(cube.volume(), volume, 1e-14));
  CHECK(agree(cube.area(), 6 * a * a + 6 * pi * a * r + 4 * pi * r * r, 1e-14));
  CHECK(agree(cube.edge_turning(), 12 * a * pi / 2, 1e-14));
  const auto m = mass_properties(cube);
  CHECK(agree(m.volume, volume, 1e-13));
  CHECK(norm(m.centroid - Vec3d{a / 2, a / 2, a / 2}) <= 1e-14);
  Random random(5);
  for (int n = 4; n < 20; ++n) {
    std::vector<Vec3d> points;
    for (int k = 0; k < n; ++k) points.push_back(random.in_cube(0.5));
    const auto body = Polyhedron::from_points(points, 0.2);
    CHECK(agree(mass_properties(body).volume, body.volume(), 1e-11));
  }
  // A core of 1e-3 of the radius is a ball: I = 8/15 pi r^5, apart from 1e-3 in the second order.
  const auto ball =
      mass_properties(Polyhedron::from_points(box_corners({0, 0, 0}, {1e-4, 1e-4, 1e-4}), 0.1));
  CHECK(agree(ball.inertia.x, 8 * pi / 15 * 1e-5, 4e-3));
  CHECK(agree(ball.inertia.y, ball.inertia.x, 1e-12));
}

TEST_CASE("dilated polyhedron: inertia against points, to their scatter") {
  Random random(6);
  const double r = 0.25;
  const auto body = Polyhedron::from_points(box_corners({-0.5, -0.3, -0.2}, {0.5, 0.3, 0.2}), r);
  const Vec3d half{0.5, 0.3, 0.2};
  const auto m = mass_properties(body);
  double sum = 0, squares = 0;
  const int n = 400000;
  for (int k = 0; k < n; ++k) {
    const Vec3d p{random.uniform(-0.75, 0.75), random.uniform(-0.55, 0.55),
                  random.uniform(-0.45, 0.45)};
    const Vec3d out{std::max(std::abs(p.x) - half.x, 0.0), std::max(std::abs(p.y) - half.y, 0.0),
                    std::max(std::abs(p.z) - half.z, 0.0)};
    const double x = norm(out) <= r ? p.y * p.y + p.z * p.z : 0;
    sum += x, squares += x * x;
  }
  const double box_volume = 1.5 * 1.1 * 0.9, mean = sum / n;
  const double scatter = box_volume * std::sqrt((squares / n - mean * mean) / n);
  CHECK(std::abs(m.inertia.x - box_volume * mean) <= 4 * scatter);  // one in 16 000 fails by chance
}

TEST_CASE("mass_properties: a concave mesh, and its convex parts as one body") {
  const double h = 0.5;
  const auto mesh = prism_of_l(h);
  const auto m = mass_properties(mesh);
  CHECK(agree(m.volume, 3 * h, 1e-15));
  CHECK(norm(m.centroid - Vec3d{5.0 / 6, 5.0 / 6, h / 2}) <= 1e-15);
  const std::vector<Polyhedron> parts{Polyhedron::from_points(box_corners({0, 0, 0}, {2, 1, h})),
                                      Polyhedron::from_points(box_corners({0, 1, 0}, {1, 2, h}))};
  const auto body = principal_shape(mesh, parts);
  CHECK(body.parts.size() == 2);
  CHECK(agree(body.volume, m.volume, 1e-12));
  // The L is its own mirror image in x = y: one principal axis is the diagonal.
  const double diagonal =
      std::abs(dot(body.frame.turn.x, Vec3d{std::sqrt(0.5), std::sqrt(0.5), 0}));
  CHECK(std::min(diagonal, std::abs(diagonal - 1)) <= 1e-12);
  CHECK(agree(body.bounding_radius, norm(Vec3d{7.0 / 6, 5.0 / 6, h / 2}), 1e-12));
  double moments = 0;  // trace and both parts' parallel axes: the same body again
  for (const auto& part : body.parts) {
    const auto p = mass_properties(part);
    moments +=
        inertia_of(p).zz + p.volume * (p.centroid.x * p.centroid.x + p.centroid.y * p.centroid.y);
  }
  CHECK(agree(moments, body.inertia.z, 1e-13));
  refuses([&] { principal_shape(mesh, {parts[0]}); }, "must fill it without overlap");
}

TEST_CASE("Polyhedron: from a mesh, also one rounded to float; what it refuses") {
  const auto body = box({1, 2, 3});
  CHECK(Polyhedron::from_mesh(body.triangles()).faces().size() == 6);
  Random random(7);
  auto soup = moved(random.hull(20).triangles(), {{10, 0, 0}, random.turn()});
  for (auto& triangle : soup)
    for (auto& p : triangle) {
      volatile float x = static_cast<float>(p.x), y = static_cast<float>(p.y),
                     z = static_cast<float>(p.z);
      p = {x, y, z};
    }
  CHECK(Polyhedron::from_mesh(soup).faces().size() > 20);
  auto open = body.triangles();
  open.pop_back();
  refuses([&] { Polyhedron::from_mesh(open); }, "the mesh is open");
  auto inside_out = body.triangles();
  for (auto& t : inside_out) std::swap(t[0], t[1]);
  refuses([&] { Polyhedron::from_mesh(inside_out); }, "inside out");
  refuses([&] { Polyhedron::from_mesh(prism_of_l(1)); }, "not convex");
  auto two = body.triangles();  // share the edge x = 0.5, y = 1
  for (const auto& t : moved(body.triangles(), {{1, 2, 0}, silt::RotationMatrix{}}))
    two.push_back(t);
  refuses([&] { Polyhedron::from_mesh(two); }, "triangles share the edge");
  two = body.triangles();  // share one corner
  for (const auto& t : moved(body.triangles(), {{1, 2, 3}, silt::RotationMatrix{}}))
    two.push_back(t);
  refuses([&] { Polyhedron::from_mesh(two); }, "touches itself at the vertex");
  two = body.triangles();  // one pierces the other
  for (const auto& t : moved(body.triangles(), {{0.4, 0.3, 1.2}, random.turn()})) two.push_back(t);
  refuses([&] { Polyhedron::from_mesh(two); }, "passes through itself");
  refuses(
      [&] {
        Polyhedron::from_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
      },
      "one plane");
  refuses([&] { Polyhedron::from_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}); }, "needs four");
  refuses([&] { Polyhedron::from_points(box_corners({0, 0, 0}, {1, 1, 1}), -1); }, "radius");
  std::vector<Vec3d> many;
  for (int k = 0; k < 2100; ++k) many.push_back(random.direction());
  refuses([&] { Polyhedron::from_points(many); }, "at most 4000");
}

}  // namespace polyhedron_test
