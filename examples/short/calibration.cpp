// silt - BSD-3-Clause, see LICENSE
//
// Friction from an angle of repose. Heaps are simulated until the friction is found with which the
// angle is that of a measured heap, in few runs; the program prints it with its interval.
//
// picture: calibration/calibration.png

#include <cmath>
#include <cstdio>
#include <numbers>

#include <silt/silt.hpp>
#include <silt/study/calibrate.hpp>

/// Angle [degrees] of the heap that a column of grains leaves as it collapses, in a slice.
double angle_of_heap(double friction, std::uint64_t seed) {
  const silt::HertzMindlin::Material grain{
      .youngs_modulus = 2e6, .poisson_ratio = 0.3, .restitution = 0.4, .friction = friction};
  silt::Particles<silt::Sphere> grains;
  grains.fill({.min = {-0.02, 0, 0}, .max = {0.02, 0.016, 0.2}},
              {.radius = silt::uniform(1.8e-3, 2.2e-3),
               .density = 2500,
               .count = 250,
               .arrangement = silt::Arrangement::Random,
               .seed = seed});
  silt::Simulation sim{
      std::move(grains),
      silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>{grain, {.rolling_friction = 0.2}},
      silt::PeriodicBox{{.min = {-1, 0, -1}, .max = {1, 0.016, 1}}, {false, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, grain);
  sim.run(0.8);

  // In a triangle of height H on a base of 2 L the mean height is H/3, the mean of |x| is L/3.
  double height = 0, width = 0;  // [m] sums
  for (std::size_t k = 0; k < sim.size(); ++k)
    height += sim.position(k).z, width += std::abs(sim.position(k).x - sim.centre_of_mass().x);
  return std::atan(height / width) * 180 / std::numbers::pi;
}

int main() {
  silt::Calibration calibration{
      {.folder = "calibration", .budget = 20, .repeats = 2},
      {{.name = "friction [-]", .least = 0.05, .most = 0.8}},
      {{.name = "angle of the heap [deg]", .measured = 20, .error = 0.7}}};  // an invented one
  calibration.run([](const std::vector<double>& p, std::uint64_t seed) {
    return std::vector<double>{angle_of_heap(p[0], seed)};
  });
  calibration.report();

  const auto& friction = calibration.result().parameters[0];
  const double angle = angle_of_heap(friction.recommended, 99);
  std::printf("friction %.2f, from %.2f to %.2f; one more heap has %.1f degrees\n",
              friction.recommended, friction.low, friction.high, angle);
  // Catches a calibration that ends elsewhere; heaps of 250 grains scatter by a degree or two.
  return std::abs(angle - 20) < 4 && friction.low > 0.06 && friction.high < 0.79 ? 0 : 1;
}
