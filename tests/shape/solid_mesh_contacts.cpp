// silt - BSD-3-Clause, see LICENSE
#include <silt/shape/narrow/solid_mesh_contacts.hpp>

#include "grounds.hpp"

namespace solid_mesh_contacts_test {

using namespace solid_test;

namespace {

template <class Body>
Touches at_plane(const Plane& wall, const Body& body) {
  return all([&](SolidContact* out, int n) { return plane_contacts(body, wall, out, n); });
}

double support_height(const auto& b, const Vec3d& n) {
  double r = 0;
  if constexpr (requires { b.shape->radius(); }) r = b.shape->radius();
  return dot(n, b.support(n)) + r;
}

/// The least depth of a line along y through the origin over normals within the quarter above.
double line_depth(const auto& body) {
  double least = 1e300, at = 0;
  const auto depth = [&](double a) {
    return support_height(body, {-std::sin(a), 0, -std::cos(a)});
  };
  for (int k = -1570; k <= 1570; ++k)
    if (const double d = depth(k * pi / 4000); d < least) least = d, at = k * pi / 4000;
  for (double step = 1e-3; step > 1e-14; step *= 0.5)
    for (const double to : {at - step, at + step})
      if (const double d = depth(to); d < least) least = d, at = to;
  return least;
}

/// All but sharp polyhedra, whose contacts are those of surface_depth.cpp.
template <class Action>
void for_bodies(Draws& r, Action&& action) {
  for (const double s : {2., 4., 8., 20.})
    action(place(SuperEllipsoid{r.uniform(.2, .5), r.uniform(.2, .5), r.uniform(.2, .5), s, s},
                 {0, 0, 0}, r.turn()),
           "s = " + std::to_string(s));
  const PolySuperEllipsoid lopsided{{0.3, 0.5, 0.2}, {0.4, 0.2, 0.3}, 5, 3};
  action(Poly{form_of(lopsided), body_axes(r.turn()), {0, 0, 0}}, std::string("octants"));
  const auto round =
      Polyhedron::from_points(shape_test::box_corners({-.3, -.2, -.2}, {.3, .2, .2}), 0.05);
  action(place(round, {0, 0, 0}, r.turn()), std::string("rounded die"));
}

}  // namespace

TEST_CASE("solid meshes: a floor of irregular triangles is the plane, at all places and turns") {
  Draws r(1);
  const TriangleMesh whole(floor_of(r, 12, 3, [](double, double) { return 0.; }));
  const TriangleMesh patches = floor_with_seam(r);
  const Plane plane{{0, 0, 0}, {0, 0, 1}};
  const double tilts[] = {0, 1e-4, 1e-6, 1e-8, 1e-10};  // [rad]
  for (int k = 0; k < 60; ++k)
    for_bodies(r, [&](const auto& any, const std::string& name) {
      INFO(name, " ", k);
      auto body = any;
      if (k % 2 == 1)  // a face down, to a tilt or none
        body = [&] {
          auto flat = any;
          const auto tilt = rotation_about(r.direction(), tilts[k / 2 % 5]);
          if constexpr (requires { flat.axes; })
            flat.axes = body_axes(tilt);
          else
            flat.pose.turn = rotation_matrix(tilt);
          return flat;
        }();
      const double height = support_height(body, {0, 0, -1}) - r.uniform(0, 0.03);
      body = moved(body, {r.uniform(-0.9, 0.9), r.uniform(-0.9, 0.9), height}, {});
      const auto exact = at_plane(plane, body);
      for (const TriangleMesh* mesh : {&whole, &patches}) {
        const auto found = at(*mesh, body);
        REQUIRE(found.size() == exact.size());
        for (const auto& e : exact) {
          const auto* f = same(found, e);
          CHECK(std::abs(f->overlap - e.overlap) < 1e-13);
          CHECK(norm(f->normal - e.normal) < 1e-13);
          CHECK(norm(f->point - e.point) < 1e-13);
          CHECK(f->feature == e.feature);
        }
      }
    });
}

TEST_CASE(
    "solid meshes: a super-ellipsoid that is a sphere touches rough ground as a sphere does") {
  Draws r(2);
  int contacts = 0, several = 0, no_face = 0;
  for (int m = 0; m < 10; ++m) {
    const TriangleMesh mesh(floor_of(r, 10, 2, [&](double, double) { return r.uniform(0, 0.3); }),
                            m % 2 ? pi / 6 : 0);
    for (int k = 0; k < 800; ++k) {
      const double R = r.uniform(0.1, 0.5);
      const Vec3d centre{r.uniform(-1.4, 1.4), r.uniform(-1.4, 1.4), 0.3 + r.uniform(0.3, 1) * R};
      const auto ball = place(SuperEllipsoid{R, R, R}, centre, r.turn());
      std::vector<std::uint32_t> near;
      mesh.triangles_near(centre, R, near);
      SurfacePoint exact[TriangleMesh::max_contacts];
      const int n = mesh.contacts(centre, R, near, exact);
      const auto found = at(mesh, ball);
      INFO("mesh ", m, " ball ", k, " R ", R, " exact ", n, " found ", found.size());
      CHECK(std::min<std::size_t>(found.size(), TriangleMesh::max_contacts) ==
            static_cast<std::size_t>(n));
      for (std::size_t c = 0; c < std::min(found.size(), static_cast<std::size_t>(n)); ++c) {
        CHECK(std::abs(found[c].overlap - (R - exact[c].distance)) < 1e-11);
        CHECK(norm(found[c].normal - exact[c].normal) < 1e-9);
        no_face += exact[c].feature >= mesh.triangles().size();
      }
      contacts += n, several += n > 1;
    }
  }
  CHECK(contacts > 1000);
  CHECK(several > 300);
  CHECK(no_face > 300);
}

TEST_CASE("solid meshes: bodies on a ridge and on a tip: least depth, and a potential") {
  Draws r(3);
  const TriangleMesh ridge = ridge_mesh(3), tip = tip_mesh(3);
  int on_ridge = 0, on_tip = 0;
  for (int k = 0; k < 25; ++k)
    for_bodies(r, [&](const auto& any, const std::string& name) {
      INFO(name, " ", k);
      const double depth = r.uniform(0.001, 0.01);
      // Its lowest place over the ridge, by the support: then less deep than any other normal has.
      auto body = moved(any, {0, r.uniform(-2, 2), 0}, {});
      body = moved(body, {r.uniform(-0.05, 0.05), 0, 0}, {});
      double low = 0, high = 2;
      for (int i = 0; i < 40; ++i) {
        const double mid = 0.5 * (low + high);
        (line_depth(moved(body, {0, 0, mid}, {})) > depth ? low : high) = mid;
      }
      const auto there = moved(body, {0, 0, low}, {});
      const auto found = at(ridge, there);
      REQUIRE(found.size() == 1);
      // A search by steps of the angle against one by slopes.
      CHECK(std::abs(found[0].overlap - depth) < 1e-9);
      CHECK(std::abs(found[0].normal.y) < 1e-12);
      CHECK(potential_error(
                there, [&](const auto& b) { return at(ridge, b); }, 1e-7) < 2e-5);
      CHECK(at(ridge, moved(there, 1.01 * depth * found[0].normal, {})).empty());
      ++on_ridge;

      // A tip: depth against any direction near.
      const auto over = moved(any, {0, 0, support_height(any, {0, 0, -1}) - 0.01}, {});
      const auto points = at(tip, over);
      for (const auto& c : points) {
        CHECK(c.overlap == near(support_height(over, -c.normal)).epsilon(1e-6));
        for (int d = 0; d < 20; ++d)
          CHECK(support_height(over, -normalised(c.normal + 1e-3 * r.direction())) >
                c.overlap - 1e-9);
        ++on_tip;
      }
      if (!points.empty())
        CHECK(potential_error(
                  over, [&](const auto& b) { return at(tip, b); }, 1e-7) < 2e-5);
      if (support_height(over, {0, 0, -1}) > 0 && points.empty())
        CHECK(support_height(over, normalised(-detail::centre_of(over))) > -1);
    });
  CHECK(on_ridge == 150);
  CHECK(on_tip > 10);
}

TEST_CASE("solid meshes: a needle across a ridge is carried where it lies, at both ridges of two") {
  const auto needle = place(SuperEllipsoid{1, 0.05, 0.05}, {0.3, 0.2, 0.045}, {});
  const auto found = at(ridge_mesh(1), needle);
  REQUIRE(found.size() == 1);
  // The ellipse x^2 + (z/0.05)^2 = 1 about (0.3, 0.045): its least depth at the origin.
  double least = 1;
  for (int k = -100000; k <= 100000; ++k) {
    const double a = k * 1e-5, c = std::cos(a), s = std::sin(a);
    least = std::min(least, std::hypot(s, 0.05 * c) - 0.3 * s - 0.045 * c);
  }
  CHECK(std::abs(found[0].overlap - least) < 1e-9);
  CHECK(std::abs(found[0].point.y - 0.2) < 1e-12);

  Soup two;
  for (const double x : {-0.5, 0.5}) {
    add_quad(two, {x, -1, 0}, {x + 0.3, -1, -0.3}, {x + 0.3, 1, -0.3}, {x, 1, 0});
    add_quad(two, {x, 1, 0}, {x - 0.3, 1, -0.3}, {x - 0.3, -1, -0.3}, {x, -1, 0});
  }
  const TriangleMesh ridges(
      two);  // smooth_angle 30 degrees: equal normals, but far from each other
  const auto round_bar =
      Polyhedron::from_points(shape_test::box_corners({-.9, -.05, -.05}, {.9, .05, .05}), 0.05);
  for (const double tilt : {0., 1e-4}) {
    const auto on = at(ridges, place(round_bar, {0, 0, 0.099}, rotation_about({0, 1, 0}, tilt)));
    REQUIRE(on.size() == 2);
    for (const auto& c : on) {
      CHECK(std::abs(std::abs(c.point.x) - 0.5) < 1e-4);
      CHECK(std::abs(c.point.y) < 0.1);
      CHECK(std::abs(c.overlap - 0.001) < 1.01 * 0.5 * tilt + 1e-8);
      if (tilt == 0) CHECK(std::abs(c.point.y) < 1e-12);  // the middle of the line
    }
  }
}

TEST_CASE("solid meshes: a rounded die over the edge of a step") {
  const TriangleMesh step = step_mesh();
  const auto rounded =
      Polyhedron::from_points(shape_test::box_corners({-.15, -.15, -.15}, {.15, .15, .15}), 0.05);
  const auto super = SuperEllipsoid{0.2, 0.2, 0.2, 20, 20};
  // A rounded die has two corners on the step, and lies on the edge.
  const auto round = at(step, place(rounded, {0.05, 0, 0.199}, {}));
  REQUIRE(round.size() == 3);
  for (const auto& c : round) CHECK(c.overlap == near(0.001).epsilon(1e-9));
  // Tilted by 20 degrees over the edge.
  for (const double tilt : {-0.35, 0.35}) {
    const auto q = rotation_about({0, 1, 0}, tilt);
    const Vec3d up = rotate(q, Vec3d{0, 0, 1});
    const auto check = [&](const auto& body, double tolerance) {
      const auto found = at(step, body);
      REQUIRE(found.size() == 1);
      CHECK(std::abs(found[0].overlap - 0.001) < tolerance);
      CHECK(norm(found[0].point) < 0.01);
      CHECK(dot(found[0].normal, up) > 1 - 1e-4);
    };
    if (tilt < 0) {
      check(place(rounded, 0.199 * up, q), 1e-12);
      check(place(super, 0.199 * up, q), 1e-4);
    }
  }
}

TEST_CASE("solid meshes: a cube in the corner of a box touches three faces") {
  Soup soup;
  add_quad(soup, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0});
  add_quad(soup, {0, 0, 0}, {0, 2, 0}, {0, 2, 2}, {0, 0, 2});
  add_quad(soup, {0, 0, 0}, {0, 0, 2}, {2, 0, 2}, {2, 0, 0});
  const TriangleMesh box(soup);
  const auto rounded =
      Polyhedron::from_points(shape_test::box_corners({-.4, -.4, -.4}, {.4, .4, .4}), 0.1);
  CHECK(at(box, place(SuperEllipsoid{.5, .5, .5, 20, 20}, {0.499, 0.498, 0.497}, {})).size() == 3);
  const auto corners = at(box, place(rounded, {0.499, 0.498, 0.497}, {}));
  CHECK(corners.size() == 12);
}

TEST_CASE(
    "solid meshes: a die in a drum of facets touches it with two edges, as in the round one") {
  Soup soup;
  constexpr int n = 60;
  for (int k = 0; k < n; ++k) {
    const auto at_angle = [&](int i, double z) {
      const double a = 2 * pi * i / n;
      return Vec3d{2 * std::cos(a), 2 * std::sin(a), z};
    };
    add_quad(soup, at_angle(k, -1), at_angle(k + 1, -1), at_angle(k + 1, 1), at_angle(k, 1));
  }
  const TriangleMesh drum(soup);
  for (const double angle : {0., 0.02, 0.05, 0.08}) {
    const auto q = rotation_about({0, 0, 1}, angle);
    const auto body =
        place(SuperEllipsoid{0.4, 0.4, 0.4, 20, 20}, rotate(q, Vec3d{0, -1.57, 0}), q);
    const auto found = at(drum, body);
    REQUIRE(found.size() == 2);
    for (const auto& c : found) {
      CHECK(std::abs(norm(Vec3d{c.point.x, c.point.y, 0}) - 2) < 0.02);
      CHECK(std::abs(rotate(conjugate(q), c.point).x) > 0.3);
    }
  }
}

TEST_CASE(
    "solid meshes: what has just touched rough ground, by distances to triangles, has a contact") {
  Draws r(7);
  double least = 1;
  for (int m = 0; m < 6; ++m) {
    // Steep and nearly flat grounds; those of a smooth angle of 0 and of 30 degrees.
    const double rough = m % 3 == 0 ? 0.5 : m % 3 == 1 ? 0.1 : 1e-3;
    const TriangleMesh mesh(floor_of(r, 10, 2, [&](double, double) { return r.uniform(0, rough); }),
                            m < 3 ? 0 : pi / 6);
    std::vector<TriangleSet> sets;
    for (const auto& t : mesh.triangles())
      sets.push_back({{mesh.vertices()[t[0]], mesh.vertices()[t[1]], mesh.vertices()[t[2]]}});
    for (int k = 0; k < 7; ++k)
      for_bodies(r, [&](const auto& any, const std::string& name) {
        INFO(name, " ", m, " ", k);
        const auto body = moved(any, {r.uniform(-1, 1), r.uniform(-1, 1), 0}, {});
        double radius = 0;
        if constexpr (requires { body.shape->radius(); }) radius = body.shape->radius();
        const auto touches = [&](double z) {
          const auto there = moved(body, {0, 0, z}, {});
          for (const auto& set : sets) {
            const auto gap = gjk_distance(there, set, {0, 0, 1}, radius);
            if (gap.overlapping || (!gap.beyond_reach && gap.distance < radius)) return true;
          }
          return false;
        };
        double low = 0, high = 2;
        for (int i = 0; i < 40; ++i) {
          const double mid = 0.5 * (low + high);
          (touches(mid) ? low : high) = mid;
        }
        const double down = 1e-4;
        CHECK(at(mesh, moved(body, {0, 0, high + 1e-6}, {})).empty());
        const auto found = at(mesh, moved(body, {0, 0, high - down}, {}));
        REQUIRE(found.size() > 0);
        const double part = found[0].overlap / (down * found[0].normal.z);
        INFO(part, " ", found.size());
        CHECK(part < 1.001);
        CHECK(part > 0.4);
        least = std::min(least, part);
      });
  }
  CHECK(least < 1);
}

}  // namespace solid_mesh_contacts_test
