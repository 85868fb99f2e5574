// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <silt/silt.hpp>

#include "near.hpp"

namespace softened_test {

namespace {

using Solid = silt::HertzMindlin::Material;
using Soft = silt::Softened<silt::HertzMindlin>;
constexpr double density = 2500;  // [kg/m3]

Solid solid(double restitution) {
  return {.youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = restitution};
}

struct Impact {
  double restitution, overlap, duration;  // [-], [m], [s]
  std::uint64_t safeguards;
};

/// A head-on impact of two spheres.
template <class Law>
Impact impact(const typename Law::Material& material, double R1, double R2, double speed) {
  silt::Particles<silt::Sphere> spheres;
  spheres.add({{0, 0, 0}, R1, density, {speed, 0, 0}});
  spheres.add({{1.1 * (R1 + R2), 0, 0}, R2, density});
  silt::Simulation sim{spheres, silt::Contacts<Law>{material}};
  sim.guard.max_overlap = 3, sim.guard.max_travel = 1;
  const auto gap = [&](const auto& s) { return s.position(1).x - s.position(0).x - R1 - R2; };
  Impact result{};
  double begin = 0, end = 0;
  sim.run(1e-9);
  sim.time_step = sim.step_length() / 20;  // 400 steps a contact
  sim.run(0.2 * (R1 + R2) / speed + 600 * *sim.time_step * 20, [&](const auto& s) {
    if (gap(s) < 0) {
      if (begin == 0) begin = s.time();
      end = s.time();
    }
    result.overlap = std::max(result.overlap, -gap(s));
  });
  result.duration = end - begin;
  result.restitution = (sim.velocity(1).x - sim.velocity(0).x) / speed;
  if constexpr (requires { sim.safeguarded(); }) result.safeguards = sim.safeguarded();
  return result;
}

}  // namespace

TEST_CASE("softened: a small sphere's contact lasts as long as that of one of the full radius") {
  const Impact full = impact<silt::HertzMindlin>(solid(1), 1e-3, 1e-3, 0.1);
  for (const double radius : {0.5e-3, 0.2e-3, 0.1e-3}) {
    CAPTURE(radius);
    const Impact soft = impact<Soft>({.solid = solid(1), .full_radius = 1e-3}, radius, radius, 0.1);
    // Ends of contacts are known to a step of 400.
    CHECK(soft.duration == near(full.duration).epsilon(0.006));
    // The overlap over the diameter grows by full radius over radius: the same overlap.
    CHECK(soft.overlap == near(full.overlap).epsilon(1e-4));
    CHECK(soft.restitution == near(1).epsilon(1e-5));
    CHECK(soft.safeguards == 0);
  }
}

TEST_CASE("softened: partners of their own factor each; large ones stay as they are") {
  const Soft::Material m{.solid = solid(1), .full_radius = 1e-3};
  // Coarse pairs: the same bits but for one multiplication by 1.
  const Impact plain = impact<silt::HertzMindlin>(solid(1), 1.5e-3, 2e-3, 0.1),
               coarse = impact<Soft>(m, 1.5e-3, 2e-3, 0.1);
  CHECK(coarse.overlap == near(plain.overlap).epsilon(1e-12));
  // Small on large: 1/E* = (1/f + 1)/2 of the solid.
  const double R1 = 0.25e-3, R2 = 2e-3, f = std::pow(R1 / 1e-3, 2.5);
  const double E = 1e8 / (1 - 0.0625) / 2 * 2 / (1 / f + 1), R = R1 * R2 / (R1 + R2);
  const auto mass = [](double r) { return density * 4 / 3 * std::numbers::pi * r * r * r; };
  const double m_eff = mass(R1) * mass(R2) / (mass(R1) + mass(R2));
  const Impact mixed = impact<Soft>(m, R1, R2, 0.1);
  CHECK(mixed.overlap == near(silt::hertz_max_overlap({E, R, m_eff, 0.1})).epsilon(1e-4));
  // The bound of the factor.
  const Impact bounded =
      impact<Soft>({.solid = solid(1), .full_radius = 1e-3, .least = 0.1}, 0.1e-3, 0.1e-3, 0.1);
  CHECK(bounded.overlap == near(silt::hertz_max_overlap(
                                    {0.1 * 1e8 / (1 - 0.0625) / 2, 0.05e-3, mass(0.1e-3) / 2, 0.1}))
                               .epsilon(1e-4));
}

TEST_CASE("softened: the safeguard turns a deep impact with the restitution of the material") {
  for (const double e : {0.9, 0.5}) {
    CAPTURE(e);
    const Impact deep = impact<Soft>({.solid = solid(e), .full_radius = 1e-3}, 0.1e-3, 0.1e-3, 5);
    CHECK(deep.safeguards == 1);
    CHECK(deep.restitution == near(e).epsilon(1e-9));
    // It acts on the first step beyond 0.15 of the diameter.
    CHECK(deep.overlap > 0.15 * 0.2e-3);
    CHECK(deep.overlap < 0.155 * 0.2e-3);
    const Impact without = impact<Soft>({.solid = solid(e),
                                         .full_radius = 1e-3,
                                         .deepest = std::numeric_limits<double>::infinity()},
                                        0.1e-3, 0.1e-3, 5);
    CHECK(without.safeguards == 0);
    CHECK(without.overlap > 0.3 * 0.2e-3);
  }
}

#ifdef SILT_LONG_TESTS
TEST_CASE("softened: on a wall, and pressed together again after the safeguard") {
  silt::Particles<silt::Sphere> spheres;
  spheres.add({{0, 0, 0.11e-3}, 0.1e-3, density, {0, 0, -10}});
  silt::Simulation sim{spheres, silt::Contacts<Soft>{{.solid = solid(0.5), .full_radius = 2e-3}},
                       silt::EnergyLedger{}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, {.solid = solid(0.5), .full_radius = 2e-3});
  sim.guard.max_overlap = sim.guard.max_travel = 1;
  const double before = 0.5 * sim.mass(0) * 100;
  sim.run(5e-5);
  CHECK(sim.safeguarded() == 1);
  CHECK(sim.velocity(0).z == near(5).epsilon(1e-6));
  // The ledger books it as normal damping; some spring energy ends at the turn.
  CHECK(sim.energy().normal_damping == near(0.75 * before).epsilon(0.02));

  // Pressed together again while the safeguard holds: it resists. What it cannot hold, the guard
  // stops.
  const auto press = [](double density_above) {
    silt::Particles<silt::Sphere> pile;
    pile.add({.position = {0, 0, 0}, .radius = 0.1e-3, .density = density, .fixed = true});
    pile.add({{0, 0, 0.21e-3}, 0.1e-3, density, {0, 0, -8}});
    pile.add({{0, 0, 0.42e-3}, 0.1e-3, density_above, {0, 0, -8}});
    silt::Simulation s{pile, silt::Contacts<Soft>{{.solid = solid(0.5), .full_radius = 2e-3}}};
    s.guard.max_overlap = s.guard.max_travel = 1;
    s.run(2e-4);
    CHECK(s.safeguarded() >= 2);
    CHECK(s.position(1).z > 0.1e-3);
    CHECK(s.position(2).z > s.position(1).z + 0.1e-3);
  };
  press(density);
  CHECK_THROWS_WITH_AS(press(1000 * density), doctest::Contains("overlap by"),
                       silt::SimulationError);
}
#endif

TEST_CASE("softened: the force that the solid would have borne") {
  const auto p = Soft::mix({.solid = solid(0.5), .full_radius = 1}, {.solid = solid(0.5)},
                           {.restitution = 0.5, .friction = 0});
  const double zeta = silt::damping_ratio(0.5, silt::DampingEnd::ZeroForce);
  CHECK(Soft::physical_force(p, 1e-3, 1e-6, 2.0) ==
        near(silt::hertz_max_elastic_force({1e8 / (1 - 0.0625) / 2, 1e-3, 1e-6, 2.0, zeta}))
            .epsilon(1e-12));
}

TEST_CASE(
    "softened: the time step of the full radius; packs of lanes as one lane; mixed precision") {
  const auto step_for = [](double full) {
    silt::Particles<silt::Sphere> spheres;
    spheres.add({{0, 0, 0}, 0.1e-3, density, {0.1, 0, 0}});
    silt::Simulation sim{spheres, silt::Contacts<Soft>{{.solid = solid(0.5), .full_radius = full}}};
    sim.run(1e-9);
    return sim.step_length();
  };
  // t ~ m^(2/5) E*^(-2/5) R^(-1/5) of two alike: f = (R/R_full)^(5/2) on E* leaves R_full/R.
  CHECK(step_for(1e-3) / step_for(0) == near(10).epsilon(1e-12));
  CHECK(step_for(0.3e-3) / step_for(0) == near(3).epsilon(1e-12));

#ifdef SILT_LONG_TESTS
  const auto run = [](auto... policy) {
    silt::Particles<silt::Sphere> spheres;
    spheres.fill({{0, 0, 0}, {0.004, 0.004, 0.004}},
                 {.radius = silt::uniform(0.1e-3, 0.3e-3), .density = density, .count = 200});
    const Soft::Material m{.solid = {1e8, 0.25, 0.5, 0.4}, .full_radius = 0.3e-3};
    silt::Simulation sim{spheres, silt::Contacts<Soft>{m}, policy...};
    sim.add_wall(silt::box({0, 0, 0}, {0.004, 0.004, 0.004}), m);
    sim.gravity = {0, 0, -9.81};
    sim.time_step = 1e-6;
    sim.run(0.01);
    double height = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k) height += sim.position(k).z;
    return height;
  };
  const double lanes = run();
  CHECK(run(silt::KernelsFor<silt::OneLane>{}) == near(lanes).epsilon(1e-9));
  CHECK(run(silt::Mixed{}) == near(lanes).epsilon(1e-5));
#endif
}

TEST_CASE("softened: what is refused") {
  const auto refused = [](const Soft::Material& m, const char* sentence) {
    CHECK_THROWS_WITH_AS(silt::Contacts<Soft>{m}, doctest::Contains(sentence), silt::InputError);
  };
  refused({.solid = solid(0.5), .full_radius = -1}, "Softened::Material.full_radius = -1 [m]");
  refused({.solid = solid(0.5), .full_radius = 1, .least = 2}, "Softened::Material.least = 2 [-]");
  refused({.solid = solid(0.5), .full_radius = 1, .deepest = 0}, "Softened::Material.deepest = 0");
  refused({.solid = solid(7)}, "restitution = 7");
}

}  // namespace softened_test
