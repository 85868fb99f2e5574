// silt - BSD-3-Clause, see LICENSE
#include "near.hpp"
#include "solid_bodies.hpp"

namespace solid_walls_test {

using namespace solid_test;

namespace {

Touches at(const Plane& wall, const auto& body) {
  return all([&](SolidContact* out, int n) { return plane_contacts(body, wall, out, n); });
}
Touches at(const Cylinder& wall, const auto& body) {
  return all([&](SolidContact* out, int n) { return cylinder_contacts(body, wall, out, n); });
}
Touches at(const Cone& wall, const auto& body) {
  return all([&](SolidContact* out, int n) { return cone_contacts(body, wall, out, n); });
}

/// [m] how far a point is from the free side of a wall, > 0: beyond the surface.
template <class Wall>
double beyond(const Wall& wall, const Vec3d& p) {
  SurfacePoint s{};
  return wall.contacts(p, 1e9, &s) == 1 ? -s.distance : -1e9;
}

/// The point of a body that is farthest beyond a wall: many support points, then smaller and
/// smaller steps of the normal from the best of them.
template <class Wall, class Body>
double deepest_place(const Wall& wall, const Body& body) {
  constexpr int n = 1000;
  Vec3d best{0, 0, 1};
  double most_beyond = -1e300;
  const auto look = [&](const Vec3d& m) {
    const double d = beyond(wall, body.support(m));
    if (d <= most_beyond) return false;
    most_beyond = d, best = m;
    return true;
  };
  for (int k = 0; k < n; ++k) {
    const double z = 1 - (2 * k + 1.0) / n, r = std::sqrt(1 - z * z), phi = 2.399963229728653 * k;
    look({r * std::cos(phi), r * std::sin(phi), z});
  }
  for (double step = 0.05; step > 1e-8;) {
    Vec3d s, t;
    const Vec3d m = best;
    tangents(m, s, t);
    bool better = false;
    for (int k = 0; k < 8; ++k)
      better |= look(
          normalised(m + (step * std::cos(k * pi / 4)) * s + (step * std::sin(k * pi / 4)) * t));
    if (!better) step *= 0.5;
  }
  return most_beyond;
}

/// Poses a body so that it overlaps by about `depth` with a wall, from the free side.
template <class Wall, class Body>
Body pressed(const Wall& wall, Body body, const Vec3d& out, double depth) {
  double low = 0, high = 0;
  while (deepest_place(wall, moved(body, high * out, {})) < 0) low = high, high += 0.1;
  for (int k = 0; k < 10; ++k) {
    const double mid = 0.5 * (low + high);
    (deepest_place(wall, moved(body, mid * out, {})) < depth ? low : high) = mid;
  }
  return moved(body, high * out, {});
}

const Cylinder drum{{0, 0, -3}, {0, 0, 3}, 2, Side::Inside};
const Cylinder shaft{{0, 0, -3}, {0, 0, 3}, 0.7, Side::Outside};
const Cone funnel{{0, 0, -3}, {0, 0, 3}, 1, 3, Side::Inside};
const Cone spike{{0, 0, -3}, {0, 0, 3}, 0.3, 1.2, Side::Outside};

SuperEllipsoid random_shape(Draws& r, double s) {
  return {r.uniform(0.2, 0.5), r.uniform(0.2, 0.5), r.uniform(0.2, 0.5), s, s};
}

/// Calls action(body, name) with bodies of all kinds around the origin.
template <class Action>
void for_bodies(Draws& r, Action&& action) {
  for (const double s : {2., 4., 8., 20.})
    action(place(random_shape(r, s), {0, 0, 0}, r.turn()), "s = " + std::to_string(s));
  const PolySuperEllipsoid lopsided{{0.3, 0.5, 0.2}, {0.4, 0.2, 0.3}, 5, 3};
  action(Poly{form_of(lopsided), body_axes(r.turn()), {0, 0, 0}}, std::string("octants"));
  const Polyhedron die = shape_test::box({0.6, 0.5, 0.4}), stone = r.hull(30);
  const auto round =
      Polyhedron::from_points(shape_test::box_corners({-.3, -.2, -.2}, {.3, .2, .2}), 0.05);
  action(place(die, {0, 0, 0}, r.turn()), std::string("die"));
  action(place(stone, {0, 0, 0}, r.turn()), std::string("hull"));
  action(place(round, {0, 0, 0}, r.turn()), std::string("rounded die"));
}
double grown(const Super&) { return 0; }
double grown(const Poly&) { return 0; }
double grown(const PlacedPolyhedron& b) { return b.shape->radius(); }

}  // namespace

TEST_CASE("solid walls: the deepest contact inside of drum and funnel is the deepest place found") {
  Draws r(1);
  for (int k = 0; k < 6; ++k)
    for_bodies(r, [&](const auto& body, const std::string& name) {
      INFO(name);
      const double phi = r.uniform(0, 2 * pi);
      const Vec3d out{std::cos(phi), std::sin(phi), 0};
      const auto check = [&](const auto& wall) {
        const auto there = pressed(wall, body, out, 0.02);
        const double exact = deepest_place(wall, there) + grown(there);
        const auto found = at(wall, there);
        REQUIRE(found.size() > 0);
        // The search by steps ends 1e-8 rad from the normal: second order in D, times 6000 radii.
        CHECK(std::abs(found[0].overlap - exact) < 1e-9);
        for (const auto& c : found) {
          CHECK(beyond(wall, c.point) == near(0.5 * c.overlap).epsilon(1e-9));
          CHECK(std::abs(norm(c.normal) - 1) < 1e-14);
        }
      };
      check(drum), check(funnel);
    });
}

TEST_CASE("solid walls: all local maxima inside a drum, against a dense scan of the angle") {
  Draws r(2);
  int several = 0;
  for (const double s : {2., 3., 8., 20.})
    for (int k = 0; k < 100; ++k) {
      const SuperEllipsoid shape = random_shape(r, s);
      // From loose to tight drums, faces turned to the wall in half of the cases.
      const double R = shape.bounding_radius() * r.uniform(1.02, 8), tilt = k % 2 ? 3 : 0.02;
      const Cylinder wall{{0, 0, -9}, {0, 0, 9}, R, Side::Inside};
      auto body = place(shape, {0, 0, 0}, rotation_about(r.direction(), r.uniform(0, tilt)));
      const double phi_c = k % 3 ? 0 : r.uniform(0, 2 * pi);
      const Vec3d out{std::cos(phi_c), std::sin(phi_c), 0};
      body.position =
          (R -
           body.axes.to_space(support_of(body.form, body.axes.to_body(out))).x * (k % 3 ? 1 : 0) -
           (k % 3 ? 0 : shape.smallest_axis()) + r.uniform(0, 0.05)) *
          out;
      constexpr int n = 8000;
      std::vector<double> D(n);
      for (int i = 0; i < n; ++i) {
        const double phi = 2 * pi * i / n;
        const Vec3d N{std::cos(phi), std::sin(phi), 0};
        D[static_cast<std::size_t>(i)] = dot(N, body.support(N)) - R;
      }
      std::vector<double> exact;  // those that stand out over the lows beside by 1e-4
      const auto d = [&](int i) { return D[static_cast<std::size_t>((i + n) % n)]; };
      for (int i = 0; i < n; ++i)
        if (d(i) > 0 && d(i) > d(i - 1) && d(i) >= d(i + 1)) exact.push_back(d(i));
      std::sort(exact.rbegin(), exact.rend());
      const auto found = at(wall, body);
      REQUIRE(exact.size() > 0);
      REQUIRE(found.size() > 0);
      CHECK(found.size() <= exact.size());
      CHECK(found[0].overlap >= exact[0] - 1e-12);  // the scan is below the maximum
      CHECK(found[0].overlap <= exact[0] + 1e-5);
      INFO("s ", s, " case ", k, " found ", found.size(), " of ", exact.size(), " R ", R);
      CHECK(found.size() == exact.size());
      if (found.size() == exact.size())
        for (std::size_t i = 0; i < exact.size(); ++i)
          CHECK(std::abs(found[i].overlap - exact[i]) < 1e-5);
      several += exact.size() > 1;
    }
  CHECK(several > 60);
}

TEST_CASE("solid walls: outside of shaft and spike the deepest place of a body is found") {
  Draws r(3);
  for (int k = 0; k < 6; ++k)
    for_bodies(r, [&](const auto& body, const std::string& name) {
      INFO(name);
      const double phi = r.uniform(0, 2 * pi);
      const Vec3d out{std::cos(phi), std::sin(phi), 0};
      const auto check = [&](const auto& wall) {
        // The deepest place of the body in the wall, for little overlap, is the least over phi too.
        auto there = moved(body, 4 * out, {});
        const auto depth = [&](const auto& b) {
          double least = 1e300, at_phi = 0;
          const double taper = [&] {
            if constexpr (requires { wall.radius_to; })
              return (wall.radius_to - wall.radius_from) / 6;
            return 0.;
          }();
          const double nr = 1 / std::sqrt(1 + taper * taper), nz = -taper * nr;
          const double radius = [&] {
            if constexpr (requires { wall.radius_from; })
              return wall.radius_from;
            else
              return wall.radius;
          }();
          const auto G = [&](double angle) {
            const Vec3d N{nr * std::cos(angle), nr * std::sin(angle), nz};
            const Vec3d foot{radius * std::cos(angle), radius * std::sin(angle), -3};
            return dot(N, foot - b.support(-N)) + grown(b);
          };
          for (int i = 0; i < 2000; ++i)
            if (const double g = G(phi + pi * (i / 1000. - 1)); g < least)
              least = g, at_phi = phi + pi * (i / 1000. - 1);
          for (double step = 2e-3; step > 1e-13; step *= 0.5)
            for (const double to : {at_phi - step, at_phi + step})
              if (const double g = G(to); g < least) least = g, at_phi = to;
          return least;
        };
        double low = 0, high = 4;
        for (int i = 0; i < 30; ++i) {
          const double mid = 0.5 * (low + high);
          (depth(moved(body, mid * out, {})) < 0.01 ? high : low) = mid;
        }
        there = moved(body, low * out, {});
        const auto found = at(wall, there);
        REQUIRE(found.size() == 1);
        CHECK(std::abs(found[0].overlap - depth(there)) < 1e-11);
        CHECK(std::abs(beyond(wall, found[0].point) - 0.5 * found[0].overlap) < 1e-11);
        // The contact point lies in the body: half the overlap below its surface.
        CHECK(dot(found[0].point - there.support(-found[0].normal), found[0].normal) +
                  grown(there) ==
              near(0.5 * found[0].overlap).epsilon(1e-9));
        CHECK(at(wall, moved(there, 0.02 * out, {})).empty());
        // Differences over 1e-7: rounding 1e-9, second derivatives up to some 100/size.
        CHECK(potential_error(
                  there, [&](const auto& b) { return at(wall, b); }, 1e-7) < 1e-5);
      };
      check(shaft), check(spike);
    });
}

TEST_CASE("solid walls: force and torque are minus the derivative of the overlap") {
  Draws r(4);
  for (int k = 0; k < 5; ++k)
    for_bodies(r, [&](const auto& body, const std::string& name) {
      INFO(name);
      const double phi = r.uniform(0, 2 * pi);
      const Vec3d out{std::cos(phi), std::sin(phi), 0};
      // Differences over 1e-6: rounding 1e-10, and third derivatives up to (6000 radii/size)^2 of
      // faces that are turned to the wall, which random turns do not reach.
      const auto check = [&](const auto& wall, const auto& there) {
        const auto find = [&](const auto& b) { return at(wall, b); };
        REQUIRE(find(there).size() > 0);
        CHECK(potential_error(there, find, 1e-6) < 1e-6);
      };
      const Plane plane{{0.3, 0.1, 0.2}, normalised(Vec3d{0.3, -0.2, 1})};
      double low = -3, high = 0;
      for (int i = 0; i < 20; ++i) {
        const double mid = 0.5 * (low + high);
        const auto there = moved(body, plane.point - mid * plane.normal, {});
        (dot(there.support(-plane.normal) - plane.point, plane.normal) - grown(there) > -0.02
             ? low
             : high) = mid;
      }
      check(plane, moved(body, plane.point - high * plane.normal, {}));
      check(drum, pressed(drum, body, out, 0.02));
      check(funnel, pressed(funnel, body, out, 0.02));
    });
}

TEST_CASE("solid walls: a super-ellipsoid that is a sphere touches as a sphere does") {
  Draws r(5);
  int touching = 0;
  for (int k = 0; k < 2000; ++k) {
    const double R = r.uniform(0.1, 0.4);
    const auto ball = place(SuperEllipsoid{R, R, R}, r.in_cube(2.5), r.turn());
    const auto check = [&](const auto& wall) {
      SurfacePoint s{};
      const int n = wall.contacts(ball.position, R, &s);
      const auto found = at(wall, ball);
      const double height = ball.position.z;
      if (n == 1 && s.distance < -R) return;  // buried
      const Vec3d foot = n ? ball.position - s.distance * s.normal : Vec3d{0, 0, 0};
      if (std::abs(foot.z) > 2.9 || std::abs(height) > 2.4) return;
      REQUIRE(static_cast<int>(found.size()) == n);
      if (n == 0) return;
      ++touching;
      CHECK(std::abs(found[0].overlap - (R - s.distance)) < 1e-13);
      CHECK(norm(found[0].normal - s.normal) < 1e-9);
      CHECK(found[0].R_eff == near(R));
    };
    check(drum), check(funnel);
    if (std::hypot(ball.position.x, ball.position.y) > R + 1) check(shaft), check(spike);
    check(Plane{{0, 0, 0}, {0, 0, 1}});
  }
  CHECK(touching > 500);
}

TEST_CASE(
    "solid walls: a die on its face touches a drum with two edges, which keep their features") {
  const auto die = place(SuperEllipsoid{0.1, 0.1, 0.1, 20, 20}, {0, -1.9, 0.02}, {});
  for (const double R : {2., 20., 200.}) {
    const Cylinder wall{{0, 0, -3}, {0, 0, 3}, R, Side::Inside};
    auto body = die;
    body.position.y = -(std::sqrt(R * R - 0.01) - 0.0985);
    std::uint32_t features[2] = {0, 0};
    for (const double tilt : {0., 1e-5, -1e-5, 1e-3}) {
      const auto found = at(wall, moved(body, {0, 0, 0}, rotation_about({0, 0, 1}, tilt / R)));
      REQUIRE(found.size() == 2);
      CHECK(found[0].point.x * found[1].point.x < 0);
      CHECK(std::abs(found[0].point.x) > 0.05);  // the edges are round
      const int left = found[0].point.x < 0 ? 0 : 1;
      if (tilt == 0) features[0] = found[left].feature, features[1] = found[1 - left].feature;
      CHECK(found[left].feature == features[0]);
      CHECK(found[1 - left].feature == features[1]);
      CHECK(features[0] != features[1]);
    }
  }
  // And a polyhedron with four corners.
  const auto cube = shape_test::box({0.2, 0.2, 0.2});
  const auto found = at(drum, place(cube, {0, -1.9, 0}, {}));
  REQUIRE(found.size() == 4);
  for (const auto& c : found) CHECK(near_relative(c.overlap, std::hypot(0.1, 2.0) - 2, 1e-12));
}

TEST_CASE("solid walls: a flat face on a shaft touches in the middle of what lies on the shaft") {
  const auto bar = shape_test::box({0.2, 0.4, 1});
  const auto on = at(shaft, place(bar, {0.799, 0.1, 0.5}, {}));
  REQUIRE(on.size() == 1);
  CHECK(on[0].overlap == near(0.001).epsilon(1e-9));
  CHECK(norm(on[0].normal - Vec3d{1, 0, 0}) < 1e-9);
  CHECK(norm(on[0].point - Vec3d{0.6995, 0, 0.5}) < 1e-9);
  const auto over = at(shaft, place(bar, {0.799, 0.1, 2.9}, {}));
  REQUIRE(over.size() == 1);
  CHECK(norm(over[0].point - Vec3d{0.6995, 0, 2.7}) < 1e-9);
  CHECK(at(shaft, place(bar, {0.799, 0.1, 3.51}, {})).empty());
  CHECK(at(drum, place(bar, {1.91, 0.1, 3.51}, {})).empty());
}

TEST_CASE("solid walls: a rounded polyhedron on a plane touches with each corner near it") {
  const auto cube =
      Polyhedron::from_points(shape_test::box_corners({-.5, -.5, -.5}, {.5, .5, .5}), 0.1);
  const Plane floor{{0, 0, 0}, {0, 0, 1}};
  const auto body = place(cube, {3, 4, 0.59}, rotation_about({1, 0, 0}, 0.001));
  const auto found = at(floor, body);
  REQUIRE(found.size() == 4);
  for (const auto& c : found) {
    const double corner = cube.vertices()[c.feature].y;
    CHECK(near_relative(c.overlap, 0.01 - corner * std::sin(0.001) + 0.5 * (std::cos(0.001) - 1),
                        1e-10));
    CHECK(std::abs(c.point.z + 0.5 * c.overlap) < 1e-15);
  }
  SolidContact two[2];
  CHECK(plane_contacts(body, floor, two, 2) == 2);
  CHECK(two[0].overlap == found[0].overlap);
  CHECK(two[1].overlap >= found[2].overlap);
}

}  // namespace solid_walls_test
