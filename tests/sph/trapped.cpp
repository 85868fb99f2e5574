// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <silt/silt.hpp>
#include <silt/sph.hpp>

#include "near.hpp"

namespace sph_trapped_test {

using namespace silt;

namespace {

constexpr double spacing = 0.01;

std::vector<double> numbers_of(const auto& sph) {
  std::vector<double> all(7 * sph.size());
  sph.for_each([&](std::uint32_t n, const Vec3d& x, const Vec3d& v, double density, double) {
    const double of[7] = {x.x, x.y, x.z, v.x, v.y, v.z, density};
    std::copy_n(of, 7, all.begin() + 7 * static_cast<std::ptrdiff_t>(n));
  });
  return all;
}

}  // namespace

// Without SphTrapped the particle stays in the body, and its density drifts.
TEST_CASE("SPH: liquid that has got into a body is put in front of it, with its velocity") {
  const std::vector<Vec3d> at{{0.1, 0, 0.05}}, still{{0, 0, 0}}, fast{{0, 0, 200}};
  const std::vector<double> radius{0.03}, mass{2.8}, volume{2.8e-3};
  const std::vector<ParticleId> id{7};
  CoupledParticles of{};
  of.shape.position = at, of.shape.radius = radius, of.velocity = fast;
  of.volume = volume, of.mass = mass, of.angular_velocity = still, of.id = id;
  Sph sph{Liquid{.density = 1000, .sound_speed = 20},
          {.spacing = spacing, .region = {{0, 0, 0}, {0.2, 0, 0.2}}, .dimensions = 2},
          Inviscid{},
          EnergyLedger{}};
  sph.fill(
      [](const Vec3d& x) {
        return norm(x - Vec3d{0.1, 0, 0.15}) < 0.008;
      },
      [](const Vec3d&) {
        return Vec3d{0.1, 0, 0};
      },
      [](const Vec3d&) { return 0.0; });
  const std::size_t count = sph.size();
  const double mass_before = sph.mass();
  const Vec3d momentum = sph.momentum();
  auto force = still, torque = still;
  sph.advance(of, 1e-7, force, {}, torque);
  // The body is farther away than the liquid sees, and gets there in one long step.
  const double h = sph.setup().h(), step = 0.6 * h / 20 * 0.99;
  const std::vector<Vec3d> jump{{0, 0, 0.09 / step}};
  of.velocity = jump;
  sph.advance(of, 1e-7, force, {}, torque);
  sph.step(step);
  std::size_t inside = 0;
  sph.run(1e-9);
  sph.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) {
    if (norm(x - Vec3d{0.1, 0, 0.14}) < 0.03 - 0.5 * spacing) ++inside;
  });
  CHECK(inside == 0);
  CHECK(sph.size() == count);
  CHECK(sph.displaced() == 0);
  CHECK(sph.mass() == mass_before);
  CHECK(norm(sph.momentum() - momentum) < 1e-3 * norm(momentum));
}

namespace {

/// A block of 0.16 by 0.08 m, twice as heavy as water, over the floor of a tank. It falls flat.
auto sinking_block(double s) {
  const double L = 0.48, d = 0.2, a = 0.16, b = 0.08, g = 9.81;
  Sph water{
      Liquid{.density = 1000, .sound_speed = 10 * std::sqrt(2 * g * d)},
      {.spacing = s, .region = {{0, 0, 0}, {L, 0, 1}}, .dimensions = 2, .gravity = {0, 0, -g}},
      ArtificialViscosity{.alpha = 0.1}};
  std::vector<Vec3d> corners;
  for (const double x : {-a / 2, a / 2})
    for (const double y : {-0.5, 0.5})
      for (const double z : {-b / 2, b / 2}) corners.push_back({x, y, z});
  Particles<Polyhedron> blocks;
  const auto form = blocks.add_form(Polyhedron::from_points(corners));
  blocks.add({.form = form, .position = {L / 2, 0, d}, .density = 2000});
  const HertzMindlin::Material stone{
      .youngs_modulus = 1e7, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.3};
  water.fill([=](const Vec3d& x) {
    return x.z < d && !(std::abs(x.x - L / 2) < a / 2 && x.z > d - b / 2);
  });
  Simulation sim{std::move(blocks), Contacts<HertzMindlin>{stone}, std::move(water)};
  sim.gravity = {0, 0, -g};
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, stone);
  sim.add_wall(Plane{{0, 0, 0}, {1, 0, 0}}, stone);
  sim.add_wall(Plane{{L, 0, 0}, {-1, 0, 0}}, stone);
  sim.run(1e-3);
  return sim;
}

}  // namespace

// It presses what is below it into the floor. Left there it sank through the floor, and two to four
// particles of 224 were lost.
TEST_CASE("SPH: liquid that a block presses into the floor is turned back") {
  constexpr double s = 0.02;
  auto sim = sinking_block(s);
  const std::size_t liquid = sim.fluid().size();
  double deepest = 0;
  for (int k = 0; k < 80; ++k) {
    sim.run(0.02);
    sim.fluid().for_each([&](std::uint32_t, const Vec3d& x, const Vec3d&, double, double) {
      deepest = std::max(deepest, -x.z / s);
    });
  }
  CHECK(sim.fluid().size() == liquid);
  CHECK(deepest > 0.3);   // else this tests nothing
  CHECK(deepest < 0.75);  // from there on it is moved out
}

#ifdef SILT_LONG_TESTS
// It presses liquid through its lower side when it hits the floor. Left there this gave the
// pressure of the gap under the block, and after 3 s the block, twice as heavy as water, rose by
// two spacings.
TEST_CASE("SPH: a heavy block that sinks stays on the floor") {
  auto sim = sinking_block(spacing);
  const std::size_t liquid = sim.fluid().size();
  sim.run(3);
  for (int k = 0; k < 10; ++k) {
    sim.run(0.1);
    CHECK(std::abs(sim.position(0).z - 0.04) < 0.5 * spacing);  // it sinks 2.5 mm into this floor
  }
  CHECK(sim.fluid().size() == liquid);
}
#endif

// Packs have as many particles as the processor has lanes: a state of one with other packs is
// sorted anew.
TEST_CASE("SPH: a state with packs of another width continues as the same liquid") {
  const auto tank = [] {
    Sph sph{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = spacing,
             .region = {{0, 0, 0}, {0.3, 0, 0.3}},
             .dimensions = 2,
             .gravity = {0, 0, -9.81}}};
    sph.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}), sph.add_wall(Plane{{0, 0, 0}, {1, 0, 0}});
    sph.add_wall(Plane{{0.3, 0, 0}, {-1, 0, 0}});
    return sph;
  };
  auto one = tank();
  one.fill([](const Vec3d& x) { return x.z < 0.2 - 0.2 * x.x; });
  one.run(0.055);
  std::map<std::string, std::vector<double>> kept;
  one.for_each_state([&](const std::string& name, auto&& values) {
    kept[name].assign(values.begin(), values.end());
  });
  const auto load = [&](auto& into) {
    into.for_each_state([&](const std::string& name, auto&& values) {
      if constexpr (requires { values.resize(1); }) values.resize(kept[name].size());
      std::copy(kept[name].begin(), kept[name].end(), values.begin());
    });
  };
  auto same = tank(), other = tank();
  load(same);
  kept["fluid.numbers"].back() = 3;
  load(other);
  one.run(0.02), same.run(0.02), other.run(0.02);
  const auto a = numbers_of(one), b = numbers_of(same), c = numbers_of(other);
  CHECK(a == b);
  double off = 0;
  for (std::size_t k = 0; k < a.size(); k += 7)
    for (std::size_t d = 0; d < 3; ++d) off = std::max(off, std::abs(a[k + d] - c[k + d]));
  CHECK(off > 0);           // otherwise it was not sorted anew
  CHECK(off < 1e-9 * 0.3);  // the order of sums, over 40 steps
}

}  // namespace sph_trapped_test
