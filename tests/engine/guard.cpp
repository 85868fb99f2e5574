// silt - BSD-3-Clause, see LICENSE
// Runs that break a limit stop with a sentence: step, ids, position, and what to change. And the
// time step, which those limits are about.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include <engine/support.hpp>
#include <silt/contact/linear_spring.hpp>

#include "near.hpp"

namespace guard_test {

namespace {

using namespace engine_test;
using silt::InputError;
using silt::SimulationError;

struct Ball {
  Vec3d position, velocity{0, 0, 0};
  double radius = 1e-3;
};

auto scene(std::initializer_list<Ball> balls, const silt::VerletList<>& search = {}) {
  silt::Particles<Sphere> p;
  for (const auto& b : balls)
    p.add({.position = b.position, .radius = b.radius, .density = 2500, .velocity = b.velocity});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, search};
  sim.threads = 1;
  return sim;
}

/// A law whose force is no number.
struct NoForce {
  struct Material {
    double stiffness;  // [N/m]
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real k;
  };
  static Coefficients<double> mix(const Material& a, const Material&) { return {a.stiffness}; }
  template <class Real>
  static Real force(const silt::Contact<Real>& c, const Coefficients<Real>& p) {
    return p.k * sqrt(-c.overlap - Real(1));
  }
};

/// The SimulationError that a run ends with.
template <class Sim>
SimulationError failure(Sim& sim, double duration) {
  std::optional<SimulationError> caught;
  try {
    sim.run(duration);
  } catch (const SimulationError& error) {
    caught = error;
  }
  REQUIRE(caught.has_value());
  return *caught;
}

/// t_c = 2.943275 d_max/v of an elastic Hertz impact; seven digits are given.
double hertz_time(double E_eff, double R_eff, double m_eff, double v) {
  const double kH = 4.0 / 3.0 * E_eff * std::sqrt(R_eff);
  return 2.943275 * std::pow(1.25 * m_eff / kH, 0.4) * std::pow(v, -0.2);
}
constexpr double seven_digits = 1e-6;

}  // namespace

TEST_CASE("guard: spheres that press into each other too far stop the run, named with the step") {
  // The wall is far away: the sentence must not blame it.
  auto sim = scene({{{-1.01e-3, 0, 0}, {8, 0, 0}}, {{1.01e-3, 0, 0}}, {{0, 0, 9e-3}}});
  sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, rubber);
  const auto error = failure(sim, 1e-2);
  CHECK(has_words(
      error.what(),
      {silt::detail::sentence("step ", sim.step(), ", t = ", sim.time(), " s"), "particles 0 and 1",
       "guard.max_overlap = 0.3", "use a stiffer material or a lower speed, or start"}));
  // At the step that silt chose, no shorter one mends it.
  CHECK(std::string(error.what()).find("smaller time step") == std::string::npos);
  CHECK(error.step == sim.step());
  CHECK(error.particles == std::vector<silt::ParticleId>{0, 1});
  CHECK(norm(error.position) < 2e-3);
  CHECK(sim.peak_overlap() > 0.3);
}

TEST_CASE("guard: a smaller time step is advised for an overlap where it is long") {
  const auto balls = [] { return scene({{{-1.01e-3, 0, 0}, {8, 0, 0}}, {{1.01e-3, 0, 0}}}); };
  auto chosen = balls();
  chosen.run(0);
  const auto advised = [&](double share) {
    auto sim = balls();
    sim.time_step = share * chosen.step_length();
    const std::string words = failure(sim, 1e-2).what();
    return words.find("a lower speed or a smaller time step") != std::string::npos;
  };
  CHECK(advised(2.2));  // the limit: 2.5
  CHECK_FALSE(advised(0.99));
}

TEST_CASE("guard: spheres that overlap at the start are named although they fly apart in a step") {
  auto sim = scene({{{-0.6e-3, 0, 0}, {-1, 0, 0}}, {{0.6e-3, 0, 0}, {1, 0, 0}}});
  const auto error = failure(sim, 1e-2);
  CHECK(error.step == 0);
  CHECK(error.particles == std::vector<silt::ParticleId>{0, 1});
  CHECK(has_words(error.what(), {"step 0, t = 0 s", "particles 0 and 1", "overlap by 0.8",
                                 "start without overlaps"}));
}

TEST_CASE("guard: a sphere that presses into a wall too far is named, and so is the wall") {
  auto sim = scene({{{5e-3, 0, 1.1e-3}, {0, 0, -8}}, {{-5e-3, 0, 4e-3}}});
  sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, rubber);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  const auto error = failure(sim, 1e-2);
  CHECK(error.particles == std::vector<silt::ParticleId>{0});
  CHECK(error.position.x == near(5e-3));
  CHECK(has_words(error.what(), {"particle 0 at (0.005", "overlaps wall 1 by 0.",
                                 "guard.max_overlap = 0.3", "use a stiffer material"}));
}

TEST_CASE("guard: the limit of the overlap is the user's") {
  auto sim = scene({{{-1.01e-3, 0, 0}, {2, 0, 0}}, {{1.01e-3, 0, 0}}});
  sim.guard.max_overlap = 0.02;
  CHECK(has_words(failure(sim, 1e-2).what(), {"guard.max_overlap = 0.02"}));
  auto patient = scene({{{-1.01e-3, 0, 0}, {2, 0, 0}}, {{1.01e-3, 0, 0}}});
  patient.run(1e-2);
  CHECK(patient.peak_overlap() > 0.02);
}

TEST_CASE("guard: velocities that are no numbers stop the run, and the particle is named") {
  // Particle 0 has just left: until the next search its place in memory is no particle.
  auto sim = scene({{{0, 0, 0}, {1, 0, 0}}, {{0.1, 0, 0}, {1, 0, 0}}}, {.skin = 3e-3});
  sim.add_outlet({{0.5e-3, -1, -1}, {0.05, 1, 1}});
  sim.run(0.8e-3);
  REQUIRE(sim.size() == 1);
  REQUIRE(sim.rows() == 2);
  sim.engine().particles.motion[sim.find(1)].vy = std::numeric_limits<double>::quiet_NaN();
  const auto error = failure(sim, 1e-3);
  CHECK(error.particles == std::vector<silt::ParticleId>{1});
  CHECK(error.position.x == near(0.1).epsilon(0.1));
  CHECK(has_words(error.what(), {silt::text("step ", error.step), "the velocity of particle 1 at (",
                                 "nan", "must be finite", "the program between two runs"}));
}

TEST_CASE("guard: a law whose force is no number stops the run, and the particle is named") {
  const auto words = [](double max_travel) {
    silt::Particles<Sphere> p;
    p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500});
    p.add({.position = {2.05e-3, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {-1, 0, 0}});
    silt::Simulation sim{std::move(p), silt::Contacts<NoForce>{{1e3}}};
    sim.time_step = 1e-5;
    sim.guard.max_travel = max_travel;
    const auto error = failure(sim, 1e-3);
    CHECK(error.step >= 5);
    CHECK(error.particles.size() == 1);
    return std::string(error.what());
  };
  // Too long steps would have been seen before: no shorter one mends it.
  CHECK(has_words(words(0.3), {"is not finite near", "look at gravity and at the forces"}));
  CHECK(words(0.3).find("lower the time step") == std::string::npos);
  CHECK(has_words(words(10), {"lower the time step, as limits"}));
}

TEST_CASE("guard: speeds whose square overflows stop the run") {
  auto sim = scene({{{0, 0, 0}, {1, 0, 0}}});
  sim.gravity = {0, 0, 1e300};
  sim.time_step = 1e-6;
  CHECK(has_words(failure(sim, 1).what(), {"step 0", "overflow", "look at gravity"}));
}

TEST_CASE("guard: particles that [] has made impossible are refused by number and field") {
  const auto refused = [](auto change, const char* words) {
    silt::Particles<Sphere> p;
    p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500});
    p.add({.position = {1, 0, 0}, .radius = 1e-3, .density = 2500});
    change(p[1]);
    try {
      silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
      FAIL("not refused: ", words);
    } catch (const InputError& error) {
      CHECK(has_words(error.what(), {"particle 1: ", words}));
    }
  };
  refused([](auto& p) { p.radius = 0; }, "radius = 0 [m]");
  refused([](auto& p) { p.density = -1; }, "density = -1 [kg/m3]");
  refused([](auto& p) { p.position.y = std::numeric_limits<double>::quiet_NaN(); },
          "position = (1, nan, 0) [m]");
}

TEST_CASE("guard: a particle outside the domain is refused at the start and stops the run later") {
  auto sim = scene({{{0, 0, 0}, {1, 0, 0}}});
  sim.guard.domain = Box{{-1e-2, -1e-2, -1e-2}, {1e-2, 1e-2, 1e-2}};
  silt::Particles<Sphere> outside;
  outside.add({.position = {0, 0, 0.5}, .radius = 1e-3, .density = 2500});
  CHECK(has_words(refusal<InputError>([&] { sim.add(outside); }),
                  {"particle 0 at (0, 0, 0.5) m", "outside guard.domain"}));
  CHECK(sim.size() == 1);

  const auto error = failure(sim, 1);
  CHECK(error.particles == std::vector<silt::ParticleId>{0});
  CHECK(error.position.x > 1e-2);
  // Found at the next look at the lists: it has gone no further than the widest skin, a diameter.
  CHECK(error.position.x < 1.2e-2);
  CHECK(has_words(error.what(), {silt::text("step ", error.step), "particle 0 at (0.01",
                                 "close the walls, add an outlet", "enlarge the domain"}));

  auto late = scene({{{0, 0, 0.5}, {1, 0, 0}}});
  late.guard.domain = sim.guard.domain;  // set after the particles came
  CHECK(has_words(failure(late, 1).what(), {"step 0", "particle 0 at (0, 0, 0.5)"}));
}

TEST_CASE("guard: limits, gravity, duration and threads that make no sense are refused by name") {
  const auto refused = [](auto change, double duration = 1e-4) {
    auto sim = scene({{{0, 0, 0}, {1, 0, 0}}});
    change(sim);
    return refusal<InputError>([&] { sim.run(duration); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto same = [](auto&) {};
  CHECK(has_words(refused(same, -1), {"duration = -1 [s]"}));
  CHECK(has_words(refused(same, nan), {"duration = nan [s]"}));
  CHECK(
      has_words(refused([](auto& s) { s.guard.max_overlap = 0; }), {"Guard.max_overlap = 0 [-]"}));
  CHECK(has_words(refused([](auto& s) { s.guard.max_time_step = -1; }),
                  {"Guard.max_time_step = -1 [-]"}));
  const auto boxed = [&](const Box& domain) {
    return refused([&](auto& s) { s.guard.domain = domain; });
  };
  CHECK(has_words(boxed({{1, 1, 1}, {-1, -1, -1}}), {"guard.domain from (1, 1, 1) to"}));
  CHECK(has_words(boxed({{-1, -1, -1}, {1, nan, 1}}), {"must have its min below its max"}));
  CHECK(has_words(refused([&](auto& s) { s.gravity.y = nan; }), {"gravity = (0, nan, 0) [m/s2]"}));
  CHECK(has_words(refused([](auto& s) { s.time_step = 0; }), {"time_step = 0 [s]"}));
  CHECK(has_words(refused([&](auto& s) { s.time_step = nan; }), {"time_step = nan [s]"}));
  CHECK(has_words(refused([](auto& s) { s.threads = 0; }), {"threads = 0 must be in [1, 4096]"}));
}

namespace {

/// A rolling model whose couple is no number.
struct NoCouple {
  static constexpr bool is_rolling_model = true;
  struct Pair {};
  template <class Real>
  struct Coefficients {
    Real unused;
  };
  static Coefficients<double> mix(const Pair&) { return {0}; }
  static void check(const Pair&) {}
  template <class Real>
  static silt::Vec3<Real> torque(const silt::RollingContact<Real>& c, const Coefficients<Real>&) {
    const Real none = sqrt(-c.overlap - Real(1));
    return {none, none, none};
  }
};

silt::TriangleMesh square(double side) {
  const Vec3d a{-side, -side, 0}, b{side, -side, 0}, c{side, side, 0}, d{-side, side, 0};
  return silt::TriangleMesh({{a, b, c}, {a, c, d}});
}

/// A pit of n sides, each of slope 60 degrees, whose lowest point is the origin.
silt::TriangleMesh pit(int n, double width) {
  std::vector<std::array<Vec3d, 3>> soup;
  const auto corner = [&](int k) {
    const double phi = 2 * std::numbers::pi * k / n, r = width / std::cos(std::numbers::pi / n);
    return Vec3d{r * std::cos(phi), r * std::sin(phi), width * std::sqrt(3.0)};
  };
  for (int k = 0; k < n; ++k) soup.push_back({Vec3d{0, 0, 0}, corner(k), corner(k + 1)});
  return silt::TriangleMesh(soup);
}

}  // namespace

TEST_CASE(
    "guard: a particle that goes too far in a step stops the run before it touches anything") {
  // Its spring is so soft that the contact time sets no limit.
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 5.5e-3}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -300}});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpring>{{.stiffness = 1e-3}}};
  sim.add_wall(square(0.1), {.stiffness = 1e-3});
  sim.time_step = 2.5e-6;  // 0.75 mm a step
  const auto error = failure(sim, 1e-3);
  CHECK(error.step == 0);
  CHECK(error.particles == std::vector<silt::ParticleId>{0});
  CHECK(has_words(error.what(), {"step 0", "particle 0 at (0, 0, 0.00", "moves by 0.00075",
                                 "guard.max_travel = 0.3 of the smallest radius 0.001 m",
                                 "Simulation::time_step to less than 9.99e-07 s"}));
  // At the limit it may go on.
  auto slower = scene({{{0, 0, 0}, {1, 0, 0}}});
  slower.guard.max_travel = 0.01;
  slower.time_step = 0.99e-5;
  slower.run(1e-4);
  CHECK(slower.step() > 0);
}

TEST_CASE(
    "guard: a wall that goes too far in a step stops the run, whether the particles move or not") {
  auto sim = scene({{{0, 0, 0}}});
  sim.add_wall(square(0.1), rubber, [](double t) {
    return silt::Pose{{}, {0, 0, t < 5e-5 ? -0.01 : 0.01}};
  });
  sim.time_step = 1e-5;
  sim.guard.max_time_step = 1e3;
  const auto error = failure(sim, 1e-3);
  CHECK(error.step == 5);
  CHECK(error.particles.empty());
  CHECK(has_words(error.what(),
                  {"wall 0 moves by 0.02", "guard.max_travel = 0.3", "to less than 1.5e-07 s"}));
}

TEST_CASE("guard: a wall whose motion gives no pose stops the run, and the wall is named") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto sentence = [](const silt::Pose& late) {
    auto sim = scene({{{0, 0, 2e-3}, {0, 0, -0.1}}});
    sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, rubber);
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber,
                 [=](double t) { return t < 3e-5 ? silt::Pose{} : late; });
    sim.time_step = 1e-5;
    const auto error = failure(sim, 1e-3);
    CHECK(error.step == 3);
    return std::string(error.what());
  };
  CHECK(has_words(sentence({{}, {0, 0, nan}}),
                  {"step 3", "the motion of wall 1", "not finite", "add_wall"}));
  CHECK(has_words(sentence({{nan, 0, 0, 0}, {0, 0, 0}}), {"the motion of wall 1", "not finite"}));
  CHECK(has_words(sentence({{2, 0, 0, 0}, {0, 0, 0}}),
                  {"the motion of wall 1", "rotation", "not of length 1"}));
}

TEST_CASE("guard: angular velocities that are no numbers are found before observers see them") {
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 1.01e-3}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -1}});
  silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpring, NoCouple>{{1e4, 0.5}, {}}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {1e4, 0.5});
  const auto error = failure(sim, 2e-4);
  CHECK(error.particles == std::vector<silt::ParticleId>{0});
  CHECK(has_words(error.what(), {"the angular velocity of particle 0 is not finite near",
                                 "look at the law and the rolling model"}));
}

TEST_CASE("guard: limits with which a particle could come out behind a mesh are refused") {
  auto sim = scene({{{0, 0, 2e-3}, {0, 0, -1}}});
  sim.guard.max_overlap = 0.7;
  sim.run(0);
  sim.add_wall(square(0.1), rubber);
  CHECK(has_words(refusal<InputError>([&] { sim.run(0); }),
                  {"Guard.max_overlap = 0.7", "Guard.max_travel = 0.3", "less than 1 together",
                   "behind one unseen", "guard.through_meshes = true"}));
  sim.guard.through_meshes = true;
  sim.run(0);
  sim.guard.through_meshes = false;
  sim.guard.max_overlap = 0.69;
  sim.run(0);
}

TEST_CASE("guard: a sphere that touches a mesh in more places than are computed stops the run") {
  const auto fall = [](int sides) {
    auto sim = scene({{{0, 0, 2.05e-3}}});  // it touches at 2 mm
    sim.gravity = {0, 0, -9.81};
    sim.add_wall(pit(sides, 0.01), rubber);
    sim.run(0.01);
    return sim.position(0).z;
  };
  CHECK(fall(4) < 2e-3);
  std::optional<SimulationError> error;
  try {
    fall(5);
  } catch (const SimulationError& e) {
    error = e;
  }
  REQUIRE(error);
  CHECK(error->particles == std::vector<silt::ParticleId>{0});
  CHECK(norm(error->position - Vec3d{0, 0, 2e-3}) < 1e-4);
  CHECK(has_words(error->what(), {"particle 0 at (", "the mesh of wall 0", "more than 4 places",
                                  "larger smooth_angle"}));
}

TEST_CASE(
    "guard: an overlap is named where it was, though the sphere has flown on in the same step") {
  auto sim = scene({{{0, 0, 0.65e-3}}, {{0.01, 0, 5e-3}}});
  sim.add_wall(square(0.1), rubber);
  sim.time_step = 1e-3;
  sim.guard.max_time_step = 1e3;
  const auto error = failure(sim, 1e-2);
  CHECK(error.particles == std::vector<silt::ParticleId>{0});
  CHECK(error.position.z == near(0.65e-3).epsilon(1e-6));
  CHECK(has_words(error.what(), {"particle 0 at (0, 0, 0.0006", "overlaps wall 0 by 0.35"}));
}

TEST_CASE("time_step: the speed of a moving wall counts as that of particles") {
  auto flies = scene({{{0, 0, 0}, {0, 0, 5}}});
  flies.run(0);
  auto hit = scene({{{0, 0, 0}}});
  hit.add_wall(silt::Plane{{0, 0, -0.01}, {0, 0, 1}}, rubber, silt::translation({0, 0, 5}));
  hit.run(0);
  CHECK(near_relative(hit.step_length(), flies.step_length(), 1e-9));
  // One that gets fast later stops the run.
  auto late = scene({{{0, 0, 0}, {0, 0, 1}}});
  late.add_wall(silt::Plane{{0, 0, -0.01}, {0, 0, 1}}, rubber, [](double t) {
    return silt::Pose{{}, {0, 0, -100 * std::max(t - 1e-4, 0.0)}};
  });
  late.run(0);  // the wall has 26 m/s on the mean of the step in which it starts
  late.time_step = 0.9 * *late.time_step_limit(1);
  CHECK(has_words(failure(late, 1e-3).what(), {"is above its limit", "at the largest speed 26"}));
}

TEST_CASE("time_step: a moving wall bounds the scene where it is, not where it was drawn") {
  auto moved = scene({{{0, 0, 0.3}}});
  moved.gravity = {0, 0, -9.81};
  moved.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber, [](double) {
    return silt::Pose{{}, {0, 0, 0.1}};
  });
  moved.run(0);
  auto drawn = scene({{{0, 0, 0.3}}});
  drawn.gravity = {0, 0, -9.81};
  drawn.add_wall(silt::Plane{{0, 0, 0.1}, {0, 0, 1}}, rubber);
  drawn.run(0);
  CHECK(moved.step_length() == near(drawn.step_length()).epsilon(1e-12));
}

TEST_CASE("time_step: with gravity and walls aslant alone it is that of a fall by a diameter") {
  auto sim = scene({{{0, 0, 2e-3}}});
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 1}}, rubber);
  sim.run(0);
  auto flies = scene({{{0, 0, 0}, {0, 0, std::sqrt(2 * 9.81 * 2e-3)}}});
  flies.run(0);
  CHECK(near_relative(sim.step_length(), flies.step_length(), 1e-9));
}

TEST_CASE("time_step: a large light sphere may make shorter contacts than a small heavy one") {
  const auto chosen = [](bool with_heavy) {
    silt::Particles<Sphere> p;
    p.add({.position = {0, 0, 0}, .radius = 5e-3, .density = 5, .velocity = {0, 0, 1}});
    if (with_heavy) p.add({.position = {0.1, 0, 0}, .radius = 5e-4, .density = 7800});
    silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
    sim.run(0);
    return sim.step_length();
  };
  CHECK(near_relative(chosen(true), chosen(false), 1e-12));
}

TEST_CASE("time_step: the automatic step is a 20th of the closed form's shortest contact") {
  // Spheres of two sizes, of one density; G = E/(2 (1 + nu)).
  const double E = 1e6 / (2 * (1 - 0.09));
  const double m = 2500 * 4.0 / 3.0 * std::numbers::pi * 1e-9;  // [kg] of the smaller one
  const std::initializer_list<Ball> balls = {{{0, 0, 0.1}, {0, 0, 3}, 1e-3},
                                             {{0, 0, 0.2}, {0, 0, 1}, 2e-3}};
  auto free = scene(balls);
  free.run(0);
  CHECK(near_relative(free.step_length(), hertz_time(E, 0.5e-3, m / 2, 3) / 20, seven_digits));
  // The limit is an eighth of the same.
  CHECK(near_relative(*free.time_step_limit(3), free.step_length() * 20 / 8, 1e-12));

  // A stiffer wall: E* of the pair of materials, and the sphere's own mass and radius.
  const HertzMindlin::Material steel{.youngs_modulus = 1e9, .poisson_ratio = 0.2};
  const double E_wall = 1 / ((1 - 0.09) / 1e6 + (1 - 0.04) / 1e9);
  auto contacts = silt::Contacts<HertzMindlin>{rubber};
  contacts.set_pair(rubber, steel, {.restitution = 0.5, .friction = 0.1});
  silt::Particles<Sphere> p;
  p.add({.position = {0, 0, 0.1}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, 3}});
  silt::Simulation walled{std::move(p), contacts, silt::VerletList<>{}};
  walled.add_wall(silt::Cylinder{{0, 0, 0}, {0, 0, 2}, 1, silt::Side::Inside}, steel);
  walled.run(0);
  CHECK(near_relative(walled.step_length(), hertz_time(E_wall, 1e-3, m, 3) / 20, seven_digits));

  // Gravity: the speed of a fall through the scene, which is 2 m high.
  silt::Simulation heavy{
      silt::Particles<Sphere>{}.add({.position = {0, 0, 0.1}, .radius = 1e-3, .density = 2500}),
      contacts, silt::VerletList<>{}};
  heavy.gravity = {0, 0, -9.81};
  heavy.add_wall(silt::Cylinder{{0, 0, 0}, {0, 0, 2}, 1, silt::Side::Inside}, steel);
  heavy.run(0);
  CHECK(near_relative(heavy.step_length(),
                      hertz_time(E_wall, 1e-3, m, std::sqrt(2 * 9.81 * 2)) / 20, seven_digits));
}

TEST_CASE("time_step: a fall onto a plane is the height above it, whatever else is infinite") {
  auto sim = scene({{{0, 0, 0.3}}});
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0.1}, {0, 0, 1}}, rubber);
  sim.run(0);
  auto moving = scene({{{0, 0, 0}, {std::sqrt(2 * 9.81 * 0.2), 0, 0}}});
  moving.run(0);
  CHECK(sim.step_length() == near(moving.step_length()).epsilon(1e-12));
}

TEST_CASE("time_step: a step above the limit is refused at the start, with the limit") {
  auto sim = scene({{{0, 0, 0}, {1, 0, 0}}});
  sim.run(0);
  const double limit = sim.step_length() * 20 / 8;
  auto above = scene({{{0, 0, 0}, {1, 0, 0}}});
  above.time_step = 1.001 * limit;
  CHECK(has_words(refusal<InputError>([&] { above.run(1e-3); }),
                  {"Simulation::time_step = ", "is above the limit ", "guard.max_time_step = 0.125",
                   "at 1 m/s", "lower it, leave it out"}));
  CHECK(above.step() == 0);
  auto below = scene({{{0, 0, 0}, {1, 0, 0}}});
  below.time_step = 0.999 * limit;
  below.run(1e-3);
  CHECK(below.step() > 0);
}

TEST_CASE("time_step: particles that speed up until the step is too long stop the run") {
  auto sim = scene({{{0, 0, 0}, {1, 0, 0}}});
  sim.gravity = {10, 0, 0};  // nothing says how far it may fall
  sim.run(0);
  auto fast = scene({{{0, 0, 0}, {1, 0, 0}}});
  fast.gravity = sim.gravity;
  fast.time_step = 0.9 * sim.step_length() * 20 / 8;
  const auto error = failure(fast, 1);
  // The limit falls as v^-1/5: at 0.9^-5 = 1.69 m/s; speeds are looked at when they grew by 5 %.
  CHECK(error.step * fast.step_length() * 10 + 1 > 1.69);
  CHECK(error.step * fast.step_length() * 10 + 1 < 1.69 * 1.06);
  CHECK(has_words(error.what(), {silt::text("step ", error.step), "the time step ",
                                 "is above its limit", "at the largest speed 1.",
                                 "set a smaller Simulation::time_step or a softer material"}));
}

// Catches a step for a small gravity that is kept for a large one, in which particles are soon too
// fast.
TEST_CASE("time_step: a larger gravity in a later run chooses it anew") {
  const auto after = [](double g, bool given) {
    silt::Particles<silt::Sphere> p;
    p.add({.position = {0, 0, 0.2}, .radius = 1e-3, .density = 2500});
    silt::Simulation sim{
        std::move(p), silt::Contacts<HertzMindlin>{{.youngs_modulus = 1e7, .poisson_ratio = 0.3}}};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, sim.contacts().material(0));
    sim.gravity = {0, 0, -1e-4};
    if (given) sim.time_step = 1e-6;
    sim.run(1e-3);
    const double first = sim.step_length();
    sim.gravity = {0, 0, -g};
    sim.run(0.01);
    return sim.step_length() / first;
  };
  CHECK(after(1000, false) == near(std::pow(1e-7, 0.1)).epsilon(0.02));  // Hertz: T ~ v^(-1/5)
  CHECK(after(1e-4, false) == 1);
  CHECK(after(1000, true) == 1);
}

TEST_CASE("time_step: where nothing moves it cannot be chosen, and the sentence says what to set") {
  auto sim = scene({{{0, 0, 0}}});
  CHECK(has_words(refusal<InputError>([&] { sim.run(1e-3); }),
                  {"the time step cannot be chosen", "nothing moves", "set sim.gravity",
                   "Simulation::time_step"}));
  sim.time_step = 1e-5;
  sim.run(1e-3);
  CHECK(sim.step() == 100);
}

TEST_CASE("time_step: where all particles are fixed that is said") {
  silt::Particles<silt::Sphere> still;
  still.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .fixed = true});
  silt::Simulation sim{std::move(still), silt::Contacts<HertzMindlin>{rubber}};
  sim.gravity = {0, 0, -9.81};
  CHECK(has_words(
      refusal<InputError>([&] { sim.run(1e-3); }),
      {"the time step cannot be chosen", "all particles are fixed", "Simulation::time_step"}));
}

TEST_CASE("time_step: with several materials what walls alone are made of does not shorten it") {
  const HertzMindlin::Material steel{.youngs_modulus = 1e9, .poisson_ratio = 0.2};
  const auto time_step = [&](auto contacts, bool steel_sphere) {
    contacts.set_pair(rubber, steel, {.restitution = 0.5, .friction = 0.1});
    silt::Particles<Sphere> p;
    p.add({.position = {0, 0, 0.1}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, 3}});
    if (steel_sphere)
      p.add({.position = {0, 0, 0.5}, .radius = 1e-3, .density = 2500, .material = 1});
    silt::Simulation sim{std::move(p), contacts};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, steel);
    sim.run(0);
    return sim.step_length();
  };
  using Several = silt::Contacts<HertzMindlin, silt::SeveralMaterials>;
  const double one = time_step(silt::Contacts<HertzMindlin>{rubber}, false);
  CHECK(time_step(Several{{rubber}}, false) == one);
  CHECK(time_step(Several{{rubber}}, true) < 0.1 * one);
}

}  // namespace guard_test
