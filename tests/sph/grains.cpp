// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include <silt/coupling/drag/laws.hpp>

#include "near.hpp"
#include "refusal.hpp"
#include "sph/floating.hpp"

namespace sph_grains_test {

using namespace silt;

namespace {

constexpr double g = 9.81, rho = 1000, mu = 1e-2;

template <class Drag>
auto box(const Drag& drag, double spacing, double side, const Vec3d& gravity, double pressure) {
  Sph water{Liquid{.density = rho, .sound_speed = 10},
            {.spacing = spacing,
             .region = {{0, 0, 0}, {side, side, side}},
             .smoothing = 0.8,
             .periodic = {true, true, true},
             .gravity = gravity},
            UnresolvedGrains{drag, {.viscosity = mu}},
            LaminarViscosity{.kinematic = mu / rho, .alpha = 0}};
  water.fill([](const Vec3d&) { return true; },
             [](const Vec3d&) {
               return Vec3d{0, 0, 0};
             },
             [pressure](const Vec3d&) { return pressure; });
  return water;
}
/// Grains of a lattice, at places that have nothing to do with the liquid's.
struct Grains {
  std::vector<Vec3d> x, v, force, torque;
  std::vector<double> r, volume, mass;

  Grains(double side, int n, double radius, double density) {
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k) x.push_back((side / n) * Vec3d{i + 0.3, j + 0.4, k + 0.1});
    v.assign(x.size(), {0, 0, 0}), force = torque = v;
    r.assign(x.size(), radius);
    volume.assign(x.size(), 4 * std::numbers::pi / 3 * radius * radius * radius);
    mass.assign(x.size(), density * volume[0]);
  }
  CoupledParticles view() const {
    CoupledParticles of{};
    of.shape.position = x, of.shape.radius = r, of.velocity = v, of.volume = volume, of.mass = mass;
    return of;
  }
};
/// A liquid driven by a body force, from rest, through a fixed bed: its velocity at the end over
/// that of rho eps du/dt = rho eps a - beta(u) u for spheres of `mean` [m].
template <class Drag, class Law>
double over_fixed_bed(Grains bed, double side, const Drag& drag, const Law& law, double mean) {
  const double a = 0.2, end = 0.3;
  double solids = 0;
  for (double& m : bed.mass) m = INFINITY;
  for (const double V : bed.volume) solids += V / (side * side * side);
  const double eps = 1 - solids;
  CHECK(eps == near(0.8046).epsilon(1e-3));
  auto water = box(drag, 0.01, side, {a, 0, 0}, 500);
  Vec3d given{0, 0, 0};
  for (int k = 0; k < 30; ++k) {
    water.advance(bed.view(), end / 30, bed.force, 2, bed.torque);
    for (const Vec3d& f : bed.force) given += end / 30 * f;
  }
  // What drives it and what the grains got, though particles have masses of their own.
  const double pushed = water.mass() * a * end;
  CHECK(norm(water.momentum() + given - Vec3d{pushed, 0, 0}) < 1e-12 * pushed);
  CHECK(water.mass() == near(rho * eps * side * side * side).epsilon(0.002));
  CHECK(water.closure().momentum < 1e-13);
  CHECK(water.closure().volume < 1e-12);
  CHECK(water.closure().clipped == 0);
  double want = 0;
  const int steps = 1000;
  for (int k = 0; k < steps; ++k) {
    const double Re = eps * rho * want * mean / mu;
    const double beta = interphase_coefficient(law, eps, Re, mean, mu) / (rho * eps);
    want += end / steps * (a - beta * want);
  }
  CHECK(want < 0.8 * a * end);
  return water.momentum().x / water.mass() / want;
}

}  // namespace

TEST_CASE("SPH with unresolved grains: a fixed bed holds the liquid back as the drag law says") {
  // 1 %: the error of the drag law's mean over grains that see an eps of 0.80 +- 0.01. A liquid
  // that felt drag on all of its mass instead of its share eps, or a voidage of 1, would be off by
  // 20 %.
  const double side = 0.08, d = 0.0072;
  CHECK(over_fixed_bed(Grains(side, 8, 0.5 * d, 2500), side, WenYu{}, WenYu{}, d) ==
        near(1).epsilon(0.01));
}

TEST_CASE("SPH with unresolved grains: sizes of a mixture feel the drag of their Sauter mean") {
  // Spheres of 4 and 8.81 mm in turn. Without Polydisperse the liquid is 2 % slower.
  const double side = 0.08, d = 0.0072, small = 0.004;
  Grains bed(side, 8, 0.5 * d, 2500);
  const double large = std::cbrt(2 * d * d * d - small * small * small);
  for (std::size_t p = 0; p < bed.x.size(); ++p) {
    const bool odd = (p / 64 + p / 8 + p) % 2 == 1;  // of the lattice's three directions
    bed.r[p] = 0.5 * (odd ? small : large);
    bed.volume[p] = std::numbers::pi / 6 * std::pow(2 * bed.r[p], 3);
  }
  const double mean = 2 * d * d * d / (small * small + large * large);
  const double mixed = over_fixed_bed(bed, side, Polydisperse{WenYu{}}, WenYu{}, mean);
  CHECK(mixed == near(1).epsilon(0.01));
  CHECK(over_fixed_bed(bed, side, WenYu{}, WenYu{}, mean) < 0.985 * mixed);
}

TEST_CASE("SPH with unresolved grains: a grain settles at its terminal velocity") {
  const double side = 0.08, density = 2500;
  Grains one(side, 1, 0.0005, density);
  auto water = box(Stokes{}, 0.01, side, {0, 0, 0}, 500);
  // Weight less buoyancy as an external force; the box has no gravity, so that it does not fall.
  const double push = (density - rho) * g * one.volume[0];
  const double dt = 2e-3;
  Vec3d given{0, 0, 0};
  for (int k = 0; k < 100; ++k) {
    const std::vector<Vec3d> by_others{{0, 0, -push / one.mass[0]}};
    CoupledParticles of = one.view();
    of.acceleration = by_others;
    water.advance(of, dt, one.force, 2, one.torque);
    given += dt * one.force[0];
    one.v[0] += (dt / one.mass[0]) * (one.force[0] + Vec3d{0, 0, -push});
    one.x[0] += dt * one.v[0];
  }
  const double terminal = push / (6 * std::numbers::pi * mu * one.r[0]);
  CHECK(-one.v[0].z == near(terminal).epsilon(0.005));  // the liquid itself moves by 1e-3 of it
  CHECK(norm(water.momentum() + given) < 1e-9 * norm(given));
}

TEST_CASE("SPH with unresolved grains: liquid above and in a bed at rest stays at rest") {
  // A bed of fixed grains in the lower half of a column: the pressure is that of the depth in both,
  // as neither the voidage nor the grains' share of the weight is in it; the floor bears the liquid
  // and, by the pressure on them, the volume of the grains.
  const double side = 0.08, depth = 0.16, s = 0.01;
  Sph water{Liquid{.density = rho, .sound_speed = 20 * std::sqrt(g * depth)},
            {.spacing = s,
             .region = {{0, 0, 0}, {side, side, 0.2}},
             .smoothing = 0.8,
             .periodic = {true, true, false},
             .gravity = {0, 0, -g}},
            UnresolvedGrains{WenYu{}, {.viscosity = mu}},
            ArtificialViscosity{.alpha = 0.1}};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.fill([depth](const Vec3d& x) { return x.z < depth; });
  Grains bed(side, 8, 0.0036, 2500);
  for (double& m : bed.mass) m = INFINITY;
  const double volume = bed.volume[0] * static_cast<double>(bed.x.size());
  double load = 0, buoyancy = 0;
  for (int k = 0; k < 50; ++k) {
    water.advance(bed.view(), 0.01, bed.force, 2, bed.torque);
    if (k < 25) continue;
    load += water.wall_load(0).first.z / 25;
    for (const Vec3d& f : bed.force) buoyancy += f.z / 25;
  }
  double fastest = 0, off = 0, level = 0;
  water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double p) {
    fastest = std::max(fastest, norm(v));
    off = std::max(off, std::abs(p - rho * g * (depth - x.z)));
    level = std::max(level, x.z);
  });
  const double weight = rho * g * (side * side * depth - volume);
  // 1 %: what sound still swings after 0.25 s; of the sums over half of the time the half.
  CHECK(fastest < 0.001 * std::sqrt(g * depth));
  CHECK(off < 0.015 * rho * g * depth);
  CHECK(std::abs(level - 0.155) < 1e-4);
  CHECK(load == near(-weight - rho * g * volume).epsilon(0.005));
  CHECK(buoyancy == near(rho * g * volume).epsilon(0.005));
}

namespace {
using sph_test::plastic;
auto settling(bool ball, const std::string& checkpoint = {}) {
  const double side = 0.1, depth = 0.08, s = 0.01;
  Sph water{Liquid{.density = rho, .sound_speed = 20 * std::sqrt(g * depth)},
            {.spacing = s,
             .region = {{0, 0, 0}, {side, side, 0.2}},
             .smoothing = 0.8,
             .periodic = {true, true, false}},
            UnresolvedGrains{WenYu{}, {.viscosity = mu}},
            ArtificialViscosity{.alpha = 0.1}};
  water.gravity = {0, 0, -g};
  water.fill([depth](const Vec3d& x) { return x.z < depth; });
  Particles<Sphere> sand;
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j)
      for (int k = 0; k < 4; ++k)
        sand.add({.position = {(i + 0.5) * s, (j + 0.5) * s, 0.1 + k * s},
                  .radius = 0.004,
                  .density = 2500});
  if (ball)
    sand.add({.position = {0.05, 0.05, 0.05}, .radius = 0.016, .density = 900});  // resolved
  Simulation sim{std::move(sand), Contacts<HertzMindlin>{plastic}, std::move(water),
                 PeriodicBox{{{0, 0, 0}, {side, side, 1}}, {true, true, false}}};
  sim.gravity = {0, 0, -g};
  sim.time_step = 4e-5;
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, plastic, {.name = "floor"});
  if (!checkpoint.empty()) load_checkpoint(sim, checkpoint);
  return sim;
}
template <class Sim>
std::vector<double> state_of(const Sim& sim) {
  return sph_test::state_of(sim, 401);
}
}  // namespace

TEST_CASE("SPH with unresolved grains: grains that fall in raise the liquid by their volume") {
  auto sim = settling(false);
  sim.run(0.6);
  CHECK(sim.fluid().size() == 800);
  // Rounding, times what coefficient times velocity is over the drag that is left of it: some 1e4
  // for a grain that sinks at its terminal velocity.
  CHECK(sim.fluid().closure().momentum < 1e-11);
  // Where the liquid's centre is if it fills what the grains leave from the floor up: by 400 slices
  // of the height, each grain as a slab of its diameter. 2 %: the level's own error is a fifth of a
  // spacing. Without their volume it would stay at half of the depth, 19 % lower.
  double centre = 0, filled = 0, volume = 0.08 * 0.01, seen = 0;
  for (int slice = 0; filled < volume; ++slice) {
    const double low = slice * 2.5e-4, high = low + 2.5e-4;
    double solids = 0;
    for (std::size_t k = 0; k < 400; ++k) {
      const double z = sim.position(k).z, r = 0.004;
      solids += std::max(0.0, std::min(high, z + r) - std::max(low, z - r)) / (2 * r) *
                (4 * std::numbers::pi / 3) * r * r * r;
    }
    const double more = std::min(volume - filled, 0.01 * 2.5e-4 - solids);
    centre += more * 0.5 * (low + high), filled += more;
  }
  centre /= volume;
  sim.fluid().for_each(
      [&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) { seen += x.z / 800; });
  CHECK(centre > 1.15 * 0.04);
  CHECK(seen == near(centre).epsilon(0.02));
}

TEST_CASE("SPH with unresolved grains: same bits with threads, and from a checkpoint on") {
  // With a ball that is resolved, and a wall of the Simulation.
  const std::string path =
      (std::filesystem::temp_directory_path() / "silt_sph_grains.silt").string();
  auto sim = settling(true);
  sim.run(0.1);
  save_checkpoint(sim, path);
  const auto loads = sph_test::loads_of(sim);
  sim.run(0.02);
  auto again = settling(true, path);
  // A reading before the first step had no volumes of grains: a segmentation fault. The ball was at
  // the origin, and the floor unknown.
  CHECK(sph_test::loads_of(again) == loads);
  again.run(0);
  CHECK(sph_test::loads_of(again) == loads);
  again.threads = 3;
  again.run(0.02);
  CHECK(state_of(again) == state_of(sim));
  CHECK(sph_test::loads_of(again) == sph_test::loads_of(sim));
  std::filesystem::remove(path);
}

TEST_CASE("SPH with unresolved grains: readings between steps change no bit") {
  // A reading renewed the void fractions, and with them the densities at the surface, between two
  // steps: grains moved by 1e-12 to 1e-11 m otherwise, and last_exchange() was empty after it.
  auto quiet = settling(true), read = settling(true);
  const std::string path = (std::filesystem::temp_directory_path() / "silt_sph_read.silt").string();
  for (int k = 0; k < 8; ++k) {
    quiet.run(2e-3), read.run(2e-3, at(every_steps(7), [](const auto& sim) {
                                return sim.fluid().wall_load(0).first.z;
                              }));
    const double solids = read.fluid().last_exchange().solids;
    CHECK(std::isfinite(read.fluid().wall_load(0).first.z));
    CHECK(read.fluid().last_exchange().solids == solids);
  }
  CHECK(state_of(read) == state_of(quiet));
  save_checkpoint(read, path);  // nor is a trace of the reading saved
  auto again = settling(true, path);
  again.run(4e-3), quiet.run(4e-3);
  CHECK(state_of(again) == state_of(quiet));
  std::filesystem::remove(path);
}

TEST_CASE("SPH with unresolved grains: settings that cannot be are refused") {
  const auto with = [](const UnresolvedGrainsSetup& setup) {
    return silt_test::refusal([&] {
      Sph{Liquid{.density = rho, .sound_speed = 10},
          {.spacing = 0.01, .region = {{0, 0, 0}, {0.1, 0.1, 0.1}}},
          UnresolvedGrains{WenYu{}, setup}};
    });
  };
  CHECK(silt_test::has(with({}), "UnresolvedGrainsSetup.viscosity = 0"));
  CHECK(silt_test::has(with({.viscosity = 1e-3, .least_voidage = 1}), "must be in (0, 1)"));
  CHECK(silt_test::has(with({.viscosity = 1e-3, .resolved_from = 1}), "must be at least 1.5"));
}

}  // namespace sph_grains_test
