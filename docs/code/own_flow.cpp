// silt - BSD-3-Clause, see LICENSE
// A prescribed flow, and a user-defined flow solver, of docs/own_fluid.md.

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <span>
#include <utility>

#include <silt/fluid.hpp>

// Air whose inflow pulsates.
class PulsedAir : public silt::FlowSolver {
 public:
  using silt::FlowSolver::FlowSolver;

  static double inflow(double t) { return 0.5 + 0.3 * std::sin(2 * std::numbers::pi * 20 * t); }
  silt::FlowStep step(double dt, const silt::Team& team = {}) {
    time_ += dt;
    set_side(2, 0, silt::Inflow{.velocity = {0, 0, inflow(time_)}});
    return FlowSolver::step(dt, team);
  }
  template <class Visit>
  void for_each_state(const Visit& visit) {
    FlowSolver::for_each_state(visit);
    visit("pulse.time", std::span<double>(&time_, 1));
  }

 private:
  double time_ = 0;  // [s]
};

int main() {
  const silt::HertzMindlin::Material glass{.youngs_modulus = 1e6, .poisson_ratio = 0.3};
  const silt::FluidProperties air{.density = 1.2, .viscosity = 1.8e-5};

  // Dust in a vortex.
  const double spin = 10, d = 1e-4, density = 2500;  // [rad/s], [m], [kg/m3]
  silt::PrescribedFlow vortex{silt::Stokes{}, air, [spin](const silt::Vec3d& x, double) {
                                return silt::Vec3d{-spin * x.y, spin * x.x, 0};
                              }};

  // The exact path is r exp(lambda t) in the complex plane, with
  // lambda^2 + lambda/tau + (rho/rho_p) spin^2 - i spin/tau = 0.
  const double tau = density * d * d / (18 * air.viscosity);  // [s]
  const std::complex<double> i(0, 1);
  const auto root =
      std::sqrt(1 / (tau * tau) + 4.0 * (i * spin / tau - air.density / density * spin * spin));
  const std::complex<double> lambda = 0.5 * (root - 1 / tau), start = lambda * 0.05;

  silt::Particles<silt::Sphere> dust;
  dust.add({.position = {0.05, 0, 0},
            .radius = 0.5 * d,
            .density = density,
            .velocity = {start.real(), start.imag(), 0}});
  silt::Simulation thrown{std::move(dust), silt::Contacts<silt::HertzMindlin>{glass}, vortex};
  thrown.run(0.2);
  const double radius = norm(thrown.position(0));
  const double exact = std::abs(0.05 * std::exp(lambda * thrown.time()));
  std::printf("dust at r = %.6f m after %.1f s, exactly %.6f m\n", radius, thrown.time(), exact);

  // Grains in a gas that pulsates.
  const double width = 0.012;  // [m]
  PulsedAir pulsed(silt::Grid({{0, 0, 0}, {width, width, 0.04}}, {6, 6, 20}), air);
  pulsed.set_side(2, 1, silt::Outflow{.pressure = 0});
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 0}, {width, width, 0.02}}, {.radius = 0.5e-3, .density = 1500, .count = 300});
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, pulsed}};
  sim.add_wall(silt::box({0, 0, 0}, {width, width, 0.08}), glass);
  sim.gravity = {0, 0, -9.81};
  double missing = 0;  // [-] of the flow through the outlet
  sim.run(0.05, silt::at(silt::every(5e-3), [&](const auto& now) {
            const auto& fluid = now.fluid();
            const double in = PulsedAir::inflow(fluid.time()) * width * width;
            missing = std::max(missing, std::abs(fluid.flow().flow_rate(2, 20) / in - 1));
          }));
  std::printf("what flows out is off by %.1e of what flows in, 0.5 + 0.3 sin m/s\n", missing);

  // Fails if the drift lacks the centrifugal term (r = 0.05 m) or has twice its time constant, or
  // if the coupling does not call the user's step().
  if (std::abs(radius / exact - 1) < 1e-4 && missing < 1e-6) return 0;
  std::printf("wrong: must agree within 1e-4 and 1e-6\n");
  return 1;
}
