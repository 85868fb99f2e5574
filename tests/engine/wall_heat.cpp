// silt - BSD-3-Clause, see LICENSE
// Thermal conditions of walls: by name, changed in the middle of a run, in checkpoints; and
// temperatures that cannot be.
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/module/heat/surroundings.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace wall_heat_test {

using silt_test::has, silt_test::refusal;

const double R = 1e-3, d = 0.02e-3, density = 2500;  // [m], [m], [kg/m3]
// So soft that nothing moves while heat flows.
const silt::HertzMindlin::Material still{
    .youngs_modulus = 1e-14, .poisson_ratio = 0.3, .restitution = 0.9, .friction = 0.3};
const silt::HertzMindlin::Material other{
    .youngs_modulus = 2e-14, .poisson_ratio = 0.3, .restitution = 0.9, .friction = 0.3};
using Conditions = silt::WallValues<silt::WallHeat>;
const double k = 1.1, c = 840;  // [W/(m K)], [J/(kg K)]
const double capacity = 4.0 / 3 * 3.14159265358979323846 * R * R * R * density * c;  // [J/K]
const double at_wall = 2 * k * std::sqrt(R * d);                                     // [W/K]

/// Beads in a row between wall 0 'left' and wall 1 'right'.
auto row(std::size_t count, const Conditions& walls, std::size_t flux_every = 10) {
  silt::Particles<silt::Sphere> p;
  for (std::size_t n = 0; n < count; ++n)
    p.add({.position = {R - d + static_cast<double>(n) * (2 * R - d), 0, 0},
           .radius = R,
           .density = density});
  silt::Simulation sim{
      std::move(p), silt::Contacts<silt::HertzMindlin>{still},
      silt::HeatConduction{
          .conductivity = k, .heat_capacity = c, .walls = walls, .flux_every = flux_every}};
  const double end = static_cast<double>(count) * (2 * R - d) - d;
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, still, {.name = "left"});
  sim.add_wall(silt::Plane{{end, 0, 0}, {-1, 0, 0}}, still, {.name = "right"});
  sim.time_step = 1e-3;
  return sim;
}
template <class Sim>
double temperature(const Sim& sim, std::size_t id) {
  return sim.template field<silt::Temperature>(sim.find(id));
}

// Catches names that are taken in the order of the list.
TEST_CASE("wall heat: conditions by name are those by number, bit for bit") {
  auto by_number = row(3, {silt::held_at(400), silt::held_at(300)});
  auto by_name = row(3, {{"right", silt::held_at(300)}, {"left", silt::held_at(400)}});
  auto mixed = row(3, {{1, silt::held_at(300)}, {"left", silt::held_at(400)}});
  for (auto* sim : {&by_number, &by_name, &mixed}) sim->run(5);
  for (std::size_t n = 0; n < 3; ++n) {
    CHECK(temperature(by_name, n) == temperature(by_number, n));
    CHECK(temperature(mixed, n) == temperature(by_number, n));
  }
  CHECK(temperature(by_number, 0) > temperature(by_number, 2) + 1);
  // One alone: the other wall is insulated.
  auto one = row(1, {{"right", silt::heated_by(1e-3)}});
  one.run(1);
  CHECK(temperature(one, 0) == near(293.15 + 1e-3 / capacity).epsilon(1e-12));
}

// Catches a grain that is cooled below 0 K without a word.
TEST_CASE("wall heat: a wall that takes more heat than there is ends the run") {
  auto sim = row(1, {{"right", silt::heated_by(-1)}});
  std::string words;
  try {
    sim.run(1e3);
  } catch (const silt::SimulationError& error) {
    words = error.what();
    CHECK(error.particles.size() == 1);
  }
  CHECK(sim.time() == near(293.15 * capacity).epsilon(1e-3));  // 1 W
  for (const char* part :
       {"particle 0 at (", " m got temperature [K] = -", "above 0 K", "heated_by"})
    CHECK(words.find(part) != std::string::npos);
}

// Catches a change that waits until fluxes are asked for by themselves, and a former condition that
// goes on.
TEST_CASE("wall heat: a condition that is changed acts in the next step") {
  auto sim = row(1, {{"left", silt::held_at(400)}});
  sim.run(1.003);  // fluxes are held for ten steps, this is within
  const double before = temperature(sim, 0);
  CHECK(before > 294);
  sim.set_wall_heat("left", silt::held_at(350));
  sim.run(0.001);
  CHECK(sim.given_by_wall<silt::Temperature>("left").rate ==
        near(at_wall * (350 - temperature(sim, 0))).epsilon(1e-12));
  sim.set_wall_heat("left", silt::insulated());
  sim.set_wall_heat("right", silt::heated_by(-0.5));  // had none in the list
  sim.run(0.001);
  const double then = temperature(sim, 0);
  sim.run(0.1);
  CHECK(temperature(sim, 0) == near(then - 0.5 * 0.1 / capacity).epsilon(1e-12));
  CHECK(sim.given_by_wall<silt::Temperature>("left").rate == 0);
  CHECK(sim.given_by_wall<silt::Temperature>(1).rate == near(-0.5));
}

TEST_CASE("wall heat: in an observer, against Euler's closed form") {
  auto sim = row(1, {silt::held_at(400)}, 1);
  sim.run(4, silt::at(silt::every(2), [](auto& now) {
            if (now.time() > 1 && now.time() < 3) now.set_wall_heat(0, silt::held_at(300));
          }));
  // The observer sees the step in which the former condition acted last: steps 0 to 2000.
  const double decay = 1 - at_wall / capacity * 1e-3;
  const double at_change = 400 - (400 - 293.15) * std::pow(decay, 2001);
  CHECK(temperature(sim, 0) ==
        near(300 + (at_change - 300) * std::pow(decay, 1999)).epsilon(1e-12));
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Catches a restart that silently goes on with the condition of the program's beginning.
TEST_CASE("wall heat: checkpoints keep a changed condition") {
  const std::string path = "wall_heat.silt";
  const Conditions walls{{"left", silt::held_at(400)}};
  auto sim = row(2, walls);
  sim.run(0.5);
  silt::save_checkpoint(sim, path);
  CHECK(bytes_of(path).find("wall_heat") == std::string::npos);  // nothing was changed
  sim.set_wall_heat("left", silt::held_at(500));
  sim.set_wall_heat("right", silt::heated_by(0.01));
  sim.run(0.5);
  silt::save_checkpoint(sim, path);
  auto next = row(2, walls);
  silt::load_checkpoint(next, path);
  for (auto* s : {&sim, &next}) s->run(0.5);
  for (std::size_t n = 0; n < 2; ++n) CHECK(temperature(next, n) == temperature(sim, n));
  // The one that was loaded keeps it, too.
  silt::save_checkpoint(next, path);
  auto third = row(2, walls);
  silt::load_checkpoint(third, path);
  third.set_wall_heat("right", silt::insulated());
  silt::save_checkpoint(third, path);
  silt::load_checkpoint(next, path);
  next.run(0.2);
  CHECK(next.given_by_wall<silt::Temperature>("right").rate == 0);

  // No file has a function.
  const auto ramp = silt::held_at([](double t) { return 300 + 10 * t; });
  third.set_wall_heat("left", ramp);
  silt::save_checkpoint(third, path);
  auto without = row(2, walls), with = row(2, walls);
  const double start = temperature(without, 0);
  const std::string words = refusal([&] { silt::load_checkpoint(without, path); });
  CHECK(has(words, "wall 0 'left' is held at 315 K by a function of time"));
  CHECK(has(words, "call set_wall_heat with it before load_checkpoint"));
  CHECK(temperature(without, 0) == start);
  with.set_wall_heat("left", ramp);
  silt::load_checkpoint(with, path);
  for (auto* s : {&third, &with}) s->run(0.5);
  CHECK(temperature(with, 0) == temperature(third, 0));
}

TEST_CASE("wall heat: what cannot be is refused by a sentence") {
  CHECK(has(refusal([] {
              row(1, {{"lfet", silt::held_at(400)}}).run(0.01);
            }),
            "HeatConduction.walls: wall 'lfet' is not there; the named walls are 'left', 'right'"));
  CHECK(has(refusal([] {
              row(1, {{2, silt::held_at(400)}}).run(0.01);
            }),
            "HeatConduction.walls: wall(2): there are 2 walls"));
  CHECK(has(refusal([] {
              row(1, {{"left", silt::held_at(400)}, {0, silt::insulated()}}).run(0.01);
            }),
            "HeatConduction.walls: its entries 0 and 1 are both of wall 0 'left'"));
  CHECK(has(refusal([] {
              Conditions{{"left", silt::held_at(400)}, silt::insulated()};
            }),
            "entry 1 of a list of walls' values has no wall's name or number"));
  CHECK(has(refusal([] {
              row(1, {{}, {}, {}}).run(0.01);
            }),
            "HeatConduction.walls has 3 entries, but the simulation has 2 walls"));
  auto sim = row(1, {});
  sim.run(0.01);
  CHECK(has(refusal([&] { sim.set_wall_heat("top", silt::insulated()); }), "wall 'top'"));
  sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, other, {.name = "floor"});
  CHECK(has(refusal([&] { sim.set_wall_heat("floor", silt::held_at(300)); }),
            "wall 2 'floor' is of material 1"));
  sim.set_wall_heat("floor", silt::insulated());
  sim.set_pair(0, 1, {.restitution = 0.9, .friction = 0.3});
  CHECK(has(refusal([&] {
              sim.run(0.1, [](auto& now) {
                now.template module<silt::HeatConduction>().walls = {{"left", silt::held_at(400)}};
              });
            }),
            "Simulation::set_wall_heat changes a wall at any time"));
}

// Catches radiation of T^4 from a negative temperature, which heats like a positive one.
TEST_CASE("wall heat: temperatures of particles that cannot be are refused with id and value") {
  auto sim = row(3, {});
  sim.run(0.01);
  for (const double T : {-5.0, 0.0, std::nan("")}) {
    sim.field<silt::Temperature>(sim.find(1)) = T;
    const std::string words = refusal([&] { sim.run(0.01); });
    CHECK(has(words, "the temperature of particle 1 is "));
    if (T < 0) CHECK(has(words, "is -5 K; it must be finite and greater than 0"));
  }
  sim.field<silt::Temperature>(sim.find(1)) = 300;
  sim.run(0.01);
  for (const double T : {0.0, -20.0}) {
    sim.module<silt::HeatConduction>().start_temperature = T;
    CHECK(has(refusal([&] { sim.run(0.01); }), "HeatConduction.start_temperature = "));
  }
}

}  // namespace wall_heat_test
