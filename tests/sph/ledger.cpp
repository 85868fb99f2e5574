// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <silt/coupling/drag/di_felice.hpp>
#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"

namespace sph_ledger_test {

using namespace silt;

namespace {

constexpr double g = 9.81, rho = 1000, c = 20;
const Liquid water{.density = rho, .sound_speed = c};

/// A round drop of radius 1 m, 20 particles, that is drawn out; axes turned from the lattice.
template <class... Policies>
auto drop(double courant, const Vec3d& gravity, const Policies&... policies) {
  Sph liquid{water,
             {.spacing = 0.05,
              .region = {{-3, 0, -3}, {3, 0, 3}},
              .smoothing = 1.0,
              .dimensions = 2,
              .gravity = gravity,
              .courant = courant},
             policies...,
             EnergyLedger{}};
  const double co = std::cos(0.35), si = std::sin(0.35);
  liquid.fill([](const Vec3d& x) { return dot(x, x) < 1; },
              [=](const Vec3d& x) {
                const double a = co * x.x + si * x.z, b = -si * x.x + co * x.z;
                return Vec3d{co * a + si * b, 0, si * a - co * b};
              },
              [](const Vec3d& x) { return 500 * (1 - dot(x, x)); });
  return liquid;
}
template <class... Policies>
LiquidBalance after(double duration, double courant, const Policies&... policies) {
  auto liquid = drop(courant, {0, 0, 0}, policies...);
  liquid.run(duration);
  return liquid.energy();
}

/// Two particles, off the lattice's midst, that approach; what one step's channels are, by hand.
struct Pair {
  static constexpr double s = 0.1, h = 1.2 * 1.4142135623730951 * s;
  Vec3d way{0.8 * s, 0, 0.3 * s}, speed{-0.3, 0, 0.1};  // of a less b
  double m = rho * s * s;
  double grad() const {  // of W over r
    const double q = norm(way) / h, t = 1 - 0.5 * q;
    return 7 / (4 * 3.141592653589793 * h * h) / (h * h) * (-5) * t * t * t;
  }
};

}  // namespace

TEST_CASE("SPH ledger: a liquid's elastic energy is the integral of P/rho^2") {
  for (const double gamma : {1.0, 2.0, 7.0}) {
    const Liquid l{.density = rho, .sound_speed = c, .exponent = gamma};
    for (const double s : {0.98, 1.0005, 1.03}) {
      double sum = 0;  // Simpson's rule
      const int n = 200;
      for (int k = 0; k <= n; ++k) {
        const double r = rho * (1 + (s - 1) * k / n);
        sum += (k == 0 || k == n ? 1 : k % 2 ? 4 : 2) * l.pressure(r) / (r * r);
      }
      sum *= rho * (s - 1) / (3 * n);
      CHECK(l.elastic_energy(rho * s) == near(sum).epsilon(1e-9));
    }
    // For small compressions c^2/2 of its square.
    CHECK(l.elastic_energy(rho * (1 + 1e-6)) == near(0.5 * c * c * 1e-12).epsilon(1e-4));
  }
}

TEST_CASE("SPH ledger: without terms a drop keeps its energy, to the error of the steps") {
  const auto residual = [](double courant) {
    const auto check = [courant](auto time) {
      const LiquidBalance e = after(0.3, courant, Inviscid{}, NoDiffusion{}, NoShifting{}, time);
      CHECK(e.dissipated() == 0);
      CHECK(e.supplied() == 0);
      return std::abs(e.residual()) / e.initial;
    };
    return std::pair{check(LeapfrogTime{}), courant > 0.2 ? 0.0 : check(SymplecticTime{})};
  };
  const auto coarse = residual(0.2), fine = residual(0.1);
  CHECK(coarse.second < 2e-5);
  CHECK(fine.second < coarse.second / 3.5);  // second order or better
  CHECK(coarse.first < 2e-8);
  CHECK(residual(0.8).first < 1e-6);
}

TEST_CASE("SPH ledger: a drop in free flight gives its potential energy to its motion") {
  const double pull = 2;  // [m/s2]: more would be too fast a fall for 20 m/s of sound
  auto liquid = drop(0.2, {0, 0, -pull}, Inviscid{}, NoDiffusion{}, NoShifting{});
  const double mass = liquid.mass(), before = liquid.energy().gravity;
  liquid.run(0.2);
  const LiquidBalance e = liquid.energy();
  // The centre falls by g t^2/2, to rounding; the residual is that of the drop without gravity.
  CHECK(e.gravity - before == near(-mass * pull * 0.5 * pull * 0.04).epsilon(1e-9));
  CHECK(std::abs(e.residual()) < 3e-5 * 795);
}

TEST_CASE("SPH ledger: channels of a pair by hand") {
  const Pair of;
  const auto one_step = [&](const auto& viscosity, const auto& diffusion, double excess) {
    Sph liquid{water,        {.spacing = of.s, .region = {{-1, 0, -1}, {1, 0, 1}}, .dimensions = 2},
               viscosity,    diffusion,
               NoShifting{}, EnergyLedger{}};
    // The lattice has one place in each of these two cells; 0.8 and 0.3 of a spacing apart.
    liquid.fill(
        [](const Vec3d& x) {
          return norm(x - Vec3d{0.05, 0, 0.05}) < 0.01;
        },
        [&](const Vec3d&) { return 0.5 * of.speed; }, [&](const Vec3d&) { return excess; });
    liquid.fill(
        [](const Vec3d& x) {
          return norm(x - Vec3d{-0.05, 0, 0.05}) < 0.01;
        },
        [&](const Vec3d&) { return -0.5 * of.speed; }, [](const Vec3d&) { return 0.0; });
    const double dt = 1e-7;
    liquid.step(dt);
    LiquidBalance e = liquid.energy();
    for (double* x : {&e.artificial, &e.laminar, &e.diffusion}) *x /= dt;
    return e;
  };
  // One spacing apart along x, as the lattice has them.
  Pair p = of;
  p.way = {p.s, 0, 0};
  const double F = p.grad(), r2 = p.s * p.s, wide = r2 + 0.01 * p.h * p.h;
  const double along = dot(p.speed, p.way);
  // Of both: m m Pi v.grad W = m m (-alpha c h (v.r)/wide/rho) (v.r) F, and 4 nu m m r2 F/(2 rho
  // wide) v^2, both lost as v.r < 0 and F < 0. 1e-5: half of a step of 1e-7 s.
  const auto artificial = one_step(ArtificialViscosity{.alpha = 0.3}, NoDiffusion{}, 0);
  CHECK(artificial.artificial ==
        near(-p.m * p.m * 0.3 * c * p.h * along * along * F / (wide * rho)).epsilon(1e-5));
  CHECK(artificial.laminar == 0);
  const auto laminar = one_step(LaminarViscosity{.kinematic = 0.02}, NoDiffusion{}, 0);
  CHECK(laminar.laminar ==
        near(-p.m * p.m * 4 * 0.02 * 2 / (5.0 / 9 * p.h * p.h) * along * along * F / (2 * rho))
            .epsilon(1e-5));
  // Of diffusion: m (P_a/rho_a^2) d rho_a/dt, P_b = 0.
  const double P = 2000, rho_a = water.density_at(P);
  const auto diffusion = one_step(Inviscid{}, MolteniColagrossi{.delta = 0.2}, P);
  const double rate = 0.2 * p.h * c * 2 * (rho_a - rho) * r2 * F / wide * p.m / rho;
  CHECK(diffusion.diffusion == near(-p.m * P / (rho_a * rho_a) * rate).epsilon(1e-4));
  CHECK(diffusion.diffusion > 0);
}

TEST_CASE("SPH ledger: what a drop loses is what its channels say, for each of them") {
  // Without walls the sum of kinetic and elastic energy falls by what is lost. 2e-6 of all: the
  // steps; each channel is at least 2e-4 of it.
  const auto check = [](const LiquidBalance& e) {
    CHECK(std::abs(e.residual()) < 2e-6 * e.initial);
    CHECK(e.initial - e.held() == near(e.dissipated()).epsilon(1e-3));
  };
  const LiquidBalance usual = after(0.15, 0.2);
  check(usual);
  CHECK(usual.artificial > 2e-4 * usual.initial);
  CHECK(usual.diffusion > 2e-4 * usual.initial);
  CHECK(usual.shifting == 0);  // no gravity
  const LiquidBalance viscous =
      after(0.15, 0.2, LaminarViscosity{.kinematic = 1e-2, .alpha = 0.05}, MolteniColagrossi{});
  check(viscous);
  CHECK(viscous.laminar > 0.01 * viscous.initial);
  const LiquidBalance turbulent =
      after(0.15, 0.2, SpsTurbulence{.kinematic = 1e-2, .smagorinsky = 1});
  check(turbulent);
  CHECK(turbulent.turbulent > 0.005 * turbulent.initial);
  check(after(0.15, 0.2, Mixed{}));
  const LiquidBalance verlet = after(0.15, 0.2, VerletTime{});
  // 2.7e-5: a fifth of its steps are Euler's.
  CHECK(std::abs(verlet.residual()) < 4e-5 * verlet.initial);
  CHECK(verlet.artificial == near(usual.artificial).epsilon(1e-3));
}

namespace {
/// A column 0.2 m wide and 0.3 m high; wall 0: the floor.
template <class... Policies>
auto column(const WallSetup& floor, const Policies&... policies) {
  Sph liquid{Liquid{.density = rho, .sound_speed = 20 * std::sqrt(g * 0.3)},
             {.spacing = 0.02,
              .region = {{0, 0, 0}, {0.2, 0, 0.4}},
              .smoothing = 1.0,
              .dimensions = 2,
              .gravity = {0, 0, -g}},
             policies...,
             EnergyLedger{}};
  liquid.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, floor);
  liquid.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  liquid.add_wall(Plane{{0.2, 0, 0}, {-1, 0, 0}});
  liquid.fill([](const Vec3d& x) { return x.z < 0.3; });
  return liquid;
}
}  // namespace

TEST_CASE("SPH ledger: a column at rest exchanges next to nothing") {
  auto liquid = column({});
  liquid.run(0.5);
  const LiquidBalance e = liquid.energy();
  const double weight = liquid.mass() * g * 0.3;  // [J/m]
  CHECK(e.walls == 0);
  CHECK(std::abs(e.residual()) < 1e-8 * weight);
  CHECK(e.viscosity() >= 0);
  // The first settling of the surface: 0.1 mm of the column's height.
  CHECK(std::abs(e.mirrored()) < 3e-4 * weight);
  CHECK(std::abs(e.shifting) < 3e-4 * weight);
}

TEST_CASE("SPH ledger: a floor that rises lifts the column: its work is force times way") {
  // 5 mm up, by a smooth start and end: at the end all is as before, 5 mm higher.
  const double up = 0.005, T = 0.4, pi = 3.141592653589793;
  const auto floor = [=](double t) {
    const double s = std::min(t, T) / T;
    return Pose{{}, {0, 0, up * (s - std::sin(2 * pi * s) / (2 * pi))}};
  };
  auto liquid = column({.motion = floor}, Inviscid{}, NoShifting{}, NoDiffusion{});
  double work = 0, last = 0, floor_bears = 0, all_bear = 0;
  const double dt = 2.5e-4, weight = liquid.mass() * g, steps = T / dt;
  for (int k = 0; k * dt < T - 1e-9; ++k) {  // trapezium over the load that users read
    const double force = -liquid.wall_load(0).first.z, z = floor(liquid.time()).translation.z;
    if (k > 0) work += 0.5 * (last + force) * (z - floor(liquid.time() - dt).translation.z);
    last = force, floor_bears += force / (weight * steps);
    for (std::size_t w = 0; w < 3; ++w) all_bear -= liquid.wall_load(w).first.z / (weight * steps);
    liquid.step(dt);
  }
  const LiquidBalance e = liquid.energy();
  const double lifted = liquid.mass() * g * up;
  CHECK(e.walls == near(work).epsilon(2e-3));
  // Particles in corners belong to one wall alone. Those of the walls at rest bear 2.5 % each, a
  // quarter of a spacing of the floor's ten (1.2 % at half the spacing): the floor bears 95 %, and
  // does 95 % of the work; the mirror images in the corners do the rest.
  CHECK(all_bear == near(1).epsilon(1e-3));
  CHECK(floor_bears == near(0.95).epsilon(0.003));
  CHECK(e.walls == near(floor_bears * lifted).epsilon(2e-3));
  CHECK(e.walls + e.at_walls == near(lifted).epsilon(0.006));
  CHECK(std::abs(e.residual()) < 2e-4 * lifted);
}

// Catches separation from walls that lowers densities by the pressures of the step before: at c =
// 100 times the speed of the fall such a column gained 0.5 % of its energy at a Courant number of
// 0.2 and 27 % at 0.4.
TEST_CASE("SPH ledger: a column that collapses gains nothing, however stiff it is") {
  const double H = 0.2, fall = std::sqrt(2 * g * H);
  Sph column{
      Liquid{.density = rho, .sound_speed = 100 * fall},
      {.spacing = 0.01, .region = {{0, 0, 0}, {1, 0, 0.4}}, .dimensions = 2, .gravity = {0, 0, -g}},
      EnergyLedger{}};
  column.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  column.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  column.fill([](const Vec3d& x) { return x.x < 0.1 && x.z < 0.2; });
  column.run(0.06);
  const LiquidBalance e = column.energy();
  CHECK(e.kinetic > 0.02 * e.initial);
  CHECK(std::abs(e.residual()) < 1e-4 * e.initial);
}

TEST_CASE("SPH ledger: what a body gets the liquid loses") {
  const double spacing = 0.0125;
  Sph liquid{
      Liquid{.density = rho, .sound_speed = 20},
      {.spacing = spacing, .region = {{0, 0, 0}, {0.4, 0, 0.4}}, .smoothing = 1.0, .dimensions = 2},
      EnergyLedger{}};
  liquid.gravity = {0, 0, -g};
  liquid.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  liquid.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  liquid.add_wall(Plane{{0.4, 0, 0}, {-1, 0, 0}});
  liquid.fill([](const Vec3d& x) { return x.z < 0.3; });
  Particles<Sphere> balls;
  // A cylinder for the liquid, 1 m of which would have 7.85 kg; the sphere's mass is that.
  const double R = 0.05, mass = 500 * 3.141592653589793 * R * R;
  balls.add({.position = {0.2, 0, 0.29},
             .radius = R,
             .density = mass / (4.0 / 3 * 3.141592653589793 * R * R * R)});
  Simulation sim{
      std::move(balls),
      Contacts<HertzMindlin>{
          {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}},
      std::move(liquid), EnergyLedger{}};
  sim.gravity = {0, 0, -g};
  double most = 0;
  const auto off = [&](double step) {
    sim.time_step = step;
    for (int k = 0; k < 10; ++k) {
      sim.run(0.01);
      most = std::max(most, std::abs(sim.energy().fluid + sim.fluid().energy().bodies));
    }
    return most;
  };
  const double apart = off(1e-4);
  const LiquidBalance e = sim.fluid().energy();
  // Of what goes from one to the other: the velocity that the liquid's step holds is half a step
  // old.
  CHECK(apart < 0.01 * std::abs(e.bodies));
  CHECK(std::abs(e.bodies) > 0.2);
  CHECK(std::abs(e.residual()) < 1e-4 * std::abs(e.bodies));
  // A second body comes where there is liquid.
  CHECK(e.displaced == 0);
  const double held = e.held();
  Particles<Sphere> more;
  more.add({.position = {0.1, 0, 0.1}, .radius = R, .density = 1000});
  sim.add(more);
  sim.run(5e-4);  // a step of the liquid
  const LiquidBalance after = sim.fluid().energy();
  CHECK(after.displaced == near(held - after.held()).epsilon(0.02));
  CHECK(std::abs(after.residual()) < 1e-4 * std::abs(e.bodies));
}

TEST_CASE("SPH ledger: what comes, leaves, goes round and falls under another gravity") {
  Sph liquid{water,
             {.spacing = 0.05,
              .region = {{0, 0, 0}, {1, 0, 1}},
              .smoothing = 1.0,
              .dimensions = 2,
              .periodic = {true, false, false},
              .gravity = {2, 0, -g}},
             EnergyLedger{}};
  liquid.fill([](const Vec3d& x) { return x.z > 0.2 && x.z < 0.4; },
              [](const Vec3d&) {
                return Vec3d{3, 0, 0};
              },
              [](const Vec3d&) { return 0.0; });
  liquid.run(0.05);
  const double one = liquid.energy().held();
  liquid.fill([](const Vec3d& x) { return x.z > 0.7 && x.z < 0.8; });
  CHECK(liquid.energy().openings == near(liquid.energy().held() - one).epsilon(1e-9));
  liquid.run(0.05);
  liquid.gravity = {0, 0, -2 * g};
  liquid.run(0.35);
  const LiquidBalance e = liquid.energy();
  CHECK(liquid.left() > 50);
  CHECK(e.openings != 0);
  CHECK(e.going_round > 0);
  CHECK(e.changed_gravity != 0);
  // Of all that was there at first, some 1.2e3 J/m.
  CHECK(std::abs(e.residual()) < 1e-3 * std::abs(e.initial));
}

TEST_CASE("SPH ledger: with grains that are not resolved") {
  Sph liquid{Liquid{.density = rho, .sound_speed = 20},
             {.spacing = 0.01,
              .region = {{0, 0, 0}, {0.08, 0.08, 0.12}},
              .smoothing = 1.0,
              .periodic = {true, true, false}},
             UnresolvedGrains{DiFelice{}, {.viscosity = 1e-3}},
             EnergyLedger{}};
  liquid.gravity = {0, 0, -g};
  liquid.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  liquid.fill([](const Vec3d& x) { return x.z < 0.1; });
  Particles<Sphere> grains;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      grains.add(
          {.position = {0.01 + 0.02 * i, 0.01 + 0.02 * j, 0.06}, .radius = 2e-3, .density = 2500});
  Simulation sim{
      std::move(grains),
      Contacts<HertzMindlin>{
          {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}},
      std::move(liquid), PeriodicBox{{{0, 0, 0}, {0.08, 0.08, 1}}, {true, true, false}},
      EnergyLedger{}};
  sim.gravity = {0, 0, -g};
  sim.time_step = 1e-4;
  sim.run(0.1);
  const LiquidBalance e = sim.fluid().energy();
  // The grains sink: they give work to the liquid. Drag heats besides, so that it gets less.
  CHECK(sim.energy().fluid < 0);
  CHECK(e.grains > 0);
  CHECK(e.grains < -sim.energy().fluid);
  CHECK(std::abs(e.residual()) < 0.02 * e.grains);
}

TEST_CASE("SPH ledger: same bits with threads, and from a checkpoint on") {
  const std::string path =
      (std::filesystem::temp_directory_path() / "silt_sph_ledger.silt").string();
  const auto scene = [&](bool restart) {
    Sph liquid{
        Liquid{.density = rho, .sound_speed = 20},
        {.spacing = 0.02, .region = {{0, 0, 0}, {0.4, 0, 0.6}}, .smoothing = 1.0, .dimensions = 2},
        VerletTime{},
        EnergyLedger{}};
    liquid.gravity = {0, 0, -g};
    liquid.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
    liquid.fill([](const Vec3d& x) { return x.x < 0.2 && x.z < 0.3; });
    Particles<Sphere> far;
    far.add({.position = {0.23, 0, 0.2}, .radius = 0.05, .density = 1000});
    Simulation sim{
        std::move(far),
        Contacts<HertzMindlin>{
            {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}},
        std::move(liquid), EnergyLedger{}};
    sim.gravity = {0, 0, -g};
    sim.time_step = 1e-4;
    if (restart) load_checkpoint(sim, path);
    return sim;
  };
  const auto books = [](const LiquidBalance& e) {
    return std::vector<double>{e.kinetic,   e.gravity,   e.elastic, e.artificial, e.diffusion,
                               e.shifting,  e.displaced, e.walls,   e.bodies,     e.at_walls,
                               e.at_bodies, e.openings,  e.initial, e.residual()};
  };
  auto sim = scene(false);
  sim.run(0.02);
  save_checkpoint(sim, path);
  sim.run(0.02);
  auto again = scene(true);
  again.threads = 3;
  again.run(0.02);
  CHECK(books(again.fluid().energy()) == books(sim.fluid().energy()));
  CHECK(sim.fluid().energy().bodies != 0);
  std::filesystem::remove(path);
}

}  // namespace sph_ledger_test
