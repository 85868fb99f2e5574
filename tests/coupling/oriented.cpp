// silt - BSD-3-Clause, see LICENSE
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include <silt/coupling/lift/ellipsoid_torque.hpp>
#include <silt/fluid.hpp>

#include "near.hpp"

namespace oriented_test {

using silt::EllipsoidTorque;
using silt::FormInFlow;
using silt::HoelzerSommerfeld;
using silt::InclinedLift;
using silt::InFluid;
using silt::OrientedDrag;
using silt::Quaternion;
using silt::SlowEllipsoid;
using silt::SuperEllipsoid;
using silt::Vec3d;

namespace {

constexpr double pi = std::numbers::pi;

/// A particle in air with so much slip.
InFluid in_air(const FormInFlow* form, const Quaternion& q, const Vec3d& slip, double eps = 1) {
  InFluid at{};
  at.density = 1.2, at.viscosity = 1.8e-5, at.voidage = eps, at.diameter = 2e-3;
  at.volume = silt::Sphere::volume(1e-3), at.mass = 2500 * at.volume, at.dt = 1e-4;
  at.slip = slip, at.orientation = q, at.body = form;
  return at;
}
double reynolds(const InFluid& at) {
  return at.voidage * at.density * norm(at.slip) * at.diameter / at.viscosity;
}
Vec3d drag_on(const auto& law, const InFluid& at) {
  return 3 * pi * at.viscosity * at.diameter * at.voidage * law.normalised(at, reynolds(at)) *
         at.slip;
}
template <class Call>
bool refused(const Call& call, const std::string& words) {
  try {
    call();
  } catch (const silt::InputError& error) {
    return std::string(error.what()).find(words) != std::string::npos;
  }
  return false;
}

/// A heavy body in a slow step: the torque of now.
InFluid in_shear(const FormInFlow* form, const Quaternion& q, double rate) {
  InFluid at{};
  at.density = 1000, at.viscosity = 0.1, at.voidage = 1, at.diameter = 2e-4;
  at.mass = 1e9, at.dt = 1e-3, at.orientation = q, at.body = form;
  at.curl = {0, rate, 0}, at.strain = {0, 0.5 * rate, 0};  // u = rate z e_x
  return at;
}

/// One body in the middle of a flow. All tests share this program: it is what costs to compile.
auto alone(const silt::FlowSolver& flow, const SuperEllipsoid& shape, const Quaternion& turned,
           double radius, double step) {
  silt::Particles<SuperEllipsoid> bodies;
  bodies.add({.form = bodies.add_form(shape),
              .position = flow.grid().box().min + 0.5 * flow.grid().box().extent(),
              .orientation = turned,
              .radius = radius,
              .density = 1100});
  silt::CoupledFlow fluid{SlowEllipsoid{},
                          silt::Unresolved{.share = silt::Unresolved::Share::Centre}, flow,
                          SlowEllipsoid{}, EllipsoidTorque{}};
  fluid.steps = 1;
  silt::Simulation sim{std::move(bodies), silt::Contacts<silt::HertzMindlin>{{1e6, 0.3, 0.8, 0.3}},
                       fluid};
  sim.time_step = step;
  sim.guard.max_time_step = 1e9;  // it meets nobody
  return sim;
}

}  // namespace

TEST_CASE("oriented: drag is the law's for the silhouette along the slip, in any frame") {
  const SuperEllipsoid body{2.5, 1, 1};
  const auto form = silt::form_in_flow(body);
  const Quaternion q = silt::rotation_about({0.36, 0.48, 0.8}, 1.1);
  for (const Vec3d& u : {Vec3d{1, 0, 0}, Vec3d{0, 0.6, 0.8}, normalised(Vec3d{1, -2, 0.5})}) {
    const auto at = in_air(&form, q, 0.7 * rotate(q, u), 0.6);
    const auto shape = silt::shape_in_flow(body, u);
    const double Re = reynolds(at);
    // 1e-3: of the mean area across the flow, of which the lengthwise sphericity is made.
    CHECK(OrientedDrag<>{}.normalised(at, Re) ==
          near(silt::with_di_felice(HoelzerSommerfeld(), shape, 0.6, Re)).epsilon(1e-3));
    CHECK(OrientedDrag<silt::Ganser, silt::Beetstra>{}.normalised(at, Re) ==
          near(silt::scaled_by_sphere(silt::Beetstra(), silt::Ganser(), shape, 0.6, Re)));
  }
  // Broadside on it is held more than end on; a sphere is a sphere's shape in any law.
  const auto end = in_air(&form, {}, {1, 0, 0}), side = in_air(&form, {}, {0, 1, 0});
  CHECK(norm(drag_on(OrientedDrag<>{}, side)) > 1.5 * norm(drag_on(OrientedDrag<>{}, end)));
  const auto ball = in_air(nullptr, {}, {0, 1, 0});
  CHECK(OrientedDrag<>{}.normalised(ball, 50) ==
        near(HoelzerSommerfeld().over_stokes(silt::ShapeInFlow<double>{}, 50.0)));
  CHECK(std::isfinite(OrientedDrag<>{}.normalised(in_air(&form, {}, {0, 0, 0}), 0)));
}

TEST_CASE("oriented: lift of an inclined body") {
  const auto form = silt::form_in_flow(SuperEllipsoid{2.5, 1, 1});
  const double angle = 0.6;
  const auto at = in_air(&form, silt::rotation_about({0, 1, 0}, -angle), {0.5, 0, 0});  // nose up
  const Vec3d L = InclinedLift<>{}.force_on(at);
  // (C_D90 - C_D0) sin alpha cos alpha of drag/orientation.hpp, by its own formula.
  const double Re = reynolds(at);
  const auto C = [&](const Vec3d& u) {
    return silt::lone_body_drag(HoelzerSommerfeld(), form.along(u), Re);
  };
  const Vec3d n{std::cos(angle), 0, std::sin(angle)};
  const Vec3d both =
      silt::axisymmetric_force(at.diameter, at.density, at.slip, n, C({1, 0, 0}), C({0, 1, 0}));
  CHECK(std::abs(L.x) < 1e-12 * std::abs(L.z));
  CHECK(L.z == near(both.z).epsilon(1e-9));
  CHECK(L.z < 0);  // n n.W is held less than the rest: away from the nose, as drag pulls along x
  CHECK(std::abs(L.y) < 1e-12 * std::abs(L.z));
  // None along a principal axis, of a sphere, of a cube, or without slip.
  const auto cube = silt::form_in_flow(SuperEllipsoid{1, 1, 1, 8, 8});
  CHECK(norm(InclinedLift<>{}.force_on(in_air(&form, {}, {0, 0, 0.5}))) == 0);
  CHECK(norm(InclinedLift<>{}.force_on(in_air(nullptr, {}, {0.1, 0, 0.5}))) == 0);
  CHECK(norm(InclinedLift<>{}.force_on(in_air(&cube, {}, {0.1, 0, 0.5}))) < 1e-6 * norm(L));
  CHECK(norm(InclinedLift<>{}.force_on(in_air(&form, {}, {0, 0, 0}))) == 0);
}

TEST_CASE("oriented: Zastawny's drag, lift and pitching torque by the body's own axis") {
  const auto& fit = silt::zastawny_ellipsoid_5_2;
  const auto form = silt::form_in_flow(SuperEllipsoid{1, 2.5, 1});  // its axis is y
  const double angle = 0.7;
  const auto at = in_air(&form, silt::rotation_about({0, 0, 1}, angle), {0, 0.5, 0});
  const Vec3d n{-std::sin(angle), std::cos(angle), 0};
  const double Re = reynolds(at), s = std::sin(angle), c = std::cos(angle);
  const silt::ZastawnyLift lift{fit};
  const Vec3d all = drag_on(silt::ZastawnyDrag{fit}, at) + lift.force_on(at);
  const Vec3d exact = silt::drag_and_lift(at.diameter, at.density, at.slip, n, fit.drag(Re, s, c),
                                          fit.lift(Re, s, c));
  CHECK(norm(all - exact) < 1e-9 * norm(exact));
  // The torque turns the axis away from the slip, about z: the angle grows.
  CHECK(lift.torque_on(at).z == near(pi / 16 * 1.2 * 8e-9 * 0.25 * fit.torque(Re, s, c)));
  CHECK(lift.torque_on(at).z > 0);
  // In slow flow drag is proportional to the slip: C_D Re of where the fit ends.
  const silt::ZastawnyDrag drag{fit};
  CHECK(drag.normalised(at, 1e-6) == drag.normalised(at, 0.05));
  drag.check_form(&form);
  const auto round = silt::form_in_flow(SuperEllipsoid{1, 1, 1});
  CHECK(refused([&] { drag.check_form(&round); }, "ZastawnyDrag is a fit of a body 2.5 times as"));
  CHECK(refused([&] { lift.check_form(nullptr); }, "these particles are spheres"));
}

TEST_CASE("oriented: a disc that falls on edge is 81 % faster than broadside on (docs/limits.md)") {
  // Of one weight, C_D Re^2: what it costs that no torque turns it. By the law alone, by bisection.
  const auto form = silt::form_in_flow(SuperEllipsoid{5, 5, 1});
  const auto C = [&](const Vec3d& u, double Re) {
    return silt::lone_body_drag(HoelzerSommerfeld(), form.along(u), Re);
  };
  for (const auto& [Re, faster] : {std::pair{100.0, 0.81}, {10.0, 0.37}}) {
    const double weight = C({0, 0, 1}, Re) * Re * Re;
    double low = Re, high = 10 * Re;
    while (high > low * (1 + 1e-9)) {
      const double on_edge = std::sqrt(low * high);
      (C({1, 0, 0}, on_edge) * on_edge * on_edge < weight ? low : high) = on_edge;
    }
    CHECK(std::abs(low / Re - 1 - faster) < 0.01);
  }
}

TEST_CASE(
    "oriented: Zastawny's disc: broadside on it is held more; inclined it glides as it lies") {
  const auto disc = silt::form_in_flow(SuperEllipsoid{5, 5, 1});  // its axis is z
  const silt::ZastawnyDrag drag{silt::zastawny_disc};
  const silt::ZastawnyLift lift{silt::zastawny_disc};
  drag.check_form(&disc);
  const auto flat = in_air(&disc, {}, {0, 0, 0.5}), edge = in_air(&disc, {}, {0.5, 0, 0});
  CHECK(norm(drag_on(drag, flat)) > 1.5 * norm(drag_on(drag, edge)));
  // As the exact solution of slow flow has it, the force across the slip is towards the axis: of an
  // upward flow on a disc whose axis leans to +x, to +x. To -x was the error of a disc taken as a
  // rod. Drag is upwards and the torque turns the axis into the flow, broadside on.
  const auto leaning = in_air(&disc, silt::rotation_about({0, 1, 0}, 0.5), {0, 0, 0.5});
  const Vec3d exact = silt::SlowEllipsoid{}.force_on(leaning), L = lift.force_on(leaning);
  CHECK(exact.x > 0);
  CHECK(L.x > 0);
  CHECK(std::abs(L.z) < 1e-12 * L.x);
  CHECK(lift.torque_on(leaning).y < 0);
}

TEST_CASE("ellipsoid_torque: Jeffery's torques on a spheroid that lies still in a shear") {
  const auto form = silt::form_in_flow(SuperEllipsoid{3, 1, 1});
  // Along and across the flow the spin that would have no torque is rate/(1 + r^2), r^2 times that.
  const EllipsoidTorque law;
  const auto along = in_shear(&form, {1, 0, 0, 0}, 2);
  const double C = pi * 0.1 * 8e-12 * form.spin_resistance.y;
  CHECK(law.torque_on(along).y == near(C * 2 / 10).epsilon(1e-5));
  const auto across = in_shear(&form, silt::rotation_about({0, 1, 0}, pi / 2), 2);
  CHECK(law.torque_on(across).y == near(C * 2 * 9 / 10).epsilon(1e-5));
  // Along the vorticity it rolls at half of the rate.
  const auto rolls = in_shear(&form, silt::rotation_about({0, 0, 1}, pi / 2), 2);
  const double C_axis = pi * 0.1 * 8e-12 * form.spin_resistance.x;
  CHECK(law.torque_on(rolls).y == near(C_axis * 1).epsilon(1e-5));
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
    auto sim = alone(flow, SuperEllipsoid{r, 1, 1}, {}, 3e-4, step);
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

TEST_CASE("oriented: a spheroid that lies askew settles askew, as in Stokes flow") {
  // Oberbeck's resistances, by S. Kim, S. J. Karrila, Microhydrodynamics (1991), table 3.4, over
  // Stokes' of the sphere of equal volume.
  const double r = 2.5, e = std::sqrt(1 - 1 / (r * r)), L = std::log((1 + e) / (1 - e));
  const double size = std::pow(r, 2.0 / 3);  // a over the radius of equal volume
  const double along = size * 8.0 / 3 * e * e * e / (-2 * e + (1 + e * e) * L);
  const double across = size * 16.0 / 3 * e * e * e / (2 * e + (3 * e * e - 1) * L);
  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {1, 1, 1}}, {3, 3, 3}, {true, true, true}),
                        {1000, 0.1});
  const double angle = pi / 4;
  auto sim =
      alone(flow, SuperEllipsoid{r, 1, 1}, silt::rotation_about({0, 1, 0}, -angle), 5e-4, 1e-3);
  sim.gravity = {0, 0, -9.81};
  sim.run(0.02);
  const double d = 2 * 5e-4 / size, V = silt::Sphere::volume(d / 2);
  const double force = 100 * 9.81 * V / (3 * pi * 0.1 * d);  // downwards, over Stokes' drag
  const Vec3d n{std::cos(angle), 0, std::sin(angle)}, across_n{-n.z, 0, n.x};
  const Vec3d v = sim.velocity(0);
  // 2e-3: the liquid in the cell of the body moves with it a little.
  CHECK(dot(v, n) == near(-force * n.z / along).epsilon(2e-3));
  CHECK(dot(v, across_n) == near(-force * n.x / across).epsilon(2e-3));
  CHECK(std::abs(v.x) > 0.05 * std::abs(v.z));
  CHECK(norm(rotate(sim.orientation(0), {1, 0, 0}) - n) < 1e-9);  // in Stokes flow it does not turn
}

}  // namespace oriented_test
