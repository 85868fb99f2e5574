// silt - BSD-3-Clause, see LICENSE
// The scene of docs/gas_heat.md: hot air through a bed of cold grains, against Schumann's solution.

#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

#include <silt/fluid.hpp>

/// Fraction of the way from the temperature of the cold bed to that of the incoming gas, y transfer
/// units into the bed at the time s: of the gas J(y, s), of the grains 1 - J(s, y).
double J(double y, double s) {
  double sum = 0;
  const int n = 1000;
  for (int k = 0; k < n; ++k) {
    const double x = (k + 0.5) * y / n;
    sum += std::exp(-s - x) * std::cyl_bessel_i(0, 2 * std::sqrt(s * x)) * y / n;
  }
  return 1 - sum;
}

int main() {
  const double d = 4e-3, width = 0.024, height = 0.096, U = 1.2;  // [m], [m/s]
  const double cold = 300, hot = 400, c = 20;                     // [K], [J/(kg K)]
  const silt::HertzMindlin::Material soft{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.3, .friction = 0.3};
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 0}, {width, width, height}},
              {.radius = 0.5 * d, .density = 2500, .count = 600});

  silt::FlowSolver air(
      silt::Grid({{0, 0, 0}, {width, width, height}}, {6, 6, 24}, {true, true, false}),
      {.density = 1.2, .viscosity = 1.8e-5});
  air.set_side(2, 0, silt::Inflow{{0, 0, U}}), air.set_side(2, 1, silt::Outflow{});
  air.set_heat({.heat_capacity = 1005, .conductivity = 0.026, .start_temperature = cold});

  silt::Simulation sim{
      std::move(grains), silt::Contacts<silt::HertzMindlin>{soft},
      silt::PeriodicBox{{{0, 0, 0}, {width, width, height}}, {true, true, false}},
      silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{.width = 1.5}, air},
      silt::Heat{
          silt::HeatConduction{.conductivity = 1e-3, .heat_capacity = c, .start_temperature = cold},
          silt::FluidConvection<silt::Gunn>{}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, soft);
  sim.run(0.4);  // until they are at rest

  silt::FlowSolver& flow = sim.fluid().flow();
  flow.set_side_heat(2, 0, {.temperature = hot});
  const auto grains_heat = [&] {
    double sum = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sum += sim.mass(k) * c * (sim.field<silt::Temperature>(k) - cold);
    return sum;
  };
  const auto before = flow.heat_book();
  const double start = sim.fluid().time();
  sim.run(0.5,
          silt::flow_profile("gas_heat", "axis", {width / 2, width / 2, 0},
                             {width / 2, width / 2, height}, 49, silt::every(0.1)),
          silt::csv_series("gas_heat", silt::every(0.1)));
  const auto after = flow.heat_book();

  // The bed: its voidage from 16 to 40 mm above the plate, and h A per volume by Gunn's law.
  const double h = 2 * d, t = sim.fluid().time() - start;
  double eps = 0;
  for (int k = 4; k < 10; ++k)
    for (int n = 0; n < 36; ++n) eps += flow.voidage()(n % 6, n / 6, k) / 216;
  const double Re = 1.2 * U * d / 1.8e-5, Pr = 1.8e-5 * 1005 / 0.026;
  const double hA = 6 * (1 - eps) / (d * d) * silt::Gunn::nusselt(Re, Pr, eps) * 0.026;
  const double per_length = hA / (1.2 * 1005 * U), per_time = hA / ((1 - eps) * 2500 * c);
  std::printf("voidage %.3f, %.1f transfer units a metre, t = %.3f s\n", eps, per_length, t);
  double worst = 0;
  for (int layer = 0; layer < 6; ++layer) {  // 8 mm each
    double sum = 0, count = 0, height_of = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.position(k).z >= layer * h && sim.position(k).z < (layer + 1) * h)
        sum += sim.field<silt::Temperature>(k), height_of += sim.position(k).z, ++count;
    const double z = height_of / count, share = (sum / count - cold) / (hot - cold);
    const double schumann = 1 - J((t - z * eps / U) * per_time, z * per_length);
    std::printf("z = %4.1f mm: grains %.3f, Schumann %.3f\n", 1e3 * z, share, schumann);
    worst = std::max(worst, std::abs(share - schumann));
  }
  const double kept = grains_heat() + after.from_particles - before.from_particles;
  std::printf("grains got %.6f J, the gas gave %.6f J\n", grains_heat(),
              before.from_particles - after.from_particles);
  // Cells of 4 mm, whose temperature is that of the gas leaving them, smear a front that is 12 mm
  // wide: 0.04. Fails if a grain exchanges heat over the width of the kernel (0.07), if a Nusselt
  // number, an area or a capacity is wrong by a factor of two, or if only one side receives heat.
  return worst < 0.045 && std::abs(kept) < 1e-10 * grains_heat() ? 0 : 1;
}
