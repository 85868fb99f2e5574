// silt - BSD-3-Clause, see LICENSE
// The guard of the rate: what particles can do in their contacts against the time step.
#include <cmath>
#include <numbers>

#include <engine/support.hpp>
#include <silt/boundary/domain.hpp>
#include <silt/contact/jkr.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/contact/rolling/directional.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/engine/checks/contact_rates.hpp>

#include "near.hpp"

namespace contact_rates_test {

namespace {

using namespace engine_test;
using silt::Contacts;
using silt::LinearSpring;
using silt::Particles;

constexpr double radius = 1e-3, density = 2500;  // [m], [kg/m3]
const double mass = density * Sphere::volume(radius);
/// Linear springs are in a box of one type throughout; here it repeats far away.
const silt::PeriodicBox room{{{-1, -1, -1}, {2, 2, 2}}, {false, true, false}};

template <class Sim>
auto rates(const Sim& sim) {
  return silt::detail::ContactRates<typename Sim::Engine, typename Sim::Domain>(
      sim.engine(), sim.domain(), 0, sim.step_length());
}

/// Spheres that are at rest at overlaps, with springs so stiff and steps so short that they stay.
template <class Law, class... Policies>
auto at_rest(const typename Law::Material& m, const std::vector<Vec3d>& places,
             Policies... policies) {
  Particles<Sphere> p;
  for (const auto& x : places) p.add({.position = x, .radius = radius, .density = density});
  silt::Simulation sim{std::move(p), Contacts<Law>{m}, policies...};
  sim.threads = 1;
  sim.time_step = 1e-9;
  return sim;
}

}  // namespace

TEST_CASE(
    "contact_rates: springs of known stiffness and damping between two spheres and at a wall") {
  const double k = 1e4, e = 0.3;  // [N/m], [-]
  const double zeta = silt::damping_ratio(e, silt::DampingEnd::ZeroForce);
  const auto expected = [&](double inv_m) {
    // omega^2 = k/m*, c/m* = 2 zeta omega
    const double omega = std::sqrt(k * inv_m);
    return 1e-9 * (omega + zeta * omega);
  };
  auto pair = at_rest<LinearSpring>({k, e}, {{0, 0, 0}, {0, 0, 1.9e-3}, {0, 0, 1}}, room);
  pair.run(0);
  CHECK(rates(pair).rate(pair.find(0)) == near(expected(2 / mass)).epsilon(1e-6));
  CHECK(rates(pair).rate(pair.find(1)) == near(expected(2 / mass)).epsilon(1e-6));
  CHECK(rates(pair).rate(pair.find(2)) == 0);

  auto on_wall = at_rest<LinearSpring>({k, e}, {{0, 0, 0.9e-3}}, room);
  on_wall.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {k, e});
  on_wall.run(0);
  CHECK(rates(on_wall).rate(0) == near(expected(1 / mass)).epsilon(1e-6));
}

TEST_CASE("contact_rates: a Hertz contact has the stiffness 2 E* sqrt(R* d), a sticky one more") {
  const double depth = 1e-5, E = 1e6 / (2 * (1 - 0.09));
  auto hertz = at_rest<HertzMindlin>({1e6, 0.3, 1.0, 0.5}, {{0, 0, 0}, {0, 0, 2e-3 - depth}});
  hertz.run(0);
  const double omega = std::sqrt(2 * E * std::sqrt(radius / 2 * depth) * 2 / mass);
  CHECK(rates(hertz).rate(0) == near(1e-9 * omega).epsilon(1e-5));
  auto sticky = at_rest<silt::Jkr>({1e6, 0.3, 1.0, 1.0, 0.5}, {{0, 0, 0}, {0, 0, 2e-3 - depth}});
  sticky.run(0);
  CHECK(rates(sticky).rate(0) > 1.05e-9 * omega);  // its contact area is larger
}

TEST_CASE(
    "contact_rates: of a face-centred cubic lattice it is the highest frequency, sqrt(8 k/m)") {
  const double k = 1e4, a = 1.98e-3 * std::sqrt(2.0);  // [m] edge of a cell
  std::vector<Vec3d> places;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z)
        for (const Vec3d& b : {Vec3d{0, 0, 0}, Vec3d{a / 2, a / 2, 0}, Vec3d{a / 2, 0, a / 2},
                               Vec3d{0, a / 2, a / 2}})
          places.push_back(Vec3d{x * a, y * a, z * a} + b);
  auto sim = at_rest<LinearSpring>(
      {k, 1.0}, places, silt::PeriodicBox{{{0, 0, 0}, {3 * a, 3 * a, 3 * a}}, {true, true, true}});
  sim.run(0);
  for (std::size_t i = 0; i < sim.rows(); i += 7)
    CHECK(rates(sim).rate(i) == near(1e-9 * std::sqrt(8 * k / mass)).epsilon(1e-6));
}

TEST_CASE("contact_rates: a light sphere under a heavy one swings alone") {
  Particles<Sphere> p;
  p.add({.position = {0, 0, 0}, .radius = radius, .density = density});
  p.add({.position = {0, 0, 0.1 + 0.99e-3}, .radius = 0.1, .density = density});
  silt::Simulation sim{std::move(p), Contacts<LinearSpring>{{1e4, 1.0}}, room};
  sim.threads = 1, sim.time_step = 1e-9;
  sim.run(0);
  // 1/m + 1/sqrt(m M), M = 1e6 m; in truth 1/m + 1/M.
  CHECK(rates(sim).rate(sim.find(0)) == near(1e-9 * std::sqrt(1e4 / mass * 1.001)).epsilon(1e-6));
}

TEST_CASE("contact_rates: resistance to rolling counts with the inertia of the spheres") {
  const double k = 1e4, mu = 5, eta = 0.4;
  Particles<Sphere> p;
  p.add({.position = {0, 0, 0.9e-3}, .radius = radius, .density = density});
  silt::Simulation sim{std::move(p), Contacts<LinearSpring, silt::RollingEpsd>{
                                         {k, 1.0}, {.rolling_friction = mu, .damping = eta}}};
  sim.threads = 1, sim.time_step = 1e-9;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {k, 1.0});
  sim.run(0);
  // k_r = 2.25 k mu^2 r^2, C = 2 eta sqrt(1.4 m r^2 k_r), over the inertia 0.4 m r^2
  const double omega = std::sqrt(2.25 * k * mu * mu / (0.4 * mass));
  CHECK(rates(sim).rate(0) == near(1e-9 * omega * (1 + eta * std::sqrt(3.5))).epsilon(1e-6));
}

// The guard stopped beds at the step that silt had chosen: it took what follows the step for a
// dashpot.
TEST_CASE(
    "contact_rates: resistance that follows the step does not count, with twelve neighbours "
    "either") {
  const double side = 2 * std::numbers::sqrt2 * radius * (1 - 1e-4);  // of a face-centred cell
  std::vector<Vec3d> places;
  for (int cell = 0; cell < 27; ++cell)
    for (const Vec3d& x :
         {Vec3d{0, 0, 0}, Vec3d{0, 0.5, 0.5}, Vec3d{0.5, 0, 0.5}, Vec3d{0.5, 0.5, 0}})
      places.push_back(side *
                       (x + Vec3d{double(cell % 3), double(cell / 3 % 3), double(cell / 9)}));
  Particles<Sphere> p;
  for (std::size_t k = 0; k < places.size(); ++k)
    p.add({.position = places[k],
           .radius = radius,
           .density = density,
           .angular_velocity = {0, 0, 1e-6 * std::sin(static_cast<double>(k * k))}});  // [rad/s]
  silt::Simulation sim{
      std::move(p),
      Contacts<silt::HertzMindlin, silt::RollingDirectional>{
          {.youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.5},
          {0.1}},
      silt::PeriodicBox{{{0, 0, 0}, {3 * side, 3 * side, 3 * side}}, {true, true, true}}};
  sim.time_step = 1e-6;
  // Contacts pass on rotation, but keep their sum: what differs from the mean is to die.
  const auto differences = [&] {
    Vec3d mean{0, 0, 0};
    for (std::size_t k = 0; k < sim.rows(); ++k)
      mean += sim.angular_velocity(k) * (1.0 / static_cast<double>(sim.rows()));
    double most = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      most = std::max(most, norm(sim.angular_velocity(k) - mean));
    return most;
  };
  const double first = differences();
  sim.run(300e-6);
  CHECK(differences() < first);  // it overshoots at first, then dies
  CHECK(rates(sim).rate(0) < 0.2);
}

TEST_CASE("contact_rates: a grain that slow plates squeeze stops the run before it trembles") {
  // At 1 mm/s contacts last long, and the limit of the time step is far off.
  const auto squeeze = [](double max_rate) {
    Particles<Sphere> p;
    p.add({.position = {0, 0, radius}, .radius = radius, .density = density});
    const HertzMindlin::Material m{1e8, 0.3, 1.0, 0.5};
    silt::Simulation sim{std::move(p), Contacts<HertzMindlin>{m}};
    sim.threads = 1;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, m, silt::translation({0, 0, 0.5e-3}));
    sim.add_wall(silt::Plane{{0, 0, 2 * radius}, {0, 0, -1}}, m,
                 silt::translation({0, 0, -0.5e-3}));
    sim.run(0);
    sim.time_step = 0.9 * *sim.time_step_limit(0.5e-3);
    sim.guard.max_rate = max_rate;
    return [sim = std::move(sim)]() mutable {
      try {
        sim.run(0.2);
        return std::string();
      } catch (const silt::SimulationError& e) {
        return std::string(e.what());
      }
    }();
  };
  CHECK(has_words(squeeze(1.25),
                  {"the contacts of particle 0 near (0, 0, 0.001",
                   "too stiff or too strongly damped for the time step", "rate 1.",
                   "guard.max_rate = 1.25", "set Simulation::time_step to less than"}));
  // Where it is lifted, the grain gets speed out of nothing, and the limit of the time step sees
  // it.
  CHECK(has_words(squeeze(1e9), {"above its limit", "at the largest speed", "(of particle "}));
}

TEST_CASE("contact_rates: limits that make no sense are refused by name") {
  auto sim = at_rest<HertzMindlin>(rubber, {{0, 0, 0}});
  sim.guard.max_rate = 0;
  CHECK(has_words(refusal<silt::InputError>([&] { sim.run(0); }), {"Guard.max_rate = 0 [-]"}));
  sim.guard.max_rate = 1, sim.guard.max_travel = -1;
  CHECK(has_words(refusal<silt::InputError>([&] { sim.run(0); }), {"Guard.max_travel = -1 [-]"}));
}

}  // namespace contact_rates_test
