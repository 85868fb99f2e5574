// silt - BSD-3-Clause, see LICENSE

#include "two_polyhedra.hpp"

#include <silt/shape/narrow/thickness_overlap.hpp>

namespace volume_overlap_test {

using namespace shape_test;
using silt::OverlapMemory;
using silt::rotation_about;
using silt::thickness_contact;
using silt::thickness_overlap;
using silt::volume_contact;
using silt::volume_overlap;
using silt::VolumeScale;

namespace {

bool inside(const PlacedPolyhedron& body, const Vec3d& p) {
  const Vec3d x = body.pose.to_body(p);
  for (const auto& face : body.shape->faces())
    if (dot(face.normal, x) > face.offset) return false;
  return true;
}

PlacedPolyhedron turned_about(PlacedPolyhedron body, const Vec3d& at, const Vec3d& axis,
                              double angle) {
  const auto r = rotation_matrix(rotation_about(axis, angle));
  body.pose.position = at + r * (body.pose.position - at);
  auto& t = body.pose.turn;
  t = {r * t.x, r * t.y, r * t.z};
  return body;
}

/// One body cut by all planes of the other, whichever way volume_overlap would choose.
silt::VolumeOverlap cut_by(const PlacedPolyhedron& cutting, const PlacedPolyhedron& body) {
  auto& cutter = silt::detail::Cutter::empty();
  silt::detail::place_planes(cutting, body, cutter);
  auto& left = silt::detail::ClippedBody::whole(*body.shape);
  if (!silt::detail::cut_by_all(left, cutter, 0)) return {};
  return finish(silt::detail::CutIntegrator(left.graph(), *body.shape, cutter).result(), body.pose,
                1);
}

const Vec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

}  // namespace

TEST_CASE("volume_overlap: 2e4 boxes in multiples of 1/8, coplanar faces and all: exact") {
  Random random(1);
  const auto eighths = [&](int low, int high) {
    return std::floor(random.uniform(low, high + 1)) / 8;
  };
  double worst = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3d ea{eighths(1, 8), eighths(1, 8), eighths(1, 8)};
    const Vec3d eb{eighths(1, 8), eighths(1, 8), eighths(1, 8)};
    const Vec3d at{eighths(-8, 8), eighths(-8, 8), eighths(-8, 8)};
    const auto side = [](double p, double a, double b) {
      return std::max(std::min(p + a / 2, b / 2) - std::max(p - a / 2, -b / 2), 0.0);
    };
    const double volume = side(at.x, ea.x, eb.x) * side(at.y, ea.y, eb.y) * side(at.z, ea.z, eb.z);
    const auto a = box(ea), b = box(eb);
    const PlacedPolyhedron i{&a, {at, Quaternion{}}}, j{&b, {{0, 0, 0}, Quaternion{}}};
    worst = std::max(worst, std::abs(volume_overlap(i, j, random.direction()).volume - volume));
  }
  CHECK(worst <= 1e-15);
}

TEST_CASE("volume_overlap: random points count the same volume, to their scatter") {
  Random random(2);
  double chi_square = 0;
  for (int k = 0; k < 30; ++k) {
    const auto a = random.hull(12 + k % 8), b = random.hull(16);
    const PlacedPolyhedron i{&a, {random.in_cube(0.25), random.turn()}};
    const PlacedPolyhedron j{&b, {{0, 0, 0}, random.turn()}};
    const int n = 40000;
    int hits = 0;
    for (int p = 0; p < n; ++p) {
      const Vec3d at = random.in_cube(0.5);
      hits += inside(i, at) && inside(j, at);
    }
    const double v = volume_overlap(i, j, {1, 0, 0}).volume;
    REQUIRE(v > 0);
    chi_square += (hits - n * v) * (hits - n * v) / (n * v * (1 - v));
  }
  CHECK(chi_square < 70);  // 30 degrees of freedom: by chance once in 20 000
  CHECK(chi_square > 8);
}

TEST_CASE("volume_overlap: S and G are the derivatives of V; i and j press each other alike") {
  Random random(3);
  double worst = 0, unequal = 0;
  int touching = 0;
  for (int k = 0; k < 3000; ++k) {
    const auto a = random.hull(4 + k % 17), b = k % 3 == 0 ? box({0.6, 0.5, 0.7}) : random.hull(12);
    const PlacedPolyhedron i{&a, {random.in_cube(0.5), random.turn()}};
    const PlacedPolyhedron j{&b, {{0, 0, 0}, random.turn()}};
    const auto found = volume_overlap(i, j, i.pose.position);
    if (!(found.volume > 0)) continue;
    ++touching;
    const auto reverse = volume_overlap(j, i, -i.pose.position);
    unequal = std::max(
        {unequal, std::abs(found.volume - reverse.volume), norm(found.area + reverse.area)});
    const double h = 1e-6;
    for (const auto& e : axes) {
      auto plus = i, minus = i;
      plus.pose.position += h * e, minus.pose.position -= h * e;
      const auto v = [&](const PlacedPolyhedron& p) {
        return volume_overlap(p, j, {1, 0, 0}).volume;
      };
      worst = std::max(worst, std::abs((v(plus) - v(minus)) / (2 * h) - dot(found.area, e)));
      const double turned =
          (v(turned_about(i, found.point, e, h)) - v(turned_about(i, found.point, e, -h))) /
          (2 * h);
      worst = std::max(worst, std::abs(turned - found.couple * dot(found.area, e)));
    }
  }
  CHECK(touching > 1500);
  CHECK(unequal <= 1e-14);
  // Rounding 1e-16/h, and the change of S within h where features of the size of h appear: 10 h.
  CHECK(worst <= 1e-5);
}

TEST_CASE("volume_overlap: whichever body is cut, also where faces nearly are in one plane") {
  Random random(4);
  double worst = 0;
  int touching = 0;
  for (int k = 0; k < 30000; ++k) {
    const auto a = k % 2 == 0 ? box({1, 0.6, 0.8}) : box({1, 1, 1});
    const auto b = box({1, 1, 1});
    const double tilt = std::pow(10.0, -random.uniform(1, 18));
    const PlacedPolyhedron i{&a, {{random.uniform() < 0.5 ? 0.0 : 0.25, 0, 0.8}, Quaternion{}}};
    PlacedPolyhedron j{&b, {tilt * random.in_cube(1), rotation_about(random.direction(), tilt)}};
    const auto one = cut_by(i, j), other = cut_by(j, i);
    touching += one.volume > 0;
    worst = std::max(worst, std::abs(one.volume - other.volume));
    REQUIRE(std::isfinite(one.point.x + one.couple));
  }
  CHECK(touching == 30000);
  CHECK(worst <= 1e-14);
}

TEST_CASE("volume_overlap: a half-space, and the same wall in triangles") {
  Random random(5);
  for (int k = 0; k < 500; ++k) {
    const auto a = random.hull(14);
    const PlacedPolyhedron body{&a, {{0.1, 0.2, random.uniform(-0.3, 0.45)}, random.turn()}};
    const Vec3d up{0, 0, 1};
    const auto found = volume_overlap(body, Vec3d{0, 0, 0}, up);
    const auto slab = Polyhedron::from_points(box_corners({-2, -2, -2}, {2, 2, 0}));
    const auto expected = volume_overlap(body, {&slab, {}}, up);
    CHECK(agree(found.volume, expected.volume, 1e-13));
    CHECK(norm(found.area - expected.area) <= 1e-14);
    CHECK(norm(found.point - expected.point) <= 1e-11);
    if (found.volume > 0 && found.volume < 0.999 * a.core_volume()) CHECK(found.area.z < 0);
    // Four triangles around a point of the plane somewhere below the body.
    const Vec3d corner[5] = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, {0.13, 0.17, 0}};
    double volume = 0;
    Vec3d area{0, 0, 0};
    for (std::size_t t = 0; t < 4; ++t) {
      const auto part = volume_overlap(body, std::array{corner[t], corner[(t + 1) % 4], corner[4]});
      volume += part.volume, area += part.area;
    }
    CHECK(agree(volume, found.volume, 1e-13));
    CHECK(norm(area - found.area) <= 1e-14);
  }
}

TEST_CASE("volume_contact: memory changes the speed alone; near misses and buried bodies") {
  Random random(6);
  const VolumeScale scale{1};
  for (int k = 0; k < 300; ++k) {
    const auto a = random.hull(14), b = random.hull(18);
    PlacedPolyhedron i{&a, {0.9 * random.direction(), random.turn()}};
    const PlacedPolyhedron j{&b, {{0, 0, 0}, random.turn()}};
    const Vec3d step = -0.02 * normalised(i.pose.position) + 0.004 * random.direction();
    const Vec3d spin = random.direction();
    OverlapMemory memory;
    for (int n = 0; n < 60; ++n) {  // in, and out on the other side
      i.pose.position += step;
      i = turned_about(i, i.pose.position, spin, 0.02);
      OverlapMemory fresh;
      const auto found = volume_contact(i, j, scale, memory),
                 cold = volume_contact(i, j, scale, fresh);
      CHECK(std::abs(found.volume - cold.volume) <= 1e-12 * cold.volume + 1e-16);
      CHECK((found.volume > 1e-15) <= gjk_distance(i, j, Vec3d{0, 0, 0}).overlapping);
      CHECK(memory.touched() == (found.overlap > 0));
      if (found.volume > 1e-12) CHECK(norm(found.normal - cold.normal) <= 1e-6);
    }
  }
  const auto small = box({0.2, 0.2, 0.2}), large = box({1, 1, 1});
  OverlapMemory memory;
  const auto buried =
      volume_contact({&small, {{0.1, 0, 0}, Quaternion{}}}, {&large, {}}, scale, memory);
  CHECK(buried.buried);
  CHECK(buried.gradient == 0);
  CHECK(buried.overlap > 0);
  CHECK(norm(buried.normal - Vec3d{1, 0, 0}) <= 1e-15);
}

TEST_CASE("contact_of: overlap, its gradient and exponents of face, edge and corner") {
  const auto cube = box({1, 1, 1});
  const double r = std::sqrt(0.5), c = std::sqrt(0.75);
  const Quaternion face{}, edge = rotation_about({1, 0, 0}, pi / 4);
  const Quaternion corner =
      rotation_about({1, 0, 0}, std::asin(std::sqrt(1.0 / 3))) * rotation_about({0, 1, 0}, pi / 4);
  const auto at = [&](const Quaternion& q, double height, double depth) {
    const PlacedPolyhedron body{&cube, {{0, 0, height - depth}, q}};
    return contact_of(volume_overlap(body, Vec3d{0, 0, 0}, Vec3d{0, 0, 1}), {1}, {0, 0, 1});
  };
  // V = d, d^2 and (corner of a cube, 3 right angles) sqrt(3)/2 d^3; overlap = V^(2/3).
  CHECK(agree(at(face, 0.5, 0.01).overlap, std::pow(0.01, 2.0 / 3), 1e-12));
  CHECK(agree(at(face, 0.5, 0.01).gradient, 2.0 / 3 * std::pow(0.01, -1.0 / 3), 1e-12));
  CHECK(agree(at(edge, r, 0.01).volume, 1e-4, 1e-11));
  CHECK(agree(at(corner, c, 0.01).volume, std::sqrt(0.75) * 1e-6, 1e-9));
  CHECK(agree(at(corner, c, 0.01).gradient,
              2.0 / 3 * std::pow(std::sqrt(0.75) * 1e-6, -1.0 / 3) * 3 * std::sqrt(0.75) * 1e-4,
              1e-9));
  for (const auto& [q, height] : {std::pair{face, 0.5}, {edge, r}, {corner, c}}) {
    const double h = 1e-6;
    const double slope =
        (at(q, height, 0.01 + h).overlap - at(q, height, 0.01 - h).overlap) / (2 * h);
    CHECK(agree(at(q, height, 0.01).gradient, slope, 1e-7));
  }
}

TEST_CASE("thickness_overlap: a face's is its depth, an edge's and a corner's in proportion") {
  const auto cube = box({1, 1, 1});
  const Quaternion edge = rotation_about({1, 0, 0}, pi / 4);
  const Quaternion corner =
      rotation_about({1, 0, 0}, std::asin(std::sqrt(1.0 / 3))) * rotation_about({0, 1, 0}, pi / 4);
  for (const double d : {1e-2, 1e-4, 1e-6}) {
    const auto at = [&](const Quaternion& q, double height) {
      return thickness_overlap({&cube, {{0, 0, height - d}, q}}, {0, 0, 0}, {0, 0, 1});
    };
    // Exact: C of a box, of a triangular prism (height d, base 2 d), of a pyramid whose base is an
    // equilateral triangle of side sqrt(6) d: 3 d^2/80 across; per side (6 d^2/24) 3/5.
    CHECK(agree(at({}, 0.5).overlap, d / std::sqrt(1 + 2 * d * d), 1e-9));
    CHECK(agree(at(edge, std::sqrt(0.5)).overlap, d * std::sqrt(12 / (18 + 6 + 12 * d * d)), 1e-9));
    const double base = 6.0 / 24 * 3 / 5;
    CHECK(agree(at(corner, std::sqrt(0.75)).overlap, d * std::sqrt(12 / (80.0 / 3 + 2 / base)),
                1e-9));
    CHECK(agree(at({}, 0.5).gradient, 1, 4 * d * d));
  }
}

TEST_CASE(
    "thickness_overlap: force and point are its derivatives; i and j press each other alike") {
  Random random(13);
  double worst = 0, unequal = 0;
  for (int k = 0; k < 2000; ++k) {
    const auto a = random.hull(4 + k % 17), b = k % 3 == 0 ? box({0.6, 0.5, 0.7}) : random.hull(12);
    const PlacedPolyhedron i{&a, {random.in_cube(0.5), random.turn()}};
    const PlacedPolyhedron j{&b, {{0, 0, 0}, random.turn()}};
    const auto found = thickness_overlap(i, j, i.pose.position);
    if (!(found.volume > 1e-6) || found.buried) continue;
    const auto reverse = thickness_overlap(j, i, -i.pose.position);
    unequal = std::max({unequal, std::abs(found.overlap - reverse.overlap),
                        norm(found.gradient * found.normal + reverse.gradient * reverse.normal)});
    const double h = 1e-6;
    for (const auto& e : axes) {
      const auto delta = [&](const PlacedPolyhedron& p) {
        return thickness_overlap(p, j, {1, 0, 0}).overlap;
      };
      auto plus = i, minus = i;
      plus.pose.position += h * e, minus.pose.position -= h * e;
      const double along = found.gradient * dot(found.normal, e);
      worst = std::max(worst, std::abs((delta(plus) - delta(minus)) / (2 * h) + along));
      const double turned =
          (delta(turned_about(i, found.point, e, h)) - delta(turned_about(i, found.point, e, -h))) /
          (2 * h);
      worst = std::max(worst, std::abs(turned + found.couple * along));
    }
  }
  CHECK(unequal <= 1e-12);
  CHECK(worst <= 1e-4);  // as for the volume, over intersections of 1e-6^(1/3) = 1e-2 in size
}

TEST_CASE("volume law: the couple and the point matter: without them energy is not conserved") {
  // A control of the test above: the same collisions with the wrench put at the middle of the
  // bodies.
  Random random(9);
  Body a(random.hull(12));
  double with = 0, without = 0;
  for (int k = 0; k < 200; ++k) {
    const auto b = random.hull(14);
    const PlacedPolyhedron i{&a.shape, {random.in_cube(0.4), random.turn()}};
    const PlacedPolyhedron j{&b, {{0, 0, 0}, random.turn()}};
    const auto o = volume_overlap(i, j, i.pose.position);
    if (!(o.volume > 1e-6)) continue;
    const Vec3d axis = random.direction();
    const double h = 1e-6;
    const double dv =
        (volume_overlap(turned_about(i, i.pose.position, axis, h), j, {1, 0, 0}).volume -
         volume_overlap(turned_about(i, i.pose.position, axis, -h), j, {1, 0, 0}).volume) /
        (2 * h);
    const Vec3d moment = cross(o.point - i.pose.position, o.area);
    with = std::max(with, std::abs(dv - dot(axis, moment + o.couple * o.area)));
    without = std::max(without, std::abs(dv - dot(axis, moment)));
  }
  CHECK(with <= 1e-6);
  CHECK(without >= 1e-3);
}

}  // namespace volume_overlap_test
