// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"
#include "sph/floating.hpp"

namespace sph_bodies_test {

using namespace silt;

namespace {

/// One sphere of radius 1 in a periodic box of liquid, moved by hand.
struct Driven {
  static constexpr double R = 1, c = 20;
  double spacing, side;
  Sph<ArtificialViscosity> water;
  std::vector<Vec3d> x, v{{0, 0, 0}}, w{{0, 0, 0}}, force{{0, 0, 0}}, torque{{0, 0, 0}};
  std::vector<double> r{R}, volume{4 * std::numbers::pi / 3}, mass{INFINITY};
  Team team{2};

  explicit Driven(int n)
      : spacing(R / n),
        side(6 * n * spacing),
        water(Liquid{.density = 1000, .sound_speed = c},
              {.spacing = spacing,
               .region = {{0, 0, 0}, {side, side, side}},
               .smoothing = 1.0,
               .periodic = {true, true, true}},
              ArtificialViscosity{.alpha = 0.05}),
        x{{side / 2, side / 2, side / 2}} {
    // Under a pressure above all suction, as bodies are not pulled.
    water.fill([](const Vec3d&) { return true; },
               [](const Vec3d&) {
                 return Vec3d{0, 0, 0};
               },
               [](const Vec3d&) { return 2000.0; });
  }
  void go(double dt) {
    CoupledParticles of{};
    of.shape.position = x, of.shape.radius = r, of.velocity = v, of.volume = volume, of.mass = mass;
    of.angular_velocity = w;
    water.advance(of, dt, force, team, torque);
    x[0] += dt * v[0];
  }
};

/// A light ball that is half in the liquid, and a heavy one above it.
auto two_balls(const std::string& checkpoint = {}) {
  Particles<Sphere> balls;
  balls.add({.position = {0.1, 0.1, 0.09}, .radius = 0.03, .density = 500});
  balls.add({.position = {0.09, 0.1, 0.145}, .radius = 0.02, .density = 2000});
  return sph_test::floating(std::move(balls), 0.2, checkpoint);
}
template <class Sim>
std::vector<double> state_of(const Sim& sim) {
  return sph_test::state_of(sim, 2);
}

}  // namespace

TEST_CASE("SPH: a sphere that is pushed through the liquid carries half its volume along") {
  // From rest at constant acceleration, 4 spacings a radius: the force is -1/2 of the displaced
  // mass times the acceleration, after the sound of the start has gone by. 8 %: particles' size
  // (a shell half a spacing further out would be 1.4 times as heavy), images at six radii (2 %),
  // what friction has added by then. Forces of pressure at one side alone would be 3/2 or 0.
  Driven d(4);
  const double a = 0.2, dt = 0.1 * d.spacing / Driven::c;
  double sum = 0, t = 0;
  int count = 0;
  Vec3d given{0, 0, 0};
  const Vec3d before = d.water.momentum();
  while (t < 0.9) {
    d.v[0].z = t < 0.3 ? a * t * t / 0.6 : a * (t - 0.15);
    d.go(dt), t += dt;
    given += dt * d.force[0];
    if (t > 0.5) sum += d.force[0].z, ++count;
  }
  const double displaced = 1000 * d.volume[0];
  CHECK(sum / count == near(-0.5 * displaced * a).epsilon(0.08));
  // What the sphere got the liquid lost.
  CHECK(norm(d.water.momentum() - before + given) < 1e-12 * norm(given));
}

TEST_CASE("SPH: a sphere that crosses a side of a box that repeats is pushed as in its middle") {
  // The same lattice seen from a sphere by half of the box, whose centre is in the corner: its
  // points lie on all sides, and its place jumps by the box as it goes on. Points that were not
  // seen through the sides, or lists of the image before the jump, are off by the size of the
  // force.
  Driven middle(4), corner(4);
  corner.x[0] = {corner.side, corner.side, corner.side};
  for (Driven* d : {&middle, &corner}) d->v[0] = {0.3, 0, 0.5};
  const double dt = 0.1 * middle.spacing / Driven::c;
  double worst = 0, most = 0;
  for (int k = 0; k < 120; ++k) {
    middle.go(dt), corner.go(dt);
    for (double* x : {&corner.x[0].x, &corner.x[0].z})
      if (*x >= corner.side) *x -= corner.side;  // as a PeriodicBox does
    worst = std::max(worst, norm(middle.force[0] - corner.force[0]));
    most = std::max(most, norm(middle.force[0]));
  }
  CHECK(middle.water.displaced() == corner.water.displaced());
  CHECK(worst < 1e-8 * most);
}

TEST_CASE("SPH: what is read between steps changes no bit") {
  auto quiet = two_balls(), read = two_balls();
  for (int k = 0; k < 5; ++k) {
    quiet.run(4e-4), read.run(4e-4);
    CHECK(std::isfinite(read.fluid().wall_load(0).first.z));
  }
  CHECK(state_of(read) == state_of(quiet));
}

TEST_CASE("SPH: vtk_series of a Simulation writes the liquid, also after a restart") {
  const std::string folder = std::filesystem::temp_directory_path() / "silt_sph_series";
  const auto frames = [&](const std::string& to, const std::string& from) {
    auto sim = two_balls(from);
    sim.run(2e-3, vtk_series(to, every(1e-3)));
    // Walls are drawn where the liquid can be, not over ten radii of the widest body.
    CHECK(detail::wall_region(sim).min.z == 0);
    CHECK(detail::wall_region(sim).max.z == 0.25);
    save_checkpoint(sim, folder + "/balls.silt");
    const auto series = VtkSeries::resume(to, "liquid", 1);
    sim.fluid().write(to + "/last.vtp");
    CHECK(detail::read_file(to + '/' + series.last_file()) == detail::read_file(to + "/last.vtp"));
    return series.frames();
  };
  CHECK(frames(folder, {}) == 3);
  CHECK(frames(folder, folder + "/balls.silt") == 5);
  std::filesystem::remove_all(folder);
}

TEST_CASE("SPH: loads on walls after a checkpoint was loaded are those before") {
  // They were those of bodies at the origin and at rest.
  const std::string path =
      (std::filesystem::temp_directory_path() / "silt_sph_loads.silt").string();
  auto sim = two_balls();
  sim.run(2e-3);
  save_checkpoint(sim, path);
  const auto loads = sph_test::loads_of(sim);
  auto again = two_balls(path);
  CHECK(sph_test::loads_of(again) == loads);
  again.run(4e-4), sim.run(4e-4);
  CHECK(sph_test::loads_of(again) == sph_test::loads_of(sim));
  std::filesystem::remove(path);
}

template <class Walls>
double buoyancy(const Walls& walls) {  // over that of the sphere's volume
  const double g = 9.81, side = 0.16;
  Sph water{Liquid{.density = 1000, .sound_speed = 20 * std::sqrt(g * side)},
            {.spacing = 0.01,
             .region = {{0, 0, 0}, {side, side, 0.2}},
             .smoothing = 1.0,
             .periodic = {true, true, false},
             .gravity = {0, 0, -g}},
            ArtificialViscosity{.alpha = 0.1},
            walls};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.fill([side](const Vec3d& x) { return x.z < side; });
  std::vector<Vec3d> x{{0.08, 0.08, 0.08}}, v{{0, 0, 0}}, w = v, force(1), torque(1);
  std::vector<double> r{0.04}, volume{4 * std::numbers::pi / 3 * 0.04 * 0.04 * 0.04}, mass{INFINITY};
  CoupledParticles of{};
  of.shape.position = x, of.shape.radius = r, of.velocity = v, of.volume = volume, of.mass = mass;
  of.angular_velocity = w;
  Vec3d sum{0, 0, 0};
  double time = 0;
  for (int n = 0; n < 60; ++n) {
    water.advance(of, 0.01, force, 2, torque);
    if (n >= 20) sum += 0.01 * force[0], time += 0.01;
  }
  CHECK(std::abs(sum.x / time) < 0.02 * 1000 * g * volume[0]);
  CHECK(water.displaced() > 200);
  return sum.z / time / (1000 * g * volume[0]);
}

TEST_CASE("SPH: a sphere at rest in a liquid at rest feels its buoyancy") {
  // 0.3 % seen; 2 %: what sound still swings after 0.2 s, on average over 0.4 s.
  CHECK(buoyancy(MirroredWalls{}) == near(1).epsilon(0.02));
  CHECK(buoyancy(DynamicWalls{}) == near(1).epsilon(0.02));
}

TEST_CASE("SPH in a Simulation: same bits with threads, and from a checkpoint on") {
  const std::string path =
      (std::filesystem::temp_directory_path() / "silt_sph_bodies.silt").string();
  auto sim = two_balls();
  sim.run(0.01);
  save_checkpoint(sim, path);
  sim.run(0.0104);
  auto again = two_balls(path);
  again.threads = 3;
  CHECK(again.fluid().size() == sim.fluid().size());
  again.run(0.0104);
  CHECK(state_of(again) == state_of(sim));
  std::filesystem::remove(path);
}

TEST_CASE("SPH: what bodies cannot be is refused") {
  Particles<Sphere> small;
  small.add({.position = {0.05, 0.05, 0.05}, .radius = 0.01, .density = 1000});
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = 0.01, .region = {{0, 0, 0}, {0.1, 0.1, 0.1}}}};
  water.fill([](const Vec3d&) { return true; });
  Simulation sim{std::move(small), Contacts<HertzMindlin>{sph_test::plastic}, water};
  sim.time_step = 1e-5;
  CHECK_THROWS_WITH_AS(sim.run(1e-3), doctest::Contains("is too small for a spacing of 0.01 m"),
                       Error);
  Particles<Sphere> large;
  large.add({.position = {0.05, 0.05, 0.05}, .radius = 0.02, .density = 1000});
  Simulation round{std::move(large), Contacts<HertzMindlin>{sph_test::plastic}, water,
                   PeriodicBox{{{0, 0, 0}, {0.2, 0.2, 1}}, {true, true, false}}};
  round.time_step = 1e-5;
  CHECK_THROWS_WITH_AS(round.run(1e-3), doctest::Contains("give both the same PeriodicBox"),
                       InputError);
}

}  // namespace sph_bodies_test
