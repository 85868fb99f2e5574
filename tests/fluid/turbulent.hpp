// silt - BSD-3-Clause, see LICENSE
//
// Turbulent flows that the tests of all closures look at.
#pragma once

#include <cmath>
#include <numbers>

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

/// Friction over Prandtl's of air in a smooth pipe that lies along (2, 0, 1) in the cells, `cells`
/// a diameter, driven by the slope of Prandtl's law at this Re.
template <class Closure>
double askew_friction(int cells, double Re, double D, const Closure& closure) {
  const double U = Re * mu / (rho * D), slope = prandtl(Re) * 0.5 * rho * U * U / D, h = D / cells,
               tilt = 1 / std::sqrt(5.0);
  const int n = static_cast<int>(std::ceil((cells + 2) * std::sqrt(5.0) / 2));  // of periods
  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {2 * n * h, (cells + 2) * h, n * h}},
                                   {2 * n, cells + 2, n}, {true, false, true}),
                        {rho, mu});
  flow.set_boundary({.distance = [=](const silt::Vec3d& x) {
    return 0.5 * D - std::hypot(std::remainder((x.x - 2 * x.z) * tilt, 2 * n * h * tilt),
                                x.y - 0.5 * (cells + 2) * h);
  }});
  flow.set_turbulence(closure);
  for (const int d : {0, 2}) {
    const double share = d == 0 ? 2 * tilt : tilt;
    flow.force(d).fill(slope * share), flow.velocity(d).fill(U * share);
  }
  // A difference of mean velocities decays as exp(-t U f/D): less than 1 % is left of 5 %.
  for (double t = 0; t < 2 * D / U / prandtl(Re);) {
    const double dt = flow.stable_step();
    flow.step(dt), t += dt;
  }
  const double mean =
      flow.flow_rate(0, 0) / (std::numbers::pi / 4 * D * D);  // cut by an area / cos
  return slope * D / (0.5 * rho * mean * mean) / prandtl(rho * mean * D / mu);
}

}  // namespace turbulent
