// silt - BSD-3-Clause, see LICENSE
#include <silt/boundary/motion.hpp>

#include "support.hpp"

namespace motion_test {

using namespace boundary_test;
using silt::Motion;
using silt::Pose;

TEST_CASE("pose: to_body undoes to_space, and directions turn without moving") {
  const Pose pose{silt::rotation_about(normalised({1, -2, 3}), 0.7), {4, 5, 6}};
  const Vec3d p{0.3, -0.2, 0.9};
  CHECK(gap(pose.to_body(pose.to_space(p)), p) < 2e-15);
  CHECK(gap(pose.rotate_back(pose.rotate(p)), p) < 1e-15);
  CHECK(gap(pose.to_space(p) - pose.to_space({0, 0, 0}), pose.rotate(p)) < 2e-15);
  CHECK(Pose{}.to_space(p) == p);
}

TEST_CASE("translation: velocity times time") {
  const Motion motion = silt::translation({1, -2, 0.5});
  CHECK(motion(0) == Pose{});
  CHECK(motion(2).to_space({1, 1, 1}) == Vec3d{3, -3, 2});
}

TEST_CASE("rotation: a quarter turn about a line, which stays where it is") {
  const Motion motion = silt::rotation({1, 0, 0}, {0, 0, 2}, pi / 2);  // one quarter a second
  CHECK(gap(motion(1).to_space({2, 0, 5}), {1, 1, 5}) < 1e-15);
  CHECK(gap(motion(1).to_space({1, 0, -3}), {1, 0, -3}) < 1e-15);
  CHECK(gap(motion(4).to_space({2, 0, 5}), {2, 0, 5}) < 2e-15);
  CHECK(motion(0) == Pose{});
}

TEST_CASE("vibration: starts at rest position for any phase and follows the sine") {
  const Vec3d amplitude{0, 0.2, 0};
  for (const double phase : {0.0, 0.4, pi / 2}) {
    const Motion motion = silt::vibration(amplitude, 5, phase);
    CHECK(motion(0) == Pose{});
    for (const double t : {0.013, 0.05, 1.77}) {
      const double y = 0.2 * std::sin(10 * pi * t + phase) - 0.2 * std::sin(phase);
      CHECK(gap(motion(t).to_space({1, 1, 1}), {1, 1 + y, 1}) < 1e-14);
    }
  }
  CHECK(silt::vibration(amplitude, 5)(0.05).translation.y == doctest::Approx(0.2).epsilon(1e-15));
}

TEST_CASE("combined: a point goes through the first motion, then the second") {
  const Motion spin = silt::rotation({0, 0, 0}, {0, 0, 1}, pi / 2);
  const Motion tilt = silt::rotation({0, 0, 1}, {1, 0, 0}, pi / 2);
  const Motion both = silt::combined(spin, tilt);
  const Vec3d p{1, 2, 3};
  for (const double t : {0.0, 0.3, 1.0})
    CHECK(gap(both(t).to_space(p), tilt(t).to_space(spin(t).to_space(p))) < 2e-15);
  CHECK(gap(both(1).to_space(p), silt::combined(tilt, spin)(1).to_space(p)) > 1);
}

TEST_CASE("motion: refuses arguments without meaning, by name") {
  using silt::InputError;
  refuses<InputError>([] { silt::translation({0, infinity, 0}); }, "velocity = (0, inf, 0) [m/s]");
  refuses<InputError>(
      [] {
        silt::rotation({not_a_number, 0, 0}, {0, 0, 1}, 1);
      },
      "rotation: centre = (nan, 0, 0) [m]");
  refuses<InputError>(
      [] {
        silt::rotation({0, 0, 0}, {0, 0, 0}, 1);
      },
      "rotation: axis = (0, 0, 0) [-]");
  refuses<InputError>(
      [] {
        silt::rotation({0, 0, 0}, {0, 0, 1}, infinity);
      },
      "rotation: rate = inf [rad/s]");
  refuses<InputError>([] { silt::vibration({0, 0, not_a_number}, 1); }, "vibration: amplitude");
  refuses<InputError>([] { silt::vibration({0, 0, 1}, 0); }, "vibration: frequency = 0 [Hz]");
  refuses<InputError>(
      [] {
        silt::vibration({0, 0, 1}, 1, not_a_number);
      },
      "vibration: phase = nan [rad]");
  refuses<InputError>([] { silt::combined({}, silt::translation({0, 0, 0})); }, "first motion");
  refuses<InputError>([] { silt::combined(silt::translation({0, 0, 0}), {}); }, "second motion");
}

}  // namespace motion_test
