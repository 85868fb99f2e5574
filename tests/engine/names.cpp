// silt - BSD-3-Clause, see LICENSE
// Names of materials and forms: found by name, in messages, refused where they cannot be.
#include <array>
#include <limits>

#include <engine/support.hpp>

#include <silt/module/charge/tribo_charge.hpp>
#include <silt/module/heat/conduction.hpp>
#include <silt/module/heat/mutual_radiation.hpp>
#include <silt/shape/multi_sphere.hpp>
#include <silt/shape/super_ellipsoid.hpp>

namespace names_test {

namespace {

using namespace engine_test;
using silt::InputError;
using silt::SimulationError;
using silt::SuperEllipsoid;
using Several = silt::Contacts<HertzMindlin, silt::SeveralMaterials>;
using One = silt::Contacts<HertzMindlin>;
using Grains = silt::Particles<Sphere>;
using Pills = silt::Particles<SuperEllipsoid>;

HertzMindlin::Material of(double youngs_modulus) {
  auto m = rubber;
  m.youngs_modulus = youngs_modulus;
  return m;
}
const auto soft = of(1e6), hard = of(1e7), other = of(2e6);

template <class Action>
void refused(Action&& action, std::initializer_list<std::string> words) {
  CHECK(has_words(refusal<InputError>(action), words));
}
template <class Action>
void stopped(Action&& action, std::initializer_list<std::string> words) {
  CHECK(has_words(refusal<SimulationError>(action), words));
}

/// Materials 0 'gum' and 1 'steel'.
Several two_named() {
  Several contacts{{soft, hard}};
  contacts.add(soft, "gum"), contacts.add(hard, "steel");
  contacts.set_pair(soft, hard, {.restitution = 0.5, .friction = 0.3});
  return contacts;
}
/// Two spheres of 1 mm whose centres are `apart` [m], of materials 0 and 1, which approach.
Grains two_grains(double apart) {
  Grains p;
  p.add({.position = {0, 0, 1e-3}, .radius = 1e-3, .density = 2500});
  p.add({.position = {apart, 0, 1e-3},
         .radius = 1e-3,
         .density = 2500,
         .velocity = {-1, 0, 0},
         .material = 1});
  return p;
}
auto scene(double apart, Several contacts = two_named()) {
  silt::Simulation sim{two_grains(apart), std::move(contacts)};
  sim.threads = 1;
  return sim;
}
SuperEllipsoid pill(double c) { return {.a = 1e-3, .b = 1e-3, .c = c}; }

}  // namespace

TEST_CASE("names of materials: they find the material; those that cannot be are refused") {
  Several contacts{{soft, hard}};
  CHECK(contacts.material_name(1) == "material 1");
  refused([&] { contacts.find_material("gum"); },
          {"material 'gum' is not there; no material has a name: give it one with contacts.add("});
  CHECK(contacts.add(hard, "steel") == 1);
  CHECK(contacts.add(hard, "steel") == 1);  // its own
  CHECK(contacts.add(hard) == 1);           // keeps it
  CHECK(contacts.add(other, "rubber") == 2);
  CHECK(contacts.materials() == 3);
  CHECK(contacts.find_material("rubber") == 2);
  CHECK(contacts.material("steel") == hard);
  CHECK(contacts.material(0) == soft);
  CHECK(contacts.material_name(1) == "material 1 'steel'");
  contacts.name_material("rubber", "gum");
  CHECK(contacts.material_name(2) == "material 2 'gum'");

  refused([&] { contacts.find_material("glass"); },
          {"material 'glass' is not there; the named materials are 'steel', 'gum'"});
  refused([&] { contacts.material(3); }, {"material(3): there are 3 materials"});
  refused([&] { contacts.add(soft, "gum"); }, {"material 2 has the name 'gum' already"});
  refused([&] { contacts.add(soft, "steel"); }, {"material 1 has the name 'steel' already"});
  refused([&] { contacts.name_material(0, ""); }, {"a material's name is empty"});
  refused([&] { contacts.name_material(0, "a=b"); }, {"the material name 'a=b'", "printable"});
  refused([&] { contacts.add(of(-1), "bad"); },
          {"material 3 'bad': HertzMindlin::Material.youngs_modulus = -1"});
  CHECK(contacts.materials() == 3);
}

// Catches equal values that become one without a word, values of a pair that the second of two
// equal materials lacks, and a wall that gets another one than it names.
TEST_CASE("names of materials: equal values with names of their own are materials of their own") {
  Several contacts = two_named();
  CHECK(contacts.add(hard, "coated") == 2);
  CHECK(contacts.add(hard, "coated") == 2);
  CHECK(contacts.add(hard, "steel") == 1);
  CHECK(contacts.add(hard) == 1);  // by values alone: the first
  CHECK(contacts.material(2) == hard);
  CHECK(contacts.materials() == 3);
  const auto of_pair = [&](std::size_t a, std::size_t b) {
    const auto c = contacts.coefficients(a, b);
    return std::array{c.twice_modulus, c.normal_damping, c.friction};
  };
  // Pairs: those of its values, given before or after; without any, its own values.
  CHECK(of_pair(0, 2) == of_pair(0, 1));
  CHECK(of_pair(2, 1) == of_pair(1, 1));
  contacts.set_pair(hard, soft, {.restitution = 0.2, .friction = 0.1});
  CHECK(of_pair(0, 2) == of_pair(0, 1));
  contacts.set_pair(hard, hard, {.restitution = 0.1, .friction = 0.1});
  CHECK(of_pair(2, 1) == of_pair(1, 1));
  CHECK(of_pair(2, 2) == of_pair(1, 1));

  // In a simulation: each with its own heat capacity and work function, a wall of the second.
  silt::Contacts<HertzMindlin, silt::SeveralMaterials> powders{{soft}};
  powders.add(soft, "light"), powders.add(soft, "heavy");
  const silt::HeatConduction heat{.conductivity = 1,
                                  .heat_capacity = 800,
                                  .start_temperature = 300,
                                  .others = {{.conductivity = 1, .heat_capacity = 1600}},
                                  .flux_every = 1};
  // They overlap by 0.01 mm, at rest: what one gives the other gets, 2 to 1 in temperature.
  silt::Simulation sim{two_grains(1.99e-3), powders, heat};
  sim.threads = 1;
  sim.time_step = 1e-6;
  sim.set_velocity(1, {0, 0, 0});
  sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, soft, {.name = "floor", .material = "heavy"});
  sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, soft, {.name = "by values"});
  CHECK(sim.wall("floor").material == 1);
  CHECK(sim.wall("by values").material == 0);
  sim.field<silt::Temperature>(sim.find(0)) = 400;
  sim.run(1e-4);
  const double lost = 400 - sim.field<silt::Temperature>(sim.find(0));
  CHECK(lost > 0);
  CHECK(sim.field<silt::Temperature>(sim.find(1)) - 300 ==
        doctest::Approx(lost / 2).scale(0).epsilon(1e-8));
}

TEST_CASE("names of materials: values of modules for materials that are not there are refused") {
  const auto with = [](auto module) {
    silt::Contacts<HertzMindlin, silt::SeveralMaterials> equal{{soft, soft}};
    Grains p;
    p.add({.position = {0, 0, 1e-3}, .radius = 1e-3, .density = 2500});
    silt::Simulation sim{std::move(p), equal, std::move(module)};
    sim.threads = 1;
    sim.time_step = 1e-6;
    sim.run(0);
  };
  const silt::HeatConduction one{.conductivity = 1, .heat_capacity = 800};
  auto two = one;
  two.others = {{.conductivity = 2, .heat_capacity = 800}};
  with(one);
  refused([&] { with(two); },
          {"HeatConduction.others has 1 entry, from material 1 on, but the contacts and walls "
           "have 1 material: those of equal values are one unless they have names of their own "
           "(contacts.add(material, name))"});
  refused(
      [&] {
        with(silt::MutualRadiation{one, {.gap = 1e-3, .others = {0.5, 0.5}}});
      },
      {"MutualRadiation.others has 2 entries, from material 1 on, but the contacts and walls "
       "have 1 material"});
  refused(
      [&] {
        with(silt::TriboCharge{silt::Charge{.cutoff = 4e-3}, {.work_functions = {4, 5}}});
      },
      {"TriboCharge.work_functions has 2 entries, but the contacts and walls have 1 material"});
}

TEST_CASE("names of materials: in a simulation, which changes particles by them") {
  auto sim = scene(3e-3);
  CHECK(sim.material_name(1) == "material 1 'steel'");
  sim.set_material(0, "steel");
  CHECK(sim.material(0) == 1);
  sim.set_material(0, sim.find_material("gum"));
  CHECK(sim.material(0) == 0);
  refused([&] { sim.set_material(0, "glass"); }, {"material 'glass' is not there", "'gum'"});
  refused([&] { sim.set_material(0, 2); }, {"set_material: material 2 is not in the table of 2"});
  // That of a wall comes with it.
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, other, {.name = "floor"});
  sim.name_material(sim.wall("floor").material, "floor paint");
  CHECK(sim.find_material("floor paint") == 2);
  refused([&] { sim.name_material(2, "gum"); }, {"material 0 has the name 'gum' already"});
  refused([&] { sim.run(0); },
          {"materials 0 'gum' and 2 'floor paint' have no pair value; call set_pair"});
}

TEST_CASE("names of materials: overlaps, the time step and particles that do not fit") {
  auto deep = scene(1e-3);
  stopped([&] { deep.run(0); }, {"overlap by 1",
                                 "for material 0 'gum' (youngs_modulus = 1e+06 Pa) and material 1 "
                                 "'steel' (youngs_modulus = 1e+07 Pa) alone"});
  auto low = scene(1.95e-3);
  low.set_max_overlap(soft, hard, 0.01);
  stopped([&] { low.run(0); }, {"above the limit 0.01 that set_max_overlap gives to material 0 "
                                "'gum'"});
  // By name: catches a limit that goes to another pair.
  auto named = scene(1.95e-3);
  named.set_max_overlap("steel", "steel", 0.01);
  named.run(0);
  named = scene(1.95e-3);
  named.set_max_overlap("steel", 0, 0.01);
  stopped([&] { named.run(0); }, {"above the limit 0.01 that set_max_overlap gives to material 0 "
                                  "'gum'"});
  refused([&] { named.set_max_overlap("steal", "gum", 1); }, {"'steal'"});
  auto fast = scene(3e-3);
  fast.time_step = 1;
  refused([&] { fast.run(1); }, {"of a particle of radius 0.001 m and material 1 'steel' (",
                                 "with one of radius 0.001 m and material"});
  One contacts{soft};
  contacts.add(hard, "steel");
  refused(
      [&] {
        silt::Simulation{two_grains(3e-3), contacts};
      },
      {"particle 1: material 1 'steel' needs Contacts<Law, SeveralMaterials>"});
}

TEST_CASE("names of materials: values that modules lack or that are wrong") {
  const auto with = [](auto module) {
    silt::Simulation sim{two_grains(3e-3), two_named(), std::move(module)};
    sim.threads = 1;
    sim.run(0);
  };
  const silt::HeatConduction heat{.conductivity = 1, .heat_capacity = 800};
  auto bad = heat, wall = heat;
  bad.others = {{.conductivity = -2, .heat_capacity = 800}};
  refused([&] { with(heat); }, {"HeatConduction: particle 1 is of material 1 'steel', which has no "
                                "conductivity in `others`"});
  refused([&] { with(bad); },
          {"HeatConduction.others[0] (material 1 'steel').conductivity = -2 [W/(m K)]"});
  wall.walls = {silt::held_at(300)};
  refused(
      [&] {
        Grains p;
        p.add({.position = {0, 0, 1e-3}, .radius = 1e-3, .density = 2500});
        silt::Simulation sim{std::move(p), two_named(), wall};
        sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, hard, {.name = "floor"});
        sim.run(0);
      },
      {"HeatConduction: wall 0 'floor' is of material 1 'steel', which has no"});
  auto full = heat;
  full.others = {{.conductivity = 2, .heat_capacity = 800}};
  refused(
      [&] {
        with(silt::MutualRadiation{full, {.gap = 1e-3}});
      },
      {"MutualRadiation: particle 1 is of material 1 'steel', which has no"});
  refused(
      [&] {
        with(silt::MutualRadiation{full, {.gap = 1e-3, .others = {2}}});
      },
      {"MutualRadiation.others[0] (material 1 'steel') = 2 [-]"});
  const auto tribo = [](std::vector<double> work) {
    return silt::TriboCharge{silt::Charge{.cutoff = 4e-3}, {.work_functions = std::move(work)}};
  };
  refused([&] { with(tribo({4})); }, {"TriboCharge: particle 1 is of material 1 'steel', which has "
                                      "no value [eV] in `work_functions`"});
  refused(
      [&] {
        with(tribo({4, std::numeric_limits<double>::infinity()}));
      },
      {"TriboCharge.work_functions[1] (material 1 'steel') = inf [eV]"});
}

TEST_CASE("names of forms: they find the form; those that cannot be are refused") {
  Pills p;
  p.add_form(pill(1e-3));
  CHECK(p.add_form(pill(2e-3), "long") == 1);
  CHECK(p.find_form("long") == 1);
  refused([&] { p.find_form("flat"); }, {"form 'flat' is not there; the named forms are 'long'"});
  refused([&] { p.add_form(pill(3e-3), "long"); }, {"form 1 has the name 'long' already"});
  refused([&] { p.add_form(pill(3e-3), "a:b"); }, {"the form name 'a:b'"});
  refused([&] { p.add_form(pill(-1), "bad"); }, {"form 'bad': ", "c = -1"});
  CHECK(p.forms().size() == 2);
  p.add({.position = {0, 0, 0}, .density = 2500});

  silt::Simulation sim{p, One{soft}};
  sim.threads = 1;
  CHECK(sim.form_name(0) == "form 0");
  CHECK(sim.form_name(1) == "form 1 'long'");
  CHECK(sim.find_form("long") == 1);
  sim.set_form(0, "long");
  CHECK(sim.form(sim.find(0)) == 1);
  sim.name_form(0, "round");
  sim.set_form(0, "round");
  CHECK(sim.form(sim.find(0)) == 0);
  refused([&] { sim.set_form(0, "flat"); }, {"form 'flat' is not there", "'round', 'long'"});
  refused([&] { sim.name_form(0, "long"); }, {"form 1 has the name 'long' already"});
  refused([&] { sim.name_form(5, "x"); }, {"form(5): there are 2 forms"});
}

TEST_CASE("names of forms: equal shapes of two names are two forms, of one or none they are one") {
  Pills first;
  first.add_form(pill(1e-3));
  first.add_form(pill(2e-3), "long");
  first.add({.position = {0, 0, 0}, .density = 2500});
  silt::Simulation sim{first, One{soft}};
  const auto added = [&](auto&&... names) {
    Pills more;
    (more.add_form(pill(2e-3), names), ...);
    return sim.add(more);
  };
  using Numbers = std::vector<std::size_t>;
  CHECK(added("long") == Numbers{1});
  CHECK(added("") == Numbers{1});
  CHECK(added("spare") == Numbers{2});
  CHECK(sim.form_name(2) == "form 2 'spare'");
  // An equal one without a name gets it.
  Pills round;
  round.add_form(pill(1e-3), "round");
  CHECK(sim.add(round) == Numbers{0});
  CHECK(sim.form_name(0) == "form 0 'round'");
  // Another shape cannot have a name that is taken, and nothing is added.
  Pills wrong;
  wrong.add_form(pill(3e-3), "flat");
  wrong.add_form(pill(4e-3), "long");
  refused([&] { sim.add(wrong); }, {"form 1 has the name 'long' already"});
  CHECK(sim.forms().size() == 3);
  // A copy is its form, also after it has got another name; shapes that cannot be compared too.
  sim.name_form(1, "rod");
  CHECK(sim.add(first) == Numbers{0, 1});
  CHECK(sim.form_name(1) == "form 1 'rod'");
  CHECK(sim.size() == 2);
}

}  // namespace names_test
