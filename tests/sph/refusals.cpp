// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace sph_refusals_test {

using namespace silt;

namespace {
/// Throws an E that says so.
template <class E, class Call>
void refuses(const Call& call, const char* words) {
  CHECK_THROWS_AS(call(), E);
  silt_test::has(silt_test::refusal(call), words);
}
constexpr double none = std::numeric_limits<double>::quiet_NaN();
const Liquid water{.density = 1000, .sound_speed = 20};
const SphSetup setup{.spacing = 0.01, .region = {{0, 0, 0}, {0.2, 0, 0.2}}, .dimensions = 2};
template <class Change>
auto made(const Change& change) {
  return [change] {
    Liquid l = water;
    SphSetup s = setup;
    change(l, s);
    Sph sph{l, s};
  };
}
// Read in observers that are given a constant simulation, such as a table's.
static_assert(requires(const decltype(Sph{water, setup}) & sph) { sph.wall_load(0); });
}  // namespace

TEST_CASE("SPH: settings that cannot be are refused by name") {
  refuses<InputError>(made([](auto& l, auto&) { l.density = 0; }), "Liquid.density = 0 [kg/m3]");
  refuses<InputError>(made([](auto& l, auto&) { l.sound_speed = none; }), "Liquid.sound_speed");
  refuses<InputError>(made([](auto& l, auto&) { l.exponent = 0.5; }), "Liquid.exponent = 0.5");
  refuses<InputError>(made([](auto&, auto& s) { s.spacing = -1; }), "SphSetup.spacing = -1 [m]");
  refuses<InputError>(made([](auto&, auto& s) { s.region.max.z = -1; }), "SphSetup.region");
  refuses<InputError>(made([](auto&, auto& s) { s.region.max.y = 0.1; }), "in 2D");
  refuses<InputError>(made([](auto&, auto& s) { s.dimensions = 1; }), "SphSetup.dimensions = 1");
  refuses<InputError>(made([](auto&, auto& s) { s.smoothing = 5; }), "SphSetup.smoothing = 5");
  refuses<InputError>(made([](auto&, auto& s) { s.courant = 2; }), "SphSetup.courant = 2");
  refuses<InputError>(made([](auto&, auto& s) { s.gravity.x = none; }), "SphSetup.gravity");
  refuses<InputError>(made([](auto&, auto& s) { s.scatter = 0.5; }), "SphSetup.scatter = 0.5");
  refuses<InputError>(made([](auto&, auto& s) { s.periodic[0] = true, s.region.max.x = 0.205; }),
                      "must be a whole number of them");
  refuses<InputError>(made([](auto&, auto& s) { s.periodic[0] = true, s.region.max.x = 0.05; }),
                      "less than two supports of the kernel");
  refuses<InputError>(made([](auto&, auto& s) { s.periodic[1] = true; }),
                      "in 2D the region cannot be periodic in y");
  refuses<InputError>([] { Sph(water, setup, ArtificialViscosity{.alpha = -1}); },
                      "ArtificialViscosity.alpha = -1");
  refuses<InputError>([] { Sph(water, setup, LaminarViscosity{}); },
                      "LaminarViscosity.kinematic = 0 [m2/s]");
  refuses<InputError>([] { Sph(water, setup, Fourtakas{.delta = -1}); }, "Fourtakas.delta = -1");
  refuses<InputError>([] { Sph(water, setup, MolteniColagrossi{.delta = none}); },
                      "MolteniColagrossi.delta");
  refuses<InputError>([] { Sph(water, setup, Shifting{.strength = 50}); },
                      "Shifting.strength = 50");
  refuses<InputError>([] { Sph(water, setup, ShiftingByFastest{.strength = 50}); },
                      "ShiftingByFastest.strength = 50");
  refuses<InputError>([] { Sph(water, setup, ShiftingByFastest{.threshold = 4}); },
                      "ShiftingByFastest.threshold = 4");
  refuses<InputError>([] { Sph(water, setup, VerletTime{.restart = 1}); },
                      "VerletTime.restart = 1");
  refuses<InputError>([] { Sph(water, setup, VerletTime{.restart = 8}); },
                      "VerletTime.restart = 8 steps at SphSetup.courant = 0.2");
  refuses<InputError>([] { Sph(water, setup, VerletTime{}, Inviscid{}, NoDiffusion{}); },
                      "VerletTime with Inviscid and NoDiffusion");
  SphSetup longer = setup;
  longer.courant = 0.3;
  refuses<InputError>([&] { Sph(water, longer, VerletTime{}); }, "too long for VerletTime");
  refuses<InputError>([&] { Sph(water, longer, SymplecticTime{}, NoDiffusion{}); },
                      "too long for SymplecticTime with NoDiffusion");
  longer.courant = 0.7;
  refuses<InputError>([&] { Sph(water, longer, SymplecticTime{}); }, "too long for SymplecticTime");
}

TEST_CASE("SPH: fill, walls and runs that cannot be are refused") {
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.fill([](const Vec3d&) { return true; });
        sph.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
      },
      "add walls first");
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.fill([](const Vec3d&) { return true; },
                 [](const Vec3d&) {
                   return Vec3d{none, 0, 0};
                 },
                 [](const Vec3d&) { return 0.0; });
      },
      "velocity (nan, 0, 0) m/s");
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.fill([](const Vec3d&) { return true; });
        sph.run(-1);
      },
      "duration = -1 s");
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
        sph.run(1);
      },
      "there is no liquid and no opening; call fill() or add_inlet() first");
  refuses<InputError>(
      [] {
        Sph sph{Liquid{.density = 1000, .sound_speed = 3}, setup};
        sph.gravity = {0, 0, -9.81};
        sph.fill([](const Vec3d&) { return true; });
      },
      "Liquid.sound_speed = 3 m/s is too low for it");
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.fill([](const Vec3d&) { return true; });
        sph.step(none);
      },
      "Sph::step: dt = nan s");
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.fill([](const Vec3d& x) { return x.x < 0.1; });
        sph.fill([](const Vec3d& x) { return x.x > 0.05; });
      },
      "there is liquid at");
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.fill([](const Vec3d&) { return true; });
        static_cast<void>(sph.wall_load(3));
      },
      "there is no wall 3");
}

// Catches a row of liquid that is lost at walls of 45 degrees through the corner of the region.
TEST_CASE("SPH: a lattice whose rows lie on oblique walls is refused") {
  const auto in_valley = [](double shift) {
    const double s = 0.01, slope = std::sqrt(0.5);
    Sph sph{water,
            {.spacing = s, .region = {{-0.3 - shift * s, 0, 0}, {0.3, 0, 0.3}}, .dimensions = 2}};
    sph.add_wall(Plane{{0, 0, 0}, {slope, 0, slope}});
    sph.add_wall(Plane{{0, 0, 0}, {-slope, 0, slope}});
    sph.fill([](const Vec3d& x) { return x.z < 0.2; });
    return sph.mass() / (water.density * 0.2 * 0.2);
  };
  refuses<InputError>([&] { in_valley(0); },
                      "40 places of the lattice lie on oblique walls and stay empty");
  CHECK(in_valley(0.25) == near(1).epsilon(1e-3));
}

TEST_CASE("SPH: a fill that finds no place says which of its inputs leaves none") {
  const auto filled = [](const SphSetup& of, auto... walls) {
    return [=] {
      Sph sph{water, of};
      int k = 0;
      (sph.add_wall(walls, {.name = "side " + std::to_string(k++)}), ...);
      sph.fill([](const Vec3d&) { return true; });
    };
  };
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.fill([](const Vec3d&) { return false; });
      },
      "Sph::fill: there is no place for liquid: inside(x) is false at all 400 places of the "
      "lattice, from (0.005, 0, 0.005) to (0.195, 0, 0.195) m with a spacing of 0.01 m");
  refuses<InputError>(filled(setup, Plane{{0, 0, 0}, {0, 0, -1}}),
                      "all 400 places where inside(x) is true are behind wall 'side 0'; the normal "
                      "of a wall points to the liquid");
  refuses<InputError>(filled(setup, Plane{{0, 0, -1}, {0, 0, 1}}, Plane{{0, 0, 1}, {0, 0, 1}}),
                      "behind wall 'side 1'");
  // Each place is behind one of two walls, and none behind both.
  refuses<InputError>(filled(setup, Plane{{0, 0, 0.15}, {0, 0, 1}}, Plane{{0, 0, 0.05}, {0, 0, -1}},
                             Plane{{0.1, 0, 0}, {1, 0, 0}}, Plane{{0.1, 0, 0}, {-1, 0, 0}}),
                      "of 400 places where inside(x) is true, 400 are behind walls or");
  SphSetup flat = setup;
  flat.dimensions = 3;
  refuses<InputError>(filled(flat),
                      "SphSetup.region has no extent in y (from (0, 0, 0) to "
                      "(0.2, 0, 0.2) m), and the liquid is in 3D; give it one, or "
                      ".dimensions = 2, where the liquid lies in x and z");
  SphSetup thin = flat;
  thin.region.max.y = 0.004;
  const Plane behind{{0, 0.004, 0}, {0, -1, 0}};
  refuses<InputError>(filled(thin, behind),
                      "SphSetup.spacing = 0.01 m is larger than SphSetup.region, which is 0.004 m "
                      "long in y; use a smaller spacing, or .dimensions = 2");
  SphSetup coarse = setup;
  coarse.spacing = 0.5;
  refuses<InputError>(filled(coarse, Plane{{0.2, 0, 0}, {-1, 0, 0}}),
                      "SphSetup.spacing = 0.5 m is larger than SphSetup.region, which is 0.2 m "
                      "long in x; use a smaller spacing");
}

TEST_CASE("SPH: liquid that has left the region, or of few particles, is warned of") {
  SphSetup low = setup;
  low.gravity = {0, 0, -9.81}, low.region.max.z = 0.05;
  // A layer of 40 particles, in a box or falling out of the region.
  const auto poured = [&low](bool boxed) {
    Sph sph{water, low};
    if (boxed) sph.add_wall(box({0, -1, 0}, {0.2, 1, 1}));
    sph.fill([](const Vec3d& x) { return x.z < 0.02; });
    return sph;
  };
  auto lost = poured(false), kept = poured(true);
  CHECK(lost.warnings().empty());
  lost.run(0.1), kept.run(0.1);
  CHECK(lost.left() == 40);
  REQUIRE(lost.warnings().size() == 1);
  silt_test::has(lost.warnings()[0],
                 "the liquid: 40 of 40 particles (100 %) have left SphSetup.region, from "
                 "(0, 0, 0) to (0.2, 0, 0.05) m, and are lost; close the walls");
  CHECK(kept.warnings().empty());

  SphSetup rough = low;
  rough.spacing = 0.02;  // a layer of 10
  Sph few{water, rough};
  few.add_wall(box({0, -1, 0}, {0.2, 1, 1}));
  few.fill([](const Vec3d& x) { return x.z < 0.02; });
  REQUIRE(few.warnings().size() == 1);
  silt_test::has(few.warnings()[0], "it has 10 particles at a spacing of 0.02 m");

  Liquid gas = water;
  gas.density = 1;
  SphSetup heavy = low, weightless = low;
  heavy.gravity = {0, 0, -9.81}, weightless.gravity = {0, 0, 0};
  Sph thin{gas, heavy}, space{gas, weightless};
  for (Sph<>* one : {&thin, &space}) one->fill([](const Vec3d& x) { return x.z < 0.02; });
  CHECK(space.warnings().empty());
  REQUIRE(thin.warnings().size() == 1);
  silt_test::has(thin.warnings()[0],
                 "the liquid: Liquid.density = 1 kg/m3 is that of a gas; water has 1000: a density "
                 "in g/cm3 is a thousandth of that in kg/m3");

  Simulation sim{
      Particles<Sphere>{},
      Contacts<HertzMindlin>{
          {.youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}},
      poured(false)};
  sim.gravity = low.gravity, sim.time_step = 1e-3;
  std::vector<std::string> said;
  auto watch = on_warnings([&said](const std::string& w) { said.push_back(w); });
  sim.run(0.02, watch);
  CHECK(said.empty());
  sim.run(0.08, watch);
  REQUIRE(said.size() == 1);
  silt_test::has(said[0], "40 of 40 particles (100 %) have left SphSetup.region");
}

TEST_CASE("SPH: warnings of a narrow kernel in 2D, and of a viscosity that needs tiny steps") {
  SphSetup flat{.spacing = 0.005, .region = {{0, 0, 0}, {0.2, 0, 0.2}}, .dimensions = 2};
  const auto said = [](auto sph) {
    sph.fill([](const Vec3d&) { return true; });
    return sph.warnings();
  };
  CHECK(said(Sph{water, flat}).empty());
  flat.smoothing = 0.9;
  const auto narrow = said(Sph{water, flat});
  REQUIRE(narrow.size() == 1);
  silt_test::has(narrow[0], "SphSetup.smoothing = 0.9 leaves too few neighbours in 2D");
  flat.smoothing = 1.2;
  // h = 8.5 mm: h^2/(8 nu) = 9e-7 s, sound 0.6 h/c.
  const auto thick = said(Sph{water, flat, LaminarViscosity{.kinematic = 10}});
  REQUIRE(thick.size() == 1);
  silt_test::has(thick[0], "times shorter than sound does");
  CHECK(said(Sph{water, flat, LaminarViscosity{.kinematic = 1e-3}}).empty());
}

TEST_CASE("SPH: two walls of one name are refused") {
  Sph sph{water, setup};
  sph.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor"});
  sph.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}), sph.add_wall(Plane{{1, 0, 0}, {-1, 0, 0}});
  CHECK_THROWS_WITH_AS(sph.add_wall(Plane{{0, 0, 1}, {0, 0, -1}}, {.name = "floor"}),
                       doctest::Contains("there is a wall 'floor' already"), InputError);
}

TEST_CASE("SPH: spheres in 2D are warned of") {
  // Steel of 7 800 kg/m3 floats: a disc 1 m long displaces 22 kg, the sphere has 0.88 kg.
  SphSetup flat = setup;
  flat.spacing = 0.01, flat.region = {{0, 0, 0}, {0.4, 0, 0.4}}, flat.gravity = {0, 0, -9.81};
  const auto said = [&flat](auto sph, double density) {
    sph.fill([](const Vec3d& x) { return x.z < 0.2; });
    Particles<Sphere> ball;
    ball.add({.position = {0.2, 0, 0.1}, .radius = 0.03, .density = density});
    const HertzMindlin::Material steel{
        .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};
    Simulation sim{std::move(ball), Contacts<HertzMindlin>{steel}, std::move(sph)};
    sim.gravity = flat.gravity;
    for (const Vec3d& n : {Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{0, 0, 1}})
      sim.add_wall(Plane{n.x < 0 ? Vec3d{0.4, 0, 0} : Vec3d{0, 0, 0}, n}, steel);
    sim.run(1e-3);
    return sim.fluid().warnings();
  };
  const Liquid slow{.density = 1000, .sound_speed = 20};
  const auto one = said(Sph{slow, flat}, 7800);
  REQUIRE(one.size() == 1);
  silt_test::has(one[0], "one of radius 0.03 m has 0.882");
  // With the density of a disc, 3/(4 R) times as large.
  CHECK(said(Sph{slow, flat}, 7800 * 25).empty());
}

// Catches: a body off the plane, which pushes liquid that it does not displace; steps at which a
// light body is thrown about, a hint at another cause, and such a step chosen by silt itself.
TEST_CASE("SPH: in 2D bodies off the plane are refused, and light bodies beyond their step") {
  SphSetup flat = setup;
  flat.region = {{0, 0, 0}, {0.4, 0, 0.4}}, flat.gravity = {0, 0, -9.81};
  const auto run = [&flat](double y, double density, double step) {
    Sph sph{Liquid{.density = 1000, .sound_speed = 30}, flat, ArtificialViscosity{.alpha = 0.1}};
    sph.fill([](const Vec3d& x) { return x.z < 0.3; });
    Particles<Sphere> ball;
    ball.add({.position = {0.2, y, 0.15}, .radius = 0.04, .density = density});
    const HertzMindlin::Material soft{
        .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};
    Simulation sim{std::move(ball), Contacts<HertzMindlin>{soft}, std::move(sph)};
    sim.gravity = flat.gravity, sim.threads = 1;
    if (step > 0) sim.time_step = step;
    for (const Vec3d& n : {Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{0, 0, 1}})
      sim.add_wall(Plane{n.x < 0 ? Vec3d{0.4, 0, 0} : Vec3d{0, 0, 0}, n}, soft);
    sim.run(1e-3);
    return sim.step_length();
  };
  CHECK(run(0, 9375, 1e-4) == 1e-4);
  for (const double y : {0.02, -50.0})
    refuses<SimulationError>([&] { run(y, 9375, 1e-4); }, "is off the plane y = 0 m");
  // 0.5 m/(rho_0 c A): m = 0.026808 kg, A = pi 0.04 m.
  refuses<SimulationError>([&] { run(0, 100, 1e-4); }, "less than 3.55556e-06 s");
  refuses<SimulationError>([&] { run(0, 100, 1e-4); }, "has the mass of a sphere");
  // silt's own step is that limit; the soft contacts would allow longer ones.
  CHECK(near_relative(run(0, 100, 0), 3.55556e-06, 1e-5));
  CHECK(near_relative(run(0, 9375, 0), 3.33333e-04, 1e-5));
  run(0, 100, 1.4e-5);
}

// Catches: a step of sound alone, at which a tank at rest gained energy from alpha = 5 on.
TEST_CASE("SPH: a large alpha shortens the step, and a tank stays at rest") {
  SphSetup tank = setup;
  tank.gravity = {0, 0, -9.81};
  for (const double alpha : {1.0, 5.0, 20.0}) {
    Sph sph{water, tank, ArtificialViscosity{.alpha = alpha}};
    for (const Vec3d& n : {Vec3d{1, 0, 0}, Vec3d{-1, 0, 0}, Vec3d{0, 0, 1}})
      sph.add_wall(Plane{n.x < 0 ? Vec3d{0.2, 0, 0} : Vec3d{0, 0, 0}, n});
    sph.fill([](const Vec3d& x) { return x.z < 0.1; });
    sph.run(0.1);
    CAPTURE(alpha);
    CHECK(sph.kinetic_energy() < 1e-5 * sph.mass() * 9.81 * 0.1);
    CHECK(sph.longest_step() <= sph.setup().h() / (alpha * water.sound_speed) * (1 + 1e-12));
  }
}

TEST_CASE("SPH: sound that is too slow for what the scene has is refused at the first step") {
  const auto run = [](double height, double fastest) {
    SphSetup tall = setup;
    tall.gravity = {0, 0, -9.81}, tall.region.max.z = 1;
    Sph sph{water, tall};
    sph.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, {.motion = translation({fastest, 0, 0})});
    sph.fill([&](const Vec3d& x) { return x.z < height; });
    sph.step(1e-5);
  };
  run(0.5, 0);  // 6.4 times
  refuses<InputError>([&] { run(0.9, 0); }, "m/s; the liquid would be compressed by 4.");
  refuses<InputError>([&] { run(0.9, 0); },  // without the digits of rounding
                      "a fall through the liquid's height of 0.89 m, 4.17873 m/s; the");
  refuses<InputError>([&] { run(0.2, 4.1); }, "times the speed of wall 0, 4.");
}

TEST_CASE("SPH: a liquid that is too fast for its sound stops with a sentence") {
  // Pressed on the floor by ten thousand times the weight that the first step was made with.
  refuses<SimulationError>(
      [] {
        Sph sph{water, setup};
        sph.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
        sph.fill([](const Vec3d&) { return true; });
        sph.run(1e-4), sph.gravity = {0, 0, -1e5}, sph.run(0.01);
      },
      "use a larger Liquid.sound_speed, ");
}

TEST_CASE("SPH: fill refuses a liquid that is too fast for its sound, or under too much suction") {
  const auto filled = [](const Vec3d& v, double p) {
    Sph sph{water, setup};
    sph.fill([](const Vec3d&) { return true; }, [&](const Vec3d&) { return v; },
             [&](const Vec3d&) { return p; });
    return sph.size();
  };
  CHECK(filled({4, 0, 0}, 0) == 400);
  refuses<InputError>(
      [&] {
        filled({0, 0, -4.1}, 0);
      },
      "velocity (0, 0, -4.1) m/s is 0.205 of Liquid.sound_speed = 20 m/s");
  const double least = -0.1 * water.stiffness();
  CHECK(filled({0, 0, 0}, 0.99 * least) == 400);
  refuses<InputError>(
      [&] {
        filled({0, 0, 0}, 1.01 * least);
      },
      "a tenth of the liquid's stiffness");
  // Below -B the density of a pressure is no number.
  refuses<InputError>([&] { filled({0, 0, 0}, 35 * least); }, "Pa must be above -5714.29 Pa");
}

TEST_CASE("SPH: in 2D nothing may lead out of the plane, where liquid would get through walls") {
  const auto is_true = [](const Vec3d&) { return true; };
  refuses<InputError>(made([](auto&, auto& s) {
                        s.gravity = {0, -5, -9.81};
                      }),
                      "Sph: gravity = (0, -5, -9.81) [m/s2] has a part along y");
  refuses<InputError>(
      [&] {
        Sph sph{water, setup};
        sph.gravity = {0, -5, -9.81}, sph.fill(is_true);
      },
      "has a part along y");
  refuses<InputError>(
      [&] {
        Sph sph{water, setup};
        sph.fill(is_true), sph.run(1e-4), sph.gravity = {0, -5, -9.81}, sph.run(1e-4);
      },
      "has a part along y");
  refuses<InputError>(
      [&] {
        Sph sph{water, setup};
        sph.fill(
            is_true,
            [](const Vec3d&) {
              return Vec3d{0, 1, 0};
            },
            [](const Vec3d&) { return 0.0; });
      },
      "velocity (0, 1, 0) m/s has a part along y");
  // Gravity of a Simulation.
  refuses<InputError>(
      [&] {
        Sph sph{water, setup};
        sph.fill(is_true);
        Simulation sim{
            Particles<Sphere>{},
            Contacts<HertzMindlin>{
                {.youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}},
            std::move(sph)};
        sim.gravity = {0, -5, -9.81}, sim.time_step = 1e-5;
        sim.run(1e-4);
      },
      "has a part along y");
  const auto with_wall = [&](const Motion& motion) {
    Sph sph{water, setup};
    sph.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, {.motion = motion});
    sph.fill(is_true), sph.run(1e-3);
    return sph.size();
  };
  refuses<InputError>(
      [&] {
        with_wall(translation({1, 1, 0}));
      },
      "in 2D the liquid lies in x and z; move the wall in x and z, and turn it about y");
  CHECK(with_wall(rotation({0.1, 0.3, 0}, {0, 1, 0}, 0.1)) == 400);
  // In 3D all of these are for use.
  Sph whole{water,
            {.spacing = 0.02, .region = {{0, 0, 0}, {0.2, 0.2, 0.2}}, .gravity = {0, -5, -9.81}}};
  whole.fill(
      is_true,
      [](const Vec3d&) {
        return Vec3d{0, 1, 0};
      },
      [](const Vec3d&) { return 0.0; });
  CHECK(whole.size() == 1000);
}

TEST_CASE("SPH: steps by hand are as long as a Courant number of 1 allows") {
  Sph sph{water, setup};
  sph.fill([](const Vec3d&) { return true; });
  const double usual = sph.longest_step();  // Courant number 0.6
  sph.step(1.66 * usual);
  CHECK(sph.time() == 1.66 * usual);
  refuses<InputError>([&] { sph.step(1); }, "Sph::step: dt = 1 s is longer than ");
  refuses<InputError>([&] { sph.step(1.68 * usual); }, "use longest_step(), now ");
}

TEST_CASE("SPH: a wall's motion must give rotations and finite places") {
  const auto moved = [](const char* name, double from, const Pose& pose) {
    Sph sph{water, setup};
    const auto motion = [=](double t) { return t > from ? pose : Pose{}; };
    sph.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
    sph.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, {.name = name, .motion = motion});
    sph.fill([](const Vec3d& x) { return x.z < 0.1; });
    sph.run(2e-3);
  };
  const Pose stretched{{2, 0, 0, 0}, {0, 0, 0}}, nowhere{{}, {0, 0, none}};
  refuses<InputError>([&] { moved("", -1, stretched); },
                      "Sph: the motion of wall 1 gives at t = 0 s the translation (0, 0, 0) m and "
                      "a quaternion of length 2;");
  refuses<InputError>([&] { moved("gate", 1e-3, stretched); }, "the motion of wall 'gate' gives");
  refuses<InputError>([&] { moved("gate", 1e-3, nowhere); }, "it must be finite");
}

namespace {

/// A box as triangles, free outside.
TriangleMesh block(const Vec3d& low, const Vec3d& high) {
  const auto corner = [&](int c) {
    return Vec3d{c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z};
  };
  const int faces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                           {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  std::vector<std::array<Vec3d, 3>> all;
  for (const auto& f : faces) {
    all.push_back({corner(f[0]), corner(f[2]), corner(f[1])});
    all.push_back({corner(f[0]), corner(f[3]), corner(f[2])});
  }
  return TriangleMesh(all);
}
/// A tank 0.2 m wide with a baffle of that thickness [spacings] in its middle; h = 1.7 spacings.
auto with_baffle(double thickness) {
  Sph sph{water, setup};
  sph.gravity = {0, 0, -9.81};
  const double half = 0.5 * thickness * setup.spacing;
  sph.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor"});
  sph.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}), sph.add_wall(Plane{{0.2, 0, 0}, {-1, 0, 0}});
  sph.add_wall(block({0.1 - half, -0.1, -0.05}, {0.1 + half, 0.1, 0.15}), {.name = "baffle"});
  return sph;
}
bool low(const Vec3d& x) { return x.z < 0.1; }

}  // namespace

TEST_CASE("SPH: walls that liquid sees through are refused, once it is on both sides") {
  const char* const words = "wall 'baffle' is ";
  for (const double thickness : {1.0, 2.0}) {
    refuses<SimulationError>(
        [thickness] {
          auto sph = with_baffle(thickness);
          sph.fill(low), sph.run(1e-3);
        },
        words);
    // On one side alone it may be thin, until the liquid has come round it.
    auto dry = with_baffle(thickness);
    dry.fill([](const Vec3d& x) { return low(x) && x.x < 0.1; });
    dry.run(1e-3);
    dry.fill([](const Vec3d& x) { return low(x) && x.x > 0.1; });
    silt_test::has(silt_test::refusal([&] { dry.run(1e-3); }), words);
  }
  auto thick = with_baffle(4);
  thick.fill(low), thick.run(1e-3);
  // Between sites of the lattice it has no particles at all.
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.add_wall(block({0.101, -0.1, -0.1}, {0.104, 0.1, 0.3}), {.name = "sheet"});
        sph.fill(low), sph.run(1e-3);
      },
      "wall 'sheet' near ");
  // A bar on the floor, as thin, is let pass: round its edges liquid sees liquid anyway.
  Sph bar{water, setup};
  bar.gravity = {0, 0, -9.81};
  bar.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  bar.add_wall(block({0.09, -0.1, -0.05}, {0.11, 0.1, 0.02}));
  bar.fill(low), bar.run(1e-3);
  // Through the corner of a step liquid sees liquid too.
  Sph step{water, setup};
  step.gravity = {0, 0, -9.81};
  step.add_wall(block({-0.5, -0.1, -0.5}, {0.1, 0.1, 0.05}));
  step.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}), step.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
  step.add_wall(Plane{{0.2, 0, 0}, {-1, 0, 0}});
  step.fill(low), step.run(1e-3);
}

TEST_CASE(
    "SPH: a lattice that loses a row at walls is refused where that is a tenth of the liquid") {
  const auto filled = [](double width, double from, double depth) {
    SphSetup narrow = setup;
    narrow.region = {{from, 0, 0}, {0.2, 0, 0.2}};
    Sph sph{water, narrow};
    sph.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, {.name = "floor"});
    sph.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, {.name = "wall"});
    sph.add_wall(Plane{{width, 0, 0}, {-1, 0, 0}}, {.name = "far wall"});
    sph.fill([depth](const Vec3d& x) { return x.z < depth; });
  };
  filled(0.05, 0, 0.1);
  filled(0.196, 0, 0.1);  // 19 rows of 19.6
  refuses<InputError>([&] { filled(0.049, 0, 0.1); }, "leave 18.3");
  refuses<InputError>([&] { filled(0.049, 0, 0.1); }, "wall 'far wall' at x = 0.049 m");
  refuses<InputError>([&] { filled(0.06, -0.003, 0.1); }, "% empty");
  // Beside walls of a Simulation liquid may be pressed together too.
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.fill([](const Vec3d& x) { return x.z < 0.03; });
        Simulation sim{
            Particles<Sphere>{},
            Contacts<HertzMindlin>{
                {.youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}},
            std::move(sph)};
        sim.add_wall(Plane{{0, 0, 0.0045}, {0, 0, 1}}, sim.contacts().material(0),
                     {.name = "floor"});
        sim.time_step = 1e-5;
        sim.run(1e-4);
      },
      "% too few room");
}

#ifdef SILT_LONG_TESTS
TEST_CASE("SPH: liquid that is put where bodies of the Simulation are is taken out and counted") {
  Particles<Sphere> balls;
  balls.add({.position = {0.1, 0, 0.1}, .radius = 0.03, .density = 1000});
  Sph sph{water, setup};
  sph.fill([](const Vec3d& x) { return x.z < 0.1; });
  const std::size_t half = sph.size();
  Simulation sim{
      std::move(balls),
      Contacts<HertzMindlin>{
          {.youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}},
      std::move(sph)};
  sim.time_step = 1e-5;
  sim.run(1e-4);
  const std::size_t first = sim.fluid().displaced();
  CHECK(first == 16);  // of half a circle of 3 spacings, by hand
  const std::size_t more = sim.fluid().fill([](const Vec3d& x) { return x.z > 0.1; });
  CHECK(sim.fluid().displaced() == 2 * first);
  CHECK(sim.fluid().size() == half + more - 2 * first);
  sim.run(1e-4);
  CHECK(sim.fluid().displaced() == 2 * first);
}
#endif

TEST_CASE("SPH: liquid inside a body names the body and its place") {
  const std::vector<Vec3d> at{{0.05, 0, 0.02}, {0.1, 0, 0.05}}, still(2, Vec3d{0, 0, 0}),
      fast{{0, 0, 0}, {0, 0, 200}};
  const std::vector<double> radius{0.015, 0.03}, mass{0.7, 2.8}, volume{7e-4, 2.8e-3};
  const std::vector<ParticleId> id{3, 7};
  CoupledParticles of{};
  of.shape.position = at, of.shape.radius = radius, of.velocity = fast;
  of.volume = volume, of.mass = mass, of.angular_velocity = still, of.id = id;
  refuses<SimulationError>(
      [&] {
        Sph sph{water, setup, Inviscid{}};
        sph.fill([](const Vec3d& x) { return norm(x - Vec3d{0.1, 0, 0.15}) < 0.008; });
        auto force = still, torque = still;
        sph.advance(of, 1e-7, force, {}, torque);
        // The body is farther away than the liquid sees, and gets there in one long step.
        sph.step(0.8 * sph.longest_step());
        sph.least_density = 1.01, sph.step(sph.longest_step());
      },
      "has gone into body 7 at (0.1, 0, 0.13");
}

TEST_CASE("SPH: liquid behind a wall names it, a drop alone its density") {
  // A drop that is pulled to a speed; then it is checked against a density which it does not have.
  const auto shot = [](double speed) {
    return [=] {
      Sph sph{water, setup, Inviscid{}};
      sph.fill([](const Vec3d& x) { return norm(x - Vec3d{0.1, 0, 0.1}) < 0.008; });
      sph.run(1e-5), sph.gravity = {speed / 1e-3, 0, 0}, sph.run(1e-3), sph.gravity = {0, 0, 0};
      sph.least_density = 1.01, sph.run(2e-2 / speed);
    };
  };
  refuses<SimulationError>(shot(5), "use a larger Liquid.sound_speed, 48.");
  refuses<SimulationError>(shot(0.1), "an isolated drop");
  refuses<SimulationError>(
      [] {
        Sph sph{water, setup, Inviscid{}};
        // It jumps over the drop.
        const auto jump = [](double t) { return Pose{{}, {0, 0, t > 1e-3 ? 0.12 : 0}}; };
        sph.add_wall(Plane{{0, 0, 0.02}, {0, 0, 1}}, {.name = "floor", .motion = jump});
        sph.fill([&](const Vec3d& x) { return norm(x - Vec3d{0.1, 0, 0.11}) < 0.008; });
        sph.run(9e-4), sph.least_density = 1.01, sph.run(4e-3);
      },
      "gone through wall 'floor' by ");
}

}  // namespace sph_refusals_test
