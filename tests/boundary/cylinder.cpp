// silt - BSD-3-Clause, see LICENSE
#include <silt/boundary/cylinder.hpp>

#include <silt/core/random.hpp>

#include "support.hpp"

namespace cylinder_test {

using namespace boundary_test;
using silt::Cylinder;
using silt::Side;

namespace {
const Cylinder drum{.from = {0, 0, -1}, .to = {0, 0, 1}, .radius = 2, .side = Side::Inside};
const Cylinder shaft{.from = {0, 0, -1}, .to = {0, 0, 1}, .radius = 2, .side = Side::Outside};

SurfacePoint only(const Cylinder& cylinder, const Vec3d& centre) {
  const auto found = contacts(cylinder, centre, 10);
  REQUIRE(found.size() == 1);
  CHECK(silt::norm(found[0].normal) == doctest::Approx(1).epsilon(1e-15));
  return found[0];
}
}  // namespace

TEST_CASE("cylinder: from inside, distance to the wall, negative beyond it") {
  CHECK(only(drum, {1.5, 0, 0.5}).distance == 0.5);
  CHECK(only(drum, {1.5, 0, 0.5}).normal == Vec3d{-1, 0, 0});
  CHECK(only(drum, {0, -2.25, 0}).distance == -0.25);
  CHECK(only(drum, {0, -2.25, 0}).normal == Vec3d{0, 1, 0});
  CHECK(contacts(drum, {1.5, 0, 0}, 0.5).empty());
}

TEST_CASE("cylinder: from outside, distance to the wall, negative beyond it") {
  CHECK(only(shaft, {0, 2.5, 0}).distance == 0.5);
  CHECK(only(shaft, {0, 2.5, 0}).normal == Vec3d{0, 1, 0});
  CHECK(only(shaft, {1.75, 0, 0}).distance == -0.25);
  CHECK(only(shaft, {1.75, 0, 0}).normal == Vec3d{1, 0, 0});
}

TEST_CASE("cylinder: beyond an end the nearest point is on the rim") {
  for (const auto& cylinder : {drum, shaft})
    for (const double r : {2 - 0.3, 2 + 0.3}) {
      const auto p = only(cylinder, {0, r, 1.4});  // 3-4-5 triangle
      CHECK(p.distance == doctest::Approx(0.5).epsilon(1e-15));
      CHECK(gap(p.normal, {0, (r - 2) / 0.5, 0.8}) < 2e-15);
      const auto low = only(cylinder, {0, r, -1.4});
      CHECK(gap(low.normal, {0, (r - 2) / 0.5, -0.8}) < 2e-15);
    }
}

TEST_CASE("cylinder: on the free side the contact passes over the rim without a jump") {
  for (const double step : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const auto before = only(drum, {1.5, 0, 1 - step}), after = only(drum, {1.5, 0, 1 + step});
    CHECK(std::abs(before.distance - after.distance) <= 2 * step * step + 1e-15);
    CHECK(gap(before.normal, after.normal) <= 2.1 * step + 1e-15);  // step / distance = 2 step
  }
}

TEST_CASE("cylinder: a centre on the axis or on the rim gives a unit normal, not NaN") {
  for (const Vec3d axis : {Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, Vec3d{1, 2, -3}, Vec3d{1, 1, 1}}) {
    const Cylinder oblique{
        .from = {1, 1, 1}, .to = Vec3d{1, 1, 1} + 2.0 * axis, .radius = 0.5, .side = Side::Inside};
    for (const double along : {0.0, 0.3, 1.0, 2.0}) {
      const auto p = only(oblique, Vec3d{1, 1, 1} + along * axis);
      CHECK(p.distance == doctest::Approx(0.5).epsilon(1e-14));
      CHECK(std::abs(dot(p.normal, normalised(axis))) < 1e-14);
    }
  }
  const auto rim = only(drum, {2, 0, 1});
  CHECK(rim.distance == 0);
  CHECK(rim.normal == Vec3d{-1, 0, 0});
}

TEST_CASE("cylinder: close to the axis the normal stays across it") {
  const Cylinder oblique{.from = {0, 0, 0}, .to = {1, 2, -3}, .radius = 0.5, .side = Side::Outside};
  const Vec3d axis = normalised({1, 2, -3});
  const Vec3d across = normalised(cross(axis, {0, 0, 1}));
  for (double off = 1e-3; off > 1e-18; off /= 10) {
    const auto p = only(oblique, 0.7 * Vec3d{1, 2, -3} + off * across);
    CHECK(std::abs(dot(p.normal, axis)) < 1e-14);
    CHECK(p.distance == doctest::Approx(off - 0.5).epsilon(1e-14));
  }
}

TEST_CASE("cylinder: whatever the reach, a centre is found if it is nearer, and only then") {
  silt::Random random(5);
  int found = 0, missed = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3d at{3 * random.uniform(-1, 1), 3 * random.uniform(-1, 1), 2 * random.uniform(-1, 1)};
    const Cylinder& wall = n % 2 ? drum : shaft;
    const double distance = only(wall, at).distance;
    const double near = std::max(1e-12 * std::abs(distance), 1e-15);
    for (const double off : {-0.7, -1e-3, -near, near, 1e-3, 0.7}) {
      const bool within = !contacts(wall, at, distance + off).empty();
      CHECK(within == (off > 0));
      within ? ++found : ++missed;
    }
  }
  CHECK(found == missed);
}

TEST_CASE("cylinder: bounds enclose the surface tightly") {
  const auto box = drum.bounds();
  CHECK(box.min == Vec3d{-2, -2, -1});
  CHECK(box.max == Vec3d{2, 2, 1});
  const auto oblique =
      Cylinder{.from = {0, 0, 0}, .to = {3, 4, 0}, .radius = 1, .side = Side::Inside}.bounds();
  CHECK(gap(oblique.min, {-0.8, -0.6, -1}) < 1e-15);
  CHECK(gap(oblique.max, {3.8, 4.6, 1}) < 1e-15);
}

TEST_CASE("cylinder: refuses a missing length or radius") {
  const auto made = [](Vec3d from, Vec3d to, double radius) {
    return [=] { Cylinder{from, to, radius, Side::Inside}.check(); };
  };
  refuses<silt::InputError>(made({1, 1, 1}, {1, 1, 1}, 1), "Cylinder.from = (1, 1, 1)");
  refuses<silt::InputError>(made({0, 0, not_a_number}, {1, 1, 1}, 1), "Cylinder.from");
  refuses<silt::InputError>(made({0, 0, 0}, {1, infinity, 1}, 1), "Cylinder.to");
  refuses<silt::InputError>(made({0, 0, 0}, {0, 0, 1}, 0), "Cylinder.radius = 0 [m]");
  refuses<silt::InputError>(made({0, 0, 0}, {0, 0, 1}, not_a_number), "Cylinder.radius = nan");
  CHECK_NOTHROW(drum.check());
}

}  // namespace cylinder_test
