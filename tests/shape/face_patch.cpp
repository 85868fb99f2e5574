// silt - BSD-3-Clause, see LICENSE
//
// Dilated polyhedra that touch by nearly parallel faces.
#include <silt/shape/narrow/solid_pairs.hpp>

#include "bodies.hpp"

namespace face_patch_test {

namespace {

using shape_test::Random;
using silt::NormalMemory;
using silt::PlacedPolyhedron;
using silt::Polyhedron;
using silt::Quaternion;
using silt::RigidPose;
using silt::rotation_about;
using silt::SolidContact;
using silt::Vec3d;

Polyhedron block(double a, double b, double c, double dilation) {
  std::vector<Vec3d> corners;
  for (int k = 0; k < 8; ++k) corners.push_back({k & 1 ? a : -a, k & 2 ? b : -b, k & 4 ? c : -c});
  return Polyhedron::from_points(corners, dilation);
}
Polyhedron prism(int sides, double radius, double height, double dilation) {
  std::vector<Vec3d> corners;
  for (int k = 0; k < sides; ++k)
    for (const double z : {-height, height})
      corners.push_back(
          {radius * std::cos(2 * M_PI * k / sides), radius * std::sin(2 * M_PI * k / sides), z});
  return Polyhedron::from_points(corners, dilation);
}

/// i over j, which is at the origin.
struct Pair {
  const Polyhedron &i, &j;
  Vec3d place{0, 0, 0};
  Quaternion turn{};

  PlacedPolyhedron first(const Vec3d& shift = {0, 0, 0}, const Vec3d& w = {0, 0, 0}) const {
    const double angle = norm(w);
    const auto q = angle > 0 ? rotation_about(w, angle) * turn : turn;
    return {&i, RigidPose(place + shift, q)};
  }
  PlacedPolyhedron second() const { return {&j, RigidPose({0, 0, 0}, Quaternion{})}; }
  SolidContact touch(const Vec3d& shift = {0, 0, 0}, const Vec3d& w = {0, 0, 0}) const {
    NormalMemory<double> memory{};
    return touch_solids(first(shift, w), second(), memory);
  }
  /// Of margin_contact(): depth of the deepest points.
  double depth() const {
    silt::AxisMemory memory;
    return margin_contact(first(), second(), memory).overlap;
  }
  /// Lowers i until it is `wanted` deep.
  void sink(double wanted) {
    double low = 0.3, high = 4;
    for (int k = 0; k < 80; ++k) {
      place.z = 0.5 * (low + high);
      (depth() > wanted ? low : high) = place.z;
    }
  }
};

/// Largest difference of force and torque about the centre of i (for a law of slope 1) from the
/// differences of the overlap.
double gradient_error(const Pair& pair, const SolidContact& c) {
  const double h = 1e-7;
  Vec3d force{0, 0, 0}, torque{0, 0, 0};
  const Vec3d axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec3d& e : axes) {
    const Vec3d none{0, 0, 0};
    force += ((pair.touch(h * e).overlap - pair.touch(-h * e).overlap) / (2 * h)) * e;
    torque += ((pair.touch(none, h * e).overlap - pair.touch(none, -h * e).overlap) / (2 * h)) * e;
  }
  const Vec3d f = -c.gradient * c.normal;
  return std::max(norm(force - f), norm(torque - cross(c.point - pair.place, f) - c.couple * f));
}

}  // namespace

TEST_CASE("face_patch: force and torque are the gradient of the overlap, 2000 pairs of faces") {
  const auto a = block(1, 0.8, 0.5, 0.2), b = block(0.9, 1.1, 0.6, 0.15),
             hex = prism(6, 1, 0.4, 0.1);
  Random random(1);
  int near = 0, wrong = 0;
  for (int k = 0; k < 2000; ++k) {
    const double tilt = std::pow(10, random.uniform(-5, -1.5)), round = random.uniform(0, 6.3);
    Pair pair{k % 2 == 0 ? a : hex, b, {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), 0}};
    pair.turn = rotation_about({std::cos(round), std::sin(round), 0}, tilt) *
                rotation_about({0, 0, 1}, random.uniform(-3, 3));
    pair.sink(std::pow(10, random.uniform(-4, -1.5)));
    const auto c = pair.touch();
    if (!(c.overlap > 0) || pair.place.z < 0.5) continue;
    near += c.overlap != pair.depth() ? 1 : 0;
    wrong += gradient_error(pair, c) > 1e-3 ? 1 : 0;
  }
  CAPTURE(near);
  CHECK(near > 800);
  CHECK(wrong <= 2);  // where a difference spans the kink of a corner that passes an edge
}

TEST_CASE("face_patch: as two faces tilt through parallel, the point moves without a jump") {
  const auto cube = block(1, 1, 1, 0.1);
  const double depth = 2e-3;
  for (const double round : {0.0, 0.4, M_PI / 4}) {
    Pair pair{cube, cube, {0.3, 0.2, 0}};
    Vec3d last{0, 0, 0};
    double most = 0, widest = 0;
    const int steps = 6000;
    for (int k = 0; k <= steps; ++k) {
      const double tilt = 4e-3 * (2.0 * k / steps - 1);
      pair.turn = rotation_about({std::cos(round), std::sin(round), 0}, tilt);
      pair.sink(depth);
      const auto c = pair.touch();
      if (k > 0) most = std::max(most, norm(c.point - last));
      last = c.point, widest = std::max(widest, std::abs(c.point.y));
      CHECK(c.overlap >= pair.depth());
      CHECK(c.overlap < 1.2 * pair.depth());
    }
    CAPTURE(round);
    CHECK(widest > 0.8);  // reaches the edge
    CHECK(most < 0.01);   // of 1.6 from edge to edge; it was 1.6 in one step
  }
}

TEST_CASE(
    "face_patch: contacts of tilted faces, corners and edges are those of the deepest points") {
  const auto cube = block(1, 1, 1, 0.1);
  Random random(4);
  for (int k = 0; k < 500; ++k) {
    Pair pair{cube, cube, {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 0}};
    pair.turn = k % 2 == 0 ? random.turn() : rotation_about({0.6, 0.8, 0}, 0.03);
    pair.sink(2e-3);
    silt::AxisMemory memory;
    const auto c = pair.touch();
    const auto deepest = margin_contact(pair.first(), pair.second(), memory);
    if (std::abs(dot(c.normal, {0, 0, 1})) > 0.9999 && k % 2 == 0) continue;
    CHECK(c.gradient == 1);
    CHECK(c.couple == 0);
    CHECK(c.spread.trace() == 0);
    CHECK(std::abs(c.overlap - deepest.overlap) < 1e-9);
  }
}

TEST_CASE("face_patch: the spread of two faces that lie flat is that of the region they share") {
  const auto plate = block(1, 0.5, 0.2, 0.05);
  Pair pair{plate, plate, {0.4, 0, 0}};  // shared: 1.6 x 1
  pair.sink(1e-3);
  const auto c = pair.touch();
  CHECK(std::abs(c.spread.xx - 1.6 * 1.6 / 12) < 1e-4);
  CHECK(std::abs(c.spread.yy - 1.0 / 12) < 1e-4);
  CHECK(std::abs(c.spread.xy) < 1e-6);
  CHECK(std::abs(c.point.x - 0.2) < 1e-6);
  CHECK(std::abs(c.point.y) < 1e-6);
  const double rho = norm(Vec3d{1, 0.5, 0.2}) + 0.05;
  CHECK(std::abs(c.overlap - 1e-3 / (1 - 0.2 * (0.8 * 0.8 + 0.5 * 0.5) / (rho * rho))) < 1e-9);
}

}  // namespace face_patch_test
