// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include <unistd.h>

#include <silt/silt.hpp>

#include "near.hpp"

namespace integrators_test {

namespace {

// Nothing is damped at restitution 1, so that it makes no difference where the damping ends.
using Spring = silt::BasicLinearSpring<silt::DampingEnd::ZeroOverlap>;

constexpr double k = 1e3, radius = 1e-3, density = 2500, g = 9.81;
const double mass = density * 4 / 3 * std::numbers::pi * radius * radius * radius;
const double omega = std::sqrt(k / mass);

/// The error of place and velocity, over the amplitude, of a sphere that swings in its linear
/// spring on a plane and never leaves it: smooth. Damping ratio zeta.
template <class Integrator>
double error_of_swing(int steps_a_period, double restitution) {
  const double rest = mass * g / k, amplitude = 0.3 * rest;
  silt::Particles<silt::Sphere> spheres;
  spheres.add({{0, 0, radius - rest + amplitude}, radius, density});
  silt::Simulation sim{spheres, silt::Contacts<Spring>{{k, restitution}}, Integrator{}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {k, restitution});
  sim.gravity = {0, 0, -g};
  const double period = 2 * std::numbers::pi / omega;
  sim.time_step = period / steps_a_period;
  double worst = 0;
  const double L = -std::log(restitution);
  const double zeta = L / std::sqrt(std::numbers::pi * std::numbers::pi + L * L),
               w = omega * std::sqrt(1 - zeta * zeta);
  sim.run(3 * period, [&](const auto& s) {
    const double t = s.time(), decay = std::exp(-zeta * omega * t);
    const double x = amplitude * decay * (std::cos(w * t) + zeta * omega / w * std::sin(w * t));
    const double v = -amplitude * decay * omega * omega / w * std::sin(w * t);
    worst = std::max(worst, std::abs(s.position(0).z - radius + rest - x) / amplitude);
    worst = std::max(worst, std::abs(s.velocity(0).z - v) / (amplitude * omega));
  });
  return worst;
}

template <class Integrator>
double order_of_swing(double restitution, int steps = 100) {
  return std::log2(error_of_swing<Integrator>(steps, restitution) /
                   error_of_swing<Integrator>(4 * steps, restitution)) /
         2;
}

/// The same sphere at rest, whose plane begins to rise as the sixth power of time: so smoothly that
/// an integrator that knows no derivatives at the start loses nothing. Error of place after 1.5
/// periods, over the plane's way until then.
template <class Integrator>
double error_of_lift(int steps_a_period) {
  const double rest = mass * g / k, period = 2 * std::numbers::pi / omega, end = 1.5 * period;
  const auto way = [=](double t) { return 0.3 * rest * std::pow(t / end, 6); };  // [m]
  silt::Particles<silt::Sphere> spheres;
  spheres.add({{0, 0, radius - rest}, radius, density});
  silt::Simulation sim{spheres, silt::Contacts<Spring>{{k, 1}}, Integrator{}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {k, 1}, [=](double t) {
    return silt::Pose{{}, {0, 0, way(std::max(t, 0.0))}};
  });
  sim.gravity = {0, 0, -g};
  sim.time_step = period / steps_a_period;
  sim.run(end);
  // x'' = -w^2 (x - way), by the classical Runge-Kutta method, to 1e-12.
  double x = 0, v = 0;
  const int n = 20000;
  const double h = end / n;
  const auto pull = [&](double t, double at) { return -omega * omega * (at - way(t)); };
  for (int j = 0; j < n; ++j) {
    const double t = j * h;
    const double v1 = v, a1 = pull(t, x), v2 = v + 0.5 * h * a1,
                 a2 = pull(t + 0.5 * h, x + 0.5 * h * v1), v3 = v + 0.5 * h * a2,
                 a3 = pull(t + 0.5 * h, x + 0.5 * h * v2), v4 = v + h * a3,
                 a4 = pull(t + h, x + h * v3);
    x += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return std::abs(sim.position(0).z - (radius - rest) - x) / way(end);
}

}  // namespace

TEST_CASE("integrators: orders on a smooth motion") {
  CHECK(order_of_swing<silt::VelocityVerlet>(1) == near(2).epsilon(0.02));
  CHECK(order_of_swing<silt::SymplecticEuler>(1) == near(1).epsilon(0.05));
  // Damping uses the velocity of half a step ago. Its coefficient is mended so that restitutions
  // are of second order (tests/physics/impact.cpp); the frequency is of first.
  CHECK(order_of_swing<silt::VelocityVerlet>(0.5) == near(1).epsilon(0.05));
  // Gear begins with the acceleration alone: where motion begins at once, that decides.
  CHECK(order_of_swing<silt::Gear>(0.5, 50) == near(2).epsilon(0.1));
  const double coarse = error_of_lift<silt::Gear>(40), fine = error_of_lift<silt::Gear>(80);
  CHECK(std::log2(coarse / fine) == near(5).epsilon(0.06));
  CHECK(std::log2(error_of_lift<silt::VelocityVerlet>(40) /
                  error_of_lift<silt::VelocityVerlet>(80)) == near(2).epsilon(0.05));
  CHECK(fine < 1e-3 * error_of_lift<silt::VelocityVerlet>(80));
}

TEST_CASE("integrators: with Gear free motion is exact") {
  silt::Particles<silt::Sphere> spheres;
  spheres.add({{0, 0, 0}, radius, density, {1, 2, 3}, {50, 0, 0}});
  silt::Simulation sim{spheres, silt::Contacts<silt::HertzMindlin>{{1e8, 0.25, 0.8, 0.4}},
                       silt::Gear{}};
  sim.gravity = {0, 0, -g};
  sim.time_step = 1e-3, sim.guard.max_time_step = sim.guard.max_travel = 1e9;
  sim.run(1);
  // The first step knows the acceleration, which is all there is: exact.
  CHECK(sim.position(0).z == near(3 - 0.5 * g).epsilon(1e-12));
  CHECK(sim.velocity(0).z == near(3 - g).epsilon(1e-12));
  CHECK(sim.position(0).x == near(1).epsilon(1e-12));
  CHECK(sim.angular_velocity(0).x == near(50).epsilon(1e-12));
}

TEST_CASE("integrators: impacts, and a bed, with each") {
  const auto restitution = [](auto integrator, double dt) {
    silt::Particles<silt::Sphere> spheres;
    spheres.add({{0, 0, 0}, radius, density, {1, 0, 0}});
    spheres.add({{2.1 * radius, 0, 0}, radius, density});
    silt::Simulation sim{spheres, silt::Contacts<silt::HertzMindlin>{{1e8, 0.25, 0.7, 0.4}},
                         integrator};
    sim.time_step = dt;
    sim.run(5e-4);
    return sim.velocity(1).x - sim.velocity(0).x;
  };
  // 200 steps a contact.
  CHECK(restitution(silt::VelocityVerlet{}, 3e-7) == near(0.7).epsilon(1e-3));
  CHECK(restitution(silt::SymplecticEuler{}, 3e-7) == near(0.7).epsilon(1e-3));
  CHECK(restitution(silt::Gear{}, 3e-7) == near(0.7).epsilon(1e-3));

  const auto bed = [](auto integrator, double share, auto... precision) {
    silt::Particles<silt::Sphere> spheres;
    spheres.fill({{0, 0, 0}, {0.02, 0.02, 0.04}},
                 {.radius = silt::uniform(0.8e-3, 1.2e-3), .density = density, .count = 300});
    silt::Simulation sim{spheres, silt::Contacts<silt::HertzMindlin>{{1e7, 0.25, 0.5, 0.4}},
                         integrator, precision...};
    sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.05}), {1e7, 0.25, 0.5, 0.4});
    sim.gravity = {0, 0, -g};
    sim.run(0);
    sim.time_step = share * sim.step_length();
    sim.run(0.25);
    double height = 0;
    for (std::size_t n = 0; n < sim.rows(); ++n) height += sim.position(n).z / 300;
    return height;
  };
  // A chaotic fall into one random packing or another: some percent.
  const double verlet = bed(silt::VelocityVerlet{}, 1);
  // (With leapfrog's step Gear fed the bed, which shook itself 9 % denser.)
  CHECK(bed(silt::Gear{}, 1) == near(verlet).epsilon(0.05));
  CHECK(bed(silt::Gear{}, 1, silt::Mixed{}) == near(verlet).epsilon(0.05));
  CHECK(bed(silt::SymplecticEuler{}, 1) == near(verlet).epsilon(0.05));
}

TEST_CASE("integrators: a step that changes in the middle of an impact, and a restart there") {
  const auto check = [](auto integrator, double tolerance) {
    const auto make = [&] {
      silt::Particles<silt::Sphere> spheres;
      spheres.add({{0, 0, 0}, radius, density, {1, 0.3, 0}, {0, 0, 100}});
      spheres.add({{2.001 * radius, 0, 0}, radius, density});
      silt::Simulation sim{spheres, silt::Contacts<silt::HertzMindlin>{{1e8, 0.25, 1, 0.4}},
                           integrator};
      sim.time_step = 2e-7;
      return sim;
    };
    auto steady = make(), changed = make();
    steady.run(2e-4);
    changed.run(3e-5);  // deep in contact
    CHECK(changed.touching_pairs() == 1);
    changed.time_step = 1e-7;
    changed.run(2e-4 - 3e-5);
    CHECK(changed.velocity(1).x == near(steady.velocity(1).x).epsilon(tolerance));
    // By an observer, at the same step. Catches a time_step that a run ignores until the next one.
    auto observed = make();
    observed.run(2e-4, silt::at(silt::every(3e-5), [](auto& s) {
                   if (s.time() > 1e-5) s.time_step = 1e-7;
                 }));
    CHECK(observed.step_length() == 1e-7);
    CHECK(observed.step() == changed.step());
    CHECK(observed.velocity(1).x == near(changed.velocity(1).x).epsilon(1e-12));
    CHECK(observed.angular_velocity(1).z == near(changed.angular_velocity(1).z).epsilon(1e-12));

    const std::string file =
        (std::filesystem::temp_directory_path() / ("silt_integrator_" + std::to_string(::getpid())))
            .string();
    auto half = make(), rest = make();
    half.run(3e-5);
    silt::save_checkpoint(half, file);
    silt::load_checkpoint(rest, file);
    std::filesystem::remove(file);
    half.run(2e-4 - 3e-5), rest.run(2e-4 - 3e-5);
    CHECK(rest.velocity(1).x == half.velocity(1).x);
    CHECK(rest.angular_velocity(1).z == half.angular_velocity(1).z);
  };
  // Impacts of 300 steps; for symplectic Euler a new step is an error of first order.
  check(silt::VelocityVerlet{}, 2e-4), check(silt::SymplecticEuler{}, 1e-3);
  check(silt::Gear{}, 2e-4);
}

// An observer's step is checked as that of a run.
TEST_CASE("integrators: a step that an observer makes too long is refused") {
  silt::Particles<silt::Sphere> spheres;
  spheres.add({{0, 0, 0}, radius, density, {1, 0, 0}});
  spheres.add({{3 * radius, 0, 0}, radius, density});
  silt::Simulation sim{spheres, silt::Contacts<silt::HertzMindlin>{{1e8, 0.25, 1, 0.4}}};
  const auto set = [](auto& s) { s.time_step = 1e-3; };
  CHECK_THROWS_WITH_AS(sim.run(1e-3, silt::at(silt::every(1e-4), set)),
                       doctest::Contains("Simulation::time_step = 0.001 [s] is above the limit"),
                       silt::InputError);
}

TEST_CASE("integrators: what Gear keeps of a particle") {
  using Contacts = silt::Contacts<silt::HertzMindlin>;
  using Verlet = silt::Simulation<silt::Particles<silt::Sphere>, Contacts>;
  using Geared = silt::Simulation<silt::Particles<silt::Sphere>, Contacts, silt::Gear>;
  CHECK(Geared::bytes_per_particle == Verlet::bytes_per_particle + 8 * 32);
}

}  // namespace integrators_test
