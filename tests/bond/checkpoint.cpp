// silt - BSD-3-Clause, see LICENSE
// Bonds in checkpoints: a run that goes on from one gives the same bits; damaged numbers and other
// bonds are refused.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace bond_checkpoint_test {

using silt::Vec3d;
constexpr double R = 1e-3;
const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
const silt::ParallelBond model{
    .youngs_modulus = 1e7, .tensile_strength = 1e4, .shear_strength = 1e4, .weibull_modulus = 4};

/// An agglomerate above a plane, a fibre that hangs on a second one; nothing of it if `empty`.
auto scene(const silt::ParallelBond& bonds = model, bool empty = false) {
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Bonds{bonds}, silt::EnergyLedger{}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.add_wall(silt::Plane{{0, 0, 0.04}, {0, 0, -1}}, glass, {.name = "ceiling"});
  sim.gravity = {0, 0, -9.81}, sim.threads = 2;
  if (empty) return sim;
  silt::Particles<silt::Sphere> ball;
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= 3; ++y)
      for (int z = -3; z <= 3; ++z)
        if (x * x + y * y + z * z <= 9)
          ball.add({.position = {1.9 * R * x, 1.9 * R * y, 1.9 * R * z + 7 * R},
                    .radius = R,
                    .density = 2000,
                    .velocity = {0.3, 0, -1}});
  sim.add(ball);
  bond_near(sim, 0.01 * R);
  const auto first = add_bonded(
      sim, silt::fibre({0.02, 0, 0.039}, {0.02, 0, 0.025}, 8, {.radius = R, .density = 2000}));
  sim.bond_to_wall(first, "ceiling", {0.02, 0, 0.04});
  return sim;
}
template <class Sim>
std::vector<double> bits(const Sim& sim) {
  const auto e = sim.energy();
  std::vector<double> all{sim.time(),
                          static_cast<double>(sim.bonds()),
                          static_cast<double>(sim.broken_bonds()),
                          e.bond_damping,
                          e.bond_breaking,
                          sim.wall("ceiling").force.z};
  for (silt::ParticleId id = 0; id < sim.rows(); ++id)
    for (const Vec3d& v : {sim.position(sim.find(id)), sim.velocity(sim.find(id)),
                           sim.angular_velocity(sim.find(id))})
      all.insert(all.end(), {v.x, v.y, v.z});
  sim.for_each_bond([&](const silt::BondSeen& b) {
    all.insert(all.end(), {static_cast<double>(b.number), b.load, b.force.x, b.couple.z});
  });
  return all;
}
std::string file(const char* name) {
  return (std::filesystem::temp_directory_path() / (std::string("silt_bonds_") + name)).string();
}

TEST_CASE("bonds: a run that goes on from a checkpoint gives the same bits") {
  auto whole = scene();
  const double dt = [&] {
    whole.run(0);
    return whole.step_length();
  }();
  const std::string path = file("same.silt");
  for (const int steps : {0, 600, 900}) {
    auto one = scene();
    one.run(steps * dt);
    save_checkpoint(one, path);
    auto other = scene(model, true);
    load_checkpoint(other, path);
    CHECK(bits(other) == bits(one));
    CHECK(other.bonds() == one.bonds());
    one.run(2000 * dt), other.run(2000 * dt);
    CHECK(bits(other) == bits(one));
    CHECK(one.broken_bonds() > 20);
  }
  std::filesystem::remove(path);
}

TEST_CASE("bonds: a checkpoint of other bonds is refused, and taken where that is said") {
  auto one = scene();
  one.run(0);
  const std::string path = file("other.silt");
  save_checkpoint(one, path);
  auto other_model = model;
  other_model.tensile_strength = 2e4;
  auto other = scene(other_model, true);
  const auto words = silt_test::refusal([&] { load_checkpoint(other, path); });
  CHECK(silt_test::has(words, "tensile strength [Pa]"));
  CHECK(other.bonds() == 0);
  load_checkpoint(other, path, {.materials = true});
  CHECK(other.bonds() == one.bonds());
#ifdef SILT_LONG_TESTS
  // Without bonds it is another program's.
  silt::Simulation none{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                        silt::EnergyLedger{}};
  CHECK(silt_test::has(silt_test::refusal([&] { load_checkpoint(none, path); }), "bonds"));
#endif
  std::filesystem::remove(path);
}

}  // namespace bond_checkpoint_test
