// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include <silt/sph.hpp>

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
}  // namespace

TEST_CASE("SPH: settings that cannot be are refused by name") {
  refuses<InputError>(made([](auto& l, auto&) { l.density = 0; }), "Liquid.density = 0 [kg/m3]");
  refuses<InputError>(made([](auto& l, auto&) { l.sound_speed = none; }), "Liquid.sound_speed");
  refuses<InputError>(made([](auto& l, auto&) { l.exponent = 0.5; }), "Liquid.exponent = 0.5");
  refuses<InputError>(made([](auto&, auto& s) { s.spacing = -1; }), "SphSetup.spacing = -1 [m]");
  refuses<InputError>(made([](auto&, auto& s) { s.region.max.z = -1; }), "SphSetup.region");
  refuses<InputError>(made([](auto&, auto& s) { s.dimensions = 1; }), "SphSetup.dimensions = 1");
  refuses<InputError>(made([](auto&, auto& s) { s.smoothing = 5; }), "SphSetup.smoothing = 5");
  refuses<InputError>(made([](auto&, auto& s) { s.courant = 2; }), "SphSetup.courant = 2");
  refuses<InputError>(made([](auto&, auto& s) { s.gravity.x = none; }), "SphSetup.gravity");
  refuses<InputError>(made([](auto&, auto& s) { s.periodic[0] = true, s.region.max.x = 0.205; }),
                      "must be a whole number of them");
  refuses<InputError>(made([](auto&, auto& s) { s.periodic[0] = true, s.region.max.x = 0.05; }),
                      "less than two supports of the kernel");
  refuses<InputError>(made([](auto&, auto& s) { s.periodic[1] = true; }),
                      "in 2D nothing repeats in y");
  refuses<InputError>([] { Sph(water, setup, ArtificialViscosity{.alpha = -1}); },
                      "ArtificialViscosity.alpha = -1");
  refuses<InputError>([] { Sph(water, setup, LaminarViscosity{}); },
                      "LaminarViscosity.kinematic = 0 [m2/s]");
  refuses<InputError>([] { Sph(water, setup, Fourtakas{.delta = -1}); }, "Fourtakas.delta = -1");
  refuses<InputError>([] { Sph(water, setup, MolteniColagrossi{.delta = none}); },
                      "MolteniColagrossi.delta");
  refuses<InputError>([] { Sph(water, setup, Shifting{.strength = 50}); },
                      "Shifting.strength = 50");
  refuses<InputError>([] { Sph(water, setup, VerletTime{.restart = 0}); },
                      "VerletTime.restart = 0");
}

TEST_CASE("SPH: fill, walls and runs that cannot be are refused") {
  refuses<InputError>(
      [] {
        Sph sph{water, setup};
        sph.fill([](const Vec3d&) { return false; });
      },
      "no place of the lattice of 0.01 m is inside");
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
  refuses<InputError>([&] { run(0.9, 0); }, "m/s, so that the liquid would be compressed by 4.");
  refuses<InputError>([&] { run(0.9, 0); }, "a fall through the liquid's height of 0.89");
  refuses<InputError>([&] { run(0.2, 4.1); }, "times the speed of a wall, 4.");
}

TEST_CASE("SPH: a liquid that is too fast for its sound stops with a sentence") {
  // Two halves that meet at twice the sound's speed.
  refuses<SimulationError>(
      [] {
        Sph sph{water, setup};
        sph.fill([](const Vec3d&) { return true; },
                 [](const Vec3d& x) {
                   return Vec3d{x.x < 0.1 ? 40.0 : -40.0, 0, 0};
                 },
                 [](const Vec3d&) { return 0.0; });
        sph.run(0.01);
      },
      "take a larger Liquid.sound_speed");
}

}  // namespace sph_refusals_test
