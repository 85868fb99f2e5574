// silt - BSD-3-Clause, see LICENSE
// Stones (convex polyhedra) hit a plate and break into cells. From docs/breakage.md.
#include <cmath>
#include <iostream>
#include <vector>

#include <silt/silt.hpp>

int main() {
  // A stone of 20 corners on an ellipsoid of 10 x 10 x 8 mm.
  std::vector<silt::Vec3d> corners;
  for (int i = 0; i < 20; ++i) {
    const double z = 2 * std::fmod(0.618034 * (i + 1), 1.0) - 1, angle = 2.39996 * i;
    const double r = std::sqrt(1 - z * z);
    corners.push_back({5e-3 * r * std::cos(angle), 5e-3 * r * std::sin(angle), 4e-3 * z});
  }
  silt::Particles<silt::Polyhedron> stones;
  const auto form = stones.add_form(silt::Polyhedron::from_points(corners), "stone");
  for (int k = 0; k < 12; ++k)
    stones.add({.form = form,
                .position = {0.015 * (k % 4), 0.015 * (k / 4), 0.0065},
                .orientation = silt::rotation_about({1, 0, 0}, 0.5 * k),
                .density = 2600,
                .velocity = {0, 0, -6}});

  const silt::HertzMindlin::Material rock{
      .youngs_modulus = 5e9, .poisson_ratio = 0.25, .restitution = 0.3, .friction = 0.4};
  silt::Simulation sim{
      std::move(stones), silt::Contacts<silt::HertzMindlin>{rock},
      silt::Breakage{
          silt::WeibullStrength{.scale = 0.01, .at_diameter = 10e-3, .exponent = 2, .modulus = 3},
          silt::EnergyEquivalence{},
          silt::T10Sizes{.limit = 0.6, .rate = 0.05, .unit = silt::LoadUnit::Energy},
          silt::NoFatigue{},
          {.dust_below = 2.5e-3, .most_fragments = 20, .step = silt::BreakStep::SmallestLiving}}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rock, {.name = "plate"});
  sim.gravity = {0, 0, -9.81};
  sim.guard.max_overlap = 0.6;  // cells are thinner than the stone that presses them

  double coarsest = 0;  // [-] largest load over strength
  sim.run(3e-3, silt::on_break([&](const silt::BreakEvent& b) {
            coarsest = std::max(coarsest, b.load / b.strength);
          }),
          silt::vtk_series("stones", silt::every(1e-3)), silt::progress());

  const silt::SizeTable dust = sim.dust();
  for (std::size_t k = 0; k < dust.classes(); ++k)
    for (std::size_t bin = 0; bin < dust.bins(); ++bin)
      if (const double mass = dust.mass(k, bin); mass > 0)
        std::cout << mass << " kg of " << silt::SizeTable::edge(k) << " to "
                  << silt::SizeTable::edge(k + 1) << " m from " << bin * dust.bin_width()
                  << " s on\n";
  const auto mass = sim.mass_balance();
  std::cout << sim.broken() << " stones broke, under loads of up to " << coarsest
            << " times their strength; " << sim.size() << " are there, "
            << 100 * mass.dust / mass.fed << " % of the mass is dust\n";
  const bool closed = std::abs(mass.residual()) < 1e-12 * mass.fed;
  return sim.broken() > 3 && sim.size() > 12 && closed ? 0 : 1;
}
