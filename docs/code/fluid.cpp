// silt - BSD-3-Clause, see LICENSE
// The program of docs/fluid.md.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <silt/coupling/drag/ergun.hpp>
#include <silt/coupling/drag/lone_sphere.hpp>
#include <silt/coupling/formulas.hpp>
#include <silt/fluid/boundary_of.hpp>
#include <silt/fluid/flow_solver.hpp>

int main() {
  const silt::FluidProperties air{.density = 1.2, .viscosity = 1.8e-5};
  const silt::Grid grid({{0, 0, 0}, {0.02, 0.02, 0.10}}, {4, 4, 20}, {true, true, false});
  silt::FlowSolver flow(grid, air, {.model = silt::MomentumModel::A});
  flow.set_side(2, 0, silt::Inflow{.velocity = {0, 0, 0.4}});
  flow.set_side(2, 1, silt::Outflow{.pressure = 0});

  // A bed at rest fills the middle: grains of 1 mm, four tenths void.
  const double eps = 0.4, d = 1e-3, superficial = 0.4;
  const double Re = air.density * superficial * d / air.viscosity;
  const double beta =
      silt::interphase_coefficient(silt::Ergun{}, eps, Re, d, air.viscosity);  // [kg/(m3 s)]
  for (int k = 5; k < 15; ++k)
    for (int j = 0; j < grid.ny(); ++j)
      for (int i = 0; i < grid.nx(); ++i) {
        flow.voidage()(i, j, k) = eps;
        flow.drag()(i, j, k) = beta;
      }
  // What the laws say of such grains of 2500 kg/m3.
  const double v_t = silt::terminal_velocity(silt::SchillerNaumann{}, d, 2500, air.density,
                                             air.viscosity);  // [m/s]
  const double U_mf = silt::minimum_fluidisation_velocity(silt::Ergun{}, eps, d, 2500, air.density,
                                                          air.viscosity);  // [m/s]
  const double carried = silt::bed_pressure_gradient(silt::Ergun{}, eps, d, air.density,
                                                     air.viscosity, U_mf);  // [Pa/m]
  std::printf("terminal velocity %.2f m/s, minimum fluidisation %.2f m/s\n", v_t, U_mf);

  flow.start();
  for (double t = 0; t < 0.1;) {
    const double dt = std::min(1e-3, flow.stable_step());
    flow.step(dt);
    t += dt;
  }
  const double per_metre =
      (flow.pressure()(0, 0, 7) - flow.pressure()(0, 0, 12)) / (5 * grid.h().z);
  std::printf("pressure gradient in the bed %.0f Pa/m; Ergun: %.0f Pa/m\n", per_metre,
              silt::ergun_pressure_gradient(eps, d, air.density, air.viscosity, superficial));

  // A turbulent pipe of 50 mm, periodic along it.
  const silt::Cylinder wall{{-1, 0, 0}, {1, 0, 0}, 0.025, silt::Side::Inside};
  silt::FlowSolver pipe(
      silt::Grid({{0, -0.03, -0.03}, {0.01, 0.03, 0.03}}, {2, 12, 12}, {true, false, false}), air);
  pipe.set_boundary(silt::boundary_of(wall));
  pipe.set_turbulence({.half_width = 0.025});
  // Or by two equations: what is set last holds.
  pipe.set_turbulence(silt::KEpsilon{.width = 0.05, .intensity = 0.05});
  pipe.force(0).fill(60);     // [Pa/m]
  pipe.velocity(0).fill(15);  // [m/s]
  for (double t = 0; t < 0.5;) {
    const double dt = std::min(1e-3, pipe.stable_step());
    pipe.step(dt);
    t += dt;
  }
  const double mean = pipe.flow_rate(0, 0) / (3.14159 * 0.025 * 0.025);  // [m/s]
  std::printf("60 Pa/m drive %.1f m/s through the pipe\n", mean);

  // A jet into a box, 8 mm wide.
  silt::FlowSolver box(silt::Grid({{0, 0, 0}, {0.03, 0.03, 0.06}}, {15, 15, 30}), air);
  const auto nozzle = [](const silt::Vec3d& x) {
    return 0.004 - std::hypot(x.x - 0.015, x.y - 0.015);
  };
  box.set_side(2, 0, silt::Inflow{.velocity = {0, 0, 2}, .outline = nozzle});
  box.set_side(2, 1, silt::Outflow{});
  box.start();
  const double by_area = box.flow_rate(2, 0);
  box.set_side(2, 0, silt::Inflow{.rate = 1e-4, .outline = nozzle});
  box.start();
  std::printf("the nozzle lets in %.4e m3/s (2 m/s and its area: %.4e), then %.4e m3/s\n", by_area,
              2 * 3.14159265 * 0.004 * 0.004, box.flow_rate(2, 0));

  // Fails if drag uses another velocity than that of the gas (the gradient would be off by 1/0.4),
  // if the flow in the pipe does not move or has no friction (15 m/s, or 25 more in half a second),
  // and if the nozzle consists of whole cells (3 % too large or small) or does not keep the rate.
  const double ergun =
      silt::ergun_pressure_gradient(eps, d, air.density, air.viscosity, superficial);
  double prandtl = 15, root = 7;  // [m/s] at 60 Pa/m; 1/sqrt(f)
  for (int n = 0; n < 50; ++n) {
    root = 2 * std::log10(air.density * prandtl * 0.05 / air.viscosity / root) - 0.8;
    prandtl = root * std::sqrt(2 * 0.05 * 60 / air.density);
  }
  const char* wrong = nullptr;
  if (std::abs(per_metre / ergun - 1) > 0.005)
    wrong = "the bed's gradient must be Ergun's, to 0.5 %";
  if (std::abs(mean / prandtl - 1) > 0.03) wrong = "the pipe's mean must be Prandtl's, to 3 %";
  if (std::abs(by_area / (2 * 3.14159265 * 0.004 * 0.004) - 1) > 0.005 ||
      std::abs(box.flow_rate(2, 0) / 1e-4 - 1) > 1e-9)
    wrong = "the nozzle must have its area, to 0.5 %, and let in the rate given";
  if (std::abs(carried / ((1 - eps) * (2500 - air.density) * 9.81) - 1) > 1e-9)
    wrong = "at minimum fluidisation the pressure gradient must carry the bed's weight";
  if (wrong) std::printf("wrong: %s\n", wrong);
  return wrong ? 1 : 0;
}
