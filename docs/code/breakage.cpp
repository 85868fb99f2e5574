// silt - BSD-3-Clause, see LICENSE
// Grains hit a plate and break. From docs/breakage.md.
#include <cmath>
#include <iostream>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material salt{
      .youngs_modulus = 2e9, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.3};
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 2e-3}, {0.03, 0.03, 0.012}}, {.radius = silt::uniform(0.9e-3, 1.1e-3),
                                                    .density = 2165,
                                                    .count = 300,
                                                    .velocity = {0, 0, -12}});
  silt::Simulation sim{
      std::move(grains), silt::Contacts<silt::HertzMindlin>{salt}, silt::EnergyLedger{},
      silt::Breakage{silt::LogLogisticStrength{
                         .median = 31, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3},
                     silt::HertzEquivalence{},
                     silt::GaudinSchuhmann{.exponent = 1, .coarsest = 0.8},
                     silt::PowerFatigue{.kappa = 0.1, .psi = 3},
                     {.dust_below = 0.3e-3}}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
  sim.gravity = {0, 0, -9.81};
  sim.guard.max_overlap =
      0.6;  // [-] of the radius: large fragments press small ones onto the plate

  double fastest = 0;
  sim.run(2e-3,
          silt::on_break([&](const silt::BreakEvent& b) { fastest = std::max(fastest, b.speed); }),
          silt::breakage_table("breakage.csv", silt::every(1e-4)));

  silt::SizeTable product = silt::sizes_present(sim);
  product.merge(sim.dust());
  silt::write_sizes("sizes.csv", product);
  const auto mass = sim.mass_balance();
  std::cout << sim.broken() << " grains broke, at up to " << fastest << " m/s; " << sim.size()
            << " grains are left, " << 100 * mass.dust / mass.fed
            << " % of the mass is dust\nhalf of the mass is finer than "
            << 1e3 * product.quantile(0.5) << " mm\n";
  const bool closed = std::abs(mass.residual()) < 1e-12 * mass.fed;
  return sim.broken() > 20 && closed ? 0 : 1;
}
