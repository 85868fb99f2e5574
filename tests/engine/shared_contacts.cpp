// silt - BSD-3-Clause, see LICENSE
#include <array>
#include <cmath>

#include <silt/shape/multi_sphere.hpp>
#include <silt/silt.hpp>

#include "engine/support.hpp"
#include "near.hpp"

namespace shared_contacts_test {

namespace {

using namespace engine_test;
using silt::MultiSphere;
using Shares = silt::detail::SharedContacts<double>;

constexpr HertzMindlin::Material smooth{
    .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0};

/// A square plate of n x n balls, flat, with the mass of a given cuboid.
MultiSphere plate(int n) {
  const double side = 4e-3, r = 0.5e-3;
  MultiSphere form;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      form.balls.push_back({{side * (i / (n - 1.0) - 0.5), side * (j / (n - 1.0) - 0.5), 0}, r});
  const double v = 5e-3 * 5e-3 * 1e-3;
  form.mass = silt::MassProperties{v, {0, 0, 0}, v * Vec3d{2.2e-6, 2.2e-6, 4.2e-6}, {}};
  return form;
}

struct Impact {
  double restitution, overlap;
};
/// [-] of n contacts at once, where the damping ratio of one grows by n^growth.
double grown(double n, double growth) {
  return silt::damping_ratio(smooth.restitution, silt::DampingEnd::ZeroForce) * std::pow(n, growth);
}
double restitution(double n, double growth) {
  return silt::restitution_of(grown(n, growth), silt::DampingEnd::ZeroForce);
}
double overlap_ratio(double n, double growth) {  // the largest over the elastic one's
  return silt::hertz_overlap_ratio(grown(n, growth));
}
/// A plate falls flat onto the floor at 0.5 m/s.
Impact flat_impact(int n, bool share) {
  silt::Particles<MultiSphere> one;
  one.add_form(plate(n));
  one.add({.position = {0, 0, 0.6e-3}, .density = 2500, .velocity = {0, 0, -0.5}});
  silt::Simulation sim{std::move(one), silt::Contacts<HertzMindlin>{smooth}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, smooth);
  sim.share_contacts(share);
  sim.time_step = 2e-7;
  sim.run(2e-3);
  return {sim.velocity(0).z / 0.5, sim.peak_overlap()};
}

}  // namespace

TEST_CASE("n contacts of one depth make n^(1/4) of one, one that has just begun changes nothing") {
  const auto share = [](std::size_t k, std::vector<double> depths, double exponent) {
    std::vector<Shares::One> all;
    for (const double d : depths) all.push_back({Shares::strength(d, 1e-3, exponent), {0, 0, 1}});
    Shares::share(all, exponent);
    return all[k].share;
  };
  const std::vector<double> same{1e-6, 1e-6, 1e-6}, begun{1e-6, 1e-8};
  CHECK(3 * share(0, same, 2.5) == near(std::pow(3, 0.25)).epsilon(1e-12));
  CHECK(3 * share(0, same, 2) == near(std::pow(3, 0.2)).epsilon(1e-12));
  CHECK(share(0, begun, 2.5) == near(1).epsilon(1e-12));
  CHECK(share(1, begun, 2.5) < 1e-14);
}

/// Whether the shared forces of four contacts are the gradient of this energy of their depths.
template <class Energy>
void check_gradient(const std::array<Vec3d, 4>& normals, const Energy& energy) {
  // e = R^(1/5) d; the law's force (5/2) sqrt(R) d^(3/2).
  using Four = std::array<double, 4>;
  const Four depth{1.0, 0.9, 0.97, 0.8}, radius{1, 2, 1.5, 0.7};
  const auto at = [&](const Four& depths) {
    Four e10;
    for (std::size_t k = 0; k < 4; ++k) e10[k] = std::pow(radius[k], 2) * std::pow(depths[k], 10);
    return energy(e10);
  };
  std::vector<Shares::One> all;
  for (std::size_t k = 0; k < 4; ++k)
    all.push_back(
        {Shares::strength(depth[k], radius[k], 2.5), normals[k], static_cast<std::uint32_t>(k)});
  Shares::share(all, 2.5);
  for (std::size_t k = 0; k < 4; ++k) {
    Four more = depth, less = depth;
    more[k] += 1e-6, less[k] -= 1e-6;
    const double force = 2.5 * std::sqrt(radius[k]) * std::pow(depth[k], 1.5) * all[k].share;
    CHECK(std::abs((at(more) - at(less)) / 2e-6 - force) < 1e-9);
  }
}
const auto root = [](double e10) { return std::pow(e10, 0.25); };

TEST_CASE("The shared force is the gradient of an energy: side by side, in a corner, between") {
  const Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  check_gradient({y, y, y, y}, [](const auto& e) { return root(e[0] + e[1] + e[2] + e[3]); });
  // Two on the floor and two at the wall: each pair shares, the pairs do not.
  check_gradient({y, x, y, x}, [](const auto& e) { return root(e[0] + e[2]) + root(e[1] + e[3]); });
  // All alone: three at right angles, one against the first.
  check_gradient({y, x, -y, z},
                 [](const auto& e) { return root(e[0]) + root(e[1]) + root(e[2]) + root(e[3]); });
  // The strongest, contact 2 by its radius, shares with half of contact 1 (75.5 degrees: f(1/4) =
  // 1/2).
  const Vec3d leans{std::sqrt(15.0 / 16), 0.25, 0};
  check_gradient({z, y, leans, -z}, [](const auto& e) {
    return root(e[0]) + root(e[2] + 0.5 * e[1]) + 0.5 * root(e[1]) + root(e[3]);
  });
}

TEST_CASE("A rod in the corner of a mesh does as in that of planes, and keeps its energy") {
  // Two balls fall askew between three sides. Sharing over a right angle: a rebound of 0.6 of it.
  const auto run = [](bool planes) {
    auto elastic = smooth;
    elastic.restitution = 1;
    silt::Particles<MultiSphere> rods;
    rods.add_form(MultiSphere{.balls = {{{-0.5e-3, 0, 0}, 0.5e-3}, {{0.5e-3, 0, 0}, 0.4e-3}}});
    rods.add({.position = {1.7e-3, 1.2e-3, 1.4e-3},
              .orientation = silt::rotation_about({0.6, 0, 0.8}, 0.7),
              .density = 2500,
              .velocity = {-0.3, -0.2, -0.4}});
    silt::Simulation sim{std::move(rods), silt::Contacts<HertzMindlin>{elastic},
                         silt::EnergyLedger{}};
    const Vec3d top{20e-3, 20e-3, 20e-3};
    if (planes)
      sim.add_wall(silt::box({0, 0, 0}, top), elastic);
    else
      sim.add_wall(silt::box_mesh({0, 0, 0}, top), elastic);
    sim.time_step = 2e-7;
    double most = 0;  // [-] change of the energy
    const double whole = 0.5 * sim.mass(0) * 0.29;
    sim.run(10e-3, [&](const auto& now) {
      const auto e = now.energy();
      most = std::max(most, std::abs(e.held() / whole - 1));
    });
    CHECK(most < 2e-4);
    return std::pair{sim.velocity(0), sim.angular_velocity(0)};
  };
  const auto [v, w] = run(true);
  const auto [of_mesh, turning] = run(false);
  CHECK(norm(v - of_mesh) < 1e-9);
  CHECK(norm(w - turning) < 1e-5);
}

TEST_CASE("A plate is nearly as stiff and as damped with 4 as with 100 balls that touch") {
  // Stiffness and dashpot grow by n^(1/4), so that an elastic plate's largest overlap goes by
  // n^(-1/10), as for a spring of Hertz' law, and the damping ratio by n^(1/8). Without sharing: n,
  // n^(-2/5), n^(1/2). 1e-3: the step is a hundredth of the impact at most.
  const Impact few = flat_impact(2, true), many = flat_impact(10, true);
  CHECK(
      many.overlap / few.overlap ==
      near(std::pow(25, -0.1) * overlap_ratio(100, 0.125) / overlap_ratio(4, 0.125)).epsilon(1e-3));
  CHECK(few.restitution == near(restitution(4, 0.125)).epsilon(1e-3));
  CHECK(many.restitution == near(restitution(100, 0.125)).epsilon(1e-3));
  const Impact alone_few = flat_impact(2, false), alone_many = flat_impact(10, false);
  CHECK(alone_few.restitution == near(restitution(4, 0.5)).epsilon(1e-3));
  // Beyond critical damping velocities of half a step ago leave an error of first order: 4e-3.
  CHECK(alone_many.restitution == near(restitution(100, 0.5)).epsilon(6e-3));
  CHECK(alone_many.overlap / alone_few.overlap ==
        near(std::pow(25, -0.4) * overlap_ratio(100, 0.5) / overlap_ratio(4, 0.5)).epsilon(6e-3));
}

TEST_CASE("Two plates share the contacts between them") {
  const auto run = [](int n, bool share) {
    silt::Particles<MultiSphere> two;
    two.add_form(plate(n));
    two.add({.position = {0, 0, 0.55e-3}, .density = 2500, .velocity = {0, 0, -0.3}});
    two.add({.position = {0, 0, -0.55e-3}, .density = 2500, .velocity = {0, 0, 0.3}});
    silt::Simulation sim{std::move(two), silt::Contacts<HertzMindlin>{smooth}};
    sim.share_contacts(share);
    sim.time_step = 2e-7;
    sim.run(2e-3);
    return Impact{(sim.velocity(sim.find(0)).z - sim.velocity(sim.find(1)).z) / 0.6,
                  sim.peak_overlap()};
  };
  const Impact few = run(2, true), many = run(8, true);
  CHECK(few.restitution == near(restitution(4, 0.125)).epsilon(1e-3));
  CHECK(many.restitution == near(restitution(64, 0.125)).epsilon(1e-3));
  CHECK(run(8, false).restitution == near(restitution(64, 0.5)).epsilon(7e-3));
}

TEST_CASE("An elastic plate that falls onto an edge, rocks and flies off keeps its energy") {
  const auto error = [](double tilt, bool share) {
    auto elastic = smooth;
    elastic.restitution = 1, elastic.youngs_modulus = 1e8;
    silt::Particles<MultiSphere> one;
    one.add_form(plate(5));
    one.add({.position = {0, 0, 2.5e-3},
             .orientation = silt::rotation_about({0.8, 0.6, 0}, tilt),
             .density = 2500,
             .velocity = {0, 0, -0.5}});
    silt::Simulation sim{std::move(one), silt::Contacts<HertzMindlin>{elastic}};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, elastic);
    sim.share_contacts(share);
    sim.time_step = 5e-8;
    const auto energy = [&] {
      const Vec3d v = sim.velocity(0),
                  w = rotate(conjugate(sim.orientation(0)), sim.angular_velocity(0));
      return 0.5 * sim.mass(0) *
             (dot(v, v) + 2.2e-6 * (w.x * w.x + w.y * w.y) + 4.2e-6 * w.z * w.z);
    };
    sim.run(0);
    const double before = energy();
    sim.run(0.01);
    return energy() / before - 1;
  };
  for (const double tilt : {0.02, 0.1, 0.3}) {
    CHECK(std::abs(error(tilt, false)) < 1e-4);
    CHECK(std::abs(error(tilt, true)) < 1e-3);  // stiffer against tilting: larger errors of a step
  }
}

}  // namespace shared_contacts_test
