// silt - BSD-3-Clause, see LICENSE
#include <cmath>
#include <numbers>
#include <utility>

#include <doctest/doctest.h>

#include <silt/coupling/lift/ellipsoid_torque.hpp>
#include <silt/fluid.hpp>

using silt::EllipsoidTorque;
using silt::FormInFlow;
using silt::InFluid;
using silt::Quaternion;
using silt::SuperEllipsoid;
using silt::Vec3d;

namespace {

constexpr double pi = std::numbers::pi;

/// A heavy body in a slow step: the torque of now.
InFluid in_shear(const FormInFlow* form, const Quaternion& q, double rate) {
  InFluid at{};
  at.density = 1000, at.viscosity = 0.1, at.voidage = 1, at.diameter = 2e-4;
  at.mass = 1e9, at.dt = 1e-3, at.orientation = q, at.body = form;
  at.curl = {0, rate, 0}, at.strain = {0, 0.5 * rate, 0};  // u = rate z e_x
  return at;
}

}  // namespace

TEST_CASE("ellipsoid_torque: Jeffery's torques on a spheroid that lies still in a shear") {
  const auto form = silt::form_in_flow(SuperEllipsoid{3, 1, 1});
  // Along and across the flow the spin that would have no torque is rate/(1 + r^2), r^2 times that.
  const EllipsoidTorque law;
  const auto along = in_shear(&form, {1, 0, 0, 0}, 2);
  const double C = pi * 0.1 * 8e-12 * form.spin_resistance.y;
  CHECK(law.torque_on(along).y == doctest::Approx(C * 2 / 10).epsilon(1e-5));
  const auto across = in_shear(&form, silt::rotation_about({0, 1, 0}, pi / 2), 2);
  CHECK(law.torque_on(across).y == doctest::Approx(C * 2 * 9 / 10).epsilon(1e-5));
  // Along the vorticity it rolls at half of the rate.
  const auto rolls = in_shear(&form, silt::rotation_about({0, 0, 1}, pi / 2), 2);
  const double C_axis = pi * 0.1 * 8e-12 * form.spin_resistance.x;
  CHECK(law.torque_on(rolls).y == doctest::Approx(C_axis * 1).epsilon(1e-5));
  CHECK(std::abs(law.torque_on(rolls).x) < 1e-12 * C);
  // A sphere: that of SpinTorque, also beyond Stokes flow and in a stiff step.
  auto ball = in_shear(nullptr, {}, 2e5);
  ball.angular_velocity = {3e4, 1e4, -2e4}, ball.mass = 4e-9;
  const Vec3d a = law.torque_on(ball), b = silt::SpinTorque{}.torque_on(ball);
  CHECK(norm(a - b) < 1e-12 * norm(b));
}

TEST_CASE("ellipsoid_torque: a spheroid in a shear flow turns in Jeffery's orbit") {
  // Couette flow between plates; the body's Stokes number rho d^2 rate/(60 mu) is 1e-5.
  const double width = 0.05, rate = 2, r = 3;
  const double period = 2 * pi * (r + 1 / r) / rate;
  const auto turned = [&](double step) {
    silt::FlowSolver flow(
        silt::Grid({{0, 0, 0}, {width, width, width}}, {3, 3, 5}, {true, true, false}),
        {1000, 0.2});
    const double U = 0.5 * rate * width;
    flow.set_side(2, 0, silt::NoSlip{{-U, 0, 0}});
    flow.set_side(2, 1, silt::NoSlip{{U, 0, 0}});
    for (int k = 0; k < 5; ++k)
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i <= 3; ++i)
          flow.velocity(0)(i, j, k) = rate * width * ((k + 0.5) / 5 - 0.5);
    silt::Particles<SuperEllipsoid> bodies;
    bodies.add({.form = bodies.add_form(SuperEllipsoid{r, 1, 1}),
                .position = {0.5 * width, 0.5 * width, 0.5 * width},
                .radius = 3e-4,
                .density = 1000});
    silt::CoupledFlow fluid{silt::OrientedDrag{}, silt::Unresolved{}, flow, EllipsoidTorque{}};
    fluid.steps = 1;
    silt::Simulation sim{std::move(bodies),
                         silt::Contacts<silt::HertzMindlin>{{1e6, 0.3, 0.8, 0.3}}, fluid};
    sim.time_step = step;
    sim.guard.max_time_step = 1e9;  // it meets nobody
    sim.run(0.3 * period);
    const Vec3d n = rotate(sim.orientation(0), {1, 0, 0});
    CHECK(std::abs(n.y) < 1e-9);
    const double angle = std::atan2(-n.z, n.x), t = sim.time();
    // tan(angle) = tan(2 pi t/T)/r of one that lay along the flow at first.
    const double x = 2 * pi * t / period;
    const double exact = std::atan2(std::sin(x), r * std::cos(x));
    return std::pair{angle, exact};
  };
  // Each step turns by the spin of its beginning: an error of first order.
  const auto [coarse, exact_coarse] = turned(period / 1000);
  const auto [fine, exact_fine] = turned(period / 4000);
  CHECK(std::abs(coarse - exact_coarse) < 0.02);
  CHECK(std::abs(fine - exact_fine) < 0.3 * std::abs(coarse - exact_coarse));
}
