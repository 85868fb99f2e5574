// silt - BSD-3-Clause, see LICENSE
// Servos that meet no load are warned of at the end of a run; negative forces are refused.
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/observers.hpp>
#include <silt/simulation.hpp>

#include "refusal.hpp"

namespace servo_warnings_test {

using silt::ServoForce, silt::ServoTorque, silt::Vec3d;
using silt_test::has, silt_test::refusal;
using Sentences = std::vector<std::string>;

const silt::HertzMindlin::Material soft{
    .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.3};

/// A grain on a floor, and a lid 1 mm above it with this drive.
inline auto scene(silt::WallDrive drive) {
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 1e-3}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{soft}};
  sim.threads = 1;
  sim.time_step = 1e-5;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, soft);
  sim.add_wall(silt::Plane{{0, 0, 3e-3}, {0, 0, -1}}, soft,
               {.name = "lid", .drive = std::move(drive)});
  return sim;
}
/// Of runs of these lengths [s], seen by one observer.
inline Sentences warned(silt::WallDrive drive, const std::vector<double>& runs) {
  auto sim = scene(std::move(drive));
  Sentences out;
  auto watch = silt::on_warnings([&](const std::string& w) { out.push_back(w); });
  for (const double t : runs) sim.run(t, watch);
  return out;
}

// Catches a servo that goes the wrong way without a word, and one that is warned of although it
// bears its load.
TEST_CASE("servo_warnings: a servo that meets no load is warned of at the end of a run") {
  const ServoForce down{.direction = {0, 0, -1}, .force = 1e-3, .max_speed = 0.1};
  auto up = down;
  up.direction = {0, 0, 2};
  const Sentences away = warned(up, {0.01});
  REQUIRE(away.size() == 1);
  CHECK(has(away[0], "wall 1 'lid': its ServoForce has moved it by 0.00"));
  CHECK(has(away[0],
            "without meeting a load; if it moves away from the particles, reverse its direction"));
  CHECK(warned(down, {0.005}).size() == 1);  // it has not got there yet
  CHECK(warned(down, {0.1}).empty());        // it is there
  up.max_travel = 1e-4;
  CHECK(warned(up, {0.01}).size() == 1);  // at the end of its way
  auto nothing = up;
  nothing.force = 0;
  CHECK(warned(nothing, {0.01}).empty());
  CHECK(warned(std::monostate{}, {0.01}).empty());
  CHECK(warned(silt::Slide{.direction = {0, 0, 1}, .mass = 1e-3, .speed = 0.1}, {0.01}).empty());
  const Sentences turns = warned(
      ServoTorque{.centre = {0, 0, 0}, .axis = {0, 0, 1}, .torque = 1, .max_rate = 2}, {0.01});
  REQUIRE(turns.size() == 1);
  CHECK(has(turns[0], "its ServoTorque has moved it by 0.0"));
  CHECK(has(turns[0], "reverse its axis"));
  CHECK(warned(ServoTorque{.centre = {0, 0, 0}, .axis = {0, 0, 1}, .torque = -1, .max_rate = 2},
               {0.01})
            .size() == 1);
}

TEST_CASE("servo_warnings: a negative force is refused; the direction gives the sign") {
  CHECK(has(refusal([&] {
              scene(ServoForce{.direction = {0, 0, -1}, .force = -5, .max_speed = 0.1});
            }),
            "ServoForce.force = -5 [N] must not be negative: reverse `direction` instead"));
}

}  // namespace servo_warnings_test
