// silt - BSD-3-Clause, see LICENSE
// Charged grains on a grounded plate that is turned over, of docs/charge.md: which ones stick.

#include <cmath>
#include <cstdio>
#include <numbers>

#include <silt/silt.hpp>

int main() {
  const double R = 50e-6, density = 2500, g = 9.81;  // [m], [kg/m3], [m/s2]
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
  silt::Particles<silt::Sphere> grains;
  for (int k = 0; k < 64; ++k)
    grains.add(
        {.position = {k % 8 * 12 * R, k / 8 * 12 * R, 1.01 * R}, .radius = R, .density = density});

  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Charge{.cutoff = 20 * R,                      // [m]
                                    .planes = {{{0, 0, 0}, {0, 0, 1}}}}};  // grounded: images
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.field<silt::ElectricCharge>(k) = 4e-15 * static_cast<double>(sim.id(k));  // [C]

  sim.gravity = {0, 0, -g};
  sim.run(0.01);
  sim.gravity = {0, 0, g};  // the plate is turned over
  sim.run(0.02);

  // The image holds a grain if q^2/(16 pi eps0 R^2) > m g.
  const double mass = 4.0 / 3 * std::numbers::pi * R * R * R * density;
  const double least = 4 * R * std::sqrt(std::numbers::pi * silt::Charge::eps0 * mass * g);
  int stuck = 0, wrong = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const double q = sim.field<silt::ElectricCharge>(k);
    const bool sticks = sim.position(k).z < 1.1 * R;
    stuck += sticks;
    // The overlap with the plate brings the image closer by some 1e-3; grains next to the limit are
    // not judged.
    wrong += std::abs(q / least - 1) > 0.02 && sticks != (q > least);
  }
  std::printf("%d of 64 grains stick, those with more than %.3g C\n", stuck, least);
  // Fails if the image force has another factor, or is repulsive.
  return wrong == 0 && stuck > 20 && stuck < 60 ? 0 : 1;
}
