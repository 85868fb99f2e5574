// silt - BSD-3-Clause, see LICENSE
//
// Bodies that spin fast: the speed of their tips counts wherever a speed counts - the time step,
// its limit and the way in a step - so that none passes through others unseen.
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <silt/io/checkpoint.hpp>
#include <silt/shape/compound.hpp>
#include <silt/shape/mix.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/shape/surface_mesh.hpp>
#include <silt/silt.hpp>

#include "engine/body_totals.hpp"
#include "engine/stones.hpp"
#include "near.hpp"

namespace fast_spins_test {

namespace {

using namespace engine_test;
using silt::InputError;
using silt::Particles;
using silt::SimulationError;
using silt::SuperEllipsoid;
using Any = silt::Mix<silt::Sphere, silt::MultiSphere, SuperEllipsoid, silt::Polyhedron,
                      silt::Compound<silt::Polyhedron>>;

constexpr double b = 1e-3, half = 30 * b;  // [m] semi-axes of the needle
const SuperEllipsoid needle{.a = b, .b = b, .c = half};

HertzMindlin::Material elastic(double youngs_modulus) {
  return {.youngs_modulus = youngs_modulus, .poisson_ratio = 0.3, .restitution = 1, .friction = 0};
}
template <class Shape>
auto simulation(Particles<Shape> bodies, double youngs_modulus) {
  silt::Simulation sim{std::move(bodies), silt::Contacts<HertzMindlin>{elastic(youngs_modulus)}};
  sim.threads = 1;
  return sim;
}

/// Forms of all kinds, about 1 mm in size: random super-ellipsoids, hulls, compounds,
/// multi-spheres.
Any random_form(silt::Random& random) {
  const auto size = [&] { return b * std::exp(random.uniform(-1.5, 1.5)); };
  const auto box = [&] { return block(size(), size(), size()); };
  switch (static_cast<int>(random.uniform(0, 5))) {
    case 0:
      return SuperEllipsoid{.a = size(), .b = size(), .c = size()};
    case 1:
      return SuperEllipsoid{.a = size(),
                            .b = size(),
                            .c = size(),
                            .s1 = random.uniform(2, 8),
                            .s2 = random.uniform(2, 8)};
    case 2: {
      std::vector<Vec3d> points;
      for (int k = 0; k < 12; ++k)
        points.push_back(
            {random.uniform(-1, 1) * b, random.uniform(-1, 1) * b, random.uniform(-3, 3) * b});
      return silt::Polyhedron::from_points(points);
    }
    case 3:
      return silt::Compound<silt::Polyhedron>{{{box(), {0, 0, 0}}, {box(), {0.5 * b, 0.3 * b, b}}}};
    default:
      return silt::MultiSphere{{{{0, 0, 0}, b}, {{b, 0, 0}, 0.7 * b}, {{0, 0, size()}, b}}};
  }
}

/// The error of type E that a run ends with; none if it comes to its end.
template <class Sim>
std::optional<SimulationError> stop_of(Sim& sim, double duration) {
  try {
    sim.run(duration);
  } catch (const SimulationError& error) {
    return error;
  }
  return std::nullopt;
}

/// A needle that spins with 500 m/s at its tips sweeps over a bead at `place` of its half length,
/// `phase` [rad] ahead of it.
auto sweep(double youngs_modulus, double place, double phase) {
  Particles<SuperEllipsoid> bodies;
  bodies.add_form(needle), bodies.add_form({.a = b, .b = b, .c = b});
  bodies.add({.position = {0, 0, 0}, .density = 2500, .angular_velocity = {0, 500 / half, 0}});
  bodies.add({.form = 1,
              .position = place * half * Vec3d{std::sin(phase), 0, std::cos(phase)},
              .density = 2500});
  return simulation(std::move(bodies), youngs_modulus);
}
constexpr double quarter_turn = 0.5 * std::numbers::pi * half / 500;  // [s]

}  // namespace

// A step that knew the speed of the centres alone let the needle of E = 1e7 Pa go by 5.9 mm at its
// tips in a step: in most of these phases through the bead.
TEST_CASE("fast_spins: a needle whose tips move at 500 m/s passes a bead in none of 24 phases") {
  int stopped = 0;
  for (int k = 0; k < 24; ++k) {
    auto soft = sweep(1e7, 0.95, 0.2 + k / 24.0 * 5.9e-3 / half);
    const auto error = stop_of(soft, quarter_turn);
    stopped +=
        error && has_words(error->what(), {"the tips of particle 0 at", "guard.max_travel = 0.3",
                                           "Simulation::time_step to less than",
                                           "or lower the spin", "by its spin of 1666"});
  }
  CHECK(stopped == 24);
}

TEST_CASE("fast_spins: at its own step the needle hits the bead as it should, in all 24 phases") {
  double energy = 0, momentum = 0, angular = 0, apart = 0, least = 1e9;
  for (int k = 0; k < 24; ++k) {
    const double phase = 0.2 + 0.01 * k;
    const auto hit = [&](double share) {
      auto sim = sweep(2e11, 0.8, phase);
      sim.run(0);
      sim.time_step = share * sim.step_length();
      const auto before = totals(sim);
      sim.run(quarter_turn / 4);
      const auto after = totals(sim);
      const double p = sim.mass(sim.find(1)) * 500;  // [kg m/s]
      energy = std::max(energy, std::abs(after.energy / before.energy - 1));
      momentum = std::max(momentum, norm(after.momentum - before.momentum) / p);
      angular = std::max(angular, norm(after.angular - before.angular) / (p * half));
      return sim.velocity(sim.find(1));
    };
    const Vec3d v = hit(1);
    least = std::min(least, norm(v));
    if (k % 6 == 0) apart = std::max(apart, norm(v - hit(0.25)) / norm(v));
  }
  CHECK(least > 400);       // [m/s] all were hit: 0.8 * 500 m/s is the needle's own speed there
  CHECK(energy < 2e-4);     // second order in a 20th of a contact; 7e-5 was computed
  CHECK(apart < 1e-3);      // likewise
  CHECK(momentum < 1e-12);  // roundings of some 1000 steps
  CHECK(angular < 1e-11);   // arms of half a step apart are exact: forces act at one point
}

TEST_CASE("fast_spins: the chosen step is that of a body whose centre is as fast as the tips") {
  const auto within = [](double value, double error) { return near(value).epsilon(error); };
  const auto step = [](auto shape, const Vec3d& v, const Vec3d& w) {
    Particles<decltype(shape)> one;
    one.add_form(shape);
    one.add({.position = {0, 0, 0},
             .radius = half,
             .density = 2500,
             .velocity = v,
             .angular_velocity = w});
    auto sim = simulation(std::move(one), 1e9);
    sim.guard.max_travel = 1e9;  // soft enough to be seen here
    sim.run(0);
    return sim.step_length();
  };
  // The normal speed of an ellipse of half axes a, b that turns is w (a - b) at most; the lever is
  // the widest of 1000 normals, within 1 % there, of which the step knows a fifth.
  const Vec3d slow{1, 0, 0};
  CHECK(step(needle, slow, {0, 500 / half, 0}) ==
        within(step(needle, {1 + 500 * (1 - b / half), 0, 0}, {0, 0, 0}), 0.003));
  // About its axis it moves no surface, nor does a disc, nor a ball.
  CHECK(step(needle, slow, {0, 0, 1e6}) == within(step(needle, slow, {0, 0, 0}), 1e-9));
  const SuperEllipsoid disc{.a = 30 * b, .b = 30 * b, .c = b};
  CHECK(step(disc, slow, {0, 0, 1e6}) == within(step(disc, slow, {0, 0, 0}), 1e-9));
  CHECK(step(Any{silt::Sphere{}}, slow, {1e6, 0, 0}) ==
        within(step(Any{silt::Sphere{}}, slow, {0, 0, 0}), 1e-9));
  // A dumbbell moves the centres of its balls.
  const silt::MultiSphere dumbbell{{{{-b, 0, 0}, b}, {{b, 0, 0}, b}}};
  CHECK(step(dumbbell, slow, {0, 100 / (0.5 * half), 0}) ==
        within(step(dumbbell, {101, 0, 0}, {0, 0, 0}), 1e-9));
}

TEST_CASE("fast_spins: a step that the spin makes too long is refused, and the sentence names it") {
  const auto scene = [](double spin) {
    Particles<SuperEllipsoid> one;
    one.add_form(needle);
    one.add({.position = {0, 0, 0},
             .density = 2500,
             .velocity = {1, 0, 0},
             .angular_velocity = {0, spin, 0}});
    return simulation(std::move(one), 1e9);
  };
  auto slow = scene(0);
  slow.run(0);
  const auto refused = [&](double spin) {
    auto sim = scene(spin);
    sim.time_step = 0.99 * 20 / 8 * slow.step_length();
    return refusal<InputError>([&] { sim.run(0); });
  };
  CHECK(refused(0) == "");
  CHECK(has_words(refused(500 / half), {"Simulation::time_step = ", "[s] is above the limit",
                                        "of the tips of particle 0", "its velocity of 1 m/s and 48",
                                        "m/s by its spin of 16666.7"}));
}

TEST_CASE("fast_spins: a needle that a blow makes spin stops a run whose step is too long then") {
  Particles<SuperEllipsoid> bodies;
  bodies.add_form(needle), bodies.add_form({.a = 5 * b, .b = 5 * b, .c = 5 * b});
  bodies.add({.position = {0, 0, 0}, .density = 2500});
  bodies.add(
      {.form = 1, .position = {6.5 * b, 0, 0.9 * half}, .density = 25000, .velocity = {-1, 0, 0}});
  auto sim = simulation(std::move(bodies), 1e7);
  sim.run(0);
  // The tip leaves with up to twice the speed of the blow; the limit falls with its fifth root.
  sim.time_step = 0.99 * 20 / 8.0 * sim.step_length();
  const auto error = stop_of(sim, 0.01);
  REQUIRE(error);
  CHECK(has_words(error->what(), {"is above its limit", "at the largest speed 1.",
                                  "of the tips of particle 0", "rad/s), guard.max_time_step"}));
}

/// Largest normal speed [m/s] of the surface of a form that turns by w [rad/s], both in the frame
/// that it was given in.
double speed_of(const Any& form, const silt::MassProperties& mass, const Vec3d& w,
                silt::Random& random) {
  double most = 0;
  const auto look = [&](const Vec3d& point, const Vec3d& normal) {
    most = std::max(most, std::abs(dot(cross(w, point - mass.centroid), normalised(normal))));
  };
  const auto& of = form.shape;
  if (const auto* s = std::get_if<SuperEllipsoid>(&of)) {
    const auto f = [&](const Vec3d& p) {
      const double round =
          std::pow(std::abs(p.x / s->a), s->s2) + std::pow(std::abs(p.y / s->b), s->s2);
      return std::pow(round, s->s1 / s->s2) + std::pow(std::abs(p.z / s->c), s->s1);
    };
    for (int k = 0; k < 3000; ++k) {
      const Vec3d u = rotate(silt::random_orientation(random), Vec3d{0, 0, 1});
      Vec3d p{s->a * u.x, s->b * u.y, s->c * u.z};
      p = std::pow(f(p), -1 / s->s1) * p;
      const double h = 1e-4 * std::min({s->a, s->b, s->c});
      look(p, {f(p + Vec3d{h, 0, 0}) - f(p - Vec3d{h, 0, 0}),
               f(p + Vec3d{0, h, 0}) - f(p - Vec3d{0, h, 0}),
               f(p + Vec3d{0, 0, h}) - f(p - Vec3d{0, 0, h})});
    }
  } else if (const auto* balls = std::get_if<silt::MultiSphere>(&of)) {
    for (const auto& ball : balls->balls)
      most = std::max(most, norm(cross(w, ball.centre - mass.centroid)));
  } else {  // flat faces: the speed is the largest at a corner
    const auto mesh = surface_of(form);
    for (const auto& t : mesh.triangles) {
      const Vec3d p[3] = {mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]};
      const Vec3d n = cross(p[1] - p[0], p[2] - p[0]);
      if (norm(n) > 1e-9 * b * b)
        for (const Vec3d& corner : p) look(corner, n);
    }
  }
  return most;
}

TEST_CASE("fast_spins: no surface moves faster along its normal than the speed of the tips says") {
  silt::Random random(7);
  double most = 0, widest = 0;
  for (int k = 0; k < 60; ++k) {
    const silt::BodyForm<Any> form{random_form(random)};
    silt::detail::Body body{};
    body.lever = form.lever;
    for (int draw = 0; draw < 20; ++draw) {
      Vec3d w = rotate(silt::random_orientation(random), Vec3d{0, 0, 1});
      if (draw < 3) w = {draw == 0 ? 1.0 : 0.0, draw == 1 ? 1.0 : 0.0, draw == 2 ? 1.0 : 0.0};
      const double speed = speed_of(form.shape, form.mass, rotate(form.mass.axes, w), random);
      most = std::max(most, speed / body.tip_speed(w));
      widest = std::max(widest, body.tip_speed(w) / speed);
    }
  }
  MESSAGE("true over bound at most " << most << ", bound over true at most " << widest);
  CHECK(most < 1.1);  // as BodyForm::lever says
  CHECK(widest < 4);  // a sum over the axes; no bound that is far too wide would do
}

// Each either ends as one in steps an eighth as long does, with its energy, or is stopped.
TEST_CASE("fast_spins: random bodies that spin fast hit a bead, or are stopped") {
  silt::Random random(11);
  int ran = 0, stopped = 0, hit = 0;
  double energy = 0;
  for (int k = 0; k < 40; ++k) {
    const Any form = random_form(random);
    const silt::BodyForm<Any> of{form};
    const double tips = std::exp(random.uniform(1, 6)), modulus = std::exp(random.uniform(17, 25));
    const double radius = of.radius * random.uniform(0.1, 0.5);
    const Vec3d axis = rotate(silt::random_orientation(random), Vec3d{0, 0, 1});
    const auto from = silt::random_orientation(random);
    Vec3d away = rotate(silt::random_orientation(random), Vec3d{0, 0, 1});
    away = normalised(away - 0.9 * dot(away, axis) * axis);
    // Just out of reach at the start, so that a tip comes round: it drifts in by a radius a turn.
    const double turn = 2 * std::numbers::pi * of.radius / tips;  // [s]
    const auto scene = [&] {
      Particles<Any> bodies;
      bodies.add_form(form), bodies.add_form(silt::Sphere{});
      bodies.add({.position = {0, 0, 0},
                  .orientation = from,
                  .density = 2500,
                  .angular_velocity = (tips / of.radius) * axis});
      bodies.add({.form = 1,
                  .position = 1.01 * (of.radius + radius) * away,
                  .radius = radius,
                  .density = 2500,
                  .velocity = -(radius / turn) * away});
      return simulation(std::move(bodies), modulus);
    };
    auto sim = scene(), fine = scene();
    if (stop_of(sim, 0)) {
      ++stopped;
      continue;
    }
    const double before = totals(sim).energy, was = norm(sim.velocity(sim.find(1)));
    if (stop_of(sim, 2 * turn)) {
      ++stopped;
      continue;
    }
    ++ran;
    fine.time_step = sim.step_length() / 8;
    const bool met = std::abs(norm(sim.velocity(sim.find(1))) / was - 1) > 1e-9;
    if (met) ++hit, energy = std::max(energy, std::abs(totals(sim).energy / before - 1));
    if (!met && !stop_of(fine, 2 * turn)) {
      CAPTURE(k);
      CHECK(norm(fine.velocity(fine.find(1))) == near(was).epsilon(1e-9));  // it had not been there
    }
  }
  MESSAGE(ran << " ran, " << hit << " hit, " << stopped << " stopped, energy " << energy);
  CHECK(hit >= 8);
  CHECK(ran + stopped == 40);
  CHECK(energy < 5e-3);
}

// A step that knew the speed of the centre alone, at rest, took the fall's.
TEST_CASE("fast_spins: a spinning brick does not sweep through a mesh unseen") {
  int stopped = 0, ran = 0;
  double energy = 0, behind = 0;
  for (const double youngs_modulus : {1e7, 2e11})
    for (int k = 0; k < 12; ++k) {
      Particles<silt::Polyhedron> one;
      one.add_form(block(1e-3, 1e-3, 20e-3));
      const double spin = 300 / 20e-3;
      one.add({.position = {0, 0, 12e-3},
               .orientation = silt::rotation_about({0, 1, 0}, 0.5 * std::numbers::pi + 0.01 * k),
               .density = 2500,
               .velocity = {0, 0, -1},
               .angular_velocity = {0, spin, 0}});
      auto sim = simulation(std::move(one), youngs_modulus);
      const double s = 1;
      sim.add_wall(silt::TriangleMesh({std::array<Vec3d, 3>{{{-s, -s, 0}, {s, -s, 0}, {s, s, 0}}},
                                       {{{-s, -s, 0}, {s, s, 0}, {-s, s, 0}}}}),
                   elastic(youngs_modulus));
      std::optional<SimulationError> error = stop_of(sim, 0);
      const double before = totals(sim).energy;
      if (!error) error = stop_of(sim, 0.4 * std::numbers::pi / spin);
      if (error) {
        ++stopped;
        continue;
      }
      ++ran;
      energy = std::max(energy, std::abs(totals(sim).energy / before - 1));
      behind = std::max(behind, -sim.velocity(0).z);  // [m/s] it has not been thrown up
    }
  MESSAGE(ran << " ran, " << stopped << " stopped, energy " << energy);
  CHECK(ran >= 6);
  CHECK(stopped >= 6);
  CHECK(energy < 2e-3);
  CHECK(behind == 0);
}

TEST_CASE("fast_spins: angular velocities of bodies that are no numbers stop the run at once") {
  Particles<SuperEllipsoid> one;
  one.add_form(needle);
  one.add({.position = {0, 0, 0}, .density = 2500, .velocity = {1, 0, 0}});
  auto sim = simulation(std::move(one), 1e9);
  sim.run(0);
  sim.engine().mover.bodies[0].momentum.x = NAN;
  const auto error = stop_of(sim, 1e-4);
  REQUIRE(error);
  CHECK(error->step <= 1);
  CHECK(has_words(error->what(), {"the angular velocity of particle 0 is not finite"}));
}

TEST_CASE("fast_spins: a checkpoint keeps the levers, and refuses those of another size") {
  Particles<SuperEllipsoid> one;
  one.add_form(needle);
  one.add({.position = {0, 0, 0}, .density = 2500, .angular_velocity = {0, 1000, 0}});
  auto sim = simulation(one, 1e9), again = simulation(one, 1e9);
  sim.run(1e-4);
  silt::save_checkpoint(sim, "fast_spins.silt");
  silt::load_checkpoint(again, "fast_spins.silt");
  CHECK(again.engine().largest_speed == sim.engine().largest_speed);
  CHECK(again.engine().mover.bodies[0].lever == sim.engine().mover.bodies[0].lever);
  again.engine().mover.bodies[0].lever.y *= 0.5;
  silt::save_checkpoint(again, "fast_spins.silt");
  CHECK(has_words(refusal<silt::FileError>([&] { load_checkpoint(sim, "fast_spins.silt"); }),
                  {"body 0: lever", "does not match its form"}));
  std::remove("fast_spins.silt");
}

// Bodies are looked at where forces acted on them, not where they have flown since.
TEST_CASE("fast_spins: a deep contact that is gone in the same step is still named") {
  Particles<SuperEllipsoid> two;
  two.add_form({.a = b, .b = b, .c = 2 * b});
  two.add({.position = {-0.6 * b, 0, 0}, .density = 2500, .velocity = {-100, 0, 0}});
  two.add({.position = {0.6 * b, 0, 0},
           .density = 2500,
           .velocity = {100, 0, 0},
           .angular_velocity = {0, 0, 3e4}});
  auto sim = simulation(std::move(two), 1e6);
  sim.guard.max_time_step = 1e3;
  sim.time_step = 1e-5;
  const auto error = stop_of(sim, 1e-3);
  REQUIRE(error);
  CHECK(error->particles == std::vector<silt::ParticleId>{0, 1});
  CHECK(has_words(error->what(), {"step 0, t = 0 s", "particles 0 and 1", "overlap by 0.8",
                                  "guard.max_overlap = 0.3"}));
}

TEST_CASE("fast_spins: a deep contact of parts that turn away is told without names") {
  Particles<silt::MultiSphere> two;
  two.add_form({{{{0, 0, 0}, b}, {{5 * b, 0, 0}, b}}});
  two.add_form({{{{0, 0, 0}, b}}});
  // Half a turn in a step: the part that was in the other one is on the far side.
  two.add({.position = {0, 0, 0}, .density = 2500, .angular_velocity = {0, 0, 3e5}});
  two.add({.form = 1, .position = {2.5 * b, 1.2 * b, 0}, .density = 2500});
  auto sim = simulation(std::move(two), 1e6);
  sim.guard.max_time_step = 1e3;
  sim.time_step = 1e-5;
  const auto error = stop_of(sim, 1e-3);
  REQUIRE(error);
  CHECK(has_words(error->what(), {"step 0, t = 0 s", "overlapped by 0.8", "above the limit 0.3",
                                  "have parted within the step"}));
}

}  // namespace fast_spins_test
