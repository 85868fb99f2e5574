// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <silt/silt.hpp>

#include "near.hpp"

namespace energy_ledger_test {

using silt::Vec3d;

namespace {

using Material = silt::HertzMindlin::Material;
const Material glass{
    .youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};
const Material elastic{.youngs_modulus = 1e8, .poisson_ratio = 0.25};

/// Two spheres that spin and hit each other off centre.
silt::Particles<silt::Sphere> two_spheres() {
  silt::Particles<silt::Sphere> beads;
  beads.add({{-0.0011, 0, 0}, 1e-3, 2500, {1, 0, 0}, {0, 0, 300}});
  beads.add({{0.0013, 5e-4, 0}, 1.2e-3, 2500, {-1, 0, 0.2}, {100, 0, 0}});
  return beads;
}

/// The largest residual of all steps over the energy turned over in the end [-].
template <class Sim>
double worst_residual(Sim& sim, double duration) {
  double worst = 0;
  sim.run(duration,
          [&](const auto& s) { worst = std::max(worst, std::abs(s.energy().residual())); });
  REQUIRE(sim.energy().turned_over > 0);
  return worst / sim.energy().turned_over;
}

/// The order with which the residual falls from `dt` to a quarter of it.
template <class Make>
double order(const Make& make, double dt, double duration) {
  double residual[2];
  for (int k = 0; k < 2; ++k) {
    auto sim = make();
    sim.time_step = k == 0 ? dt : dt / 4;
    residual[k] = worst_residual(sim, duration);
  }
  return std::log2(residual[0] / residual[1]) / 2;
}

template <class Contacts>
double order_of_impact(const Contacts& contacts) {
  return order(
      [&] {
        return silt::Simulation{two_spheres(), contacts, silt::EnergyLedger{}};
      },
      2e-7, 2e-4);
}

silt::Particles<silt::Sphere> cloud(std::size_t n, double side, double speed,
                                    std::uint64_t seed = 7) {
  silt::Particles<silt::Sphere> beads;
  silt::Random random(seed);
  beads.fill({{0, 0, 0}, {side, side, side}},
             {.radius = silt::uniform(0.8e-3, 1.2e-3), .density = 2500, .count = n});
  for (std::size_t k = 0; k < beads.size(); ++k)
    beads[k].velocity = {speed * random.normal(), speed * random.normal(), speed * random.normal()};
  return beads;
}

}  // namespace

TEST_CASE("ledger: an impact closes to second order in the step, whatever the law") {
  CHECK(order_of_impact(silt::Contacts<silt::HertzMindlin>{elastic}) > 1.8);
  CHECK(order_of_impact(silt::Contacts<silt::HertzMindlin>{glass}) > 1.8);
  CHECK(order_of_impact(silt::Contacts<silt::LinearSpring>{{1e4, 0.8}}) > 1.8);
  CHECK(order_of_impact(silt::Contacts<silt::LinearSpringFriction>{{1e4, 0.8, 0.4}}) > 1.8);
  CHECK(order_of_impact(
            silt::Contacts<silt::HertzDamped<silt::KuwabaraKono>>{{1e8, 0.25, 1e-6, 0.4}}) > 1.8);
  CHECK(order_of_impact(silt::Contacts<silt::Dcdem>{{1e8, 0.25, 0.8, 0.4}}) > 1.8);
  CHECK(order_of_impact(
            silt::Contacts<silt::HertzMindlin, silt::Both<silt::RollingEpsd, silt::Twisting>>{
                glass, {{.rolling_friction = 0.2}, {.twisting_friction = 0.4}}}) > 1.8);
  CHECK(order_of_impact(silt::Contacts<silt::Cohesive<silt::HertzMindlin, silt::Dmt>>{
            {glass, {.work_of_adhesion = 0.1}}}) > 1.8);
}

TEST_CASE("ledger: what is lost is in its channel") {
  const auto run = [](const Material& m) {
    silt::Simulation sim{two_spheres(), silt::Contacts<silt::HertzMindlin>{m},
                         silt::EnergyLedger{}};
    sim.time_step = 1e-7;
    sim.run(4e-4);
    return sim.energy();
  };
  const auto e = run(elastic);
  const double all = e.initial;
  // Nothing touches any more; the rest is of the order of (dt/contact)^2 = 1e-6.
  CHECK(std::abs(e.elastic()) == 0);
  CHECK(std::abs(e.dissipated()) < 1e-9 * all);
  CHECK(std::abs(e.kinetic() - all) < 2e-6 * all);
  const auto damped = run({1e8, 0.25, 0.8, 0});
  CHECK(damped.friction == 0);
  CHECK(damped.tangential_damping == 0);
  CHECK(damped.normal_damping == near(all - damped.kinetic()).epsilon(1e-5));
  // Gross sliding: dv_t = mu (1 + e) v_n, so that friction takes what is lost across the normal.
  const auto rough = run({1e8, 0.25, 1, 0.02});
  CHECK(std::abs(rough.normal_damping) < 1e-6 * all);
  CHECK(rough.friction == near(all - rough.kinetic()).epsilon(1e-4));
}

TEST_CASE("ledger: what sticks loses to the dashpot, what slides to friction") {
  const auto run = [](double friction, double dt) {
    silt::Simulation sim{two_spheres(),
                         silt::Contacts<silt::LinearSpringFriction>{{1e4, 0.8, friction}},
                         silt::EnergyLedger{}};
    sim.time_step = dt;
    sim.run(4e-4);
    return sim.energy();
  };
  // It slides as the contact ends only, which loses what its spring still holds. Told apart on each
  // fourth of some 700 steps of contact: an error of a step of these or less.
  const auto stuck = run(100, 1e-7), finer = run(100, 1e-7 / 8);
  CHECK(stuck.tangential_damping > 1e-3 * stuck.initial);
  CHECK(stuck.friction < 0.05 * stuck.tangential_damping);
  CHECK(stuck.tangential_damping == near(finer.tangential_damping).epsilon(0.006));
  CHECK(stuck.tangential_damping + stuck.friction ==
        near(finer.tangential_damping + finer.friction).epsilon(1e-3));
  // Sliding: the dashpot damps the spring's own motion to and fro with the limit; friction is the
  // rest. The less damping, the smaller its share (c_t times the spring's velocity squared).
  const auto slid = run(0.02, 1e-7);
  CHECK(slid.friction > 1e-3 * slid.initial);
  CHECK(slid.tangential_damping > 0);
  CHECK(slid.tangential_damping < 0.2 * slid.friction);
}

TEST_CASE("ledger: a sphere slides until it rolls: friction, damping and spring in closed form") {
  // Pressed in as at rest, so that N = m g throughout. The slip velocity falls by
  // mu g (1 + 5/2 arm^2) each second, arm the lever over the radius; F s of the way s is in the
  // spring, F^2/(2 S_t), in its dashpot as much (spring_slider.cpp), and the rest friction.
  const double R = 1e-3, g = 9.81, mu = 0.4, v0 = 0.2, kn = 50, St = 2.0 / 7 * kn;
  const double m = 2500 * 4.0 / 3 * std::numbers::pi * R * R * R, F = mu * m * g,
               press = m * g / kn;
  silt::Particles<silt::Sphere> ball;
  ball.add({{0, 0, R - press}, R, 2500, {v0, 0, 0}});
  const silt::LinearSpringFriction::Material rough{kn, 0.8, mu};
  silt::Simulation sim{ball, silt::Contacts<silt::LinearSpringFriction>{rough},
                       silt::EnergyLedger{}};
  sim.gravity = {0, 0, -g};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rough);
  sim.time_step = 1e-6;
  sim.run(0.01);
  const double arm = 1 - press / R, slowing = mu * g * (1 + 2.5 * arm * arm);
  const double t = 0.01, way = v0 * t - 0.5 * slowing * t * t;
  const auto slides = sim.energy();
  const double spring = F * F / (2 * St);
  CHECK(slides.tangential == near(spring).epsilon(1e-4));
  CHECK(slides.tangential_damping == near(spring).epsilon(0.02));  // 1.3 dt S_t/c_t = 0.011
  CHECK(slides.friction == near(F * way - 2 * spring).epsilon(1e-4));
  sim.run(0.09);
  // It has rolled for long: 2/7 of its energy is gone, v'/v = 1/(1 + 2/5/arm^2).
  const auto rolls = sim.energy();
  const double lost = 1 - 1 / (1 + 0.4 / (arm * arm)), start = 0.5 * m * v0 * v0;
  CHECK(lost == near(2.0 / 7).epsilon(5e-3));
  CHECK(rolls.tangential < 1e-6 * start);
  CHECK(rolls.friction + rolls.tangential_damping == near(lost * start).epsilon(1e-4));
  // As it comes to roll the spring swings out: the dashpot takes what it held.
  CHECK(rolls.tangential_damping == near(2 * spring).epsilon(0.05));
}

namespace {

/// How far the losses of a run fall back, and the least of what springs hold, over the energy.
struct Backwards {
  double friction = 0, damping = 0, normal = 0, rolling = 0, least = 0;  // [-]
};
template <class Sim>
Backwards losses_of(Sim& sim, double duration) {
  Backwards b;
  std::array<double, 4> most{};
  sim.run(duration, [&](const auto& s) {
    const auto e = s.energy();
    const double losses[] = {e.friction, e.tangential_damping, e.normal_damping,
                             e.rolling_resistance};
    double* back[] = {&b.friction, &b.damping, &b.normal, &b.rolling};
    for (int k = 0; k < 4; ++k) {
      most[k] = std::max(most[k], losses[k]);
      *back[k] = std::max(*back[k], (most[k] - losses[k]) / e.initial);
    }
    b.least =
        std::min({b.least, e.normal / e.initial, e.tangential / e.initial, e.rolling / e.initial});
  });
  return b;
}

/// Random oblique impacts with spin, of two spheres or on a plane, by `contacts_of(e, mu)`.
/// 2e-5: a contact takes 300 steps and more; the error of a spring's energy is (w dt)^2/8 of it,
/// w dt = pi/300, and the dashpots' loss is known at half steps.
template <class Make>
void losses_only_grow(const std::string& name, const Make& contacts_of, bool attracts = false) {
  CAPTURE(name);
  silt::Random random(11);
  for (int run = 0; run < 12; ++run) {
    CAPTURE(run);
    const double e = random.uniform(0.3, 0.98), mu = random.uniform(0.05, 1.2);
    const auto contacts = contacts_of(e, mu);
    const bool on_plane = run % 2 == 0;
    const auto turn = [&] {
      return Vec3d{random.normal(), random.normal(), random.normal()} * 300.0;
    };
    silt::Particles<silt::Sphere> spheres;
    spheres.add(
        {{0, 0, 1.01e-3}, 1e-3, 2500, {random.uniform(0, 3), random.uniform(-1, 1), -1}, turn()});
    if (!on_plane)
      spheres.add({{4e-4, 0, -0.8e-3}, random.uniform(0.6e-3, 1e-3), 2500, {0, 0, 0.2}, turn()});
    silt::Simulation sim{spheres, contacts, silt::EnergyLedger{}};
    if (on_plane) sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
    sim.guard.max_overlap = 1;
    sim.time_step = 1e-6;
    const auto back = losses_of(sim, 4e-4);
    CHECK(sim.energy().turned_over > 0);
    CHECK(back.friction == 0);
    CHECK(back.damping < 2e-5);
    if (!attracts) CHECK(back.normal < 2e-5);  // what attractions give comes back
    CHECK(back.rolling < 2e-5);
    CHECK(back.least >= 0);
  }
}

}  // namespace

TEST_CASE("ledger: losses only grow, springs hold no debt, in random impacts by each law") {
  using silt::Contacts;
  losses_only_grow("HertzMindlin", [](double e, double mu) {
    return Contacts<silt::HertzMindlin>{{1e7, 0.25, e, mu}};
  });
  losses_only_grow("of displacements", [](double e, double mu) {
    return Contacts<
        silt::BasicHertzMindlin<silt::DampingEnd::ZeroForce, silt::TangentialMemory::Displacement>>{
        {1e7, 0.25, e, mu}};
  });
  losses_only_grow("LinearSpringFriction", [](double e, double mu) {
    return Contacts<silt::LinearSpringFriction>{{5e3, e, mu}};
  });
  losses_only_grow("KuwabaraKono", [](double e, double mu) {
    return Contacts<silt::HertzDamped<silt::KuwabaraKono>>{{1e7, 0.25, 1e-5 * (1 - e), mu}};
  });
  losses_only_grow("Dcdem", [](double e, double mu) {
    return Contacts<silt::Dcdem>{{1e7, 0.25, e, mu}};
  });
  losses_only_grow("rolling and twisting", [](double e, double mu) {
    return Contacts<silt::HertzMindlin, silt::Both<silt::RollingEpsd, silt::Twisting>>{
        {1e7, 0.25, e, mu}, {{.rolling_friction = 0.3 * mu}, {.twisting_friction = mu}}};
  });
  losses_only_grow(
      "Dmt",
      [](double e, double mu) {
        return Contacts<silt::Cohesive<silt::HertzMindlin, silt::Dmt>>{
            {{1e7, 0.25, e, mu}, {.work_of_adhesion = 0.05}}};
      },
      true);
  losses_only_grow(
      "Jkr",
      [](double e, double mu) {
        return Contacts<silt::Jkr>{{1e7, 0.25, 0.05, e, mu}};
      },
      true);
}

TEST_CASE("ledger: an oblique impact that slides throughout; its channels sum up") {
  // The impact of a 3 mm sphere at 3 m/s along and 1 m/s into a plane: rigid bodies lose
  // dv_t = mu (1 + e) v_n, and 5/2 of that spins it.
  const auto run = [](const auto& contacts) {
    silt::Particles<silt::Sphere> ball;
    ball.add({{0, 0, 3.001e-3}, 3e-3, 2500, {3, 0, -1}});
    silt::Simulation sim{ball, contacts, silt::EnergyLedger{}};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
    sim.time_step = 2e-6;
    const auto back = losses_of(sim, 4e-3);
    CHECK(back.friction == 0);
    CHECK(back.damping < 1e-6);
    const auto e = sim.energy();
    CHECK(sim.velocity(0).x == near(3 - 0.4 * 1.5).epsilon(1e-4));
    CHECK(e.normal_damping == near((1 - 0.25) * 0.5 * sim.mass(0)).epsilon(1e-3));
    CHECK(e.friction > 10 * e.tangential_damping);
    CHECK(e.tangential_damping > 0);
    CHECK(e.elastic() == 0);
    CHECK(e.dissipated() == near(e.initial + e.supplied() - e.kinetic()).epsilon(1e-4));
  };
  const silt::HertzMindlin::Material soft{1e7, 0.25, 0.5, 0.4};
  run(silt::Contacts<silt::HertzMindlin>{soft});
  run(silt::Contacts<
      silt::BasicHertzMindlin<silt::DampingEnd::ZeroForce, silt::TangentialMemory::Displacement>>{
      {1e7, 0.25, 0.5, 0.4}});
}

TEST_CASE("ledger: a closed form of each loss") {
  // A head-on impact loses (1 - e^2) of the energy of the approach.
  silt::Particles<silt::Sphere> beads;
  beads.add({{-0.00101, 0, 0}, 1e-3, 2500, {1, 0, 0}});
  beads.add({{0.00101, 0, 0}, 1e-3, 2500, {-1, 0, 0}});
  silt::Simulation sim{beads, silt::Contacts<silt::HertzMindlin>{glass}, silt::EnergyLedger{}};
  sim.time_step = 5e-8;
  sim.run(2e-4);
  const auto e = sim.energy();
  CHECK(e.normal_damping == near((1 - 0.64) * e.initial).epsilon(1e-3));
  // Turned over: in on the approach, out with what is left of it; forces differ by the dashpot's.
  CHECK(e.turned_over == near(0.5 * (1 + 0.64) * e.initial).epsilon(1e-3));

  // A sphere that slides on a plane until it rolls loses 2/7 of its energy to friction. It starts
  // pressed in as at rest; the lever arm is the radius less that.
  silt::Particles<silt::Sphere> ball;
  ball.add({{0, 0, 1e-3 - 1.28e-7}, 1e-3, 2500, {0.2, 0, 0}});
  silt::Simulation slide{ball, silt::Contacts<silt::HertzMindlin>{glass}, silt::EnergyLedger{}};
  slide.gravity = {0, 0, -9.81};
  slide.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  slide.run(0.05);
  const auto s = slide.energy();
  const double start = 0.5 * slide.mass(0) * 0.04;
  CHECK(s.friction + s.tangential_damping == near(2.0 / 7 * start).epsilon(5e-4));
  CHECK(s.rotation == near(2.0 / 7 * s.kinetic()).epsilon(5e-4));
}

TEST_CASE("ledger: what a safeguard takes from a spring is damping") {
  using Soft = silt::Softened<silt::HertzMindlin>;
  const Soft::Material soft{
      .solid = {.youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = 0.9},
      .full_radius = 1e-3};
  for (const bool on_wall : {false, true}) {
    CAPTURE(on_wall);
    silt::Particles<silt::Sphere> spheres;
    spheres.add({{1.4e-4, 0, 0}, 1e-4, 2500, {-5, 0, 0}});
    if (!on_wall) spheres.add({{-1.4e-4, 0, 0}, 1e-4, 2500});
    silt::Simulation sim{spheres, silt::Contacts<Soft>{soft}, silt::EnergyLedger{}};
    if (on_wall) sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, soft);
    sim.guard.max_overlap = sim.guard.max_travel = 1;
    sim.run(1e-9);
    sim.time_step = sim.step_length() / 20;  // 400 steps a contact
    sim.run(1e-4);
    const auto e = sim.energy();
    CHECK(sim.safeguarded() == 1);
    CHECK(e.elastic() == 0);
    // The error of a spring's energy is (w dt)^2/8 of it, w = pi/400 dt.
    const double approach = on_wall ? e.initial : 0.5 * e.initial;
    CHECK(std::abs(e.residual()) < 1e-5 * approach);
    CHECK(e.normal_damping == near((1 - 0.81) * approach).epsilon(1e-4));
  }
}

TEST_CASE("ledger: many elastic spheres between walls close below 1e-6 of the energy turned over") {
  silt::Simulation sim{cloud(300, 0.02, 0.3), silt::Contacts<silt::HertzMindlin>{elastic},
                       silt::EnergyLedger{}};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.02}), elastic);
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 2e-7;
  sim.run(0.04, [&](const auto& s) {
    if (s.step() % 500 != 0) return;
    const auto e = s.energy();
    // A contact in progress is off by some (dt w)^2/8 of its energy, of which some are under way.
    CHECK(std::abs(e.residual()) < 1e-6 * std::max(e.turned_over, e.initial));
  });
  const auto e = sim.energy();
  CHECK(e.turned_over > 5 * e.initial);
  CHECK(std::abs(e.residual()) < 1e-6 * e.turned_over);
}

TEST_CASE("ledger: mixed precision closes as double does") {
  const auto run = [](auto... precision) {
    silt::Simulation sim{cloud(200, 0.02, 0.3), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::EnergyLedger{}, precision...};
    sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.02}), glass);
    sim.time_step = 1e-6;
    sim.run(0.01);
    return sim.energy();
  };
  const auto doubles = run(), floats = run(silt::Mixed{});
  CHECK(floats.dissipated() > 0.5 * floats.initial);
  CHECK(std::abs(floats.residual() - doubles.residual()) < 1e-7 * floats.initial);
}

TEST_CASE("ledger: work of walls that move, and of fixed particles that do") {
  const auto make = [] {
    silt::Simulation sim{cloud(50, 0.01, 0.1), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::EnergyLedger{}};
    sim.add_wall(silt::box({0, 0, 0}, {0.01, 0.01, 0.01}), glass,
                 silt::rotation({0.005, 0.005, 0.005}, {0, 1, 1}, 40.0));
    return sim;
  };
  auto sim = make();
  sim.time_step = 1e-6;
  sim.run(0.05);
  CHECK(sim.energy().walls > sim.energy().initial);  // they are driven
  CHECK(std::abs(sim.energy().residual()) < 1e-4 * sim.energy().walls);
  CHECK(order(make, 1e-6, 0.01) > 1.6);

  const auto pushed = [](double friction) {
    silt::Particles<silt::Sphere> beads;
    beads.add({.position = {0, 0, 0},
               .radius = 1e-3,
               .density = 2500,
               .velocity = {1, 0, 0},
               .angular_velocity = {0, 0, 500},
               .fixed = true});
    beads.add({{0.0021, 3e-4, 0}, 1e-3, 2500});
    return silt::Simulation{beads, silt::Contacts<silt::HertzMindlin>{{1e8, 0.25, 0.8, friction}},
                            silt::EnergyLedger{}};
  };
  auto one = pushed(0.4);
  one.time_step = 1e-7;
  one.run(5e-4);
  CHECK(one.energy().initial == 0);
  CHECK(one.energy().kinetic() > 0);
  CHECK(one.energy().walls ==
        near(one.energy().kinetic() + one.energy().dissipated()).epsilon(1e-5));
  CHECK(order([&] { return pushed(0); }, 4e-7, 5e-4) > 1.8);
}

TEST_CASE("ledger: particles that come and go, gravity that is changed") {
  double residual[2];
  for (int k = 0; k < 2; ++k) {
    // Of eight seeds two have a residual of twice the others', of the step's order as well.
    silt::Simulation sim{cloud(20, 0.01, 0.1, 4), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::EnergyLedger{}};
    sim.gravity = {0, 0, -9.81};
    sim.add_inlet(silt::Box{{0, 0, 0.02}, {0.01, 0.01, 0.03}},
                  {.radius = silt::uniform(0.5e-3, 1e-3),
                   .density = 2500,
                   .rate = 5000,
                   .velocity = {0, 0, -1}});
    sim.add_outlet({{-0.1, -0.1, -0.06}, {0.11, 0.11, -0.04}});
    sim.time_step = k == 0 ? 1e-6 : 0.25e-6;
    sim.run(0.05);
    sim.gravity = {3, 0, -9.81};
    sim.run(0.03);
    const auto e = sim.energy();
    CHECK(sim.outlet(0).count > 50);
    CHECK(std::abs(e.changed_gravity) > 1e-3 * std::abs(e.openings));
    residual[k] = std::abs(e.residual());
    CHECK(residual[k] < 2e-4 * e.turned_over);  // 20 to 80 steps a contact
  }
  CHECK(std::log2(residual[0] / residual[1]) / 2 > 1.7);
}

TEST_CASE("ledger: gravity that an observer changes is booked as between runs") {
  const auto run = [](bool in_observer) {
    silt::Simulation sim{cloud(20, 0.01, 0.1, 4), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::EnergyLedger{}};
    sim.threads = 1;
    sim.gravity = {0, 0, -9.81};
    sim.time_step = 1e-6;
    sim.add_wall(silt::Plane{{0, 0, -0.01}, {0, 0, 1}}, glass);
    const Vec3d tilted{3, 0, -9.81};
    if (in_observer) {
      sim.run(0.05, silt::at(silt::every(0.03), [&](auto& s) {
                if (s.time() < 0.02) return;
                s.gravity = tilted;
                CHECK(s.energy().changed_gravity == 0);  // held as before, until it is booked
              }));
    } else {
      sim.run(0.03);
      sim.gravity = tilted;
      sim.run(0.02);
    }
    return sim.energy();
  };
  const auto inside = run(true), between = run(false);
  CHECK(std::abs(between.changed_gravity) > 0.01 * between.turned_over);
  CHECK(inside.changed_gravity == between.changed_gravity);
  CHECK(inside.residual() == between.residual());
  CHECK(std::abs(inside.residual()) < 1e-3 * inside.turned_over);
}

TEST_CASE("ledger: gravity along a repeating direction is booked with each passage") {
  SUBCASE("one sphere that falls round and round: m g L each time") {
    silt::Particles<silt::Sphere> p;
    p.add({.position = {0.01, 0.01, 0.005}, .radius = 1e-3, .density = 2500});
    silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::EnergyLedger{},
                         silt::PeriodicBox{{{0, 0, 0}, {0.02, 0.02, 0.02}}, {true, true, true}}};
    sim.gravity = {0, 0, -9.81};
    sim.time_step = 5e-6;
    sim.run(0.2);  // 0.196 m, 10 passages
    const double m = sim.mass(0);
    const auto e = sim.energy();
    CHECK(e.going_round == doctest::Approx(10 * m * 9.81 * 0.02).epsilon(1e-12));
    CHECK(std::abs(e.residual()) < 1e-9 * e.translation);
    sim.gravity = {2, 0, 9.81};  // and back again
    sim.run(0.5);
    CHECK(std::abs(sim.energy().residual()) < 1e-3 * sim.energy().translation);
  }
  SUBCASE("a chute: the bed gains what gravity gives along the flow") {
    silt::Simulation sim{cloud(60, 0.012, 0.05), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::EnergyLedger{},
                         silt::PeriodicBox{{{0, 0, 0}, {0.012, 0.012, 1}}, {true, true, false}}};
    sim.gravity = {7, 0, -7};
    sim.time_step = 1e-6;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
    sim.run(0.1);
    const std::string path = (std::filesystem::temp_directory_path() / "going_round.silt").string();
    silt::save_checkpoint(sim, path);
    sim.run(0.05);
    const auto e = sim.energy();
    CHECK(e.going_round > 0.2 * e.turned_over);
    CHECK(std::abs(e.residual()) < 2e-4 * e.turned_over);
    silt::Simulation again{cloud(60, 0.012, 0.05), silt::Contacts<silt::HertzMindlin>{glass},
                           silt::EnergyLedger{},
                           silt::PeriodicBox{{{0, 0, 0}, {0.012, 0.012, 1}}, {true, true, false}}};
    again.gravity = {7, 0, -7};
    again.time_step = 1e-6;
    again.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
    silt::load_checkpoint(again, path);
    again.run(0.05);
    CHECK(again.energy().going_round == e.going_round);
    std::filesystem::remove(path);
  }
  SUBCASE("bodies") {
    silt::Particles<silt::MultiSphere> p;
    const auto rod =
        p.add_form(silt::MultiSphere{.balls = {{{-1e-3, 0, 0}, 1e-3}, {{1e-3, 0, 0}, 1e-3}}});
    p.add({.form = rod,
           .position = {0.01, 0.01, 0.005},
           .radius = 2e-3,
           .density = 2500,
           .angular_velocity = {3, 1, 2}});
    silt::Simulation sim{std::move(p), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::EnergyLedger{},
                         silt::PeriodicBox{{{0, 0, 0}, {0.02, 0.02, 0.02}}, {true, true, true}}};
    sim.gravity = {0, 0, -9.81};
    sim.time_step = 5e-6;
    sim.run(0.2);
    const auto e = sim.energy();
    CHECK(e.going_round == doctest::Approx(10 * sim.mass(0) * 9.81 * 0.02).epsilon(1e-12));
    CHECK(std::abs(e.residual()) < 1e-9 * e.translation);
  }
}

TEST_CASE("ledger: a checkpoint keeps the books") {
  std::string folder = (std::filesystem::temp_directory_path() / "silt_ledger_XXXXXX").string();
  REQUIRE(::mkdtemp(folder.data()) != nullptr);
  const auto make = [] {
    silt::Simulation sim{cloud(50, 0.01, 0.5), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::EnergyLedger{}};
    sim.add_wall(silt::box({0, 0, 0}, {0.01, 0.01, 0.01}), glass,
                 silt::vibration({1e-3, 0, 0}, 50.0));
    sim.time_step = 1e-6;
    return sim;
  };
  auto whole = make();
  whole.run(0.002), whole.run(0.002);
  auto first = make();
  first.run(0.002);
  silt::save_checkpoint(first, folder + "/books.silt");
  auto second = make();
  silt::load_checkpoint(second, folder + "/books.silt");
  second.run(0.002);
  CHECK(second.energy().residual() == whole.energy().residual());
  CHECK(second.energy().friction == whole.energy().friction);
  CHECK(second.energy().walls == whole.energy().walls);
  std::filesystem::remove_all(folder);
}

TEST_CASE("ledger: same books for any number of threads; none before the first run") {
  double friction[2];
  for (int k = 0; k < 2; ++k) {
    silt::Simulation sim{cloud(3000, 0.04, 0.5), silt::Contacts<silt::HertzMindlin>{glass},
                         silt::EnergyLedger{}};
    CHECK_THROWS_WITH_AS(sim.energy(), doctest::Contains("run() first"), silt::InputError);
    sim.threads = 1 + 2 * k, sim.time_step = 1e-6;
    sim.run(0.002);
    friction[k] = sim.energy().friction;
  }
  CHECK(friction[0] == friction[1]);
}

}  // namespace energy_ledger_test
