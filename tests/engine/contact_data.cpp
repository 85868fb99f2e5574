// silt - BSD-3-Clause, see LICENSE
//
// for_each_contact(): its forces are those with which the step has moved the particles, whatever
// law, wall and precision; its fields against closed forms; its refusals.
#include <cmath>

#include "engine/contact_sums.hpp"
#include "engine/mixed_scene.hpp"
#include "near.hpp"

namespace contact_data_test {

using namespace engine_test;
using silt::Vec3d;

TEST_CASE("contact data: forces, torques and wall loads are those of the step, in all of a scene") {
  // Two materials, rolling resistance, a direction that repeats, planes and a mesh that move,
  // spheres that come and go. Sums of some ten contacts: rounding of 1e-16 each, and of velocities
  // whose change in a step is 1e-4 of them. A history that is advanced once more would err by the
  // slip of a step: 1e-2 of the tangential force.
  auto sim = mixed_scene();
  CHECK(check_sums(sim, 6e-3, 200, 1e-9).contacts > 1000);
}
#ifdef SILT_LONG_TESTS
TEST_CASE("contact data: the same in mixed precision") {
  // Loads are floats there: 6e-8 each, and cancel by a factor of ten or so.
  auto sim = mixed_scene<silt::Mixed>();
  CHECK(check_sums(sim, 6e-3, 100, 1e-5).contacts > 300);
}
#endif

TEST_CASE("contact data: bodies of balls that share contacts, in a cylinder and a cone") {
  silt::Particles<silt::MultiSphere> p;
  p.add_form(silt::MultiSphere{std::vector<silt::Ball>{
      {{-0.7e-3, 0, 0}, 0.9e-3}, {{0.7e-3, 0, 0}, 0.8e-3}, {{0, 0.8e-3, 0}, 0.7e-3}}});
  p.fill({{-3.4e-3, -3.4e-3, 3e-3}, {3.4e-3, 3.4e-3, 30e-3}},
         {.radius = silt::uniform(1.5e-3, 1.7e-3), .density = 2500, .velocity = {0.1, 0, -0.5}});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cylinder{{0, 0, 0}, {0, 0, 60e-3}, 6e-3, silt::Side::Inside}, rubber);
  sim.add_wall(silt::Cone{{0, 0, -6e-3}, {0, 0, 0}, 1e-3, 6e-3, silt::Side::Inside}, rubber);
  const auto check = check_sums(sim, 0.1, 50, 1e-9);
  CHECK(check.contacts > 1000);
  std::size_t at_cone = 0, several = 0, last = 0;
  sim.for_each_contact([&](const ContactSeen& c) {
    at_cone += c.wall == 1;
    several += c.wall == silt::no_wall && c.a * 1000 + c.b == last;
    last = c.a * 1000 + c.b;
  });
  CHECK(at_cone > 5);
  CHECK(several > 10);  // of the same two bodies
}

TEST_CASE("contact data: two spheres of different size, in numbers") {
  // A linear spring without losses, pushed 1 % together and sheared by 1 mm/s for a short while:
  // forces k d and k_t s, arms r (1 - d/reach); the law's own memory is the slip.
  const silt::LinearSpringFriction::Material m{.stiffness = 1000, .restitution = 1, .friction = 10};
  silt::Particles<Sphere> p;
  const double r[] = {2e-3, 1e-3}, d = 3e-5;
  p.add({.position = {0, 0, 0}, .radius = r[0], .density = 2500, .fixed = true});
  p.add({.position = {0, 0, 3e-3 - d}, .radius = r[1], .density = 1e9, .velocity = {1e-3, 0, 0}});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpringFriction>{m}};
  sim.time_step = 1e-7;
  sim.run(1e-5);
  int seen = 0;
  sim.for_each_contact([&](const ContactSeen& c) {
    ++seen;
    CHECK(c.a == 0);
    CHECK(c.b == 1);
    CHECK(c.place_a == sim.find(0));
    CHECK(c.place_b == sim.find(1));
    CHECK(c.wall == silt::no_wall);
    CHECK(c.facet == silt::no_facet);
    CHECK(c.normal.z == near(-1).epsilon(1e-9));
    CHECK(c.overlap == near(d).epsilon(1e-6));
    CHECK(c.normal_force == near(1000 * d).epsilon(1e-6));
    CHECK(c.branch.z == near(-(3e-3 - d)).epsilon(1e-9));
    CHECK(c.point.z == near(r[0] * (1 - d / 3e-3)).epsilon(1e-9));
    CHECK(norm(c.force - c.normal_force * c.normal - c.tangential_force) < 1e-18);
    CHECK(norm(c.spring - c.tangential_force) < 1e-12);
    CHECK(c.tangential_force.x > 0);  // on the fixed one, which the other drags along
    CHECK(norm(c.torque_a - cross(c.point - Vec3d{0, 0, 0}, c.force)) < 1e-18);
    CHECK(norm(c.torque_b - cross(c.point - sim.position(sim.find(1)), -c.force)) < 1e-18);
    REQUIRE(c.history.size() == 3);
    CHECK(std::abs(c.history[0]) ==
          near(1e-8).epsilon(0.02));  // slip: v t, less what it has rolled
    CHECK(c.cohesion == 0);
  });
  CHECK(seen == 1);
}

#ifdef SILT_LONG_TESTS
TEST_CASE("contact data: cohesion is a part of the normal force") {
  // DMT in a contact at rest that nothing presses: the pull 2 pi w R is all that is there, so that
  // it holds the elastic force.
  using Sticky = silt::Cohesive<HertzMindlin, silt::Dmt>;
  const Sticky::Material m{rubber, {.work_of_adhesion = 0.1}};
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500});
  p.add({.position = {0, 0, 1.999e-3}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(p), silt::Contacts<Sticky>{m}};
  sim.time_step = 2e-6;
  sim.run(0.02);
  int seen = 0;
  sim.for_each_contact([&](const ContactSeen& c) {
    ++seen;
    CHECK(c.cohesion == near(2 * M_PI * 0.1 * 0.5e-3).epsilon(1e-12));
    CHECK(std::abs(c.normal_force) < 1e-3 * c.cohesion);
  });
  CHECK(seen == 1);
}
#endif

TEST_CASE("contact data: a mesh's facets, and the corners of a floor") {
  // Three spheres on a floor of four triangles: over one triangle each, and on the common corner.
  const Vec3d low{-0.01, -0.01, 0}, right{0.01, -0.01, 0}, far{0.01, 0.01, 0}, up{-0.01, 0.01, 0},
      middle{0, 0, 0};
  silt::Particles<Sphere> p;
  const Vec3d at[] = {{0, -5e-3, 1e-3}, {5e-3, 0, 1e-3}, {0, 0, 1e-3}};
  for (const Vec3d& x : at) p.add({.position = x, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(
      silt::TriangleMesh(
          {{low, right, middle}, {right, far, middle}, {far, up, middle}, {up, low, middle}}),
      rubber);
  sim.run(0.02);
  std::vector<std::size_t> facets;
  sim.for_each_contact([&](const ContactSeen& c) {
    CHECK(c.wall == 0);
    CHECK(c.b == silt::no_particle);
    CHECK(c.place_b == sim.rows());
    facets.push_back(c.facet);
  });
  CHECK(facets == std::vector<std::size_t>{0, 1, 0});  // the corner counts as its lowest triangle
}

TEST_CASE("contact data: asking changes no later bit, and threads no contact") {
  auto plain = mixed_scene(), asked = mixed_scene(), threaded = mixed_scene(3);
  plain.keep_contacts = false;
  plain.run(8e-3);
  std::vector<double> first, second;
  asked.run(8e-3, [&](const auto& s) { first = numbers_of(s); });
  threaded.run(8e-3, silt::at(silt::every(1e-3), [&](const auto& s) { second = numbers_of(s); }));
  CHECK(bits(plain) == bits(asked));
  CHECK(first.size() > 200);
  CHECK(first == second);
  CHECK(first == numbers_of(asked));  // between runs the same as in the last step
}

TEST_CASE("contact data: refused where the step was not recorded") {
  auto sim = mixed_scene();
  const auto refused = [&] {
    return refusal<silt::InputError>([&] { sim.for_each_contact([](const ContactSeen&) {}); });
  };
  CHECK(has_words(refused(), {"Simulation::for_each_contact", "step 0", "after run()"}));
  sim.keep_contacts = false;
  sim.run(1e-3);
  CHECK(has_words(refused(), {"were not recorded", "keep_contacts = true"}));
  sim.keep_contacts = true;
  sim.run(1e-4);
  CHECK(refused().empty());
  // A particle that has left since is no end of a contact any more.
  std::size_t of_it = 0, after = 0;
  silt::ParticleId id = 0;
  sim.run(6e-3);
  sim.for_each_contact([&](const ContactSeen& c) { id = c.a; });
  const auto count = [&](std::size_t& n) {
    sim.for_each_contact([&](const ContactSeen& c) { n += c.a == id || c.b == id; });
  };
  count(of_it);
  sim.remove(id);
  count(after);
  CHECK(of_it > 0);
  CHECK(after == 0);
}

}  // namespace contact_data_test
