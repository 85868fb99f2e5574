// silt - BSD-3-Clause, see LICENSE
// Conduction through contacts against closed forms: two spheres, a chain between walls at rest and
// in time, walls that give, softened contacts, lattices; and refusals.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/contact/softened.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/module/heat/fluid_convection.hpp>
#include <silt/module/heat/mutual_radiation.hpp>
#include <silt/module/heat/surroundings.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace heat_test {

using silt_test::has, silt_test::refusal;

using silt::Vec3d;

const double R = 1e-3, d = 0.02e-3, density = 2500;  // [m], [m], [kg/m3]
// So soft that nothing moves while heat flows.
const silt::HertzMindlin::Material still{
    .youngs_modulus = 1e-14, .poisson_ratio = 0.3, .restitution = 0.9, .friction = 0.3};
// Asked in each step, so that Euler's steps are those of the time step.
const silt::HeatConduction glass{.conductivity = 1.1, .heat_capacity = 840, .flux_every = 1};
const double mass = 4.0 / 3 * 3.14159265358979323846 * R * R * R * density;  // [kg]

/// A row of beads along x from 0 on, each d into the next, and into what stands at its ends.
inline silt::Particles<silt::Sphere> row(std::size_t count) {
  silt::Particles<silt::Sphere> p;
  for (std::size_t k = 0; k < count; ++k)
    p.add({.position = {R - d + static_cast<double>(k) * (2 * R - d), 0, 0},
           .radius = R,
           .density = density});
  return p;
}
inline double end_of_row(std::size_t count) { return static_cast<double>(count) * (2 * R - d) - d; }
template <class Sim>
double temperature(const Sim& sim, std::size_t id) {
  return sim.template field<silt::Temperature>(sim.find(id));
}
/// With walls at both ends.
inline auto chain(std::size_t count, const silt::HeatConduction& heat) {
  silt::Simulation sim{row(count), silt::Contacts<silt::HertzMindlin>{still}, heat};
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, still);
  sim.add_wall(silt::Plane{{end_of_row(count), 0, 0}, {-1, 0, 0}}, still);
  return sim;
}

/// Contacts of two materials, without friction between them.
auto unlike_contacts() {
  silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials> contacts{
      {still,
       {.youngs_modulus = 2e-14, .poisson_ratio = 0.3, .restitution = 0.9, .friction = 0.3}}};
  contacts.set_pair(contacts.material(0), contacts.material(1),
                    {.restitution = 0.9, .friction = 0});
  return contacts;
}

// Catches a conductance of 4 k a, of k_i + k_j for the mean, of a diameter for the radius, and
// capacities that are interchanged.
#ifdef SILT_LONG_TESTS
TEST_CASE("heat: two spheres of unlike materials follow the exponential of Euler's steps") {
  const auto contacts = unlike_contacts();
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 0}, .radius = R, .density = density});
  p.add({.position = {2.5 * R - d, 0, 0}, .radius = 1.5 * R, .density = density, .material = 1});
  silt::HeatConduction heat = glass;
  heat.others = {{.conductivity = 50, .heat_capacity = 450}};
  silt::Simulation sim{std::move(p), contacts, heat};
  sim.time_step = 1e-3;
  sim.field<silt::Temperature>(0) = 400;
  sim.field<silt::Temperature>(1) = 300;
  sim.run(10);
  const double k = 2 / (1 / 1.1 + 1 / 50.0), a = std::sqrt(0.6 * R * d), H = 2 * k * a;
  const double C0 = mass * 840, C1 = 3.375 * mass * 450, rate = H / C0 + H / C1;
  const double mean = (C0 * 400 + C1 * 300) / (C0 + C1);
  const double left = 100 * std::pow(1 - rate * 1e-3, 10000);
  // Rounding of 1e4 steps; the closed exponential differs by half of rate dt more.
  CHECK(temperature(sim, 0) == near(mean + left * C1 / (C0 + C1)).epsilon(1e-10));
  CHECK(temperature(sim, 1) == near(mean - left * C0 / (C0 + C1)).epsilon(1e-10));
  CHECK(left == near(100 * std::exp(-rate * 10)).epsilon(rate * 10 * rate * 1e-3));
  CHECK(left < 60);
}
#endif

// Catches walls with the wrong effective radius, ends that are interchanged, a wall that gives what
// its particle does not get.
TEST_CASE("heat: a chain between a hot and a cold wall comes to resistances in series") {
  silt::HeatConduction heat = glass;
  heat.heat_capacity = 1;  // at rest sooner
  heat.walls = {silt::held_at(400), silt::held_at([](double) { return 300.0; })};
  auto sim = chain(8, heat);
  sim.time_step = 5e-3;
  sim.run(12);
  // Between beads a = sqrt(R d/2), at walls sqrt(R d).
  const double of_wall = 1 / std::sqrt(2.0), all = 2 * of_wall + 7;
  for (std::size_t k = 0; k < 8; ++k)
    CHECK(temperature(sim, k) ==
          near(400 - 100 * (of_wall + static_cast<double>(k)) / all).epsilon(1e-9));
}

// Catches a capacity or a step that is wrong by a factor, which a steady profile does not see.
TEST_CASE("heat: a chain cools by the discrete modes between insulated ends") {
  constexpr std::size_t n = 12;
  silt::HeatConduction heat = glass;
  heat.walls = {silt::insulated()};
  auto sim = chain(n, heat);
  sim.time_step = 1e-3;
  const double pi = 3.14159265358979323846;
  for (std::size_t k = 0; k < n; ++k)
    sim.field<silt::Temperature>(sim.find(k)) =
        300 + 50 * std::cos(pi * 2 * (static_cast<double>(k) + 0.5) / n);
  sim.run(20);
  // dT_k/dt = w (T_k-1 - 2 T_k + T_k+1), w = H/C: the mode m decays with 4 w sin^2(pi m/(2 n)).
  const double w = 2 * 1.1 * std::sqrt(0.5 * R * d) / (mass * 840);
  const double rate = 4 * w * std::pow(std::sin(pi * 2 / (2 * n)), 2);
  const double left = std::pow(1 - rate * 1e-3, 20000);
  CHECK(left < 0.9);
  for (std::size_t k = 0; k < n; ++k)
    CHECK(temperature(sim, k) ==
          near(300 + 50 * left * std::cos(pi * 2 * (static_cast<double>(k) + 0.5) / n))
              .epsilon(1e-10));
}

// Catches power that is given to each contact in whole, or by number instead of by conductance.
TEST_CASE("heat: a wall that gives 2 W gives 2 W, in proportion to conductances") {
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, R - d}, .radius = R, .density = density});
  p.add({.position = {0.01, 0, 2 * R - d}, .radius = 2 * R, .density = density});
  silt::HeatConduction heat = glass;
  heat.walls = {silt::heated_by(2)};
  silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{still}, heat};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, still);
  sim.time_step = 1e-4;
  sim.run(0.01);
  const double C = mass * 840;
  const double got[2] = {C * (temperature(sim, 0) - 293.15),
                         8 * C * (temperature(sim, 1) - 293.15)};
  CHECK(got[0] + got[1] == near(2 * 0.01).epsilon(1e-9));
  CHECK(got[1] / got[0] == near(std::sqrt(2.0)).epsilon(1e-9));  // a = sqrt(R d)
  CHECK(sim.given_by_wall<silt::Temperature>(0).sum == near(2 * 0.01).epsilon(1e-9));
  CHECK(sim.given_by_wall<silt::HeatConduction>(0).sum ==
        sim.given_by_wall<silt::Temperature>(0).sum);
}

// Catches an exponent of 1/2 or 2/3, a ratio upside down, and a law's own softening that is
// forgotten: the same spheres conduct as the solid ones would under the same force.
TEST_CASE("heat: softened contacts conduct as their solids would under the same force") {
  const silt::HertzMindlin::Material solid{
      .youngs_modulus = 1e-3, .poisson_ratio = 0.25, .restitution = 0.9, .friction = 0};
  const auto warmed = [](const auto& contacts, double youngs_modulus) {
    silt::HeatConduction heat = glass;
    heat.youngs_modulus = youngs_modulus, heat.poisson_ratio = 0.25;
    silt::Simulation sim{row(2), contacts, heat};
    sim.time_step = 1e-2;
    sim.template field<silt::Temperature>(1) = 400;
    sim.run(0.01);
    return sim.template field<silt::Temperature>(0) - 293.15;
  };
  const double as_is = warmed(silt::Contacts<silt::HertzMindlin>{solid}, 0);
  CHECK(warmed(silt::Contacts<silt::HertzMindlin>{solid}, 1) == near(0.1 * as_is).epsilon(1e-9));
#ifdef SILT_LONG_TESTS
  // (R/R_full)^(5/2) = 1e-3.
  using Soft = silt::Softened<silt::HertzMindlin>;
  const double full = R * std::pow(1e3, 0.4);
  CHECK(warmed(silt::Contacts<Soft>{{.solid = solid, .full_radius = full}}, 0) ==
        near(0.1 * as_is).epsilon(1e-9));
  CHECK(has(refusal([&] { warmed(silt::Contacts<silt::LinearSpring>{{.stiffness = 1e-6}}, 1); }),
            "no Young's modulus"));
#endif
}

// Catches a lattice whose layers lose heat sideways, and a factor in H that one contact hides.
#ifdef SILT_LONG_TESTS
TEST_CASE("heat: a simple cubic lattice conducts 2 k a over its spacing") {
  constexpr std::size_t n = 4;
  const double step = 2 * R - d;
  silt::Particles<silt::Sphere> p;
  for (std::size_t x = 0; x < n; ++x)
    for (std::size_t y = 0; y < n; ++y)
      for (std::size_t z = 0; z < 6; ++z)
        p.add({.position = {(static_cast<double>(x) + 0.5) * step,
                            (static_cast<double>(y) + 0.5) * step, static_cast<double>(z) * step},
               .radius = R,
               .density = density});
  silt::HeatConduction heat = glass;
  heat.heat_capacity = 1;
  silt::Simulation sim{
      std::move(p), silt::Contacts<silt::HertzMindlin>{still},
      silt::PeriodicBox{{{0, 0, -1}, {n * step, n * step, 1}}, {true, true, false}}, heat};
  sim.time_step = 5e-5;
  // The first layer gets 1 W, the last loses it, by hand, each step: steady after a while.
  const double C = mass * 1;  // [J/K]
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.field<silt::Temperature>(k) = 300 - 1e3 * sim.position(k).z;
  double before = 0, after = 0;
  const auto held = [&](double& sum) {
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.position(k).z > 2.5 * step) sum += C * sim.field<silt::Temperature>(k);
  };
  held(before);
  sim.run(5e-5);
  held(after);
  // Of a linear profile the heat that crosses the middle in a step, over area and gradient.
  const double k_e = (after - before) / 5e-5 / (n * step * n * step) / 1e3;
  CHECK(k_e == near(2 * 1.1 * std::sqrt(0.5 * R * d) / step).epsilon(1e-6));
}
#endif

// Catches a flux that is held too long or too short, heat that one end gets for longer than the
// other gives it, a choice of steps that ignores the rate.
TEST_CASE("heat: a flux that is held for several steps is Euler's rule of their length") {
  const auto left = [](double dt, std::size_t most, double time) {
    silt::HeatConduction heat = glass;
    heat.flux_every = most;
    auto sim = chain(2, heat);
    sim.time_step = dt;
    sim.field<silt::Temperature>(0) = 400, sim.field<silt::Temperature>(1) = 300;
    sim.run(time);
    const double a = temperature(sim, 0), b = temperature(sim, 1);
    CHECK(a + b == near(700).epsilon(1e-13));
    return a - b;
  };
  const double rate = 2 * 2 * 1.1 * std::sqrt(0.5 * R * d) / (mass * 840);  // [1/s]
  // The estimate of the rate, 12 k R/(m c) = 1.5 1/s, allows 0.01/1.5 s: of 1e-4 s all 10 steps
  // asked for, of 2e-3 s 3.
  CHECK(left(1e-4, 10, 1) == near(100 * std::pow(1 - rate * 1e-3, 1000)).epsilon(1e-10));
  CHECK(left(1e-4, 4, 1) == near(100 * std::pow(1 - rate * 4e-4, 2500)).epsilon(1e-10));
  // Each hundredth step asks anyway: after 99 comes 100, then 102, ...
  const double r = rate * 2e-3;
  CHECK(left(2e-3, 10, 0.6) ==
        near(100 * std::pow(1 - 3 * r, 98) * std::pow(1 - 2 * r, 2) * std::pow(1 - r, 2))
            .epsilon(1e-10));
}

// Catches coefficients of pairs that stay those of the start of the run.
TEST_CASE("heat: a conductivity that an observer changes conducts from the next step on") {
  const auto left = [](bool in_observer) {
    auto sim = chain(2, glass);
    sim.time_step = 1e-4;
    sim.field<silt::Temperature>(0) = 400, sim.field<silt::Temperature>(1) = 300;
    const auto better = [](auto& s) {
      s.template module<silt::HeatConduction>().conductivity = 50;
    };
    if (in_observer) {
      sim.run(0.2, silt::at(silt::every(0.1), [&](auto& s) {
                if (s.step() == 1000) better(s);
              }));
    } else {
      sim.run(0.1), better(sim), sim.run(0.1);
    }
    CHECK(sim.step() == 2000);
    return temperature(sim, 0) - temperature(sim, 1);
  };
  const double rate = 2 * 2 * 1.1 * std::sqrt(0.5 * R * d) / (mass * 840);  // [1/s]
  // The flux of the step that the observer sees is known already.
  const double exact =
      100 * std::pow(1 - rate * 1e-4, 1001) * std::pow(1 - 50 / 1.1 * rate * 1e-4, 999);
  CHECK(left(false) == near(exact).epsilon(1e-10));
  CHECK(left(true) == near(exact).epsilon(1e-10));
}

// Catches a step that resolves conduction as a swing, or through wider contacts than real ones; a
// limit that is not Euler's; a guard that is later than it.
TEST_CASE(
    "heat: silt's step of a chain is 3 R/a below Euler's limit, and longer ones are stopped") {
  constexpr std::size_t n = 20;
  const silt::HeatConduction heat{.conductivity = 50, .heat_capacity = 0.1, .flux_every = 1};
  const double a = std::sqrt(0.5 * R * d), H = 2 * 50 * a, C = mass * 0.1;
  // The fastest mode of a chain that is insulated at its ends: neighbours with opposite signs.
  const double fastest = 2 * H / C * (1 + std::cos(std::numbers::pi / n)), limit = 2 / fastest;
  constexpr double start = 0.05;  // [K] grows to 140
  const auto make = [&](const silt::HeatConduction& how) {
    auto sim = chain(n, how);
    for (std::size_t k = 0; k < n; ++k) {
      sim.set_velocity(k, {0, 0, 1e-12});  // from none no step can be chosen
      sim.field<silt::Temperature>(k) =
          300 + start * std::cos(std::numbers::pi * (n - 1) * (static_cast<double>(k) + 0.5) / n);
    }
    return sim;
  };
  auto own = make(heat);
  own.run(0);
  CHECK(own.step_length() == near(C / (12 * 50 * R)).epsilon(1e-9));
  CHECK(limit / own.step_length() == near(3 * R / a).epsilon(0.01));
  // Contacts softer than their solid: narrower by the cube root of the moduli.
  silt::HeatConduction narrow = heat;
  narrow.youngs_modulus = 1e-11, narrow.poisson_ratio = 0.3;
  auto softer = make(narrow);
  softer.run(0);
  CHECK(softer.step_length() == near(10 * own.step_length()).epsilon(1e-9));
  // At Euler's limit: 400 steps.
  const auto left = [&](double dt) {
    auto sim = make(heat);
    sim.time_step = dt, sim.guard.max_rate = 100;
    sim.run(400 * dt);
    return std::abs(temperature(sim, n / 2) - 300) /
           std::abs(start * std::cos(std::numbers::pi * (n - 1) * (n / 2 + 0.5) / n));
  };
  CHECK(left(0.99 * limit) == near(std::pow(0.98, 400)).epsilon(1e-3));
  CHECK(left(1.01 * limit) == near(std::pow(1.02, 400)).epsilon(1e-3));
  // The guard: 1.25 over the bound 2 sum of H over m c of a bead with two partners.
  const double guarded = 1.25 * C / (4 * H);
  CHECK(guarded < limit);
  auto longest = make(heat), longer = make(heat);
  longest.time_step = 0.999 * guarded, longer.time_step = 1.001 * guarded;
  longest.run(100 * guarded);
  CHECK(std::abs(temperature(longest, 3) - 300) < start);
  CHECK(has(refusal([&] { longer.run(guarded); }), "guard.max_rate"));
}

// Catches a step by a particle's own conductivity where that of its partner limits the flow.
#ifdef SILT_LONG_TESTS
TEST_CASE("heat: silt's step is that of the pairs of materials that may meet") {
  const auto contacts = unlike_contacts();
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 0}, .radius = R, .density = density, .velocity = {1e-12, 0, 0}});
  p.add({.position = {1, 0, 0}, .radius = 2 * R, .density = density, .material = 1});
  silt::HeatConduction heat{.conductivity = 50, .heat_capacity = 0.1};
  heat.others = {{.conductivity = 0.5, .heat_capacity = 1e-4}};
  silt::Simulation sim{std::move(p), contacts, heat};
  sim.run(0);
  // The large one, of the small capacity: touched by the metal, its pair has 2/(1/50 + 1/0.5).
  const double k = 2 / (1 / 50.0 + 1 / 0.5);
  CHECK(sim.step_length() == near(8 * mass * 1e-4 / (12 * k * 2 * R)).epsilon(1e-9));
}
#endif

// Catches a neighbour that goes on receiving from a particle which is no longer there.
#ifdef SILT_LONG_TESTS
TEST_CASE("heat: who has left gives nothing more, and a restart in between gives the same bits") {
  silt::HeatConduction heat = glass;
  heat.flux_every = 10;
  const auto make = [&] {
    auto sim = chain(3, heat);
    sim.time_step = 1e-4;
    sim.field<silt::Temperature>(1) = 400;
    sim.run(14e-4);  // fluxes of step 10 are held until 20
    return sim;
  };
  auto sim = make();
  CHECK(temperature(sim, 0) > 293.15);
  sim.remove(1);
  sim.run(1e-4);  // ends the step whose fluxes were known
  const double before = temperature(sim, 0);
  sim.run(10e-4);
  CHECK(temperature(sim, 0) == before);

  auto whole = make(), again = chain(3, heat);
  again.time_step = 1e-4;
  const auto path = (std::filesystem::temp_directory_path() / "silt_heat").string();
  silt::save_checkpoint(whole, path);
  silt::load_checkpoint(again, path);
  std::filesystem::remove(path);
  again.run(1e-2), whole.run(1e-2);
  for (std::size_t k = 0; k < 3; ++k) CHECK(temperature(again, k) == temperature(whole, k));
}
#endif

TEST_CASE("heat: a step that does not resolve conduction, and values that make no sense") {
  auto sim = chain(3, {.conductivity = 400, .heat_capacity = 1e-3});
  sim.time_step = 1e-3;
  CHECK(has(refusal([&] { sim.run(0.1); }), "guard.max_rate"));
  CHECK(has(refusal([&] { chain(2, {.heat_capacity = 1}).run(0.1); }),
            "HeatConduction.conductivity"));
  CHECK(has(refusal([&] { chain(2, {.conductivity = 1}).run(0.1); }),
            "HeatConduction.heat_capacity"));
  CHECK(has(
      refusal([&] { chain(2, {.conductivity = 1, .heat_capacity = 1, .flux_every = 0}).run(0.1); }),
      "HeatConduction.flux_every"));
  CHECK(has(refusal([&] {
              auto s = chain(2, glass);
              s.module<silt::HeatConduction>().walls = {{}, {}, {}};
              s.run(0.1);
            }),
            "2 walls"));
  CHECK(has(refusal([&] {
              auto s = chain(2, glass);
              s.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}},
                         {.youngs_modulus = 1e9, .poisson_ratio = 0.3});
              s.module<silt::HeatConduction>().walls = {{}, {}, silt::held_at(300)};
              s.run(0.1);
            }),
            "wall 2 is of material 1"));
  CHECK(has(refusal([&] {
              auto s = chain(2, glass);
              s.module<silt::HeatConduction>().youngs_modulus = 1e-4 * still.youngs_modulus;
              s.time_step = 1e-3;
              s.run(0.1);
            }),
            "10000 times softer than the contacts"));
  CHECK(has(refusal([&] { silt::held_at(-3); }), "held_at: temperature"));
  CHECK(has(refusal([&] { silt::heated_by(INFINITY); }), "must be finite"));
}

// Catches losses of ended contacts that are forgotten, of walls that are given in whole, a factor 2
// between both ends, and the same loss twice.
TEST_CASE("heat: what friction and damping take from the motion is heat, 1e-9") {
  silt::Particles<silt::Sphere> p;
  p.fill({{0, 0, 0}, {0.02, 0.02, 0.02}},
         {.radius = silt::uniform(0.8e-3, 1e-3), .density = density, .count = 300});
  const silt::HertzMindlin::Material hard{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4};
  silt::Simulation sim{
      std::move(p), silt::Contacts<silt::HertzMindlin>{hard},
      silt::PeriodicBox{{{0, 0, 0}, {0.02, 0.02, 0.02}}, {true, true, true}},
      silt::FrictionHeat{{.conductivity = 1.1, .heat_capacity = 840, .start_temperature = 1}},
      silt::EnergyLedger{}};
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const double phase = static_cast<double>(sim.id(k));
    sim.set_velocity(sim.id(k), {std::sin(7 * phase), std::sin(11 * phase), std::sin(13 * phase)});
  }
  double booked = 0, last = 0;  // [J] now, and a step ago: heat follows in the next step
  sim.run(0.02, [&](const auto& s) {
    const auto e = s.energy();
    last = std::exchange(booked, e.dissipated() + e.tangential + e.rolling - e.stiffening);
  });
  double heat = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    heat += sim.mass(k) * 840 * (sim.field<silt::Temperature>(k) - 1);
  CHECK(last > 0.1 * sim.energy().initial);
  CHECK(heat == near(last).epsilon(1e-9));
}

}  // namespace heat_test
