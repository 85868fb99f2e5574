// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <silt/core/random.hpp>
#include <silt/coupling/drag/di_felice.hpp>
#include <silt/sph.hpp>

#include "near.hpp"
#include "refusal.hpp"
#include "sph/openings_support.hpp"

namespace sph_openings_test {

using namespace silt;

namespace {
constexpr double none = std::numeric_limits<double>::quiet_NaN();
}

TEST_CASE("SPH openings: a uniform stream stays one, and what comes in leaves") {
  // Without openings, in a channel that repeats, the noise is as large. A
  // buffer that ends too early, a row of it that is late, or a density of buffers that is off shows
  // as waves of rho c v = 20 kPa per m/s.
  auto water = stream(0.05, 2, {.name = "out", .pressure = 1000.0});
  const std::size_t start = water.size();
  water.run(0.6);
  const auto [v, p] = unrest(water);
  MESSAGE("uniform: ", v, " m/s, ", p, " Pa");
  CHECK(v < 0.005);
  CHECK(p < 5);
  // 20 a row, a row each 0.05 s.
  CHECK(water.opening_books(0).in.particles == 240);
  CHECK(water.opening_books(0).out.particles == 0);
  CHECK(water.opening_books(1).out.particles == 240);
  CHECK(water.flow_rate(0) == near(1000).epsilon(1e-9));
  CHECK(water.flow_rate(1) == near(-1000).epsilon(1e-3));
  CHECK(water.opening_books(0).in.momentum.x == near(water.opening_books(0).in.mass).epsilon(1e-9));
  CHECK(water.opening_books(0).in.kinetic_energy ==
        near(0.5 * water.opening_books(0).in.mass).epsilon(1e-9));
  CHECK(water.opening_books(1).out.pressure_work == near(600.0).epsilon(0.01));
  books_close(water, start);
  // Buffers do not load the walls beside them: 2 m of floor under 1 kPa. 2 %: half a spacing at
  // each end; with buffers it would be 8 % too much.
  CHECK(water.wall_load(0).first.z == near(-2000).epsilon(0.02));
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

TEST_CASE("SPH openings: what a pulse of sound leaves behind at an outlet") {
  // p = rho c v, which runs to the outlet and partly back: the largest p in the channel over that
  // of the same pulse at that time in a longer channel. A given pressure turns the pulse over: -1.
  const auto largest = [](double L, OpeningSetup out, bool absorbs = false) {
    const double s = 0.05, H = 0.5, c = 20, p0 = 1000, a = 200;
    Sph water{Liquid{.density = 1000, .sound_speed = c},
              {.spacing = s, .region = {{0, 0, 0}, {L, 0, H}}, .dimensions = 2},
              NoShifting{}};
    water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
    water.add_wall(Plane{{0, 0, H}, {0, 0, -1}});
    water.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
    // That of a wave which goes out alone, p0 + rho c v: as docs/sph.md has it.
    if (absorbs)
      out.pressure = [&, c, H, p0](const Vec3d&, double) {
        return p0 - c * water.flow_rate(0) / H;
      };
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
               nothing = largest(3, {.name = "out"}) / there,
               absorbed = largest(3, {.name = "out"}, true) / there;
  MESSAGE("sound: given pressure ", given, ", nothing given ", nothing, ", absorbed ", absorbed,
          " of ", there);
  CHECK(given == near(-1).epsilon(0.05));
  CHECK(nothing < 0);
  CHECK(nothing > -1.05);
  CHECK(std::abs(absorbed) < 0.3);
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
    seen.add(r, 0.02 * random.uniform(0.5, 1), row);
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
  refused([](S, O o, P) { o.corner.y = 0.3; },
          "has its corner at (0, 0.3, 0.05) m, but in 2D the liquid lies in the plane y = 0 m");
  refused([](S, O, P p) { p.velocity = {1, 0.5, 0}; }, "with a part along y");
  refused([](S s, O, P) { s.periodic[0] = true; }, "faces x, in which the region is periodic");
  refused([](S, O, P p) { p.velocity = {-1, 0, 0}; }, "points out of the liquid");
  refused([](S, O, P p) { p.velocity = {1, 0, 0}; }, "points into the liquid", false);
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
  refused([&](S, O, P p) { p.velocity = turns({1, 0.5, 0}); }, "with a part along y", true, true);
  refused([&](S, O, P p) { p.velocity = turns({none, 0, 0}); }, "it must be finite", true, true);
  refused([](S, O, P p) { p.pressure = [](const Vec3d&, double) { return -1e6; }; },
          "it must be finite, and above", true, true);
  refused([](S s, O o, P) { s.region.min.z = -0.05, o.corner.z = -0.02; },
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
                       doctest::Contains("openings and UnresolvedGrains cannot be combined"),
                       InputError);
  Sph books{liquid, setup, EnergyLedger{}};
  CHECK_THROWS_WITH_AS(books.add_outlet(at),
                       doctest::Contains("openings and an EnergyLedger cannot be combined"),
                       InputError);
}

TEST_CASE("SPH openings: a drop that comes back above an inlet's surface does not make it wider") {
  // The six particles of the drop enter the buffer above its ten rows, and leave it again. Followed
  // by others of their rows they added 15 % to the inflow for ever.
  const double depth = 0.05, dx = 0.005, U = 1;
  Sph water{Liquid{.density = 1000, .sound_speed = 15},
            {.spacing = dx,
             .region = {{0, 0, 0}, {0.3, 0, 0.3}},
             .dimensions = 2,
             .gravity = {0, 0, -9.81}},
            ArtificialViscosity{.alpha = 0.1}};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_inlet({.corner = {0, 0, 0}, .edge = {0, 0, 0.1}, .into = {1, 0, 0}},
                  {.velocity = {U, 0, 0}, .surface = depth});
  water.add_outlet({.corner = {0.3, 0, 0}, .edge = {0, 0, 0.1}, .into = {-1, 0, 0}}, {});
  const auto in_drop = [](const Vec3d& x) { return std::hypot(x.x - 0.03, x.z - 0.085) < 0.012; };
  water.fill([&](const Vec3d& x) { return x.z < depth || in_drop(x); },
             [&](const Vec3d& x) {
               return in_drop(x) ? Vec3d{-U, 0, 0.3} : Vec3d{U, 0, 0};
             },
             [&](const Vec3d& x) { return in_drop(x) ? 0 : 9810 * (depth - x.z); });
  const double want = 1000 * U * depth;
  double most = 0;
  for (int k = 0; k < 40; ++k) water.run(4e-3), most = std::max(most, water.flow_rate(0) / want);
  CHECK(most > 1.02);  // the drop has been in the buffer
  CHECK(water.flow_rate(0) == near(want).epsilon(1e-9));
}

}  // namespace sph_openings_test
