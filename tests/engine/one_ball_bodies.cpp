// silt - BSD-3-Clause, see LICENSE
// Bodies of one ball do as spheres by each law and rolling model, at walls of planes and of
// triangles, and their ledgers close.
//   a law that gets other radii, masses or spins from bodies; forces at a distance that lists of
//   bodies miss; the last step of a contact with a wall that is not booked
#include <engine/support.hpp>

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <type_traits>

#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/cohesion/area_cohesion.hpp>
#include <silt/contact/cohesion/cohesive.hpp>
#include <silt/contact/cohesion/dmt.hpp>
#include <silt/contact/cohesion/van_der_waals.hpp>
#include <silt/contact/cohesion/viscous_bridge.hpp>
#include <silt/contact/dcdem.hpp>
#include <silt/contact/hertz_damped.hpp>
#include <silt/contact/jkr.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/contact/rolling/own.hpp>
#include <silt/contact/rolling/twisting.hpp>
#include <silt/contact/softened.hpp>
#include <silt/core/random.hpp>
#include <silt/shape/multi_sphere.hpp>

#include "near.hpp"

namespace one_ball_bodies_test {

using namespace engine_test;
using silt::Cohesive;
using silt::Contacts;
using silt::MultiSphere;

namespace {

/// What 27 balls of three sizes do in a box with a bed of 1.2 layers.
struct Outcome {
  std::vector<ParticleBits> all;
  silt::EnergyBalance energy;
};
void add_forms(silt::Particles<Sphere>&, std::span<const double>) {}
void add_forms(silt::Particles<MultiSphere>& balls, std::span<const double> radii) {
  for (const double r : radii) balls.add_form(MultiSphere{.balls = {{{0, 0, 0}, r}}});
}
template <class Shape, class ContactsType>
Outcome thrown(const ContactsType& contacts, bool planes) {
  constexpr double radii[3] = {0.5e-3, 0.4e-3, 0.6e-3}, width = 3.75e-3;
  silt::Particles<Shape> balls;
  add_forms(balls, radii);
  silt::Random random(5);
  const auto any = [&] { return 2 * random.uniform() - 1; };
  const auto vector = [&] {
    const double x = any(), y = any(), z = any();
    return Vec3d{x, y, z};
  };
  for (std::size_t k = 0; k < 27; ++k) {
    const Vec3d cell{double(k % 3) + 0.5, double(k / 3 % 3) + 0.5, double(k / 9) + 0.5};
    const Vec3d x = width / 3 * cell + 0.02e-3 * vector(), v = 0.2 * vector(), w = 200 * vector();
    if constexpr (std::is_same_v<Shape, Sphere>)
      balls.add({.position = x,
                 .radius = radii[k % 3],
                 .density = 2500,
                 .velocity = v,
                 .angular_velocity = w});
    else
      balls.add(
          {.form = k % 3, .position = x, .density = 2500, .velocity = v, .angular_velocity = w});
  }
  silt::Simulation sim{std::move(balls), contacts, silt::EnergyLedger{}};
  sim.threads = 1, sim.time_step = 1e-6, sim.gravity = {0, 0, -9.81};
  const Vec3d top{width, width, 20e-3};
  if (planes)
    sim.add_wall(silt::box({0, 0, 0}, top), contacts.material(0));
  else
    sim.add_wall(silt::box_mesh({0, 0, 0}, top), contacts.material(0));
  sim.run(4e-3);
  return {bits(sim), sim.energy()};
}

template <class ContactsType>
void check_as_spheres(const std::string& law, const ContactsType& contacts) {
  CAPTURE(law);
  constexpr double scale[3] = {1e-3, 0.2, 200};  // [m], [m/s], [rad/s]
  for (const bool planes : {true, false}) {
    CAPTURE(planes);
    const Outcome a = thrown<Sphere>(contacts, planes), b = thrown<MultiSphere>(contacts, planes);
    REQUIRE(a.all.size() == b.all.size());
    double most = 0;
    for (std::size_t k = 0; k < a.all.size(); ++k)
      for (std::size_t c = 0; c < 9; ++c)
        most = std::max(most, std::abs(a.all[k].values[c] - b.all[k].values[c]) / scale[c / 3]);
    CHECK(most < 1e-9);  // rounding, enlarged by some impacts
    // 100 to 400 steps a contact: second order. A last step that is not booked leaves up to 1e-4.
    for (const Outcome* one : {&a, &b})
      CHECK(std::abs(one->energy.residual()) < 4e-5 * one->energy.turned_over);
    CHECK(b.energy.dissipated() == near(a.energy.dissipated()).epsilon(1e-5));
  }
}

TEST_CASE("bodies of one ball do as spheres to 1e-9: damped laws, softening, areas") {
  check_as_spheres("HertzMindlin", Contacts<HertzMindlin>{rubber});
  check_as_spheres(
      "HertzDamped",
      Contacts<silt::HertzDamped<silt::KuwabaraKono>>{
          {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .dissipation = 2e-5, .friction = 0.5}});
  check_as_spheres(
      "Dcdem",
      Contacts<silt::Dcdem>{
          {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.7, .friction = 0.5}});
  check_as_spheres("Softened",
                   Contacts<silt::Softened<HertzMindlin>>{{rubber, 0.45e-3, 0.1, 0.15}});
  check_as_spheres("AreaCohesion", Contacts<Cohesive<HertzMindlin, silt::AreaCohesion>>{
                                       {rubber, {.energy_density = 3e4}}});
  check_as_spheres(
      "Dmt", Contacts<Cohesive<HertzMindlin, silt::Dmt>>{{rubber, {.work_of_adhesion = 0.05}}});
}

TEST_CASE("bodies of one ball do as spheres to 1e-9: laws with a range, rolling models") {
  check_as_spheres("Jkr", Contacts<silt::Jkr>{{.youngs_modulus = 1e6,
                                               .poisson_ratio = 0.3,
                                               .work_of_adhesion = 0.05,
                                               .restitution = 0.7,
                                               .friction = 0.5}});
  check_as_spheres("VanDerWaals",
                   Contacts<Cohesive<HertzMindlin, silt::VanDerWaals>>{
                       {rubber, {.hamaker = 1e-12, .closest = 3e-6, .cutoff = 3e-5}}});
  check_as_spheres("ViscousBridge",
                   Contacts<Cohesive<HertzMindlin, silt::ViscousBridge>>{{rubber,
                                                                          {.surface_tension = 0.072,
                                                                           .contact_angle = 0.3,
                                                                           .volume = 1e-12,
                                                                           .viscosity = 1e-2,
                                                                           .roughness = 1e-5}}});
  check_as_spheres("RollingEpsd and Twisting",
                   Contacts<HertzMindlin, silt::Both<silt::RollingEpsd, silt::Twisting>>{
                       rubber, {{.rolling_friction = 0.1}, {.twisting_friction = 0.1}}});
  check_as_spheres("RollingOwn",
                   Contacts<HertzMindlin, silt::RollingOwn>{rubber, {.rolling_friction = 0.1}});
}

}  // namespace
}  // namespace one_ball_bodies_test
