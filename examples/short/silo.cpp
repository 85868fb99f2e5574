// silt - BSD-3-Clause, see LICENSE
//
// A silo empties. Glass beads in coloured layers flow out of a cone with an opening 7 beads wide:
// the centre sinks first. The program prints the mass flow beside Beverloo's correlation.
//
// picture: draw silo/particles.pvd --colour layer --cut y=0 --time 0.2 0.35 0.5 -o silo.png

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.6, .friction = 0.4};
  const double d = 2.5e-3, opening = 7 * d;                   // [m]
  const double radius = 0.022, cone = 0.016, height = 0.075;  // [m]

  silt::Particles<silt::Sphere> beads;
  beads.fill(silt::CylinderRegion{{0, 0, cone}, {0, 0, height}, radius},
             {.radius = silt::uniform(0.45 * d, 0.55 * d), .density = 2500});

  // "layer" is a number of each bead, used here for its colour.
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Field<"layer">{}};
  sim.gravity = {0, 0, -9.81};
  const silt::Cylinder mantle{{0, 0, cone}, {0, 0, height}, radius, silt::Side::Inside};
  const silt::Cone funnel{{0, 0, 0}, {0, 0, cone}, opening / 2, radius, silt::Side::Inside};
  sim.add_wall(silt::Surfaces({mantle, funnel}), glass, {.name = "silo"});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass, {.name = "gate"});
  const auto outlet = sim.add_outlet({{-1, -1, -1}, {1, 1, -0.01}});
  sim.run(0.2);  // the beads come to rest on the gate
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.field<"layer">(k) = std::floor(sim.position(k).z / 0.0103);

  sim.remove_wall("gate");
  auto files = silt::vtk_series("silo", silt::every(0.01));
  sim.run(0.1, files);
  const double before = sim.outlet(outlet).mass, since = sim.time();
  sim.run(0.2, files);
  const double flow = (sim.outlet(outlet).mass - before) / (sim.time() - since);

  // Beverloo: bulk density 1500 kg/m3, opening reduced by 1.4 d.
  const double beverloo = 0.58 * 1500 * std::sqrt(9.81) * std::pow(opening - 1.4 * d, 2.5);
  std::printf("%.1f g/s flow out, by Beverloo's rule %.1f g/s\n", 1e3 * flow, 1e3 * beverloo);
  // Fails for beads that block the opening, and for an outlet that counts beads twice.
  return flow > 0.7 * beverloo && flow < 1.4 * beverloo ? 0 : 1;
}
