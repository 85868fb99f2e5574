// silt - BSD-3-Clause, see LICENSE
// Bonded grains that break: their bonds are told, counted and booked.
#include <cmath>
#include <filesystem>
#include <vector>

#include <doctest/doctest.h>

#include <silt/bond/parallel_bond.hpp>
#include <silt/io/bond_observers.hpp>
#include <silt/io/checkpoint.hpp>

#include "breakage/scene.hpp"
#include "near.hpp"

namespace breakage_bonded_test {

using namespace breakage_scene;  // NOLINT: of this test alone

constexpr double R = 1e-3, density = 2165;  // [m], [kg/m3]
const silt::ParallelBond glue{.youngs_modulus = 1e8};

/// A chain of four grains that is stretched, bent and twisted as it moves, 3 held by a wall.
/// Breaking takes no dust.
auto chain(double step, const silt::ParallelBond& of = glue, double dust_below = 0.3e-3) {
  silt::Particles<silt::Sphere> grains;
  for (int k = 0; k < 4; ++k)
    grains.add({.position = {2.01 * R * k, 0, 0},
                .radius = R,
                .density = density,
                .velocity = {0.5 * k, 0.3 * (k % 2), -0.2 * k},
                .angular_velocity = {150.0 * k, 0, 100}});
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{salt},
                       silt::EnergyLedger{}, halving({.dust_below = dust_below}), silt::Bonds{of}};
  const auto clamp = sim.add_wall(silt::Plane{{9 * R, 0, 0}, {-1, 0, 0}}, salt);
  for (silt::ParticleId k = 0; k < 3; ++k) sim.bond(k, k + 1);
  sim.bond_to_wall(3, clamp, {9 * R, 0, 0}, silt::WallContact::Excluded);
  sim.time_step = step;
  return sim;
}
struct Told {
  std::vector<silt::BondBreak> bonds;
  double energy() const {
    double sum = 0;
    for (const auto& b : bonds) sum += b.energy;
    return sum;
  }
};
auto tell(Told& all) {
  return silt::on_bond_break([&](const silt::BondBreak& b) { all.bonds.push_back(b); });
}

TEST_CASE("breakage of bonded grains: bonds are told in their order, counted, and booked") {
  // Catches bonds that vanish: what they store is then in nothing but the residual.
  for (const double step : {2e-7, 1e-7, 5e-8}) {
    auto sim = chain(step);
    sim.run(3.1e-5);
    const double stored = sim.bond_energy();
    sim.break_particle(1), sim.break_particle(3);
    Told all;
    sim.run(step, tell(all));
    const auto e = sim.energy();
    REQUIRE(all.bonds.size() == 4);  // that of 1 and 2, both of which they share, once
    for (std::size_t k = 0; k < all.bonds.size(); ++k) CHECK(all.bonds[k].number == k);
    CHECK(all.bonds.back().b == silt::no_particle);
    CHECK(sim.bonds() == 0);
    CHECK(sim.broken_bonds() == 4);
    CHECK(e.bonds == 0);
    CHECK(all.energy() == near(stored).epsilon(0.02));  // in the next step
    CHECK(e.bond_breaking == near(all.energy()).epsilon(1e-12));
    CHECK(stored > 0.05 * e.initial);
    sim.run(2e-5);
    CHECK(sim.broken_bonds() == 4);
    const double unbooked = std::abs(sim.energy().residual()) / stored;
    // 9.8e-5, 1.7e-5, 2.8e-7 (computed); of bonds that are not booked 1.
    CHECK(unbooked < 2.5e-4 * step * step / 4e-14);
  }
}

TEST_CASE("breakage of bonded grains: before the first step, and with dust") {
  auto sim = chain(1e-7, glue, 1.2e-3);
  sim.break_particle(2);
  Told all;
  sim.run(1e-7, tell(all));
  CHECK(all.bonds.size() == 2);
  CHECK(sim.bonds() == 2);
  CHECK(sim.bonded(0, 1));
  CHECK(!sim.bonded(1, 2));
  CHECK(std::abs(all.energy()) < 1e-20);  // they have not been strained
  sim.run(2e-5);
  const auto e = sim.energy();
  CHECK(std::abs(e.residual()) < 1e-4 * e.initial);
}

TEST_CASE("breakage of bonded grains: others are overloaded later; a restart") {
  auto weak = glue;
  weak.tensile_strength = weak.shear_strength = 7e5;  // [Pa]
  const auto run = [&](const std::string& file) {
    auto sim = chain(1e-7, weak);
    Told all;
    sim.run(1.5e-5, tell(all));
    sim.break_particle(1);
    if (!file.empty()) silt::save_checkpoint(sim, file);
    sim.set_velocity(2, {-5, 0, 0});
    sim.run(3e-5, tell(all));
    return std::pair{std::move(sim), std::move(all)};
  };
  const auto file = (std::filesystem::temp_directory_path() / "silt_breakage_bonded").string();
  const auto [sim, all] = run(file);
  CHECK(all.bonds.size() == 3);
  CHECK(sim.broken_bonds() == 3);
  auto again = chain(1e-7, weak);
  silt::load_checkpoint(again, file);
  std::filesystem::remove(file);
  again.set_velocity(2, {-5, 0, 0});
  again.run(3e-5);
  CHECK(again.broken_bonds() == sim.broken_bonds());
  CHECK(again.energy().residual() == sim.energy().residual());
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) CHECK(again.position(k).x == sim.position(k).x);
}

}  // namespace breakage_bonded_test
