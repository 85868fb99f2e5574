// silt - BSD-3-Clause, see LICENSE

#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>
#include <utility>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

namespace prescribed_flow_test {

using silt::HertzMindlin;
using silt::Particles;
using silt::PrescribedFlow;
using silt::Simulation;
using silt::Sphere;
using silt::Stokes;
using silt::Vec3d;

namespace {

const HertzMindlin::Material glass{2e5, 0.3, 0.8, 0.3};
constexpr double d = 1e-3, mu = 1.8e-3, rho = 1.2;  // [m], [Pa s], [kg/m3]
double tau(double density) { return density * d * d / (18 * mu); }

/// A force of one's own, along y for a spin about z.
struct Sideways {
  Vec3d force_on(const silt::InFluid& at) const { return {0, 1e-9 * at.angular_velocity.z, 0}; }
};

template <class Fluid>
auto one_grain(double density, const Vec3d& x, const Vec3d& v, const Fluid& fluid, double dt) {
  Particles<Sphere> all;
  all.add({.position = x, .radius = d / 2, .density = density, .velocity = v});
  Simulation sim{std::move(all), silt::Contacts<HertzMindlin>{glass}, fluid};
  sim.time_step = dt;
  return sim;
}

}  // namespace

TEST_CASE("prescribed_flow: a uniform wind takes a particle along exponentially") {
  // Catches a missing half of the first kick, drag of twice the time constant, and buoyancy or
  // pressure where there is neither gravity nor acceleration.
  const Vec3d wind{0.3, 0, -0.1};
  PrescribedFlow fluid{Stokes{}, {rho, mu}, [&](const Vec3d&, double) { return wind; }};
  auto sim = one_grain(2500, {0, 0, 0}, {0, 0, 0}, fluid, 2e-5);
  sim.run(0.05);
  const Vec3d exact = (1 - std::exp(-sim.time() / tau(2500))) * wind;
  // velocity(k) is in the middle of a step, which the force's half of it leaves to second order.
  CHECK(norm(sim.velocity(0) - exact) < 1e-6 * norm(wind));
}

TEST_CASE(
    "prescribed_flow: a wind that oscillates shakes a particle with its amplitude and phase") {
  // Catches a time that is off by a step (phase), and a flow that is asked once for all times.
  const double omega = 100;
  PrescribedFlow fluid{Stokes{}, {rho, mu}, [&](const Vec3d&, double t) {
                         return Vec3d{std::sin(omega * t), 0, 0};
                       }};
  auto sim = one_grain(2500, {0, 0, 0}, {0, 0, 0}, fluid, 2e-5);
  sim.run(10 * tau(2500));
  // v = A u of frequency omega: A (1 + i omega tau) = 1 + beta i omega tau.
  const std::complex<double> i(0, 1), wt = i * omega * tau(2500);
  const auto A = (1.0 + rho / 2500 * wt) / (1.0 + wt);
  const double exact = std::imag(A * std::exp(i * omega * sim.time()));
  CHECK(std::abs(sim.velocity(0).x - exact) < 1e-4 * std::abs(A));
}

TEST_CASE("prescribed_flow: what settles in a linear shear lags behind it by one relaxation") {
  // Catches a velocity taken at another place, and buoyancy left out (5e-4 of the settling).
  const double shear = 20, density = 2500, t = tau(density);
  const double settling = -9.81 * t * (1 - rho / density);
  const Vec3d start{shear * (0 - settling * t), 0, settling};
  PrescribedFlow fluid{Stokes{}, {rho, mu}, [&](const Vec3d& x, double) {
                         return Vec3d{shear * x.z, 0, 0};
                       }};
  auto sim = one_grain(density, {0, 0, 0}, start, fluid, 2e-5);
  sim.gravity = {0, 0, -9.81};
  sim.run(0.1);
  const Vec3d v = sim.velocity(0);
  CHECK(std::abs(v.z / settling - 1) < 1e-5);
  CHECK(std::abs(v.x / (shear * (sim.position(0).z - settling * t)) - 1) < 1e-5);
}

TEST_CASE("prescribed_flow: in solid-body rotation a heavy particle spirals outwards") {
  // Catches a drift rate with another time constant, and a pressure of the wrong sign.
  const double spin = 10, density = 2500, of_fluid = 250, t = tau(density);
  const auto rotation = [spin](const Vec3d& x, double) {
    return Vec3d{-spin * x.y, spin * x.x, 0};
  };
  const std::complex<double> i(0, 1);
  const auto lambda =
      0.5 *
      (std::sqrt(1 / (t * t) + 4.0 * (i * spin / t - of_fluid / density * spin * spin)) - 1 / t);
  const auto v = 0.05 * lambda;
  auto sim = one_grain(density, {0.05, 0, 0}, {v.real(), v.imag(), 0},
                       PrescribedFlow{Stokes{}, {of_fluid, mu}, rotation}, 2e-5);
  sim.run(0.2);
  const auto exact = 0.05 * std::exp(lambda * sim.time());
  CHECK(norm(sim.position(0) - Vec3d{exact.real(), exact.imag(), 0}) < 1e-5 * std::abs(exact));
  CHECK(std::abs(exact) > 0.06);
}

TEST_CASE("prescribed_flow: with virtual mass what weighs as the fluid goes with it") {
  // Catches Du/Dt left out of the virtual mass (it leaves its circle), or counted twice.
  const double spin = 10;
  const auto rotation = [spin](const Vec3d& x, double) {
    return Vec3d{-spin * x.y, spin * x.x, 0};
  };
  auto sim = one_grain(1000, {0.05, 0, 0}, {0, 0.5, 0},
                       PrescribedFlow{Stokes{}, {1000, 1e-6}, rotation, silt::VirtualMass{}}, 2e-5);
  sim.run(0.3);
  CHECK(std::abs(norm(sim.position(0)) / 0.05 - 1) < 1e-6);
}

TEST_CASE("prescribed_flow: lift knows the shear") {
  // Catches a curl of the wrong sign, or of half the size (0.71 of the lift).
  const double shear = 50;
  const auto flow = [&](const Vec3d& x, double) { return Vec3d{0.1 + shear * x.z, 0, 0}; };
  auto sim = one_grain(2500, {0, 0, 0}, {0, 0, 0},
                       PrescribedFlow{Stokes{}, {rho, mu}, flow, silt::ShearLift{}}, 2e-5);
  sim.run(0);
  const double exact = silt::SaffmanMei::force(d, rho, mu, Vec3d{0.1, 0, 0}, Vec3d{0, shear, 0}).z;
  CHECK(exact != 0);
  CHECK(std::abs(sim.fluid_force(0).z / exact - 1) < 1e-3);
}

TEST_CASE("prescribed_flow: forces know the particle's rotation, without a torque of the fluid") {
  // Catches an angular velocity of 0: no lift, and no force of one's own.
  using Wind = Vec3d (*)(const Vec3d&, double);
  const Wind wind = [](const Vec3d&, double) { return Vec3d{2, 0, 0}; };
  const Vec3d spin{0, 0, 1000};
  const auto side_force = [&](const auto& lift) {
    Particles<Sphere> all;
    all.add({.position = {0, 0, 0}, .radius = d / 2, .density = 1000, .angular_velocity = spin});
    Simulation sim{std::move(all), silt::Contacts<HertzMindlin>{glass},
                   PrescribedFlow{silt::SchillerNaumann{}, {rho, 1.8e-5}, wind, lift}};
    sim.time_step = 1e-6;
    sim.run(0);
    CHECK(sim.angular_velocity(0).z == 1000);
    return sim.fluid_force(0).y;
  };
  const double magnus = silt::OesterleBuiDinh::force(d, rho, 1.8e-5, {2, 0, 0}, -spin).y;
  CHECK(std::abs(magnus) > 1e-7);
  // The force is that at the start of the step, in which the slip falls by 2e-6.
  CHECK(std::abs(side_force(silt::SpinLift{}) / magnus - 1) < 1e-5);
  // The fluid resists the motion that it causes in the step: K dt/(2 m) = 4e-7.
  CHECK(std::abs(side_force(Sideways{}) / 1e-6 - 1) < 1e-6);
  // Forces that need no rotation do not make a simulation read it.
  using Shear = PrescribedFlow<Wind, Stokes, silt::ShearLift, silt::VirtualMass>;
  CHECK_FALSE((Shear::needs_spin || Shear::needs_rotation));
  CHECK_FALSE(silt::CoupledFlow<Stokes, silt::Kernel, silt::HistoryForce>::needs_spin);
  CHECK_FALSE(silt::CoupledFlow<Stokes, silt::Kernel, silt::FollowedDrag>::needs_spin);
  CHECK_FALSE(
      silt::CoupledFlow<silt::SlowEllipsoid, silt::Kernel, silt::SlowEllipsoid>::needs_spin);
}

TEST_CASE("prescribed_flow: a restart goes on with the same bits, and so do more threads") {
  // Catches a clock that a checkpoint forgets, and sums that depend on threads.
  const auto flow = [](const Vec3d& x, double t) {
    return Vec3d{std::sin(30 * t) + 10 * x.z, -x.x, 0.2 * std::cos(20 * t)};
  };
  const auto make = [&](int threads) {
    Particles<Sphere> all;
    all.fill({{0, 0, 0}, {0.02, 0.02, 0.02}}, {.radius = d / 2, .density = 2500, .count = 300});
    Simulation sim{std::move(all), silt::Contacts<HertzMindlin>{glass},
                   PrescribedFlow{silt::SchillerNaumann{}, {rho, mu}, flow, silt::SpinTorque{}}};
    sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.02}), glass);
    sim.gravity = {0, 0, -9.81};
    sim.threads = threads;
    return sim;
  };
  auto whole = make(1), other = make(3), first = make(1), second = make(1);
  whole.run(0.02), whole.run(0.02), other.run(0.02), other.run(0.02);
  const std::string file = "prescribed_flow.silt";
  first.run(0.02);
  save_checkpoint(first, file);
  load_checkpoint(second, file);
  std::filesystem::remove(file);
  second.run(0.02);
  for (std::size_t k = 0; k < whole.rows(); ++k) {
    CHECK(norm(whole.position(k) - second.position(second.find(whole.id(k)))) == 0);
    CHECK(norm(whole.position(k) - other.position(other.find(whole.id(k)))) == 0);
  }
  CHECK(second.fluid().clock.steps == whole.fluid().clock.steps);
}

// A step for the particles at rest was twice as long here; a run ended when they had become faster.
TEST_CASE("prescribed_flow: the time step is that for the speed which the wind gives") {
  const auto chosen = [](double speed, double wind, double size) {
    Particles<Sphere> all;
    all.add({.position = {0, 0, 0}, .radius = size, .density = 2500, .velocity = {speed, 0, 0}});
    Simulation sim{std::move(all), silt::Contacts<HertzMindlin>{glass},
                   PrescribedFlow{silt::SchillerNaumann{}, {rho, mu}, [=](const Vec3d&, double) {
                                    return Vec3d{wind, 0, 0};
                                  }}};
    sim.run(0);
    return sim.step_length();
  };
  CHECK(chosen(0, 30, d) == chosen(30, 0, d));
  CHECK(chosen(0, 30, d) < 0.9 * chosen(3, 0, d));
  // Newton's drag, 0.44, over 0.1 m; small spheres reach the velocity of the fluid.
  const silt::FastestFluid air{.velocity = 100, .density = 1.2, .viscosity = 1.8e-5, .way = 0.1};
  const double D = 0.01, m = 2500 * std::numbers::pi / 6 * D * D * D,
               F = 0.5 * 1.2 * 1e4 * 0.44 * std::numbers::pi / 4 * D * D;
  CHECK(std::abs(air.carries(D, m) - std::sqrt(2 * F / m * 0.1)) < 1e-12);
  CHECK(air.carries(1e-5, 1e-12) == 100);
}

TEST_CASE("prescribed_flow: fluids and velocities that cannot be are refused") {
  const auto still = [](const Vec3d&, double) { return Vec3d{0, 0, 0}; };
  CHECK_THROWS_AS((PrescribedFlow{Stokes{}, {0, mu}, still}), silt::InputError);
  CHECK_THROWS_AS((PrescribedFlow{Stokes{}, {.density = 1}, still}), silt::InputError);
  const auto wrong = [](const Vec3d&, double) { return Vec3d{NAN, 0, 0}; };
  auto sim =
      one_grain(2500, {0, 0, 0}, {0, 0, 0}, PrescribedFlow{Stokes{}, {rho, mu}, wrong}, 2e-5);
  CHECK_THROWS_AS(sim.run(1e-3), silt::InputError);
}

}  // namespace prescribed_flow_test
