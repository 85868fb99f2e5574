// silt - BSD-3-Clause, see LICENSE
//
// Turbulent flows that the tests of all closures look at.
#pragma once

#include <cmath>

#include <silt/fluid/flow_solver.hpp>

namespace turbulent {

constexpr double rho = 1.2, mu = 1.8e-5, nu = mu / rho;  // air

/// Darcy's friction factor of a smooth pipe, by Prandtl's law (fitted to Nikuradse's pipes).
inline double prandtl(double Re) {
  double s = 10;  // 1/sqrt(f)
  for (int n = 0; n < 50; ++n) s = 2 * std::log10(Re / s) - 0.8;
  return 1 / (s * s);
}

/// Air between plates `wide` [m] apart, `cells` cells, that move with `plates` [m/s]; driven by
/// `slope` [Pa/m], it starts `start` [m/s] faster than they.
inline silt::FlowSolver channel(int cells, double wide, double slope, double start, double plates) {
  const double h = wide / cells;
  silt::FlowSolver flow(
      silt::Grid({{0, 0, 0}, {wide, wide, h}}, {2, cells, 1}, {true, false, true}), {rho, mu});
  for (const int side : {0, 1}) flow.set_side(1, side, silt::NoSlip{{plates, 0, 0}});
  flow.force(0).fill(slope);
  flow.velocity(0).fill(start + plates);
  return flow;
}

}  // namespace turbulent
