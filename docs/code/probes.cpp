// silt - BSD-3-Clause, see LICENSE
// The scene of docs/probes.md: air oscillates through a bed of grains at rest; taps, probes, a
// profile and means of the flow.

#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include <silt/fluid.hpp>

int main() {
  const double d = 1e-3, a = 1.02 * d, width = 8 * a, height = 40 * a;  // [m]
  silt::Particles<silt::Sphere> bed;
  for (int n = 0; n < 8 * 8 * 20; ++n)
    bed.add({.position = {(n % 8 + 0.5) * a, (n / 8 % 8 + 0.5) * a, (n / 64 + 10.5) * a},
             .radius = 0.5 * d,
             .density = 2500,
             .fixed = true});
  silt::FlowSolver air(
      silt::Grid({{0, 0, 0}, {width, width, height}}, {4, 4, 20}, {true, true, false}),
      {.density = 1.2, .viscosity = 1.8e-5});

  // 0.4 m/s and half of that more and less, 50 times a second.
  const auto speed = [](double t) { return 0.4 + 0.2 * std::sin(2 * std::numbers::pi * 50 * t); };
  air.set_side(2, 0, silt::Inflow{.velocity_in_time = [=](const silt::Vec3d&, double t) {
                 return silt::Vec3d{0, 0, speed(t)};
               }});
  air.set_side(2, 1, silt::Outflow{});

  const silt::HertzMindlin::Material glass{.youngs_modulus = 1e6, .poisson_ratio = 0.3};
  silt::Simulation sim{std::move(bed), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::CoupledFlow{silt::Ergun{}, silt::Kernel{}, air}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 5e-5, sim.fluid().steps = 4;

  auto mean = silt::flow_average("probes", silt::every(2e-4), {.from = 0.02});
  sim.run(0.06, mean,
          silt::pressure_taps("probes/taps.csv",
                              {{"low", {0, 0, 15 * a}, 2}, {"high", {0, 0, 25 * a}, 2}},
                              silt::every(1e-3)),
          silt::flow_probes("probes/points.csv", {{"above", {4 * a, 4 * a, 35 * a}}},
                            silt::every(1e-3)),
          silt::flow_profile("probes", "axis", {4 * a, 4 * a, 0}, {4 * a, 4 * a, height}, 81,
                             silt::every(0.02)));

  // Ergun's law, linear and quadratic in the velocity: their means over a period, of u and of u^2.
  const double eps = 1 - std::numbers::pi / 6 / std::pow(1.02, 3), mean_square = 0.4 * 0.4 + 0.02;
  const double linear = silt::ergun_pressure_gradient(eps, d, 1e-9, 1.8e-5, 0.4);
  const double square = silt::ergun_pressure_gradient(eps, d, 1.2, 1.8e-5, 0.4) - linear;
  const double ergun = (linear + square * mean_square / 0.16) * 10 * a;
  const auto at = [&](double z) { return static_cast<int>(z / air.grid().h().z); };
  const double low = mean.mean().pressure(1, 1, at(15 * a + 1e-9)),
               high = mean.mean().pressure(1, 1, at(25 * a + 1e-9));
  const double speed_mean = mean.mean().velocity(1, 1, 18).z;
  std::printf(
      "mean over two periods: drop %.1f Pa (Ergun: %.1f), velocity above the bed %.4f m/s\n",
      low - high, ergun, speed_mean);
  // Fails if means are not over whole periods, if only the linear part is averaged (11 % less), or
  // if the inflow does not oscillate.
  const bool right =
      std::abs((low - high) / ergun - 1) < 0.03 && std::abs(speed_mean / 0.4 - 1) < 1e-3;
  if (!right)
    std::printf("wrong: the mean drop must be Ergun's, to 3 %%, and the velocity 0.4 m/s\n");
  return right ? 0 : 1;
}
