// silt - BSD-3-Clause, see LICENSE
// Walls of a new material that come between two runs: their pair values and what modules know of
// them; and which wall a missing value belongs to.
#include <cmath>
#include <cstddef>
#include <utility>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/io/observers.hpp>
#include <silt/module/charge/tribo_charge.hpp>
#include <silt/module/heat/mutual_radiation.hpp>
#include <silt/module/heat/surroundings.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace late_walls_test {

using silt_test::has, silt_test::refusal;

const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.9, .friction = 0.4};
const silt::HertzMindlin::Material steel{
    .youngs_modulus = 2e7, .poisson_ratio = 0.3, .restitution = 0.9, .friction = 0.4};

/// A grain that falls onto a wall which is not there yet.
template <class... Modules>
auto falling(const silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>& contacts,
             const Modules&... modules) {
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 1.5e-3}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -1}});
  silt::Simulation sim{std::move(p), contacts, modules...};
  sim.run(1e-4);
  return sim;
}
const silt::Plane below{{0, 0, 0}, {0, 0, 1}};

// Catches a value that is taken for the materials' own, or that acts only on a new simulation.
TEST_CASE("late walls: a pair value for the material of a wall that came after a run") {
  auto sim = falling(silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>{glass, {}});
  sim.add_wall(below, steel, {.name = "lid"});
  const std::string words = refusal([&] { sim.run(2e-3); });
  CHECK(has(words, "materials 0 and 1 have no pair value; call set_pair"));
  CHECK(has(words, "; material 1 is that of wall 0 'lid'"));
  sim.name_material(0, "glass"), sim.name_material(sim.wall("lid").material, "steel");
  CHECK(has(refusal([&] { sim.run(2e-3); }), "; material 1 'steel' is that of wall 0 'lid'"));
  CHECK(has(refusal([&] { sim.set_pair("glass", "tin", {.restitution = 0.5, .friction = 0}); }),
            "material 'tin' is not there; the named materials are 'glass', 'steel'"));
  CHECK(has(refusal([&] { sim.set_pair("glass", "steel", {.restitution = 1.5, .friction = 0}); }),
            "restitution = 1.5"));
  sim.set_pair("glass", "steel", {.restitution = 0.5, .friction = 0});
  sim.set_rolling("glass", "steel", {.rolling_friction = 0.1});
  sim.run(2e-3);
  // silt's own step of a 20th of the contact: 0.495 for 0.5 (docs/limits.md).
  CHECK(sim.velocity(0).z == near(0.5).epsilon(0.02));
}

// Catches coefficients read beyond a table that is as large as it was when the run began.
TEST_CASE("late walls: an observer adds a wall of a new material, and its pair value") {
  auto sim = falling(silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>{glass, {}},
                     silt::HeatConduction{.conductivity = 1, .heat_capacity = 800});
  const auto add = [](auto& s) {
    if (s.walls() > 0) return;
    s.add_wall(below, steel, {.name = "lid"});
    s.set_pair(0, s.wall("lid").material, {.restitution = 0.5, .friction = 0});
  };
  sim.run(2e-3, silt::at(silt::every(1e-4), add));
  CHECK(sim.velocity(0).z == near(0.5).epsilon(0.02));
  auto forgotten = falling(silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>{glass, {}});
  const auto add_alone = [](auto& s) {
    if (s.walls() == 0) s.add_wall(below, steel, {.name = "lid"});
  };
  CHECK(has(refusal([&] { forgotten.run(2e-3, silt::at(silt::every(1e-4), add_alone)); }),
            "materials 0 and 1 have no pair value"));
}

TEST_CASE("late walls: a wall that is left out is not named") {
  silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials> two{{glass, steel}};
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 1.5e-3}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(p), two};
  sim.add_wall(below, glass);
  const std::string words = refusal([&] { sim.run(1e-3); });
  CHECK(has(words, "; material 0 is that of wall 0"));
  CHECK(words.find("material 1 is that of") == std::string::npos);
}

// Walls never touch each other. Catches pair values asked for that nothing can need; and a particle
// that becomes one of a wall's material in the middle of a run, and would collide by values that
// nobody gave.
TEST_CASE("late walls: two materials that only walls have need no pair value") {
  const auto rubber = silt::HertzMindlin::Material{
      .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.4, .friction = 0.4};
  silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials> contacts{glass};
  contacts.add(glass, "glass"), contacts.add(steel, "steel"), contacts.add(rubber, "rubber");
  contacts.set_pair(glass, steel, {.restitution = 0.9, .friction = 0});
  contacts.set_pair(glass, rubber, {.restitution = 0.5, .friction = 0});
  silt::Particles<silt::Sphere> p;
  p.add({.position = {0, 0, 1.5e-3}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -1}});
  const auto scene = [&] {
    silt::Simulation sim{p, contacts};
    sim.add_wall(below, steel, {.name = "floor"});
    sim.add_wall(silt::Plane{{0, 0, 0.1}, {0, 0, -1}}, rubber, {.name = "lid"});
    return sim;
  };
  auto sim = scene();
  sim.run(2e-3);
  CHECK(sim.velocity(0).z == near(0.9).epsilon(0.02));  // as above

  const auto becomes = [](auto& sim, bool known) {
    sim.run(2e-3, [&, done = false](auto& at) mutable {
      if (std::exchange(done, true)) return;
      if (known) at.set_pair("steel", "rubber", {.restitution = 0.7, .friction = 0});
      at.set_material(0, "rubber");
    });
  };
  auto turned = scene();
  CHECK(has(refusal([&] { becomes(turned, false); }),
            "materials 1 'steel' and 2 'rubber' have no pair value"));
  auto known = scene();
  becomes(known, true);
  CHECK(known.velocity(0).z == near(0.7).epsilon(0.02));
  // Those that an inlet will bring count too.
  auto fed = scene();
  fed.add_inlet(silt::Box{{0, 0, 0.02}, {0.01, 0.01, 0.03}},
                {.radius = 1e-3, .density = 2500, .rate = 1, .material = 2});
  CHECK(has(refusal([&] { fed.run(0); }), "materials 1 'steel' and 2 'rubber' have no pair value"));
}

// Catches tables that keep the number of materials of the first run, and a list of values that is
// held against the walls of that run.
TEST_CASE("late walls: modules' values for a material whose wall comes after a run") {
  silt::Contacts<silt::HertzMindlin, silt::RollingEpsd> contacts{glass, {}};
  contacts.set_pair(glass, steel, {.restitution = 0.5, .friction = 0.3});  // adds steel
  const silt::ThermalMaterial metal{.conductivity = 50, .heat_capacity = 450};
  const silt::HeatConduction known{
      .conductivity = 1, .heat_capacity = 800, .others = {metal}, .flux_every = 1};
  const auto warmed = [&](auto& sim) {
    sim.add_wall(below, steel, {.name = "lid"});
    sim.set_wall_heat("lid", silt::held_at(500));
    sim.run(2e-3);
    return sim.template field<silt::Temperature>(0);
  };
  auto before = falling(contacts, known);
  const double T = warmed(before);
  CHECK(T > 293.152);
  CHECK(has(refusal([&] {
              falling(silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>{glass, {}}, known);
            }),
            "added later is registered by contacts.add(material, name) beforehand"));
  // Values that come with the wall.
  auto alone = known;
  alone.others.clear();
  auto after = falling(contacts, alone);
  after.module<silt::HeatConduction>().others = {metal};
  CHECK(warmed(after) == T);
  // A material that nobody has added before: the wall brings it.
  auto brought = falling(silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>{glass, {}}, alone);
  brought.add_wall(below, steel, {.name = "lid"});
  brought.set_pair(0, 1, {.restitution = 0.5, .friction = 0.3});
  brought.module<silt::HeatConduction>().others = {metal};
  brought.set_wall_heat("lid", silt::held_at(500));
  brought.run(2e-3);
  CHECK(brought.field<silt::Temperature>(0) == T);
  // Of equal values and a name of its own.
  auto named = falling(silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>{glass, {}}, alone);
  named.add_wall(below, glass, {.name = "lid", .material = "coated"});
  CHECK(named.wall("lid").material == 0);
  auto coated = falling(
      [] {
        silt::Contacts<silt::HertzMindlin, silt::RollingEpsd> c{glass, {}};
        c.name_material(0, "clean");
        return c;
      }(),
      alone, silt::TriboCharge{silt::Charge{.cutoff = 5e-3}, {.work_functions = {4}}});
  coated.add_wall(below, glass, {.name = "lid", .material = "coated"});
  CHECK(has(refusal([&] { coated.run(2e-3); }),
            "TriboCharge: wall 0 'lid' is of material 1 'coated'"));
  coated.module<silt::TriboCharge>().surfaces.work_functions = {4, 5};
  coated.module<silt::HeatConduction>().others = {metal};
  coated.set_wall_heat("lid", silt::held_at(500));
  coated.run(2e-3);
  CHECK(coated.field<silt::Temperature>(0) > 293.152);
  CHECK(coated.field<silt::ElectricCharge>(0) != 0);
  // A wall that exchanges no charge, by its name.
  const auto charged = [&](const silt::WallValues<bool>& insulated) {
    silt::Contacts<silt::HertzMindlin, silt::RollingEpsd> c{glass, {}};
    c.name_material(0, "clean");
    silt::Particles<silt::Sphere> p;
    p.add({.position = {0, 0, 1.2e-3}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, -1}});
    silt::Simulation sim{std::move(p), c,
                         silt::TriboCharge{silt::Charge{.cutoff = 5e-3},
                                           {.work_functions = {4, 5}, .insulated = insulated}}};
    sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, glass, {.name = "far"});
    sim.add_wall(below, glass, {.name = "lid", .material = "coated"});
    sim.run(1e-3);
    return sim.field<silt::ElectricCharge>(0) != 0;
  };
  CHECK(charged({}));
  CHECK(charged({{"far", true}}));
  CHECK(!charged({{"lid", true}}));
  CHECK(!charged({false, true}));
  CHECK(has(refusal([&] {
              charged({{"led", true}});
            }),
            "TriboCharge.insulated: wall 'led' is not there; the named walls are 'far', 'lid'"));
}

}  // namespace late_walls_test
