// silt - BSD-3-Clause, see LICENSE

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include <silt/core/random.hpp>
#include <silt/fluid/boundary_of.hpp>
#include <silt/fluid/flow_solver.hpp>

#include "near.hpp"

namespace boundary_of_test {

using silt::boundary_of;
using silt::Cylinder;
using silt::FlowBoundary;
using silt::FlowSolver;
using silt::Grid;
using silt::Plane;
using silt::Side;
using silt::Surfaces;
using silt::TriangleMesh;
using silt::Vec3d;

namespace {

constexpr double pi = std::numbers::pi;
using Soup = std::vector<std::array<Vec3d, 3>>;

/// A pipe along x, its mantle of `sides` facets, normals outwards.
Soup mantle(double from, double to, double radius, int sides) {
  Soup soup;
  for (int k = 0; k < sides; ++k) {
    const auto at = [&](double x, int c) {
      const double angle = 2 * pi * (c % sides) / sides;
      return Vec3d{x, radius * std::cos(angle), radius * std::sin(angle)};
    };
    soup.push_back({at(from, k), at(to, k + 1), at(to, k)});
    soup.push_back({at(from, k), at(from, k + 1), at(to, k + 1)});
  }
  return soup;
}
/// A box with its six faces, normals outwards.
Soup block(const Vec3d& a, const Vec3d& b) {
  Soup soup;
  for (int d = 0; d < 3; ++d)
    for (int end = 0; end < 2; ++end) {
      const auto corner = [&](int u, int v) {
        const double low[3] = {a.x, a.y, a.z}, high[3] = {b.x, b.y, b.z};
        double x[3];
        x[d] = end ? high[d] : low[d];
        x[(d + 1) % 3] = u ? high[(d + 1) % 3] : low[(d + 1) % 3];
        x[(d + 2) % 3] = v ? high[(d + 2) % 3] : low[(d + 2) % 3];
        return Vec3d{x[0], x[1], x[2]};
      };
      const int u = end, v = 1 - end;  // which way round
      soup.push_back({corner(0, 0), corner(u, v), corner(1, 1)});
      soup.push_back({corner(0, 0), corner(1, 1), corner(v, u)});
    }
  return soup;
}
/// Signed distance to a box: negative inside.
double to_block(const Vec3d& x, const Vec3d& a, const Vec3d& b) {
  const Vec3d c = 0.5 * (a + b), e = 0.5 * (b - a);
  const double q[3] = {std::abs(x.x - c.x) - e.x, std::abs(x.y - c.y) - e.y,
                       std::abs(x.z - c.z) - e.z};
  const double most = std::max({q[0], q[1], q[2]});
  return most < 0 ? most
                  : std::hypot(std::max(q[0], 0.0), std::max(q[1], 0.0), std::max(q[2], 0.0));
}

}  // namespace

TEST_CASE("boundary_of: signed distances are those of closed forms") {
  silt::Random random(3);
  const auto somewhere = [&] {
    return Vec3d{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
  };
  const Vec3d a{-0.5, -0.6, -0.7}, b{0.8, 0.9, 1.0};
  const FlowBoundary plane = boundary_of(Plane{{0, 0, 0.3}, {0, 0, 2}}),
                     pipe = boundary_of(Cylinder{{-3, 0, 0}, {3, 0, 0}, 1.1, Side::Inside}),
                     shaft = boundary_of(Cylinder{{-3, 0, 0}, {3, 0, 0}, 0.4, Side::Outside}),
                     cone = boundary_of(silt::Cone{{-3, 0, 0}, {3, 0, 0}, 1, 4, Side::Inside}),
                     room = boundary_of(silt::box(a, b)),
                     vessel = boundary_of(TriangleMesh(block(a, b))),
                     obstacle = boundary_of({{TriangleMesh(block(a, b)), {}, Side::Outside}}),
                     drum = boundary_of({{Cylinder{{-3, 0, 0}, {3, 0, 0}, 1.1, Side::Inside}},
                                         {Cylinder{{-3, 0, 0}, {3, 0, 0}, 0.4, Side::Outside}}});
  for (int n = 0; n < 300; ++n) {
    const Vec3d x = somewhere();
    const double r = std::hypot(x.y, x.z);
    CHECK(plane.distance(x) == doctest::Approx(x.z - 0.3));
    CHECK(pipe.distance(x) == doctest::Approx(1.1 - r));
    CHECK(shaft.distance(x) == doctest::Approx(r - 0.4));
    CHECK(drum.distance(x) == doctest::Approx(std::min(1.1 - r, r - 0.4)));
    CHECK(cone.distance(x) == doctest::Approx((1 + 0.5 * (x.x + 3) - r) / std::sqrt(1.25)));
    const double outside = to_block(x, a, b);
    CHECK(vessel.distance(x) == doctest::Approx(-outside));
    CHECK(obstacle.distance(x) == doctest::Approx(outside));
    // Planes are infinite: beyond several of them the farthest counts.
    if (outside < 0) CHECK(room.distance(x) == doctest::Approx(-outside));
    CHECK((room.distance(x) < 0) == (outside > 0));
  }
  CHECK_FALSE(static_cast<bool>(drum.velocity));
}

TEST_CASE("boundary_of: an open pipe of triangles, inside and outside") {
  silt::Random random(4);
  const int sides = 12;
  const Soup soup = mantle(-3, 3, 1, sides);
  Soup reversed = soup;
  for (auto& t : reversed) std::swap(t[1], t[2]);
  const FlowBoundary inside = boundary_of(TriangleMesh(soup)),
                     outside = boundary_of({{TriangleMesh(reversed), {}, Side::Inside}}),
                     shaft = boundary_of({{TriangleMesh(soup), {}, Side::Outside}});
  for (int n = 0; n < 300; ++n) {
    const Vec3d x{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
    // To a regular polygon: of the facet in whose sector the place is, or of its corners.
    const double step = 2 * pi / sides, r = std::hypot(x.y, x.z);
    const double off = std::remainder(std::atan2(x.z, x.y) - 0.5 * step, step);
    const double out = r * std::cos(off) - std::cos(0.5 * step), half = std::sin(0.5 * step),
                 beside = std::max(0.0, r * std::abs(std::sin(off)) - half);
    const double expected = out < 0 ? out : std::hypot(out, beside);
    CHECK(inside.distance(x) == doctest::Approx(-expected));
    CHECK(shaft.distance(x) == doctest::Approx(expected));
    CHECK(outside.distance(x) == doctest::Approx(expected));
  }
  // In the plane of an end there are still two sides, beyond it none.
  CHECK(inside.distance({3, 0.5, 0}) > 0);
  CHECK_THROWS_WITH_AS(inside.distance({3.1, 0.5, 0}),
                       doctest::Contains("three cells beyond the flow's box"), silt::InputError);
}

TEST_CASE("boundary_of: the velocity is that of the nearest wall's motion") {
  const auto turn = silt::rotation({0, 0, 0}, {1, 0, 0}, 2.5);
  const FlowBoundary drum = boundary_of(
      {{Cylinder{{-3, 0, 0}, {3, 0, 0}, 1, Side::Inside}, turn}, {Plane{{-1, 0, 0}, {1, 0, 0}}}},
      0.7);
  // Away from the plane, on the drum: omega x r.
  const Vec3d v = drum.velocity({0.5, 0, 0.9});
  CHECK(v.x == doctest::Approx(0));
  CHECK(v.y == doctest::Approx(-2.5 * 0.9));
  CHECK(v.z == doctest::Approx(0));
  CHECK(norm(drum.velocity({-0.99, 0, 0.9})) == 0);
  // A wall that comes elsewhere: as it is at that time.
  const auto rise = silt::translation({0, 0, 2});
  const FlowBoundary lid = boundary_of(Plane{{0, 0, 1}, {0, 0, -1}}, rise, 0.25);
  CHECK(lid.distance({0, 0, 0}) == doctest::Approx(1.5));
  CHECK(lid.velocity({0, 0, 1}).z == doctest::Approx(2));
}

TEST_CASE("boundary_of: what it refuses") {
  CHECK_THROWS_WITH_AS(boundary_of(std::vector<silt::FlowWall>{}), doctest::Contains("no walls"),
                       silt::InputError);
  CHECK_THROWS_WITH_AS(boundary_of(Cylinder{{0, 0, 0}, {1, 0, 0}, -1, Side::Inside}),
                       doctest::Contains("Cylinder.radius"), silt::InputError);
  Soup soup = mantle(0, 1, 1, 8);
  std::swap(soup[3][0], soup[3][1]);
  CHECK_THROWS_WITH_AS(boundary_of(TriangleMesh(soup)), doctest::Contains("opposite orientations"),
                       silt::InputError);
  // A flow whose box is longer than the pipe.
  FlowSolver flow(Grid({{0, -1, -1}, {2, 1, 1}}, {8, 8, 8}), {1.0, 0.1});
  CHECK_THROWS_WITH_AS(flow.set_boundary(boundary_of(TriangleMesh(mantle(0, 1, 0.8, 8)))),
                       doctest::Contains("the mesh is open"), silt::InputError);
}

TEST_CASE("boundary_of: Poiseuille flow in a pipe, as a cylinder and as a mesh") {
  const int n = 12, sides = 64;
  const double R = 0.5, G = 2, mu = 0.1, h = 1.2 / n;
  const Grid g({{0, -0.6, -0.6}, {2 * h, 0.6, 0.6}}, {2, n, n}, {true, false, false});
  const auto rate = [&](const FlowBoundary& boundary) {
    FlowSolver flow(g, {1.0, mu});
    flow.set_boundary(boundary);
    flow.force(0).fill(G);
    // From rest the flow rate is within exp(-5.78 nu t / R^2) = 1e-4 of its end.
    const double dt = flow.stable_step(), end = 1.6 * R * R / mu;
    for (double t = 0; t < end; t += dt) flow.step(dt);
    return flow.flow_rate(0, 0);
  };
  const double exact = pi * std::pow(R, 4) * G / (8 * mu);
  const double pipe = rate(boundary_of(Cylinder{{-1, 0, 0}, {1, 0, 0}, R, Side::Inside}));
  // 10 cells a diameter, axis on a corner of cells: 1.12 % too much, second order.
  CHECK(pipe == near(exact).epsilon(0.012));
  // Of the same cross-section as the circle, the polygon lets as much through to (pi/sides)^4.
  const double angle = 2 * pi / sides, same = R * std::sqrt(angle / std::sin(angle));
  const double mesh = rate(boundary_of(TriangleMesh(mantle(-3 * h, 5 * h, same, sides))));
  CHECK(mesh == near(pipe).epsilon(2e-3));
}

}  // namespace boundary_of_test
