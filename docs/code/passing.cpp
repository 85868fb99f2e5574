// silt - BSD-3-Clause, see LICENSE
// The program of docs/contact_data.md, what passes a surface: a hopper that empties.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.3, .friction = 0.4};
  silt::Particles<silt::Sphere> beads;
  beads.fill(silt::CylinderRegion{{0, 0, 0.02}, {0, 0, 0.05}, 9e-3},
             {.radius = silt::uniform(0.7e-3, 0.9e-3), .density = 2500, .count = 1000});
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cone{{0, 0, 0}, {0, 0, 0.02}, 4e-3, 10e-3, silt::Side::Inside}, glass);
  sim.add_wall(silt::Cylinder{{0, 0, 0.02}, {0, 0, 0.06}, 10e-3, silt::Side::Inside}, glass);
  sim.add_outlet({{-0.1, -0.1, -0.05}, {0.1, 0.1, -0.02}});

  const auto orifice = silt::disc({0, 0, 0}, {0, 0, -1}, 5e-3);  // centre, normal, radius [m]
  auto flow = silt::passing_series("orifice.csv", orifice, silt::every(0.02));
  sim.run(0.3, flow);
  const auto& beads_out = flow.counter().forwards();  // .number, .mass [kg]

  // From now on, of small beads alone, and without a file.
  silt::PassingCounter small(orifice,
                             {.which = [&](std::size_t k) { return sim.radius(k) < 0.8e-3; }});
  sim.run(0.1, small, flow);
  const double rate = small.mass_rate();  // [kg/s]

  std::size_t left = sim.outlet(0).count;  // or below the hopper, above the outlet
  for (std::size_t k = 0; k < sim.rows(); ++k) left += sim.is_present(k) && sim.position(k).z < 0;
  std::printf("%zu beads have passed, %.3g g; small ones in the last 0.1 s: %.3g g/s\n",
              static_cast<std::size_t>(beads_out.number), 1e3 * beads_out.mass, 1e3 * rate);
  // Fails if a passage is missed or counted twice, or the mass is of another one.
  const double mean = 4.0 / 3 * 3.14159 * 2500 * std::pow(0.8e-3, 3);  // [kg]
  const bool right = flow.counter().net_number() == static_cast<double>(left) && left > 500 &&
                     std::abs(beads_out.mass / (mean * static_cast<double>(left)) - 1) < 0.05 &&
                     small.forwards().number > 30 &&
                     std::abs(rate - small.forwards().mass / 0.1) < 1e-3 * rate;
  if (!right) std::printf("wrong: %zu have left\n", left);
  return right ? 0 : 1;
}
