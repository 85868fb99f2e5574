// silt - BSD-3-Clause, see LICENSE
//
// Waves on a vibrated bed. A thin layer of grains lies on a plate that vibrates vertically. Waves
// form whose crests and troughs swap at each stroke: their period is two strokes. The program
// prints the wavelength.
//
// picture: draw vibrated_bed/particles.pvd --colour velocity.z --frame -5 -1 -o vibrated_bed.png

#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material grain{
      .youngs_modulus = 2e6, .poisson_ratio = 0.25, .restitution = 0.7, .friction = 0.5};
  const double d = 2e-3, length = 0.15, width = 3.2 * d, depth = 5.4 * d;  // [m]
  const double frequency = 13.2;                                           // [Hz]
  const double omega = 2 * std::numbers::pi * frequency;                   // [rad/s]
  const double amplitude = 3 * 9.81 / (omega * omega);  // [m]: three times gravity at most

  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 0}, {length, width, 4 * depth}},
              {.radius = silt::uniform(0.47 * d, 0.53 * d),
               .density = 2500,
               .solid_volume = 0.58 * length * width * depth,
               .arrangement = silt::Arrangement::Random});

  // The layer is periodic along x and y.
  silt::Simulation sim{
      std::move(grains), silt::Contacts<silt::HertzMindlin>{grain},
      silt::PeriodicBox{{{0, 0, -0.1}, {length, width, 0.2}}, {true, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, grain,
               {.name = "plate", .motion = silt::vibration({0, 0, amplitude}, frequency)});

  const double stroke = 1 / frequency;  // [s]
  sim.run(16 * stroke);
  auto files = silt::vtk_series("vibrated_bed", silt::every(stroke / 4));

  // How much mass gathers in n crests along x, and where: a Fourier coefficient.
  const auto crests = [&](int n) {
    std::complex<double> sum = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sum += std::polar(1.0, 2 * std::numbers::pi * n * sim.position(k).x / length);
    return sum / static_cast<double>(sim.size());
  };
  int waves = 1;  // those with the largest coefficient; below, mean over 10 phases of the stroke
  std::array<double, 12> size{};
  for (int phase = 0; phase < 10; ++phase) {
    sim.run(0.1 * stroke, files);
    for (int n = 1; n < 12; ++n) size[n] += std::abs(crests(n)) / 10;
  }
  for (int n = 1; n < 12; ++n)
    if (size[n] > size[waves]) waves = n;
  const auto now = crests(waves);
  sim.run(stroke, files);
  const auto next = crests(waves);
  const double change = std::arg(next / now) * 180 / std::numbers::pi;  // [degrees] 180: swapped

  std::printf("%d waves of %.0f mm; a stroke later crests are shifted by %.0f degrees\n", waves,
              1e3 * length / waves, std::abs(change));
  // Fails for a layer without waves, and for waves with the period of the plate.
  return size[waves] > 0.05 && std::abs(change) > 120 ? 0 : 1;
}
