// silt - BSD-3-Clause, see LICENSE
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
    for (double& d : depths) d = Shares::strength(d, 1e-3, exponent);
    return Shares::share(depths[k], depths, exponent);
  };
  const std::vector<double> same{1e-6, 1e-6, 1e-6}, begun{1e-6, 1e-8};
  CHECK(3 * share(0, same, 2.5) == near(std::pow(3, 0.25)).epsilon(1e-12));
  CHECK(3 * share(0, same, 2) == near(std::pow(3, 0.2)).epsilon(1e-12));
  CHECK(share(0, begun, 2.5) == near(1).epsilon(1e-12));
  CHECK(share(1, begun, 2.5) < 1e-14);
}

TEST_CASE("The shared force is the gradient of an energy") {
  // U = D^(5/2), e = R^(1/5) d; the law's force (5/2) sqrt(R) d^(3/2).
  const std::vector<double> depth{1.0, 0.9, 0.97, 0.3}, radius{1, 2, 1.5, 0.7};
  const auto strengths = [&](const std::vector<double>& depths) {
    std::vector<double> all;
    for (std::size_t k = 0; k < depths.size(); ++k)
      all.push_back(Shares::strength(depths[k], radius[k], 2.5));
    return all;
  };
  const auto energy = [&](const std::vector<double>& depths) {
    double sum = 0;
    for (std::size_t k = 0; k < depths.size(); ++k)
      sum += std::pow(radius[k], 2) * std::pow(depths[k], 10);
    return std::pow(sum, 0.25);
  };
  for (std::size_t k = 0; k < depth.size(); ++k) {
    auto more = depth, less = depth;
    more[k] += 1e-6, less[k] -= 1e-6;
    const double gradient = (energy(more) - energy(less)) / 2e-6;
    const auto all = strengths(depth);
    const double force =
        2.5 * std::sqrt(radius[k]) * std::pow(depth[k], 1.5) * Shares::share(all[k], all, 2.5);
    CHECK(std::abs(gradient - force) < 1e-9);
  }
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
