// silt - BSD-3-Clause, see LICENSE
#include <silt/boundary/cone.hpp>
#include <silt/boundary/cylinder.hpp>

#include "support.hpp"

namespace cone_test {

using namespace boundary_test;
using silt::Cone;
using silt::Cylinder;
using silt::Side;

namespace {
// Radius falls by 3 over a height of 4: slant 5, inward normal (-0.8, 0, 0.6) at +x.
const Cone hopper{
    .from = {0, 0, 0}, .to = {0, 0, 4}, .radius_from = 1, .radius_to = 4, .side = Side::Inside};
const Cone funnel{
    .from = {0, 0, 0}, .to = {0, 0, 4}, .radius_from = 1, .radius_to = 4, .side = Side::Outside};
const Cone tip{
    .from = {0, 0, 3}, .to = {0, 0, 0}, .radius_from = 0, .radius_to = 3, .side = Side::Outside};

SurfacePoint only(const Cone& cone, const Vec3d& centre) {
  const auto found = contacts(cone, centre, 100);
  REQUIRE(found.size() == 1);
  CHECK(silt::norm(found[0].normal) == doctest::Approx(1).epsilon(1e-15));
  return found[0];
}

/// Brute force: the nearest of many points of the generatrix through the centre's half plane.
double sampled_distance(const Cone& cone, double r, double z) {
  double nearest = infinity;
  for (int k = 0; k <= 100000; ++k) {
    const double s = k / 100000.0;
    const double dr = r - (cone.radius_from + s * (cone.radius_to - cone.radius_from));
    const double dz = z - s * (cone.to.z - cone.from.z);
    nearest = std::min(nearest, std::sqrt(dr * dr + dz * dz));
  }
  return nearest;
}
}  // namespace

TEST_CASE("cone: distance and normal on both sides of the slope") {
  const Vec3d on_wall{2.5, 0, 2}, inwards{-0.8, 0, 0.6};
  for (const double d : {0.3, -0.3}) {
    const auto in = only(hopper, on_wall + d * inwards);
    CHECK(in.distance == doctest::Approx(d).epsilon(1e-14));
    CHECK(gap(in.normal, inwards) < 1e-15);
    const auto out = only(funnel, on_wall + d * inwards);
    CHECK(out.distance == doctest::Approx(-d).epsilon(1e-14));
    CHECK(gap(out.normal, -inwards) < 1e-15);
  }
}

TEST_CASE("cone: on the free side it is the distance to the generatrix, rims included") {
  std::mt19937_64 random(1);
  int rims = 0;
  for (int n = 0; n < 200; ++n) {
    const double r = uniform(random, 0, 5), z = uniform(random, -1, 5);
    const Vec3d centre{0, r, z};
    const bool inside = r < 1 + 0.75 * z;
    const double d = only(inside ? hopper : funnel, centre).distance;
    // Spacing h of the samples: error below h^2/(2 d) + rounding.
    CHECK(d == doctest::Approx(sampled_distance(hopper, r, z)).epsilon(1e-7));
    rims += z < 0 || z > 4;
  }
  CHECK(rims > 20);
}

TEST_CASE("cone: the tip is reached along the axis and the flank beside it") {
  const auto above = only(tip, {0, 0, 3.5});
  CHECK(above.distance == 0.5);
  CHECK(above.normal == Vec3d{0, 0, 1});
  const auto beside = only(tip, {1, 0, 3});
  CHECK(beside.distance == doctest::Approx(std::sqrt(0.5)).epsilon(1e-15));
  CHECK(gap(beside.normal, normalised({1, 0, 1})) < 1e-15);
}

TEST_CASE("cone: a centre on the axis, the tip or a rim gives a unit normal, not NaN") {
  CHECK(only(hopper, {0, 0, 2}).distance == doctest::Approx(2.5 * 0.8).epsilon(1e-15));
  CHECK(only(tip, {0, 0, 3}).distance == 0);
  CHECK(only(tip, {0, 0, 1}).distance == doctest::Approx(-std::sqrt(2)).epsilon(1e-15));
  CHECK(std::abs(only(hopper, {0, 4, 4}).distance) < 1e-15);
}

TEST_CASE("cone: with equal radii it equals Cylinder bit for bit") {
  std::mt19937_64 random(2);
  for (int n = 0; n < 300; ++n) {
    const Vec3d from = random_point(random, -1, 1), to = random_point(random, -1, 1);
    const double radius = uniform(random, 0.1, 1);
    const Side side = n % 2 ? Side::Inside : Side::Outside;
    const Vec3d centre = random_point(random, -2, 2);
    const auto a = contacts(Cylinder{from, to, radius, side}, centre, 1);
    const auto b = contacts(Cone{from, to, radius, radius, side}, centre, 1);
    REQUIRE(a.size() == b.size());
    if (a.empty()) continue;
    CHECK(a[0].distance == b[0].distance);
    CHECK(a[0].normal == b[0].normal);
  }
}

TEST_CASE("cone: the rim where it meets a cylinder lies in the tangent plane of the other") {
  const Cylinder bin{.from = {0, 0, 4}, .to = {0, 0, 9}, .radius = 4, .side = Side::Inside};
  const Vec3d centre = Vec3d{3.7, 0, 3.6} + 0.5 * Vec3d{-0.8, 0, 0.6};
  const auto slope = only(hopper, centre);
  const auto rim = contacts(bin, centre, 2);
  REQUIRE(rim.size() == 1);
  CHECK(rim[0].distance > slope.distance);
  CHECK(silt::in_tangent_plane(rim[0], slope, 1e-14));
  CHECK(!silt::in_tangent_plane(slope, rim[0], 1e-3));
}

TEST_CASE("cone: bounds enclose the surface tightly") {
  const auto box = hopper.bounds();
  CHECK(box.min == Vec3d{-4, -4, 0});
  CHECK(box.max == Vec3d{4, 4, 4});
}

TEST_CASE("cone: refuses a missing length and radii that make no surface") {
  const auto made = [](Vec3d to, double radius_from, double radius_to) {
    return [=] { Cone{{0, 0, 0}, to, radius_from, radius_to, Side::Inside}.check(); };
  };
  refuses<silt::InputError>(made({0, 0, 0}, 1, 2), "Cone.from = (0, 0, 0)");
  refuses<silt::InputError>(made({0, 0, 1}, -1, 2), "Cone.radius_from = -1 [m]");
  refuses<silt::InputError>(made({0, 0, 1}, 1, not_a_number), "Cone.radius_to = nan [m]");
  refuses<silt::InputError>(made({0, 0, 1}, 0, 0), "are both 0 [m]");
  CHECK_NOTHROW(tip.check());
}

}  // namespace cone_test
