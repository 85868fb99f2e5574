// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace sph_openings_test {

using namespace silt;

namespace {

constexpr double g = 9.81;
constexpr double none = std::numeric_limits<double>::quiet_NaN();
const auto everywhere = [](const Vec3d&) { return true; };

/// Liquid between slip walls, 2 m long and 1 m high, that streams with 1 m/s under 1 kPa.
template <class... Policies>
auto stream(double spacing, int dimensions, const OpeningSetup& out, const Policies&... policies) {
  const double width = dimensions == 3 ? 8 * spacing : 0, L = dimensions == 3 ? 0.6 : 2;
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = spacing,
             .region = {{0, 0, 0}, {L, width, 1}},
             .smoothing = dimensions == 3 ? 0.8 : 1.2,
             .dimensions = dimensions,
             .periodic = {false, dimensions == 3, false}},
            policies...};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, 1}, {0, 0, -1}});
  Opening one{.corner = {0, 0, 0}, .edge = {0, 0, 1}, .into = {1, 0, 0}},
      other{.corner = {L, 0, 0}, .edge = {0, 0, 1}, .into = {-2, 0, 0}};
  one.second_edge = other.second_edge = {0, width, 0};
  water.add_inlet(one, {.name = "in", .velocity = {1, 0, 0}});
  water.add_outlet(other, out);
  water.fill(
      everywhere,
      [](const Vec3d&) {
        return Vec3d{1, 0, 0};
      },
      [](const Vec3d&) { return 1000.0; });
  return water;
}
/// Largest errors of velocity [m/s] and pressure [Pa].
template <class Water>
std::array<double, 2> unrest(const Water& water) {
  std::array<double, 2> off{};
  water.for_each([&](std::uint32_t, const Vec3d&, const Vec3d& v, double, double p) {
    off[0] = std::max(off[0], norm(v - Vec3d{1, 0, 0})),
    off[1] = std::max(off[1], std::abs(p - 1000));
  });
  return off;
}
template <class Water>
std::vector<double> bits(const Water& water) {
  std::vector<double> all;
  water.for_each([&](std::uint32_t n, const Vec3d& x, const Vec3d& v, double rho, double) {
    all.insert(all.end(), {static_cast<double>(n), x.x, x.y, x.z, v.x, v.y, v.z, rho});
  });
  water.for_each_buffer([&](std::size_t o, const Vec3d& x, const Vec3d& v, double rho, double) {
    all.insert(all.end(), {static_cast<double>(o), x.x, x.y, x.z, v.x, v.y, v.z, rho});
  });
  for (std::size_t o = 0; o < water.openings(); ++o)
    for (const OpeningFlow& f : {water.opening_books(o).in, water.opening_books(o).out})
      all.insert(all.end(), {static_cast<double>(f.particles), f.mass, f.momentum.x,
                             f.kinetic_energy, f.pressure_work});
  return all;
}
/// Numbers of all liquid are true: what was there, came, left.
template <class Water>
void books_close(const Water& water, std::size_t start) {
  std::size_t in = 0, out = 0, seen = 0;
  double mass = static_cast<double>(start) * water.particle_mass();
  for (std::size_t o = 0; o < water.openings(); ++o) {
    const OpeningBooks& b = water.opening_books(o);
    in += b.in.particles, out += b.out.particles, mass += b.mass();
  }
  water.for_each([&](std::uint32_t, const Vec3d&, const Vec3d&, double, double) { ++seen; });
  CHECK(water.size() == start + in - out - water.left());
  CHECK(water.size() == seen);
  CHECK(water.mass() == near(mass).epsilon(1e-9));
}

}  // namespace

TEST_CASE("SPH openings: a uniform stream stays one, and what comes in leaves") {
  // Without openings, in a channel that repeats, the noise after 2 s is 0.005 m/s and 4 Pa. A
  // buffer that ends too early, a row of it that is late, or a density of buffers that is off shows
  // as waves of rho c v = 20 kPa per m/s.
  auto water = stream(0.05, 2, {.name = "out", .pressure = 1000.0});
  const std::size_t start = water.size();
  water.run(2);
  const auto [v, p] = unrest(water);
  MESSAGE("uniform: ", v, " m/s, ", p, " Pa");
  CHECK(v < 0.005);
  CHECK(p < 5);
  // 20 a row, a row each 0.05 s.
  CHECK(water.opening_books(0).in.particles == 800);
  CHECK(water.opening_books(0).out.particles == 0);
  CHECK(water.opening_books(1).out.particles == 800);
  CHECK(water.flow_rate(0) == near(1000).epsilon(1e-9));
  CHECK(water.flow_rate(1) == near(-1000).epsilon(1e-3));
  CHECK(water.opening_books(0).in.momentum.x == near(water.opening_books(0).in.mass).epsilon(1e-9));
  CHECK(water.opening_books(0).in.kinetic_energy ==
        near(0.5 * water.opening_books(0).in.mass).epsilon(1e-9));
  CHECK(water.opening_books(1).out.pressure_work == near(2000.0).epsilon(0.01));
  books_close(water, start);
  // Buffers do not load the walls beside them: 2 m of floor under 1 kPa. 2 %: half a spacing at
  // each end; with buffers it would be 8 % too much.
  CHECK(water.wall_load(0).first.z == near(-2000).epsilon(0.02));
}

TEST_CASE("SPH openings: all policies, in 3D, and an outlet that prescribes nothing or a suction") {
  const auto streams = [](auto water) {
    const std::size_t start = water.size();
    water.run(0.3);
    const auto [v, p] = unrest(water);
    MESSAGE("policies: ", v, " m/s, ", p, " Pa");
    CHECK(v < 0.005);
    CHECK(p < 20);
    books_close(water, start);
    CHECK(water.opening_books(0).in.particles == water.opening_books(1).out.particles);
  };
  const OpeningSetup pressure{.name = "out", .pressure = 1000.0};
  streams(stream(0.05, 2, pressure, VerletTime{}));
  streams(stream(0.05, 2, pressure, Mixed{}));
  streams(stream(0.05, 2, pressure, LaminarViscosity{.kinematic = 1e-3}, NoShifting{}));
  streams(stream(0.05, 2, {.name = "all from the liquid"}));
  streams(stream(0.05, 2, {.name = "suction", .velocity = {1, 0, 0}}));
  streams(stream(0.1, 3, pressure));
  streams(stream(0.1, 3, pressure, Mixed{}, VerletTime{}));
  // Dynamic walls push the liquid off as it settles: it stays a stream, and its books close.
  auto water = stream(0.05, 2, pressure, DynamicWalls{});
  const std::size_t start = water.size();
  water.run(0.5);
  MESSAGE("dynamic: ", unrest(water)[0], " m/s, ", unrest(water)[1], " Pa");
  CHECK(unrest(water)[0] < 0.1);
  books_close(water, start);
  const auto load = water.wall_load(0).first.z;
  CHECK(load == near(-2000).epsilon(0.1));
  // Asking for the load changes nothing.
  auto again = stream(0.05, 2, pressure, DynamicWalls{});
  again.run(0.5), again.run(0.1), water.run(0.1);
  CHECK(bits(water) == bits(again));
}

TEST_CASE("SPH openings: flow between plates with a parabolic inlet and a pressure outlet") {
  const double H = 0.01, U = 0.01, nu = 1e-5, mu = 1000 * nu, L = 3 * H;
  const double G = 12 * mu * U / (H * H);  // [Pa/m]
  Sph oil{Liquid{.density = 1000, .sound_speed = 30 * U},
          {.spacing = H / 16, .region = {{0, 0, 0}, {L, 0, H}}, .dimensions = 2},
          LaminarViscosity{.kinematic = nu}};
  oil.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  oil.add_wall(Plane{{0, 0, H}, {0, 0, -1}});
  const auto profile = [=](const Vec3d& x) { return Vec3d{6 * U * x.z / H * (1 - x.z / H), 0, 0}; };
  oil.add_inlet({.corner = {0, 0, 0}, .edge = {0, 0, H}, .into = {1, 0, 0}},
                {.name = "in", .velocity = [=](const Vec3d& x, double) { return profile(x); }});
  oil.add_outlet({.corner = {L, 0, 0}, .edge = {0, 0, H}, .into = {-1, 0, 0}},
                 {.name = "out", .pressure = 0.4});
  oil.fill(everywhere, profile, [=](const Vec3d& x) { return 0.4 + G * (L - x.x); });
  const std::size_t start = oil.size();
  oil.run(0.5);
  // On average over 0.4 s and 2 H, layer by layer; a single particle swings by 1.5 %. The larger
  // the pressure, the more: scattered particles push each other by it.
  constexpr int layers = 16;
  double n = 0, sx = 0, sp = 0, sxx = 0, sxp = 0, squares = 0;
  std::array<double, layers> off{}, count{};
  for (int k = 0; k < 20; ++k) {
    oil.run(0.02);
    oil.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double p) {
      if (std::abs(x.x - 0.5 * L) > H) return;
      const auto layer = static_cast<std::size_t>(std::clamp(x.z / H, 0.0, 0.999) * layers);
      off[layer] += v.x - profile(x).x, count[layer] += 1;
      n += 1, sx += x.x, sp += p, sxx += x.x * x.x, sxp += x.x * p;
    });
  }
  for (std::size_t k = 0; k < layers; ++k) squares += off[k] * off[k] / (count[k] * count[k]);
  const double rms = std::sqrt(squares / layers);
  const double slope = (sxp - sx * sp / n) / (sxx - sx * sx / n);
  MESSAGE("plates: rms ", rms / (1.5 * U), ", gradient ", -slope / G, ", mean p off ",
          (sp / n - 0.4 - G * (L - sx / n)) / (G * L));
  CHECK(rms < 0.01 * 1.5 * U);
  CHECK(-slope == near(G).epsilon(0.1));
  CHECK(oil.flow_rate(0) == near(1000 * U * H).epsilon(0.01));
  CHECK(oil.flow_rate(1) == near(-1000 * U * H).epsilon(0.03));
  books_close(oil, start);
}

TEST_CASE("SPH openings: a channel with a free surface keeps its level at Froude 0.4") {
  const double D = 0.1, U = 0.4 * std::sqrt(g * D), L = 0.6;
  Sph water{Liquid{.density = 1000, .sound_speed = 15 * std::sqrt(g * D)},
            {.spacing = D / 10,
             .region = {{0, 0, 0}, {L, 0, 2 * D}},
             .smoothing = 1.0,
             .dimensions = 2,
             .gravity = {0, 0, -g}},
            ArtificialViscosity{.alpha = 0.05},
            NoShifting{}};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_inlet({.corner = {0, 0, 0}, .edge = {0, 0, 2 * D}, .into = {1, 0, 0}},
                  {.name = "river", .velocity = {U, 0, 0}, .surface = D});
  water.add_outlet({.corner = {L, 0, 0}, .edge = {0, 0, 2 * D}, .into = {-1, 0, 0}},
                   {.name = "weir", .pressure = Hydrostatic{D}});
  water.fill([=](const Vec3d& x) { return x.z < D; },
             [=](const Vec3d&) {
               return Vec3d{U, 0, 0};
             },
             [=](const Vec3d& x) { return 1000 * g * (D - x.z); });
  const std::size_t start = water.size();
  water.run(1.5);
  double top = 0, speed = 0;
  water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double) {
    top = std::max(top, x.z + 0.5 * D / 10);
    speed += v.x / static_cast<double>(water.size());
  });
  const double level = water.mass() / (1000 * L) / D;
  MESSAGE("channel: level ", level, ", top ", top / D, ", speed ", speed / U);
  CHECK(level == near(1).epsilon(0.02));
  CHECK(top == near(D).epsilon(0.03));
  CHECK(speed == near(U).epsilon(0.03));
  // 10 rows came in below the surface, not the 20 of the opening.
  const double rows = static_cast<double>(water.opening_books(0).in.particles) / 10;
  CHECK(rows == near(U * 1.5 / (D / 10)).epsilon(0.02));
  books_close(water, start);
}

TEST_CASE("SPH openings: a jet from a nozzle falls in a parabola") {
  // All of it has the speed of the nozzle across gravity: straight up it is as thick as the nozzle.
  // 5 %: a particle is 12 % of its width. A pressure at the nozzle of a tenth of rho U^2 would show
  // as 5 % of the speed.
  const double b = 0.05, U = 1, s = b / 8;
  Sph water{Liquid{.density = 1000, .sound_speed = 30},
            {.spacing = s,
             .region = {{-0.1, 0, -1}, {0.6, 0, 0.3}},
             .dimensions = 2,
             .gravity = {0, 0, -g}}};
  water.add_inlet({.corner = {0, 0, -0.5 * b}, .edge = {0, 0, b}, .into = {1, 0, 0}},
                  {.name = "nozzle", .velocity = {U, 0, 0}, .pressure = 0.0});
  water.run(0.25);
  double off = 0, n = 0, speed = 0;
  water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double) {
    if (x.x < 0.03 || x.x > 0.15) return;
    off += x.z + 0.5 * g * x.x * x.x / (U * U), n += 1, speed += v.x;
  });
  const double area = n * s * s / (0.12 * b);
  MESSAGE("jet: off ", off / n / b, " of its width, area ", area, ", speed ", speed / n);
  CHECK(std::abs(off / n) < 0.05 * b);
  CHECK(area == near(1).epsilon(0.05));
  CHECK(speed / n == near(U).epsilon(0.03));
  CHECK(water.mass() == near(1000 * b * U * 0.25).epsilon(0.02));
  CHECK(water.left() == 0);
}

TEST_CASE("SPH openings: a jet askew to the axes goes straight on") {
  const double b = 0.05, U = 1, s = b / 8, angle = 0.4;
  const Vec3d along{std::cos(angle), 0, std::sin(angle)}, across{-along.z, 0, along.x};
  Sph water{Liquid{.density = 1000, .sound_speed = 30},
            {.spacing = s, .region = {{-0.1, 0, -0.1}, {0.6, 0, 0.6}}, .dimensions = 2}};
  water.add_inlet({.corner = -0.5 * b * across, .edge = b * across, .into = 3 * along},
                  {.name = "nozzle", .velocity = U * along, .pressure = 0.0});
  water.run(0.2);
  double off = 0, wide = 0;
  water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double, double) {
    off = std::max(off, norm(v - U * along)), wide = std::max(wide, std::abs(dot(x, across)));
  });
  MESSAGE("askew: ", off, " m/s, ", wide / b);
  CHECK(off < 0.01 * U);
  CHECK(wide < 0.5 * b);
  CHECK(water.mass() == near(1000 * b * U * 0.2).epsilon(0.04));
}

TEST_CASE("SPH openings: a tank is filled through its wall, and emptied through its floor") {
  // Filled from nothing: the mass is Q t to a row of particles, and lies at rest in the end.
  const double s = 0.01, W = 0.2, U = 0.5;
  Sph water{Liquid{.density = 1000, .sound_speed = 25},
            {.spacing = s,
             .region = {{0, 0, 0}, {W, 0, 0.4}},
             .smoothing = 1.0,
             .dimensions = 2,
             .gravity = {0, 0, -g}},
            ArtificialViscosity{.alpha = 0.1}};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  water.add_wall(Plane{{W, 0, 0}, {-1, 0, 0}});
  water.add_inlet({.corner = {0, 0, 0.02}, .edge = {0, 0, 0.04}, .into = {1, 0, 0}},
                  {.name = "pipe", .velocity = {U, 0, 0}});
  water.run(1);
  double centre = 0;
  water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) {
    centre += 2 * x.z / static_cast<double>(water.size());
  });
  const double level = 0.04 * U * 1 / W;
  MESSAGE("filled: ", water.mass() / (1000 * level * W), " of Q t, level ", centre / level);
  CHECK(water.mass() == near(1000 * level * W).epsilon(0.03));
  CHECK(centre == near(level).epsilon(0.05));
  books_close(water, 0);
}

TEST_CASE(
    "SPH openings: a tank runs out through a hole in its floor, as Torricelli and its jet say") {
  const double s = 0.01, W = 0.4, H = 0.25, hole = 0.1;
  Sph water{Liquid{.density = 1000, .sound_speed = 25},
            {.spacing = s,
             .region = {{0, 0, 0}, {W, 0, 0.4}},
             .smoothing = 1.0,
             .dimensions = 2,
             .gravity = {0, 0, -g}},
            ArtificialViscosity{.alpha = 0.05}};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  water.add_wall(Plane{{W, 0, 0}, {-1, 0, 0}});
  water.add_outlet({.corner = {0.15, 0, 0}, .edge = {hole, 0, 0}, .into = {0, 0, 1}},
                   {.name = "hole", .pressure = 0.0});
  water.fill([=](const Vec3d& x) { return x.z < H; });
  const std::size_t start = water.size();
  water.run(0.1);
  const double before = water.mass();
  water.run(0.3);
  const double after = water.mass();
  // d(sqrt h)/dt = -C hole/W sqrt(g/2)
  const double fall = std::sqrt(before / (1000 * W)) - std::sqrt(after / (1000 * W));
  const double C = fall / (0.3 * hole / W * std::sqrt(g / 2));
  MESSAGE("emptied: contraction ", C);
  CHECK(C > 0.5);
  CHECK(C < 1);
  CHECK(water.left() == 0);
  books_close(water, start);
}

TEST_CASE("SPH openings: a pressure drives a slug in and out again") {
  // rho (L + 2 x) du/dt = A cos(w t): pressures are those of the middle of buffers, as it were,
  // x = 1.4 spacings behind each plane. Liquid that goes back through the inlet is what came.
  const double s = 0.05, L = 2, H = 0.5, A = 800, T = 2;
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = s, .region = {{0, 0, 0}, {L, 0, H}}, .dimensions = 2},
            NoShifting{}};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, H}, {0, 0, -1}});
  const double w = 2 * std::numbers::pi / T;
  water.add_inlet({.corner = {0, 0, 0}, .edge = {0, 0, H}, .into = {1, 0, 0}},
                  {.name = "in",
                   .pressure = [=](const Vec3d&, double t) { return 4000 + A * std::cos(w * t); }});
  water.add_outlet({.corner = {L, 0, 0}, .edge = {0, 0, H}, .into = {-1, 0, 0}},
                   {.name = "out", .pressure = 4000.0});
  water.fill(
      everywhere,
      [](const Vec3d&) {
        return Vec3d{0, 0, 0};
      },
      [=](const Vec3d& x) { return 4000 + A * (1 - x.x / L); });
  const std::size_t start = water.size();
  const auto speed = [&] { return water.momentum().x / water.mass(); };
  const double largest = A / (1000 * L * w);
  water.run(0.25 * T);
  const double quarter = speed();
  water.run(0.5 * T);
  MESSAGE("slug: ", quarter / largest, ", ", speed() / largest);
  CHECK(quarter == near(largest * L / (L + 2.8 * s)).epsilon(0.03));
  CHECK(speed() < -0.6 * largest);
  CHECK(water.opening_books(1).in.particles > 0);  // an outlet that lets in
  CHECK(water.opening_books(0).out.particles > 0);
  CHECK(water.mass() == near(1000 * L * H).epsilon(0.03));
  books_close(water, start);
}

TEST_CASE("SPH openings: what a pulse of sound leaves behind at an outlet") {
  // p = rho c v, which runs to the outlet and partly back: the largest p in the channel over that
  // of the same pulse at that time in a longer channel. A given pressure turns the pulse over: -1.
  const auto largest = [](double L, const OpeningSetup& out) {
    const double s = 0.05, H = 0.5, c = 20, p0 = 1000, a = 200;
    Sph water{Liquid{.density = 1000, .sound_speed = c},
              {.spacing = s, .region = {{0, 0, 0}, {L, 0, H}}, .dimensions = 2},
              NoShifting{}};
    water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
    water.add_wall(Plane{{0, 0, H}, {0, 0, -1}});
    water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
    water.add_outlet({.corner = {L, 0, 0}, .edge = {0, 0, H}, .into = {-1, 0, 0}}, out);
    const auto pulse = [=](const Vec3d& x) {
      const double d = (x.x - 1.5) / 0.3;
      return a * std::exp(-d * d);
    };
    water.fill(
        everywhere,
        [=](const Vec3d& x) {
          return Vec3d{pulse(x) / (1000 * c), 0, 0};
        },
        [=](const Vec3d& x) { return p0 + pulse(x); });
    water.run(0.12);
    double most = 0;
    water.for_each([&](std::uint32_t, const Vec3d&, const Vec3d&, double, double p) {
      if (std::abs(p - p0) > std::abs(most)) most = p - p0;
    });
    return most;
  };
  const double there = largest(5, {.name = "out", .pressure = 1000.0});
  const double given = largest(3, {.name = "out", .pressure = 1000.0}) / there,
               nothing = largest(3, {.name = "out"}) / there;
  MESSAGE("sound: given pressure ", given, ", nothing given ", nothing, " of ", there);
  CHECK(given == near(-1).epsilon(0.05));
  CHECK(nothing < 0);
  CHECK(nothing > -1.05);
}

TEST_CASE("SPH openings: what probes see is right to first order") {
  // A linear velocity at scattered places, seen from one side: the value at the probe, not a mean.
  Random random(3);
  detail::SphSeenFlow seen;
  const auto flow = [](const Vec3d& r) {
    return Vec3d{1 + 2 * r.x - r.z, 0.5 * r.y, 3 * r.z - r.x};
  };
  for (int k = 0; k < 60; ++k) {
    const Vec3d r{random.uniform(0.1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    detail::SphRow row{};
    row.density = 1000 + 5 * r.x - 2 * r.y, row.move(flow(r));
    seen.add(r, 0.01 * random.uniform(0.5, 1), row);
  }
  CHECK(norm(seen.flow(0.8, {0, 0, 0}) - Vec3d{1, 0, 0}) < 1e-12);
  CHECK(norm((1 / seen.weight) * seen.velocity - Vec3d{1, 0, 0}) > 0.5);
  const Vec3d away{-2, 0.3, 0};
  const double density =
      seen.at(away, Liquid{.density = 1000, .sound_speed = 20}, {0, 0, 0}, 0.8, false).density;
  CHECK(density == near(1000 + 5 * away.x - 2 * away.y).epsilon(1e-12));
}

TEST_CASE("SPH openings: the same bits for every number of threads") {
  const auto compare = [](auto... policies) {
    auto one = stream(0.05, 2, {.name = "out", .pressure = 1000.0}, policies...);
    auto two = stream(0.05, 2, {.name = "out", .pressure = 1000.0}, policies...);
    one.run(0.12, 1), two.run(0.12, 2);
    CHECK(bits(one) == bits(two));
    CHECK(one.opening_books(0).in.particles == 40);
  };
  compare(Double{}), compare(Mixed{}, VerletTime{}), compare(DynamicWalls{});
}

namespace {
template <class... Policies>
auto river(const std::string& checkpoint, const Policies&... policies) {
  const double s = 0.0125, D = 0.1, U = 0.3;
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = s,
             .region = {{0, 0, 0}, {0.3, 0.2, 0.2}},
             .smoothing = 0.8,
             .periodic = {false, true, false}},
            ArtificialViscosity{.alpha = 0.05},
            policies...};
  water.add_inlet(
      {.corner = {0, 0, 0}, .edge = {0, 0.2, 0}, .second_edge = {0, 0, D}, .into = {1, 0, 0}},
      {.name = "in", .velocity = [=](const Vec3d&, double t) {
         return Vec3d{U + t, 0, 0};
       }});
  water.add_outlet(
      {.corner = {0.3, 0, 0}, .edge = {0, 0.2, 0}, .second_edge = {0, 0, 0.2}, .into = {-1, 0, 0}},
      {.name = "out", .pressure = Hydrostatic{D}});
  water.gravity = {0, 0, -g};
  water.fill([=](const Vec3d& x) { return x.z < D; },
             [=](const Vec3d&) {
               return Vec3d{U, 0, 0};
             },
             [=](const Vec3d& x) { return 1000 * g * (D - x.z); });
  Particles<Sphere> balls;
  balls.add({.position = {0.1, 0.1, 0.095}, .radius = 0.025, .density = 500});
  const HertzMindlin::Material cork{
      .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};
  Simulation sim{std::move(balls), Contacts<HertzMindlin>{cork}, std::move(water),
                 PeriodicBox{{{-1, 0, 0}, {1, 0.2, 1}}, {false, true, false}}};
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, cork);
  sim.gravity = {0, 0, -g};
  sim.time_step = 2e-5;
  if (!checkpoint.empty()) load_checkpoint(sim, checkpoint);
  return sim;
}
}  // namespace

TEST_CASE("SPH openings in a Simulation: the same bits from a checkpoint on, beside a body") {
  const auto goes_on = [](auto... policies) {
    const std::string path =
        (std::filesystem::temp_directory_path() / "silt_sph_openings.silt").string();
    auto sim = river("", policies...);
    sim.run(0.06);
    save_checkpoint(sim, path);
    sim.run(0.0404);
    auto again = river(path, policies...);
    again.threads = 2;
    CHECK(again.fluid().opening_books(0).in.particles > 0);
    again.run(0.0404);
    CHECK(bits(again.fluid()) == bits(sim.fluid()));
    CHECK(again.velocity(0).x == sim.velocity(0).x);
    CHECK(sim.velocity(0).x > 0.01);  // the ball goes with the stream
    std::filesystem::remove(path);
  };
  goes_on(), goes_on(VerletTime{}, DynamicWalls{});
}

namespace {
/// What a scene of 0.2 by 0.2 m with one opening says as it is made and run for a step.
template <class Change>
void refused(const Change& change, const char* words, bool inlet = true, bool runs = false) {
  const auto call = [&] {
    SphSetup setup{.spacing = 0.01, .region = {{0, 0, 0}, {0.2, 0, 0.2}}, .dimensions = 2};
    Opening at{.corner = {0, 0, 0.05}, .edge = {0, 0, 0.1}, .into = {1, 0, 0}};
    OpeningSetup of{.name = "one"};
    if (inlet) of.velocity = {1, 0, 0};
    change(setup, at, of);
    Sph water{Liquid{.density = 1000, .sound_speed = 20}, setup};
    water.add_wall(Plane{{0, 0, 0.0}, {0, 0, 1}});
    if (inlet)
      water.add_inlet(at, of);
    else
      water.add_outlet(at, of);
    if (runs) water.step(1e-4);
  };
  CHECK_THROWS_AS(call(), InputError);
  silt_test::has(silt_test::refusal(call), words);
}
}  // namespace

TEST_CASE("SPH openings: what cannot be is refused by name") {
  using S = SphSetup&;
  using O = Opening&;
  using P = OpeningSetup&;
  refused([](S, O o, P) { o.corner.x = -0.1; },
          "Sph: inlet 'one' has a corner at (-0.1, 0, 0.05) m, outside of SphSetup.region");
  refused([](S, O o, P) { o.edge.z = 0.105; }, "10.5 spacings; it must be a whole number of them");
  refused(
      [](S, O o, P) {
        o.edge = {0.01, 0, 0.1}, o.edge *= 0.1 / norm(o.edge);
      },
      "must be at right angles");
  refused([](S, O o, P) { o.into = {0, 0, 0}; }, "has no direction");
  refused([](S, O o, P) { o.into.x = none; }, "must be finite");
  refused([](S, O o, P) { o.second_edge = {0, 0.1, 0}; }, "in 2D inlet 'one' lies in x and z");
  refused([](S s, O o, P) { s.dimensions = 3, s.region.max.y = 0.2, o.edge.y = 0; },
          "has an edge of 0 m");
  refused([](S s, O, P) { s.periodic[0] = true; }, "faces x, in which the region repeats");
  refused([](S, O, P p) { p.velocity = {-1, 0, 0}; }, "leads out of the liquid");
  refused([](S, O, P p) { p.velocity = {1, 0, 0}; }, "leads into the liquid", false);
  refused([](S, O, P p) { p.velocity = {3, 0, 0}; }, "faster than a tenth of Liquid.sound_speed");
  refused([](S, O, P p) { p.velocity = {none, 0, 0}; }, "must be finite");
  refused([](S, O, P p) { p.velocity = {}; }, "has neither a velocity nor a pressure");
  refused([](S, O, P p) { p.pressure = none; }, "pressure = nan Pa must be finite");
  refused([](S, O, P p) { p.pressure = Hydrostatic{none}; }, "Hydrostatic.surface must be finite");
  refused([](S, O, P p) { p.surface = none; }, "surface must be finite");
  refused([](S, O, P p) { p.surface = 0.1; }, "an outlet has no surface of its own", false);
  const auto turns = [](const Vec3d& v) { return [v](const Vec3d&, double) { return v; }; };
  refused(
      [&](S, O, P p) {
        p.velocity = turns({-1, 0, 0});
      },
      "out of the liquid; an inlet's", true, true);
  refused([&](S, O, P p) { p.velocity = turns({3, 0, 0}); }, "faster than a tenth", true, true);
  refused([&](S, O, P p) { p.velocity = turns({none, 0, 0}); }, "it must be finite", true, true);
  refused([](S, O, P p) { p.pressure = [](const Vec3d&, double) { return -1e6; }; },
          "it must be finite, and above", true, true);
  refused(
      [](S, O o, P) {
        o.corner.z = 0;
        o.corner.z = 0.002;
      },
      "in front of inlet 'one' at", true, true);
}

TEST_CASE("SPH openings: two that overlap, or that come late, or with small grains, are refused") {
  const SphSetup setup{.spacing = 0.01, .region = {{0, 0, 0}, {0.2, 0, 0.2}}, .dimensions = 2};
  const Liquid liquid{.density = 1000, .sound_speed = 20};
  const Opening at{.corner = {0, 0, 0.05}, .edge = {0, 0, 0.1}, .into = {1, 0, 0}};
  Sph water{liquid, setup};
  water.add_inlet(at, {.name = "one", .velocity = {1, 0, 0}});
  Opening next = at;
  next.corner.z = 0.1;
  CHECK_THROWS_WITH_AS(water.add_outlet(next, {.name = "two"}),
                       doctest::Contains("outlet 'two' and inlet 'one' overlap"), InputError);
  next.corner.z = 0.15, next.edge.z = 0.05;
  water.add_outlet(next, {.name = "beside"});
  CHECK_THROWS_WITH_AS(static_cast<void>(water.opening_books(2)),
                       doctest::Contains("there is no opening 2; there are 2"), InputError);
  CHECK_THROWS_WITH_AS(static_cast<void>(water.flow_rate(7)), doctest::Contains("no opening 7"),
                       InputError);
  Sph full{liquid, setup};
  full.fill(everywhere);
  CHECK_THROWS_WITH_AS(full.add_inlet(at, {.velocity = {1, 0, 0}}),
                       doctest::Contains("add_inlet() comes after fill(); add openings first"),
                       InputError);
  CHECK_THROWS_WITH_AS(full.add_outlet(at), doctest::Contains("add_outlet() comes after fill()"),
                       InputError);
  Sph sand{liquid, setup, UnresolvedGrains{DiFelice{}, {.viscosity = 1e-3}}};
  CHECK_THROWS_WITH_AS(sand.add_outlet(at),
                       doctest::Contains("openings and UnresolvedGrains do not go together"),
                       InputError);
}

}  // namespace sph_openings_test
