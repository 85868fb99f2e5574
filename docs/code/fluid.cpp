// silt - BSD-3-Clause, see LICENSE
// The program of docs/fluid.md.

#include <algorithm>
#include <cstdio>

#include <silt/coupling/drag/ergun.hpp>
#include <silt/coupling/formulas.hpp>
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
}
