// silt - BSD-3-Clause, see LICENSE
//
// Friction from an angle of repose. The calibration finds, in few runs, the friction with which the
// simulated heap has the measured angle. Here the "measured" heaps are simulations with a friction
// of 0.35: the calibration must recover this value. It prints it with its confidence interval.
//
// picture: calibration/calibration.png

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

#include <silt/silt.hpp>
#include <silt/study/calibrate.hpp>

/// Angle [degrees] of a heap poured from a slot, in a periodic slice.
double angle_of_heap(double friction, std::uint64_t seed) {
  const silt::HertzMindlin::Material grain{
      .youngs_modulus = 2e6, .poisson_ratio = 0.3, .restitution = 0.4, .friction = friction};
  silt::Simulation sim{
      silt::Particles<silt::Sphere>{},
      silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>{grain, {.rolling_friction = 0.2}},
      silt::PeriodicBox{{.min = {-1, 0, -1}, .max = {1, 0.016, 1}}, {false, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, grain);
  sim.add_inlet(silt::Box{{-0.006, 0, 0.05}, {0.006, 0.016, 0.06}},
                {.radius = silt::uniform(1.8e-3, 2.2e-3),  // [m]
                 .density = 2500,
                 .rate = 500,               // [1/s]
                 .velocity = {0, 0, -0.3},  // [m/s]
                 .total = 160,
                 .seed = seed});
  sim.run(0.6);

  // In a triangle of height H on a base of 2 L, half of the area is below 0.29 H and within 0.29 L
  // of the middle. Medians are insensitive to grains that have rolled away.
  std::vector<double> height, distance;  // [m]
  for (std::size_t k = 0; k < sim.size(); ++k) {
    height.push_back(sim.position(k).z);
    distance.push_back(std::abs(sim.position(k).x));
  }
  const auto median = [](std::vector<double>& values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  };
  return std::atan(median(height) / median(distance)) * 180 / std::numbers::pi;
}

int main() {
  const double planted = 0.35;  // [-]
  double measured = 0;          // [degrees]
  for (const std::uint64_t seed : {101, 102, 103, 104})
    measured += angle_of_heap(planted, seed) / 4;

  silt::Calibration calibration{
      {.folder = "calibration", .budget = 22, .repeats = 2},
      {{.name = "friction [-]", .least = 0.05, .most = 0.8}},
      {{.name = "angle of the heap [deg]", .measured = measured, .error = 0.7}}};
  calibration.run([](const std::vector<double>& p, std::uint64_t seed) {
    return std::vector<double>{angle_of_heap(p[0], seed)};
  });
  calibration.report();

  const auto& friction = calibration.result().parameters[0];
  std::printf("heaps of %.1f degrees: friction %.2f, from %.2f to %.2f\n", measured,
              friction.recommended, friction.low, friction.high);
  // Fails for a wrong result; the angles of heaps of 160 grains scatter by one or two degrees.
  return std::abs(friction.recommended - planted) < 0.12 && friction.low < planted + 0.05 &&
                 friction.high > planted - 0.05
             ? 0
             : 1;
}
