// silt - BSD-3-Clause, see LICENSE
// Breakage beside other policies: by force, softened laws in single precision, a periodic box with
// inlet and outlet, several materials.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/contact/softened.hpp>
#include <silt/io/checkpoint.hpp>

#include "breakage/scene.hpp"
#include "near.hpp"

namespace breakage_compositions_test {

using namespace breakage_scene;  // NOLINT: of this test alone

TEST_CASE(
    "breakage by force: a grain between two plates breaks as the force reaches its strength, "
    "and weakens once a press") {
  // Too slow for inertia: the force is Hertz' of the overlap at each plate.
  const double R = 1e-3, E = 2e9 / (1 - 0.25 * 0.25) / 2, strength = 5;
  const double deepest = std::pow(0.8 * strength / silt::hertz_stiffness(E, R), 2.0 / 3);
  silt::Particles<silt::Sphere> grain;
  grain.add({.position = {0, 0, R}, .radius = R, .density = 2165});
  silt::Simulation sim{std::move(grain), silt::Contacts<silt::HertzMindlin>{salt},
                       // All of one strength: so narrow is the distribution.
                       silt::Breakage{silt::LogLogisticStrength{strength, 2 * R, 0, 1e9},
                                      silt::ForceEquivalence{},
                                      silt::GaudinSchuhmann{1, 0.8},
                                      silt::PowerFatigue{.kappa = 0.1, .psi = 2},
                                      {.dust_below = 0.5 * R}}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
  const double presses = 1e-3;  // [s] each
  const auto depth =
      [=](double t) {  // of the upper plate, twice that of each contact; it lifts off
        const double phase = std::sin(std::numbers::pi * t / presses);
        return 2 * deepest * (1.5 * phase * phase - 0.5);
      };
  sim.add_wall(silt::Plane{{0, 0, 2 * R}, {0, 0, -1}}, salt, [=](double t) {
    return silt::Pose{{}, {0, 0, -depth(t)}};
  });
  sim.time_step = 2e-7;
  std::vector<double> strengths;
  for (int press = 0; press < 3; ++press) {
    sim.run(presses);
    if (sim.broken() > 0) break;
    strengths.push_back(sim.field<std::remove_cvref_t<decltype(sim.breakage())>>(0).strength);
  }
  // Each press loads it by 0.8 of its first strength, at both contacts, until that is more than
  // what is left.
  double left = strength;
  const silt::PowerFatigue fatigue{.kappa = 0.1, .psi = 2};
  for (const double found : strengths) {
    for (int contact = 0; contact < 2; ++contact) left = fatigue.weakened(left, 0.8 * strength);
    CHECK(found == near(left).epsilon(5e-3));  // the largest force of steps, with its damping
  }
  CHECK(strengths.size() == 1);
  CHECK(sim.broken(silt::BreakCause::Wall) == 1);
}

TEST_CASE("breakage: softened, in single precision, through a periodic box with inlet and outlet") {
  using Law = silt::Softened<silt::HertzMindlin>;
  const Law::Material soft{.solid = salt, .full_radius = 0.3e-3};
  const Law::Material steel{
      .solid = {.youngs_modulus = 2e11, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3}};
  const auto run = [&](int threads) {
    silt::Contacts<Law, silt::SeveralMaterials> contacts{{soft, steel}};
    contacts.set_pair(soft, steel, {.restitution = 0.5, .friction = 0.3});
    silt::Particles<silt::Sphere> balls;  // which do not break
    for (int k = 0; k < 5; ++k)
      balls.add({.position = {0.004 + 0.008 * k, 0.01, 0.006},
                 .radius = 2e-3,
                 .density = 7800,
                 .velocity = {0.2, 0, -0.1},
                 .material = 1});
    silt::Simulation sim{std::move(balls), contacts, silt::Mixed{},
                         silt::PeriodicBox{{{0, 0, 0}, {0.04, 0.02, 1}}, {true, false, false}},
                         policy({.dust_below = 0.3e-3, .materials = {0}})};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, soft);
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, soft);
    sim.add_wall(silt::Plane{{0, 0.02, 0}, {0, -1, 0}}, soft);
    sim.add_inlet(silt::Box{{0, 0.002, 0.03}, {0.04, 0.018, 0.05}},
                  {.radius = silt::uniform(0.9e-3, 1.1e-3),
                   .density = 2165,
                   .rate = 2e5,
                   .velocity = {3, 0, -11},
                   .material = 0});
    sim.add_outlet(silt::Box{{-1, -1, 0.06}, {1, 1, 1}});
    // A grain that hammers a softened fragment into the floor goes in deep.
    sim.guard.max_overlap = 0.9;
    sim.gravity = {0, 0, -9.81}, sim.threads = threads;
    sim.run(4e-3);
    const auto m = sim.mass_balance();
    CHECK(sim.broken() > 20);
    CHECK(m.fed > m.present);
    CHECK(std::abs(m.residual()) < 1e-12 * m.fed);
    CHECK(sim.find(4) < sim.rows());  // all balls are there
    std::vector<double> all{static_cast<double>(sim.broken()), m.dust};
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) all.push_back(sim.position(k).x + sim.velocity(k).z);
    return all;
  };
  CHECK(run(1) == run(2));
}

std::vector<std::string> lines_of(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::string> all;
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}
std::vector<double> numbers_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<double> all;
  for (std::string one; std::getline(in, one, ',');) all.push_back(std::stod(one));
  return all;
}

TEST_CASE("breakage: counts and tables of the materials, which add up, and a restart keeps") {
  const auto scene = [] {
    auto ore = salt;
    ore.youngs_modulus = 3e9;
    silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials> contacts{{salt, ore}};
    contacts.set_pair(salt, ore, {.restitution = 0.5, .friction = 0.3});
    contacts.name_material(0, "salt"), contacts.name_material(1, "ore");
    silt::Particles<silt::Sphere> grains;
    for (std::size_t k = 0; k < 6; ++k)
      grains.add({.position = {0.01 * static_cast<double>(k), 0, 0},
                  .radius = 1e-3,
                  .density = k % 2 ? 3000.0 : 2165.0,
                  .velocity = {0, 0, 1},
                  .material = k % 2});
    return silt::Simulation{std::move(grains), contacts, policy({.dust_below = 0.8e-3})};
  };
  auto sim = scene();
  sim.time_step = 1e-7;
  double of_salt = 0, of_ore = 0;  // [kg]
  for (const silt::ParticleId id : {0, 1, 2}) sim.break_particle(id);
  const auto csv = (std::filesystem::temp_directory_path() / "silt_breakage_tables.csv").string();
  sim.run(1e-6, silt::on_break([&](const silt::BreakEvent& b) {
            CHECK(b.material == b.id % 2);
            CHECK(sim.material_name(b.material) ==
                  (b.id % 2 ? "material 1 'ore'" : "material 0 'salt'"));
            (b.material == 1 ? of_ore : of_salt) += b.dust;
          }));
  sim.remove(3), sim.remove(4), sim.remove(5);
  CHECK(of_salt > 0);
  CHECK(of_ore > 0);
  const auto check = [&](const auto& of) {
    // Catches counts of all, or of the other material.
    CHECK(of.broken("salt") == 2);
    CHECK(of.broken("ore") == 1);
    CHECK(of.broken(silt::BreakCause::Asked, "salt") == 2);
    CHECK(of.broken(silt::BreakCause::Wall, "salt") == 0);
    CHECK(of.broken() == 3);
    CHECK(of.dust("salt").mass() == near(of_salt).epsilon(1e-13));
    CHECK(of.dust("ore").mass() == near(of_ore).epsilon(1e-13));
    CHECK(of.dust().number() == near(of.dust(0).number() + of.dust(1).number()).epsilon(1e-13));
    CHECK(of.left("salt").mass() == near(2165 * silt::sphere_volume(1e-3)).epsilon(1e-13));
    CHECK(of.left("ore").number() == 2);
    CHECK(of.left().number() == 3);
  };
  check(sim);
  const auto file = (std::filesystem::temp_directory_path() / "silt_breakage_tables").string();
  silt::save_checkpoint(sim, file);
  auto again = scene();
  again.time_step = 1e-7;
  silt::load_checkpoint(again, file);
  check(again);
  CHECK(again.left("ore").state() == sim.left("ore").state());
  std::filesystem::remove(file);
  // The table over time goes on behind a restart, with the same columns.
  again.run(1e-6, silt::breakage_table(csv, silt::every(1e-6)));
  const auto lines = lines_of(csv);
  std::filesystem::remove(csv);
  CHECK(lines.size() >= 2);
  CHECK(
      lines.front() ==
      "time [s],particles [-],broken at walls [-],broken in pairs [-],broken as asked [-],"
      "present [kg],left [kg],dust [kg],broken of salt [-],present of salt [kg],left of salt [kg],"
      "dust of salt [kg],broken of ore [-],present of ore [kg],left of ore [kg],dust of ore [kg]");
  const auto row = numbers_of(lines.back());
  CHECK(row.size() == 16);
  CHECK(row[8] == 2);
  CHECK(row[12] == 1);
  for (const std::size_t k : {1, 2, 3})  // of all it is the sum
    CHECK(row[4 + k] == near(row[8 + k] + row[12 + k]).epsilon(1e-12));
  CHECK(row[10] == near(2165 * silt::sphere_volume(1e-3)).epsilon(1e-12));
  // Of one material the table is that of all.
  auto one = shower(1);
  one.time_step = 1e-7;
  one.break_particle(0), one.run(1e-6);
  CHECK(one.dust(0).mass() == one.dust().mass());
  CHECK(one.broken(0) == 1);
}

}  // namespace breakage_compositions_test
