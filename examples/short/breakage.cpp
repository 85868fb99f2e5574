// silt - BSD-3-Clause, see LICENSE
//
// Grains break on a plate. Salt grains hit a steel plate, and each breaks if the load exceeds its
// own strength. The program prints the share of broken grains and the fineness of the product.
//
// picture: draw breakage/particles.pvd --colour generation --time 0 0.0005 0.001 0.002 --bounds -0.01,0.07,-0.001,0.024 --width 1200 -o breakage.png
// picture: curves breakage/finer.csv --x size --y product,feed --y-label finer -o breakage_sizes.png

#include <cmath>
#include <cstdio>
#include <fstream>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material salt{
      .youngs_modulus = 2e10,  // [Pa], the true one: it makes the load
      .poisson_ratio = 0.25,
      .restitution = 0.5,
      .friction = 0.3,
  };

  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 1e-3}, {0.06, 0.015, 9e-3}}, {.radius = silt::uniform(0.9e-3, 1.1e-3),
                                                    .density = 2165,
                                                    .count = 250,
                                                    .arrangement = silt::Arrangement::Random,
                                                    .velocity = {0, 0, -15}});  // [m/s]
  silt::Simulation sim{
      std::move(grains), silt::Contacts<silt::HertzMindlin>{salt},
      // Median strength: 31 N for grains of 2 mm, proportional to (d/2 mm)^1.6 for others.
      silt::Breakage{silt::LogLogisticStrength{
                         .median = 31, .at_diameter = 2e-3, .exponent = 1.6, .spread = 3},
                     silt::HertzEquivalence{},
                     // Fragments: the mass fraction finer than x is x over 0.8 of the grain's size.
                     silt::GaudinSchuhmann{.exponent = 1, .coarsest = 0.8},
                     silt::NoFatigue{},
                     {.dust_below = 0.3e-3}}};  // [m], smaller ones are mass in a table
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
  sim.gravity = {0, 0, -9.81};
  sim.guard.max_overlap = 0.6;  // [-] large fragments press small ones onto the plate

  const silt::SizeTable feed = silt::sizes_present(sim);
  sim.run(2e-3, silt::vtk_series("breakage", silt::every(2.5e-4)), silt::progress());

  silt::SizeTable product = silt::sizes_present(sim);
  product.merge(sim.dust());
  std::ofstream table("breakage/finer.csv");
  table << "size [mm],product [% of mass],feed [% of mass]\n";
  for (double mm = 0; mm < 2.3; mm += 0.1)
    table << mm << ',' << 100 * product.finer(1e-3 * mm) << ',' << 100 * feed.finer(1e-3 * mm)
          << '\n';
  const auto mass = sim.mass_balance();
  std::printf("%zu grains broke; %.0f %% of the mass is dust below 0.3 mm\n",
              static_cast<std::size_t>(sim.broken()), 100 * mass.dust / mass.fed);
  std::printf("half of the mass is finer than %.2f mm\n", 1e3 * product.quantile(0.5));
  // Fails for lost mass, grains that do not break, and fragments as large as the grains.
  const bool closed = std::abs(mass.residual()) < 1e-12 * mass.fed;
  return closed && sim.broken() > 100 && product.quantile(0.5) < 1.8e-3 ? 0 : 1;
}
