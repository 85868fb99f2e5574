// silt - BSD-3-Clause, see LICENSE
// rotation_about: an axis of any length gives a rotation.
//   an axis of length 2 gave a quaternion of length 1.1, which stretches what it turns
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include <silt/core/quaternion.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace quaternion_test {

using silt::rotate;
using silt::rotation_about;
using silt::Vec3d;

TEST_CASE("rotation_about: an axis of any length turns by the angle and stretches nothing") {
  const Vec3d x{1, 0, 0};
  for (const double length : {1e-3, 1.0, 2.0, 1e6}) {
    const auto q = rotation_about({0, 0, length}, 0.5);
    CHECK(q.w * q.w + dot(q.vector(), q.vector()) == near(1));
    const Vec3d turned = rotate(q, x);
    CHECK(turned.x == near(std::cos(0.5)));
    CHECK(turned.y == near(std::sin(0.5)));
  }
  // A unit vector is taken as it is, to the last bit.
  const Vec3d axis = normalised(Vec3d{0.3, -1, 0.7});
  const auto q = rotation_about(axis, 0.4);
  CHECK(q.x == std::sin(0.2) * axis.x);
}

TEST_CASE("rotation_about: no axis and values that are not finite are refused") {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const Vec3d& axis, double angle, const char* words) {
    CHECK_THROWS_AS(rotation_about(axis, angle), silt::InputError);
    silt_test::has(silt_test::refusal([&] { rotation_about(axis, angle); }), words);
  };
  refused({0, 0, 0}, 1, "rotation_about: axis = (0, 0, 0) [-]");
  refused({0, none, 0}, 1, "must be finite, and the axis not zero");
  refused({0, 0, 1}, INFINITY, "angle = inf [rad]");
}

}  // namespace quaternion_test
