// silt - BSD-3-Clause, see LICENSE
// Contacts of bodies from their begin to their end: what they lose is missing of the energy.
#include <vector>

#include <engine/support.hpp>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/contact_observers.hpp>
#include <silt/shape/dilated_moments.hpp>
#include <silt/shape/mix.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/polyhedron.hpp>
#include <silt/shape/super_ellipsoid.hpp>

#include "near.hpp"

namespace contact_events_shapes_test {

using namespace engine_test;
using silt::ContactEvent;
using silt::Vec3d;

/// A body of each shape falls on a plane, in its own attitude, with a law that has no losses.
template <class ShapeType, class Form>
void check_body(const Form& form, double height, double tolerance) {
  silt::Particles<ShapeType> p;
  p.add_form(form);
  p.add({.position = {0, 0, height}, .density = 2500, .velocity = {0, 0, -0.5}});
  p.add({.position = {0.1, 0, 0.1}, .density = 2500, .velocity = {0.5, 0, 0}});
  p.add({.position = {0.1 + 2.5 * height, 0, 0.1}, .density = 2500, .velocity = {-0.5, 0, 0}});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, silt::ContactEvents{}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  const auto kinetic = [&](std::size_t k) {
    return 0.5 * sim.mass(k) * dot(sim.velocity(k), sim.velocity(k));
  };
  const double before[] = {kinetic(0), kinetic(1) + kinetic(2)};
  double lost[2] = {};
  std::size_t count[2] = {};
  sim.run(20e-3, silt::on_contact_end([&](const ContactEvent& c) {
            const bool pair = c.wall == silt::no_wall;
            CHECK(c.a == (pair ? 1u : 0u));
            CHECK(c.b == (pair ? 2u : silt::no_particle));
            CHECK(c.normal_speed == near(pair ? 1.0 : 0.5).epsilon(tolerance));
            CHECK(norm(c.normal - (pair ? Vec3d{-1, 0, 0} : Vec3d{0, 0, 1})) < tolerance);
            CHECK(c.largest_force > 0);
            lost[pair] += c.lost_energy, ++count[pair];
          }));
  REQUIRE(count[0] > 0);
  REQUIRE(count[1] > 0);
  // Straight on, so that nothing turns.
  const auto first = sim.find(0), second = sim.find(1), third = sim.find(2);
  CHECK(lost[0] == near(before[0] - kinetic(first)).epsilon(tolerance));
  CHECK(lost[1] == near(before[1] - kinetic(second) - kinetic(third)).epsilon(tolerance));
}

TEST_CASE("bodies: what an impact took is the kinetic energy that is missing") {
  check_body<silt::MultiSphere>(
      silt::MultiSphere{std::vector<silt::Ball>{{{-1e-3, 0, 0}, 1.5e-3}, {{1e-3, 0, 0}, 1.5e-3}}},
      3e-3, 1e-3);
  check_body<silt::SuperEllipsoid>(silt::SuperEllipsoid{.a = 1e-3, .b = 1.5e-3, .c = 2e-3}, 3e-3,
                                   1e-3);
  check_body<silt::SuperEllipsoid>(
      silt::SuperEllipsoid{.a = 1e-3, .b = 1e-3, .c = 1e-3, .s1 = 4, .s2 = 4}, 3e-3, 1e-3);
  std::vector<Vec3d> corners;
  for (int c = 0; c < 8; ++c)
    corners.push_back({c & 1 ? 1e-3 : -1e-3, c & 2 ? 1e-3 : -1e-3, c & 4 ? 1e-3 : -1e-3});
  check_body<silt::Polyhedron>(silt::Polyhedron::from_points(corners), 3e-3, 1e-3);
}

TEST_CASE("a crowd of shapes: what all contacts lose, their energy has no longer") {
  // Catches ends that are noted at other places than in the block of the contact: of pairs whose
  // bounding spheres come apart, many at a time.
  using Shapes = silt::Mix<silt::Sphere, silt::SuperEllipsoid, silt::Polyhedron>;
  silt::Particles<Shapes> p;
  p.add_form(silt::Sphere{});
  p.add_form(silt::SuperEllipsoid{.a = 1, .b = 1, .c = 0.6, .s1 = 4, .s2 = 2});
  std::vector<Vec3d> corners;
  for (int c = 0; c < 8; ++c)
    corners.push_back({c & 1 ? 1.0 : -1.0, c & 2 ? 1.0 : -1.0, c & 4 ? 1.0 : -1.0});
  p.add_form(silt::Polyhedron::from_points(corners));
  silt::Random random(3);
  for (int k = 0; k < 64; ++k)
    p.add({.form = static_cast<std::size_t>(k % 3),
           .position = Vec3d{3e-3 * (k % 4), 3e-3 * (k / 4 % 4), 3e-3 * (k / 16)} +
                       Vec3d{1.5e-3, 1.5e-3, 1.5e-3},
           .orientation = silt::random_orientation(random),
           .radius = 1.2e-3,
           .density = 2500,
           .velocity = {random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4),
                        random.uniform(-0.4, 0.4)}});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, silt::EnergyLedger{},
                       silt::ContactEvents{}};
  sim.add_wall(silt::box({0, 0, 0}, {0.012, 0.012, 0.012}), rubber);
  sim.run(0);
  sim.time_step = 0.5 * sim.step_length();
  double lost = 0;
  std::size_t begun = 0, over = 0;
  const auto begins = silt::on_contact_begin([&](const ContactEvent&) { ++begun; });
  const auto ends = silt::on_contact_end([&](const ContactEvent& c) {
    lost += c.lost_energy, ++over;
    CHECK(c.point.x > -1e-3);
    CHECK(c.point.x < 0.013);
  });
  sim.run(0.02, begins, ends);
  for (int k = 0; k < 20000 && begun != over; ++k) sim.run(sim.step_length(), begins, ends);
  REQUIRE(begun == over);
  CHECK(over > 100);
  const auto e = sim.energy();
  // Points of contact move over a body in a step, to first order in it.
  CHECK(lost == near(e.initial - e.kinetic()).epsilon(0.02));
}

}  // namespace contact_events_shapes_test
