// silt - BSD-3-Clause, see LICENSE
// What a stopped run says is what has gone wrong: scenes that were given wrong are not told to take
// another material or a shorter time step.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <engine/support.hpp>

#include <silt/contact/linear_spring.hpp>
#include <silt/shape/mix.hpp>
#include <silt/shape/super_ellipsoid.hpp>

namespace guard_words_test {

namespace {

using namespace engine_test;
using silt::InputError;
using silt::SimulationError;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
const silt::Contacts<HertzMindlin> contacts{rubber};

/// Spheres of 1 mm at rest, under gravity.
auto scene(std::initializer_list<Vec3d> places, const silt::Contacts<HertzMindlin>& of = contacts) {
  silt::Particles<Sphere> p;
  for (const Vec3d& at : places) p.add({.position = at, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(p), of};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  return sim;
}

/// The SimulationError that a run ends with.
template <class Sim, class... Observers>
SimulationError failure(Sim& sim, double duration, Observers&&... observers) {
  std::optional<SimulationError> caught;
  try {
    sim.run(duration, observers...);
  } catch (const SimulationError& error) {
    caught = error;
  }
  REQUIRE(caught.has_value());
  return *caught;
}

bool lacks(const std::string& sentence, std::initializer_list<std::string> words) {
  return std::none_of(words.begin(), words.end(),
                      [&](const auto& w) { return sentence.find(w) != std::string::npos; });
}

}  // namespace

namespace {
/// A law of one's own with a wrong contact_time().
struct Instant {
  struct Material {
    double lasts;  // [s]
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real lasts;
  };
  static Coefficients<double> mix(const Material& a, const Material&) { return {a.lasts}; }
  template <class Real>
  static Real force(const silt::Contact<Real>& c, const Coefficients<Real>&) {
    return Real(1e3) * c.overlap;
  }
  static double contact_time(const Coefficients<double>& p, double, double, double) {
    return p.lasts;
  }
};
}  // namespace

// Catches "moves by 0 m in a step" and "set Simulation::time_step to less than -nan s".
TEST_CASE("guard: a contact_time() that is not greater than 0 is named") {
  for (const double lasts : {0.0, -1e-3, nan}) {
    silt::Particles<Sphere> p;
    p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -1}});
    silt::Simulation sim{std::move(p), silt::Contacts<Instant>{{lasts}}};
    sim.gravity = {0, 0, -9.81};
    CHECK(has_words(refusal<InputError>([&] { sim.run(0.01); }),
                    {"the contact law's contact_time() is ", " s for R_eff = ",
                     "it must be greater than 0, or infinite where it is not known"}));
  }
}

TEST_CASE("guard: twins at the start are called so, and no other material is advised") {
  auto sim = scene({{0.1, 0, 0}, {0, 0, 0}, {0, 0, 0.3e-3}});
  const auto error = failure(sim, 0.01);
  CHECK(error.particles == std::vector<silt::ParticleId>{1, 2});
  CHECK(has_words(error.what(), {"step 0", "particles 1 and 2", "overlap by 1.7", "added twice",
                                 "leave one of them out"}));
  CHECK(lacks(error.what(), {"material", "time step", "speed"}));
  // Further apart it is an overlap like any other.
  auto apart = scene({{0, 0, 0}, {0, 0, 1.2e-3}});
  const std::string words = failure(apart, 0.01).what();
  CHECK(has_words(words, {"particles 0 and 1", "start without overlaps"}));
  CHECK(lacks(words, {"twice", "stiffer"}));
}

TEST_CASE("guard: two spheres at one place are named, not a velocity that is not finite") {
  auto sim = scene({{0.1, 0, 0}, {0, 0, 0.02}, {0, 0, 0.02}});
  const auto error = failure(sim, 0.01);
  CHECK(error.particles == std::vector<silt::ParticleId>{1, 2});
  CHECK(error.position.z == 0.02);
  CHECK(has_words(error.what(), {"particles 1 and 2 are at the same place, (0, 0, 0.02) m",
                                 "added twice", "leave one of them out"}));
  CHECK(lacks(error.what(), {"not finite", "gravity"}));
}

TEST_CASE("guard: a plane turned over and a wall inside the bed are told apart") {
  const std::initializer_list<Vec3d> column{{0, 0, 3e-3}, {0, 0, 5.1e-3}, {0, 0, 7.2e-3}};
  auto turned = scene(column);
  turned.add_wall(silt::Plane{{0, 0, 0}, {0, 0, -1}}, rubber);
  const std::string over = failure(turned, 0.01).what();
  CHECK(
      has_words(over, {"step 0", "wall 0", "all 3 particles lie behind this wall: turn it over"}));
  CHECK(lacks(over, {"stiffer", "time step", "set_max_overlap"}));

  auto outside = scene(column);
  outside.add_wall(silt::Cylinder{{0, 0, 0}, {0, 0, 0.1}, 0.05, silt::Side::Outside}, rubber);
  CHECK(has_words(failure(outside, 0.01).what(), {"behind this wall", "Side of a cylinder"}));

  auto inside = scene(column);
  inside.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  inside.add_wall(silt::Plane{{0, 0, 4e-3}, {0, 0, 1}}, rubber);
  const auto error = failure(inside, 0.01);
  CHECK(error.particles == std::vector<silt::ParticleId>{0});
  CHECK(has_words(error.what(), {"wall 1", "1 of 3 particles lie behind this wall and the others",
                                 "inside the bed"}));
  CHECK(lacks(error.what(), {"stiffer", "time step"}));

  // A region behind a wall, from the first step on and later: nothing is placed there.
  for (const double start : {0.0, 1e-3}) {
    auto fed = scene(column);
    fed.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
    fed.run(start);
    fed.add_inlet(silt::Box{{0.02, 0.02, -0.02}, {0.03, 0.03, -0.01}},
                  {.radius = 1e-3, .density = 2500, .rate = 1e4});
    fed.run(0.01);
    CHECK(fed.inlet(0).placed == 0);
    CHECK(fed.inlet(0).waiting > 0);
    CHECK(
        has_words(fed.inlet(0).why_waiting(),
                  {"0 particles placed", "200 random places in a row were occupied: 200 by wall 0",
                   "in or behind the wall: move it"}));
    CHECK(lacks(fed.inlet(0).why_waiting(), {"particles (the last"}));
  }

  auto cuts = scene(column);
  cuts.add_wall(silt::Plane{{0, 0, 2.5e-3}, {0, 0, 1}}, rubber);
  const std::string words = failure(cuts, 0.01).what();
  CHECK(has_words(words, {"overlaps wall 0 by 0.5", "start without overlaps"}));
  CHECK(lacks(words, {"behind", "stiffer", "time step"}));
}

TEST_CASE("guard: what is added later and overlaps is given so too; what runs into it is not") {
  auto sim = scene({{0, 0, 0}});
  sim.run(0.005);
  silt::Particles<Sphere> twin;
  twin.add({.position = sim.position(0) + Vec3d{0.2e-3, 0, 0}, .radius = 1e-3, .density = 2500});
  sim.add(twin);
  CHECK(has_words(failure(sim, 0.01).what(), {"particles 0 and 1", "added twice"}));

  auto hit = scene({{0, 0, 1.1e-3}});
  hit.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  hit.gravity = {0, 0, -1e6};
  CHECK(has_words(failure(hit, 0.01).what(), {"overlaps wall 0", "use a stiffer material"}));
}

// Two ellipsoids of a mix without flat faces had no room for what their contact keeps, and crashed.
TEST_CASE("guard: in a mix, two bodies that overlap are named by their numbers") {
  using Grains = silt::Mix<Sphere, silt::SuperEllipsoid>;
  for (const bool balls : {true, false})
    for (const double gap : {0.3e-3, 1.2e-3}) {
      CAPTURE(balls);
      CAPTURE(gap);
      silt::Particles<Grains> p;
      const auto ball = p.add_form(Sphere{});
      const auto lens = p.add_form(silt::SuperEllipsoid{1e-3, 1e-3, 0.8e-3});
      const auto put = [&](std::size_t form, double x) {
        p.add({.form = form, .position = {x, 0, 0}, .radius = 1e-3, .density = 2500});
      };
      put(ball, 0), put(lens, 0.01), put(ball, 0.02), put(balls ? ball : lens, 0.03);
      put(balls ? ball : lens, 0.03 + gap);
      silt::Simulation sim{std::move(p), contacts};
      sim.gravity = {0, 0, -9.81};
      sim.threads = 1;
      const auto error = failure(sim, 0.01);
      auto named = error.particles;
      std::sort(named.begin(), named.end());
      CHECK(named == std::vector<silt::ParticleId>{3, 4});
      CHECK(has_words(error.what(), {gap < 0.5e-3 ? "added twice" : "start without overlaps"}));
    }
}

// Catches: "let fill() place them", said of spheres that fill() has placed in a region larger than
// the box.
TEST_CASE("guard: what a periodic box has moved onto others is told so") {
  silt::Particles<Sphere> p;
  p.add({.position = {0.002, 0.01, 0.01}, .radius = 1e-3, .density = 2500});
  p.add({.position = {0.0132, 0.01, 0.01}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(p), contacts,
                       silt::PeriodicBox{{{0, 0, 0}, {0.01, 0.02, 0.02}}, {true, false, false}}};
  sim.gravity = {0, 0, -9.81};
  const auto error = failure(sim, 0.01);
  CHECK(has_words(error.what(), {"particles 0 and 1",
                                 "1 particle was placed outside the periodic "
                                 "box",
                                 "place all of them inside"}));
  CHECK(lacks(error.what(), {"let fill() place them"}));
}

TEST_CASE("guard: a servo that presses with more than grains bear is named with its force") {
  auto sim = scene({{0, 0, 1e-3}});
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  sim.add_wall(
      silt::Plane{{0, 0, 2.1e-3}, {0, 0, -1}}, rubber,
      {.name = "lid",
       .drive = silt::ServoForce{.direction = {0, 0, -1}, .force = 5000, .max_speed = 0.1}});
  const std::string words = failure(sim, 0.1).what();
  CHECK(has_words(words, {"overlaps wall",
                          "; wall 1 'lid' presses with a ServoForce of 5000 N, which may be "
                          "more than the particles bear: lower it",
                          "use a stiffer material"}));
}

TEST_CASE("guard: a material as soft as 5 Pa is blamed itself, not the time step") {
  const HertzMindlin::Material jelly{.youngs_modulus = 5, .poisson_ratio = 0.25};
  auto sim = scene({{0, 0, 1.5e-3}, {0, 0, 1e-2}}, silt::Contacts<HertzMindlin>{jelly});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, jelly);
  const std::string words = failure(sim, 0.1).what();
  CHECK(has_words(words, {"overlaps wall 0", "use a stiffer material", "youngs_modulus = 5 Pa"}));
  CHECK(lacks(words, {"time_step", "smaller time step"}));
}

TEST_CASE("guard: what an observer has made no number is said to be so, at the step where it did") {
  const auto after = [](auto change) {
    auto sim = scene({{0, 0, 0}, {0.1, 0, 0}});
    sim.time_step = 1e-5;
    const auto error = failure(sim, 1e-3, [&](auto& s) {
      if (s.step() == 7) change(s);
    });
    CHECK(error.step == 7);
    const std::string words = error.what();
    CHECK(has_words(words, {"step 7", "must be finite", "an observer"}));
    CHECK(lacks(words, {"time step", "overlapping"}));
    return words;
  };
  CHECK(has_words(after([](auto& s) { s.gravity.x = nan; }),
                  {"Simulation::gravity = (nan, 0, -9.81) [m/s2]"}));
  CHECK(has_words(after([](auto& s) { s.engine().particles.motion[s.find(1)].vy = nan; }),
                  {"the velocity of particle 1 at (0.1, 0, "}));
  CHECK(has_words(after([](auto& s) { s.engine().particles.position[s.find(1)].x = nan; }),
                  {"the place of particle 1 is (nan, 0, "}));
}

TEST_CASE("guard: limits that an observer sets are checked") {
  // A comparison with NaN holds for no overlap: the guard would be off.
  const auto says = [](auto change) {
    auto sim = scene({{0, 0, 0}, {0.1, 0, 0}});
    sim.time_step = 1e-5;
    return refusal<silt::InputError>([&] { sim.run(1e-4, [&](auto& s) { change(s); }); });
  };
  CHECK(says([](auto& s) { s.guard.max_overlap = nan; }).find("Guard.max_overlap = nan") == 0);
  CHECK(says([](auto& s) { s.guard.max_travel = 0; }).find("Guard.max_travel = 0 [-] must") == 0);
  CHECK(says([](auto& s) {
          s.guard.domain = silt::Box{{1, 1, 1}, {-1, -1, -1}};
        }).find("guard.domain from (1, 1, 1) to (-1, -1, -1) [m] must have its min below") == 0);
}

TEST_CASE("time_step: without particles it is said that there are none") {
  auto sim = scene({});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  const auto words = refusal<InputError>([&] { sim.run(1e-3); });
  CHECK(has_words(words, {"cannot be chosen", "there are no particles", "add some, or an inlet"}));
  CHECK(lacks(words, {"gravity"}));
  sim.add_outlet({{-1, -1, -1}, {1, 1, 0}});
  sim.add_inlet(Box{{0, 0, 1e-2}, {1e-2, 1e-2, 2e-2}},
                {.radius = silt::uniform(0.9e-3, 1e-3), .density = 2500, .rate = 100});
  sim.run(1e-3);  // an inlet will bring some
  CHECK(sim.step() > 0);
}

TEST_CASE("time_step: the step that is chosen beside walls in rotation is not refused at once") {
  const auto drum = silt::Cylinder{{0, 0, -1}, {0, 0, 1}, 0.05, silt::Side::Inside};
  // A sphere on the axis: its centre feels no speed of the wall, its surface does.
  auto on_axis = scene({{0, 0, 0}});
  on_axis.gravity = {0, 0, 0};
  on_axis.add_wall(drum, rubber, silt::rotation({0, 0, 0}, {0, 0, 1}, 10));
  on_axis.run(0.01);
  CHECK(on_axis.step() > 0);
  auto beside = scene({{1e-12, 0, 0}});
  beside.gravity = {0, 0, 0};
  beside.add_wall(drum, rubber, silt::rotation({0, 0, 0}, {0, 0, 1}, 10));
  beside.run(0.01);
  CHECK(std::abs(beside.step_length() / on_axis.step_length() - 1) < 1e-6);

  // Walls so fast that a contact's 20th is longer than max_travel allows.
  auto fast = scene({{0, 0.04, 0}});
  fast.add_wall(drum, rubber, silt::rotation({0, 0, 0}, {0, 0, 1}, 5000));
  fast.run(1e-4);
  CHECK(fast.step_length() * 5000 * 0.041 < fast.guard.max_travel * 1e-3);
  CHECK(fast.step_length() * 5000 * 0.041 > 0.3 * fast.guard.max_travel * 1e-3);
}

TEST_CASE("time_step: a wall that turns ever faster is named where it stops the run") {
  auto sim = scene({{0, 0.02, 0}});
  sim.gravity = {0, 0, 0};
  sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, rubber);
  sim.add_wall(
      silt::Cylinder{{0, 0, -1}, {0, 0, 1}, 0.05, silt::Side::Inside}, rubber, [](double t) {
        return silt::rotation({0, 0, 0}, {0, 0, 1}, 1)(t < 0.01 ? 0.1 * t : 1e4 * (t - 0.01));
      });
  sim.guard.max_travel = 1e3;
  CHECK(has_words(failure(sim, 0.1).what(),
                  {"above its limit", "m/s (of wall 1, which was slower where the step was"}));
}

TEST_CASE(
    "simulation: walls, openings and materials that are not there are refused with their count") {
  auto sim = scene({{0, 0, 0}});
  sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, rubber);
  const auto words = [&](auto action) { return refusal<InputError>(action); };
  CHECK(words([&] { sim.wall(99); }) == "wall(99): there is 1 wall, counted from 0");
  CHECK(words([&] { sim.remove_wall(1); }) == "wall(1): there is 1 wall, counted from 0");
  CHECK(words([&] {
          sim.set_reference(1, {0, 0, 0});
        }) == "wall(1): there is 1 wall, counted from 0");
  CHECK(words([&] { sim.outlet(0); }) == "outlet(0): there are 0 outlets, counted from 0");
  CHECK(words([&] { sim.inlet(2); }) == "inlet(2): there are 0 inlets, counted from 0");
  CHECK(words([&] { sim.contacts().material(3); }) ==
        "material(3): there is 1 material, counted from 0");
  CHECK(sim.wall(0).surfaces.size() == 1);
  // What find() gives for a particle that has left is a place of none.
  for (const auto& said :
       {words([&] { sim.position(sim.find(7)); }), words([&] { sim.velocity(1); }),
        words([&] { sim.mass(1); }), words([&] { sim.radius(1); }), words([&] { sim.id(1); }),
        words([&] { sim.angular_velocity(1); })})
    CHECK(has_words(said, {"there is no particle at place 1", "rows() is 1"}));
}

TEST_CASE("simulation: particles too far from the origin for their size are refused") {
  // 1e-4 radii between numbers: 4.5e11 radii.
  const auto words = [](double x, double y, double r) {
    return refusal<InputError>([&] {
      silt::Particles<Sphere> p;
      p.add({.position = {x, y, 0}, .radius = r, .density = 2500});
    });
  };
  CHECK(has_words(words(1e10, 0, 1e-3),
                  {"particle 0: position = (1e+10, 0, 0) [m]", "2.22045e-06 m apart",
                   "a radius of 0.001 m", "to the origin"}));
  CHECK(has_words(words(0, -1e300, 1e-3), {"-1e+300"}));
  silt::Particles<Sphere> p;
  p.add({.position = {1e8, -1e8, 0}, .radius = 1e-3, .density = 2500});
  p.add({.position = {1e10, 0, 0}, .radius = 1, .density = 2500});
  CHECK(p.size() == 2);
  silt::Particles<silt::SuperEllipsoid> bodies;
  bodies.add_form({1e-3, 1e-3, 2e-3, 4});
  CHECK(has_words(refusal<InputError>([&] {
                    bodies.add({.position = {0, 0, 1e10}, .density = 2500});
                  }),
                  {"radius of 0.002"}));
  auto sim = scene({{0, 0, 0}});
  silt::Particles<Sphere> far;
  far.add({.position = {0, 0, 0.1}, .radius = 1e-3, .density = 2500});
  far[0].position.z = 1e10;  // not checked here, but where it is used
  CHECK(has_words(refusal<InputError>([&] { sim.add(far); }), {"to the origin"}));
  CHECK(sim.rows() == 1);
}

}  // namespace guard_words_test
