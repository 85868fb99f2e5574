// silt - BSD-3-Clause, see LICENSE
//
// Triaxial compression of a dense and a loose sample. A periodic box of spheres is shortened along
// z at constant lateral stress. The dense sample has a peak strength and dilates, the loose one
// does neither, and both reach the same state. The program prints the friction angles.
//
// picture: curves triaxial/dense.csv triaxial/loose.csv --x axial --y stress,volumetric -o triaxial.png

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <silt/silt.hpp>

struct Angles {
  double peak, end;  // [degrees]
};

Angles compress(const std::string& name, double friction_before) {
  silt::HertzMindlin::Material sand{
      .youngs_modulus = 2e7, .poisson_ratio = 0.2, .restitution = 0.5, .friction = friction_before};
  const double d = 1e-3, density = 2600, pressure = 1e4;           // [m], [kg/m3], [Pa]
  const double inertial_time = d * std::sqrt(density / pressure);  // [s]
  const silt::Box space{{0, 0, 0}, {11 * d, 11 * d, 11 * d}};
  silt::Particles<silt::Sphere> grains;
  grains.fill(space, {.radius = silt::uniform(0.4 * d, 0.6 * d),
                      .density = density,
                      .count = 500,
                      .arrangement = silt::Arrangement::Random});

  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{sand},
                       silt::DeformingBox{space}};
  const silt::BoxDrive kept{.stress = pressure, .most_rate = 0.02 / inertial_time};
  sim.deform({.x = kept, .y = kept, .z = kept});
  sim.run(200 * inertial_time);  // compressed from all sides
  sim.set_pair(0, 0, {.restitution = 0.5, .friction = 0.5});

  const double rate = 1e-3 / inertial_time;  // [1/s] slow: an inertial number of 1e-3
  sim.deform({.x = kept, .y = kept, .z = {.rate = -rate}});
  silt::CsvTable table("triaxial/" + name + ".csv",
                       {"axial strain [%]", "stress ratio q/p", "volumetric strain [%]"});
  const auto before = sim.domain().strain();
  double peak = 0, end = 0;
  for (int k = 0; k < 60; ++k) {
    double sides = 0, axial = 0;
    sim.run(0.005 / rate, silt::at(silt::every(1e-4 / rate), [&](const auto& now) {
              const auto& stress = now.domain().stress();
              sides += 0.5 * (stress.x + stress.y), axial += stress.z;
            }));
    const double ratio = 3 * (axial - sides) / (axial + 2 * sides);  // q/p
    peak = std::max(peak, ratio);
    if (k >= 48) end += ratio / 12;  // mean from 24 to 30 %
    const auto strain = sim.domain().strain() - before;
    table.add_row({-100 * strain.zz, ratio, -100 * (strain.xx + strain.yy + strain.zz)});
  }
  // Mohr-Coulomb: sin(phi) = (axial - lateral)/(axial + lateral), with q = axial - lateral.
  const auto angle = [](double q) { return std::asin(3 * q / (6 + q)) * 180 / M_PI; };
  return {angle(peak), angle(end)};
}

int main() {
  const auto dense = compress("dense", 0), loose = compress("loose", 0.5);
  std::printf("friction angle of the dense sample: %.0f degrees at the peak, %.0f at the end\n",
              dense.peak, dense.end);
  std::printf("friction angle of the loose sample: %.0f degrees at the peak, %.0f at the end\n",
              loose.peak, loose.end);
  // Fails for friction without effect (6 degrees), a dense sample that is no stronger, and samples
  // that end in different states.
  const bool forgotten = std::abs(dense.end - loose.end) < 5;
  return loose.end > 12 && dense.peak < 45 && dense.peak > loose.peak + 3 && forgotten ? 0 : 1;
}
