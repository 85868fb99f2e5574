// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"
#include "sph/openings_support.hpp"

namespace sph_openings_test {

using namespace silt;

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
  streams(stream(0.05, 2, pressure, Inviscid{}, CubicSpline{}, NoShifting{}));
  streams(stream(0.05, 2, {.name = "all from the liquid"}));
  streams(stream(0.05, 2, {.name = "suction", .velocity = {1, 0, 0}}));
  streams(stream(0.1, 3, pressure));
  streams(stream(0.1, 3, pressure, Mixed{}, VerletTime{}));
  // Dynamic walls push the liquid off and rub it as it settles; all of it still flows.
  auto water = stream(0.05, 2, pressure, DynamicWalls{});
  const std::size_t start = water.size();
  water.run(0.5);
  CHECK(water.flow_rate(1) == near(-1000).epsilon(0.05));
  CHECK(water.wall_load(0).first.z == near(-2000).epsilon(0.2));
  books_close(water, start);
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
          LaminarViscosity{.kinematic = nu, .alpha = 0}};
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
  // Seen: 0.6 % and 1.015. An inlet with one velocity for all would be off by 30 %; walls of first
  // order (images with the velocity of the liquid around them) had 1.5 % and 1.07.
  CHECK(rms < 0.01 * 1.5 * U);
  CHECK(-slope == near(G).epsilon(0.03));
  CHECK(oil.flow_rate(0) == near(1000 * U * H).epsilon(0.01));
  CHECK(oil.flow_rate(1) == near(-1000 * U * H).epsilon(0.03));
  books_close(oil, start);
}

TEST_CASE("SPH openings: a channel with a free surface keeps its level at Froude 0.4") {
  const double D = 0.1, U = 0.4 * std::sqrt(g * D), L = 0.6;
  Sph water{Liquid{.density = 1000, .sound_speed = 15 * std::sqrt(g * D)},
            {.spacing = D / 10,
             .region = {{0, 0, 0}, {L, 0, 2 * D}},
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

TEST_CASE("SPH openings: a tank is filled through its wall, and emptied through its floor") {
  // Filled from nothing: the mass is Q t to a row of particles, and lies at rest in the end.
  const double s = 0.01, W = 0.2, U = 0.5;
  Sph water{
      Liquid{.density = 1000, .sound_speed = 25},
      {.spacing = s, .region = {{0, 0, 0}, {W, 0, 0.4}}, .dimensions = 2, .gravity = {0, 0, -g}},
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
  MESSAGE("filled: ", water.mass() / (1000 * level * W), " of Q t, level ", centre / level,
          ", lost ", water.left());
  // The wall below the opening has two spacings: some particles get behind it at its edge.
  CHECK(water.left() <= 4);
  CHECK(water.mass() == near(1000 * level * W).epsilon(0.03));
  CHECK(centre == near(level).epsilon(0.05));
  books_close(water, 0);
}

TEST_CASE(
    "SPH openings: a tank runs out through a hole in its floor, as Torricelli and its jet say") {
  const double s = 0.01, W = 0.4, H = 0.25, hole = 0.1;
  Sph water{
      Liquid{.density = 1000, .sound_speed = 25},
      {.spacing = s, .region = {{0, 0, 0}, {W, 0, 0.4}}, .dimensions = 2, .gravity = {0, 0, -g}},
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
  // 0.611 of a sharp slit by Kirchhoff's free streamlines; walls reach 1.4 spacings over each of
  // its edges.
  CHECK(C == near(0.611 * (1 - 2.8 * s / hole)).epsilon(0.1));
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
  // One column of particles more or less has come back: 0.58 or 0.64, for A from 780 to 820.
  CHECK(speed() < -0.55 * largest);
  CHECK(water.opening_books(1).in.particles > 0);  // an outlet that lets in
  CHECK(water.opening_books(0).out.particles > 0);
  CHECK(water.mass() == near(1000 * L * H).epsilon(0.03));
  books_close(water, start);
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
    sim.run(0.03);
    save_checkpoint(sim, path);
    sim.run(0.0204);
    auto again = river(path, policies...);
    again.threads = 2;
    CHECK(again.fluid().opening_books(0).in.particles > 0);
    again.run(0.0204);
    CHECK(bits(again.fluid()) == bits(sim.fluid()));
    CHECK(again.velocity(0).x == sim.velocity(0).x);
    CHECK(sim.velocity(0).x > 0.01);  // the ball goes with the stream
    std::filesystem::remove(path);
  };
  goes_on(), goes_on(VerletTime{}, DynamicWalls{});
}

}  // namespace sph_openings_test
