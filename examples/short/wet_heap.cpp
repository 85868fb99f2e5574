// silt - BSD-3-Clause, see LICENSE
//
// A dry and a wet heap. Grains lie in a box; its right wall is removed, and the rest forms the
// angle of repose. Liquid bridges between the grains make it steeper.
//
// picture: draw wet_heap/dry/particles.pvd wet_heap/wet/particles.pvd --colour layer --title dry wet -o wet_heap.png

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/silt.hpp>

// Hertz-Mindlin with the capillary force of water.
using Wet = silt::Cohesive<silt::HertzMindlin, silt::CapillaryBridge>;

// Angle of repose [degrees] with liquid bridges of this volume [m3].
double angle_of_repose(const std::string& folder, double volume) {
  const Wet::Material sand{
      .body = {.youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.4, .friction = 0.5},
      .cohesion = {.surface_tension = 0.072, .contact_angle = 0.2, .volume = volume}};
  const silt::Contacts<Wet, silt::RollingEpsd> contacts{sand, {.rolling_friction = 0.1}};

  const double length = 0.06, width = 0.01;  // [m]; the box repeats across
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 0.002}, {length, width, 0.1}}, {.radius = silt::uniform(1.35e-3, 1.65e-3),
                                                      .density = 2600,
                                                      .count = 800,
                                                      .arrangement = silt::Arrangement::Random});
  silt::Simulation sim{
      std::move(grains), contacts, silt::Field<"layer">{},
      silt::PeriodicBox{{{0, 0, -0.05}, {length, width, 0.12}}, {false, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::rectangle({0, 0, 0}, {length, 0, 0}, {0, width, 0}), sand, {.name = "floor"});
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, sand, {.name = "left"});
  sim.add_wall(silt::Plane{{length, 0, 0}, {-1, 0, 0}}, sand, {.name = "right"});
  sim.add_outlet({{-1, -1, -1}, {1, 1, -0.001}});  // what falls off
  auto files = silt::vtk_series(folder, silt::every(0.05));
  sim.run(0.25, files);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.field<"layer">(k) = std::floor(sim.position(k).z / 0.008);
  sim.remove_wall("right");
  sim.run(1, files);

  // A straight line through the highest grains of columns of 4 mm, without the crest and without
  // the last grains at the toe.
  const auto top = [&](double x) {
    double z = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (std::abs(sim.position(k).x - x) < 0.002) z = std::max(z, sim.position(k).z);
    return z;
  };
  const double crest = top(0.004);
  std::vector<double> x, z;
  for (double at = 0.004; at < length; at += 0.002)
    if (top(at) < 0.85 * crest && top(at) > 0.15 * crest) x.push_back(at), z.push_back(top(at));
  return -std::atan(silt::fit_polynomial<1>(x, z).coefficients()[1]) * 180 / M_PI;
}

int main() {
  const double dry = angle_of_repose("wet_heap/dry", 0);
  const double wet = angle_of_repose("wet_heap/wet", 2e-12);  // [m3], 1e-3 of a radius cubed
  std::printf("angle of repose: dry %.0f degrees, wet %.0f degrees\n", dry, wet);
  // Fails for water without attraction, and for dry grains that all flow off or stay as a block.
  return dry > 15 && dry < 40 && wet > dry + 5 ? 0 : 1;
}
