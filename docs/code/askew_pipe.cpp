// silt - BSD-3-Clause, see LICENSE
//
// Friction of turbulent air in pipes oblique to the cells, relative to Prandtl's law:
// docs/fluid.md. Build with -O3 -march=native; arguments: cells per diameter (10), Re (4.6e4),
// times of D/(U f) (2). Without them a quick run, for the test suite; the status says whether the
// friction is near Prandtl's.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include <silt/fluid/flow_solver.hpp>

namespace {

constexpr double D = 0.05, rho = 1.2, mu = 1.8e-5;

double prandtl(double Re) {  // Darcy's friction factor
  double s = 10;
  for (int n = 0; n < 50; ++n) s = 2 * std::log10(Re / s) - 0.8;
  return 1 / (s * s);
}

/// For a pipe along (a, 0, b).
template <class Closure>
double friction(int a, int b, int cells, double Re, double times, const Closure& closure) {
  const double U = Re * mu / (rho * D), f = prandtl(Re), slope = f * 0.5 * rho * U * U / D;
  const double h = D / cells, length = std::hypot(a, b), cosine = a / length, sine = b / length;
  const int periods = b == 0 ? 2 : static_cast<int>(std::ceil((cells + 2) * length / (a * b)));
  const int nx = b == 0 ? periods : periods * a, ny = cells + 2, nz = b == 0 ? ny : periods * b;
  silt::FlowSolver flow(
      silt::Grid({{0, 0, 0}, {nx * h, ny * h, nz * h}}, {nx, ny, nz}, {true, false, b != 0}),
      {rho, mu});
  flow.set_boundary({.distance = [=](const silt::Vec3d& x) {
    double across = b == 0 ? x.z - 0.5 * nz * h : x.x * sine - x.z * cosine;
    if (b != 0) across = std::remainder(across, nx * h * sine);
    return 0.5 * D - std::hypot(across, x.y - 0.5 * ny * h);
  }});
  flow.set_turbulence(closure);
  flow.force(0).fill(slope * cosine), flow.force(2).fill(slope * sine);
  flow.velocity(0).fill(U * cosine), flow.velocity(2).fill(U * sine);
  for (double t = 0; t < times * D / (U * f);) {
    const double dt = flow.stable_step();
    flow.step(dt), t += dt;
  }
  const double mean = flow.flow_rate(0, 0) / (std::numbers::pi / 4 * D * D);
  return slope * D / (0.5 * rho * mean * mean) / prandtl(rho * mean * D / mu);
}

}  // namespace

int main(int argc, char** argv) {
  const int cells = argc > 1 ? std::atoi(argv[1]) : 5;
  const double Re = argc > 2 ? std::atof(argv[2]) : 4.6e4,
               times = argc > 3 ? std::atof(argv[3]) : 0.5;
  std::printf("angle   mixing length  k-epsilon\n");
  double least = 1e9, most = 0;
  for (const auto& [a, b] : {std::pair{1, 0}, {3, 1}, {2, 1}, {3, 2}, {1, 1}}) {
    const double length = friction(a, b, cells, Re, times, silt::MixingLength{.half_width = D / 2});
    const double k_epsilon = friction(a, b, cells, Re, times, silt::KEpsilon{.width = D});
    std::printf("%5.1f   %.2f           %.2f\n", std::atan2(b, a) * 180 / std::numbers::pi, length,
                k_epsilon);
    least = std::min({least, length, k_epsilon}), most = std::max({most, length, k_epsilon});
  }
  // Fails if oblique walls exert no friction, or far more than those of a pipe: the flow then moves
  // away from Prandtl's mean velocity, at which the run begins.
  const double limit = times < 1 ? 1.3 : 1.45;
  if (least > 0.9 && most < limit) return 0;
  std::printf("wrong: friction over Prandtl's is %.2f to %.2f; it must be 0.9 to %.2f\n", least,
              most, limit);
  return 1;
}
