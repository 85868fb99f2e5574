// silt - BSD-3-Clause, see LICENSE
// Spheres with another moment of inertia than a solid one, f = I/(m r^2), against closed forms.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <silt/boundary/cylinder.hpp>
#include <silt/boundary/triangle_mesh.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/contact/rolling/twisting.hpp>
#include <silt/coupling/fluid_force.hpp>

#include "boundary/support.hpp"
#include "physics/support.hpp"

namespace hollow_spheres_test {

namespace {

using namespace silt;
using namespace physics_test;

/// A thin shell, as a user writes it.
struct HollowSphere : Sphere {
  static constexpr double inertia_factor() { return 2.0 / 3.0; }
};
/// Of an inertia that is known at run time.
struct LayeredSphere : Sphere {
  static inline double f = 0.4;
  static double inertia_factor() { return f; }
};
static_assert(Shape<HollowSphere> && Shape<LayeredSphere>);

using Rolling = Both<RollingEpsd, Twisting>;
using Law = LinearSpringFriction;
constexpr double radius = 1e-3, density = 2500, stiffness = 1e4;  // [m], [kg/m3], [N/m]
const double mass = mass_of(radius, density);

/// A sphere that rests on a plane at z = 0 and has this motion; `g_x` [m/s2] along the plane.
template <class S = LayeredSphere>
auto on_plane(const Rolling::Pair& rolling, double g_x, double speed, const Vec3d& spin,
              Law::Material m = {stiffness, 1.0, 0.8}) {
  Particles<S> one;
  one.add({.position = {0, 0, radius - mass * g / stiffness},
           .radius = radius,
           .density = density,
           .velocity = {speed, 0, 0},
           .angular_velocity = spin});
  Simulation sim{std::move(one), Contacts<Law, Rolling>{m, rolling}};
  sim.gravity = {g_x, 0, -g};
  sim.threads = 1;
  sim.guard.max_rate = 1e9;  // the step is chosen below
  return sim;
}
const Surfaces plane = Plane{{0, 0, 0}, {0, 0, 1}};

/// Damping ratio of a free oscillation q, of its step-by-step values: from the decay of the zero
/// crossings' slopes, half a period apart.
double damping_ratio_of(const std::vector<double>& rate) {
  // The rate q' of a damped oscillation has extrema that fall by exp(-zeta/sqrt(1 - zeta^2) pi).
  std::vector<double> peaks;
  for (std::size_t k = 1; k + 1 < rate.size(); ++k) {
    const double a = std::abs(rate[k - 1]), b = std::abs(rate[k]), c = std::abs(rate[k + 1]);
    if (b > a && b >= c) peaks.push_back(b + (a - c) * (a - c) / (16 * b - 8 * (a + c)));
  }
  REQUIRE(peaks.size() >= 3);
  const double L = std::log(peaks[1] / peaks[2]);
  return L / std::hypot(pi, L);
}

}  // namespace

TEST_CASE(
    "hollow spheres: roll down a plane, a cylinder and a mesh at g sin(a)/(1 + 2/3), within 1e-3") {
  const double tangent = 0.2, cosine = 1 / std::hypot(1, tangent), sine = tangent * cosine;
  const Surfaces slopes[] = {plane, Cylinder{{-1, 0, 0.02}, {1, 0, 0.02}, 0.02, Side::Inside},
                             TriangleMesh(boundary_test::box_soup({-1, -1.3, -1}, {1, 1, 0}))};
  for (const Surfaces& slope : slopes) {
    auto sim = on_plane<HollowSphere>({}, 0, 0, {0, 0, 0});
    sim.add_wall(slope, {stiffness, 1.0, 0.8});
    sim.gravity = {g * sine, 0, -g * cosine};
    sim.time_step = 1e-6;
    sim.run(5e-3);
    const double early = sim.velocity(0).x;
    sim.run(45e-3);
    // The contact rocks on its spring about the mean by 1e-4 of the speed gained.
    CHECK(near_relative((sim.velocity(0).x - early) / 45e-3, g * sine / (1 + 2.0 / 3), 1e-3));
    // ... and the slip by g sin(a) 1.9/sqrt(2.5 k_t/m) = 7e-5 m/s.
    CHECK(std::abs(sim.angular_velocity(0).y * radius - sim.velocity(0).x) < 8e-5);
  }
}

TEST_CASE("hollow spheres: one that slides ends up rolling with v0/(1 + f), whatever f") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> factor(0.1, 2.0 / 3);
  for (int k = 0; k < 6; ++k) {
    LayeredSphere::f = factor(random);
    auto sim = on_plane({}, 0, 0.1, {0, 0, 0}, {stiffness, 1.0, 0.4});
    sim.add_wall(plane, {stiffness, 1.0, 0.4});
    sim.time_step = 2e-6;
    sim.run(0.05);
    CAPTURE(LayeredSphere::f);
    // The contact swings in its tangential spring, undamped, when it begins to stick.
    CHECK(near_relative(sim.velocity(0).x, 0.1 / (1 + LayeredSphere::f), 5e-3));
  }
}

TEST_CASE("hollow spheres: resistance to rolling and twisting is damped by the ratio asked for") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> factor(0.1, 2.0 / 3), ratio(0.1, 0.4);
  for (int k = 0; k < 6; ++k) {
    LayeredSphere::f = k == 0 ? 2.0 / 3 : factor(random);
    const double eta = ratio(random), mu = 0.02;
    CAPTURE(LayeredSphere::f);
    CAPTURE(eta);
    const Law::Material rough{stiffness, 0.2, 0.8};  // the tangential spring comes to rest soon
    const double f = LayeredSphere::f, depth = mass * g / stiffness;
    {
      // Rolls on the spot: (I + m r^2) x''= -k_r x - C_r x', k_r = 2.25 k_n (mu r)^2.
      const double omega = std::sqrt(2.25 * stiffness * mu * mu / ((1 + f) * mass));
      const double w0 = 0.2 * mu * g / ((1 + f) * radius * omega);  // a fifth of the limit
      auto sim = on_plane({{mu, eta}, {}}, 0, w0 * radius, {0, w0, 0}, rough);
      sim.add_wall(plane, rough);
      sim.time_step = std::min(0.01 / omega, 5e-6);
      std::vector<double> rate;
      sim.run(12 / omega, [&](const auto& s) { rate.push_back(s.angular_velocity(0).y); });
      // The tangential spring gives way a little, and 1 % of a radian a step.
      CHECK(damping_ratio_of(rate) == near(eta).epsilon(0.02));
    }
    {
      // Twists on the spot: I w' = -k_w x - C_w w, k_w = k_n r d. Limit: 3 pi/16 mu_w a F_n.
      const double kw = stiffness * radius * depth, inertia = f * mass * radius * radius;
      const double omega = std::sqrt(kw / inertia);
      const double limit = 3 * pi / 16 * std::sqrt(radius * depth) * mass * g;
      const double w0 = 0.2 * limit / (inertia * omega);
      auto sim = on_plane({{}, {1.0, eta}}, 0, 0, {0, 0, w0});
      sim.add_wall(plane, {stiffness, 1.0, 0.8});
      sim.time_step = std::min(0.01 / omega, 5e-6);
      std::vector<double> rate;
      sim.run(12 / omega, [&](const auto& s) { rate.push_back(s.angular_velocity(0).z); });
      CHECK(damping_ratio_of(rate) == near(eta).epsilon(0.02));
    }
  }
}

TEST_CASE("hollow spheres: two that meet obliquely and stick part by the closed form of the slip") {
  // Springs without damping: the slip swings with k_t (1 + 1/f)/m* while the normal spring swings
  // half a period: u_t -> u_t cos(pi sqrt(shear_ratio (1 + 1/f))).
  std::mt19937 random(3);
  std::uniform_real_distribution<double> factor(0.2, 2.0 / 3), shear(0.1, 0.6);
  for (int k = 0; k < 6; ++k) {
    LayeredSphere::f = k == 0 ? 2.0 / 3 : factor(random);
    const double f = LayeredSphere::f, ratio = shear(random), v = 0.1, u = 0.02;
    const Law::Material m{stiffness, 1.0, 1e6, ratio};  // so rough that they never slide
    Particles<LayeredSphere> two;
    two.add({{0, 0, 0}, radius, density, {0.5 * u, 0, 0.5 * v}});
    two.add({{0, 0, 2.0001 * radius}, radius, density, {-0.5 * u, 0, -0.5 * v}});
    Simulation sim{std::move(two), Contacts<Law, Rolling>{m, {}}};
    sim.threads = 1;
    const double contact = pi * std::sqrt(0.5 * mass / stiffness);
    sim.time_step = contact / 1000;
    sim.run(1e-6 + 1e-4 * 2 * radius / v + 1.2 * contact);
    const Vec3d w = sim.angular_velocity(sim.find(0)) + sim.angular_velocity(sim.find(1));
    const Vec3d after = velocity_of(sim, 0) - velocity_of(sim, 1);
    const double slip = after.x + radius * w.y;
    CAPTURE(f);
    CAPTURE(ratio);
    REQUIRE(after.z < 0);
    // First order where the contact begins and ends within a step; the frame turns by 2e-3.
    CHECK(std::abs(slip / u - std::cos(pi * std::sqrt(ratio * (1 + 1 / f)))) < 0.01);
  }
}

TEST_CASE("hollow spheres: the dashpot of the slip is lowered by the mass that slips") {
  // (1 + 1/f)/m* for 1/m* of the normal: leapfrog_damping() keeps c^2/(k m) of either.
  const auto p = Law::mix({stiffness, 0.3, 1e9}, {stiffness, 0.3, 1e9}, {0.3, 1e9});
  const double c = std::sqrt(p.shear_ratio) * p.damping * std::sqrt(stiffness * mass);
  for (const double f : {0.2, 0.4, 2.0 / 3}) {
    Contact<double> at{};
    at.normal = {0, 0, 1}, at.overlap = 1e-5, at.m_eff = mass, at.inverse_m_eff = 1 / mass;
    at.time_step = at.lag = 5e-6, at.tangential_velocity = {0.01, 0, 0};
    if (f != 0.4) at.slip_mobility = 1 + 1 / f;
    Law::History<double> none{};
    const double spring = p.shear_ratio * stiffness * 0.01 * at.time_step;
    const double dashpot = leapfrog_damping(c, (1 + 1 / f) / mass, at.lag) * 0.01;
    CHECK(Law::force(at, p, none).tangential.x == near(-spring - dashpot).epsilon(1e-12));
  }
}

TEST_CASE("hollow spheres: the guard's rate of rolling, and the torque of a fluid") {
  const double mu = 5, eta = 0.4;
  for (const double f : {0.2, 0.4, 2.0 / 3}) {
    LayeredSphere::f = f;
    auto sim = on_plane({{mu, eta}, {}}, 0, 0, {0, 0, 0});
    sim.add_wall(plane, {stiffness, 1.0, 0.8});
    sim.time_step = 1e-9;
    sim.run(0);
    using Sim = decltype(sim);
    const double rate = detail::ContactRates<Sim::Engine, Sim::Domain>(sim.engine(), sim.domain(),
                                                                       0, sim.step_length())
                            .rate(0);
    // k_r = 2.25 k mu^2 r^2, C = 2 eta sqrt((1 + f) m r^2 k_r), over the inertia f m r^2
    const double omega = std::sqrt(2.25 * stiffness * mu * mu / (f * mass));
    CHECK(near_relative(rate, 1e-9 * omega * (1 + eta * std::sqrt(1 + 1 / f)), 1e-6));

    InFluid at{};
    at.density = 1000, at.viscosity = 1e-3, at.diameter = 2 * radius, at.mass = mass;
    at.dt = 1e3, at.angular_velocity = {0, 0, 5}, at.inertia_factor = f;
    // In a step that is very long the spin comes to rest: T dt = -I w.
    CHECK(
        near_relative(SpinTorque{}.torque_on(at).z * at.dt, -f * mass * radius * radius * 5, 1e-9));
  }
}

TEST_CASE("hollow spheres: rotational energy, and inertia factors that are refused") {
  LayeredSphere::f = 0.5;
  Particles<LayeredSphere> one;
  one.add({{0, 0, 0}, radius, density, {0, 0, 0}, {0, 30, 40}});
  Simulation sim{std::move(one), Contacts<Law, Rolling>{{stiffness, 1.0, 0.8}, {}}, EnergyLedger{}};
  sim.time_step = 1e-6;
  sim.run(0);
  CHECK(near_relative(sim.energy().rotation, 0.5 * 0.5 * mass * radius * radius * 2500, 1e-12));
  for (const double f : {0.0, -0.4, 0.67, double(NAN)}) {
    LayeredSphere::f = f;
    try {
      sim.run(1e-6);
      FAIL("accepted");
    } catch (const InputError& e) {
      CHECK(std::string(e.what()).find("inertia_factor() = ") != std::string::npos);
      CHECK(std::string(e.what()).find("(0, 2/3]") != std::string::npos);
    }
  }
  LayeredSphere::f = 0.4;
}

}  // namespace hollow_spheres_test
