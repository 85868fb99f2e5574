// silt - BSD-3-Clause, see LICENSE
// A mat of fibres: they fall on each other, come to rest, and a plate presses them.
//   fibres that come apart or slip through walls; loads that do not balance; a mat that does not
//   give way; fibres that stay bent without a load; bonds that make energy; results that depend on
//   the number of threads
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/boundary/finite_walls.hpp>
#include <silt/boundary/plane.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace fibre_mat_test {

constexpr double R = 1e-3, width = 24 * R, g = 9.81;
constexpr std::size_t fibres = 50, spheres = 7;
const silt::HertzMindlin::Material rubber{
    .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.4};

auto mat() {
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{rubber},
                       silt::Bonds{silt::ParallelBond{.youngs_modulus = 1e6, .damping = 0.2}},
                       silt::EnergyLedger{}};
  sim.gravity = {0, 0, -g};
  for (std::size_t k = 0; k < fibres; ++k) {
    const double turn = 2.399963 * static_cast<double>(k), half = (spheres - 1) * R;
    const silt::Vec3d way{half * std::cos(turn), half * std::sin(turn), 0};
    const silt::Vec3d middle{width * (0.5 + 0.15 * std::sin(1.7 * static_cast<double>(k))),
                             width * (0.5 + 0.15 * std::cos(2.3 * static_cast<double>(k))),
                             R * (1.5 + 2.2 * static_cast<double>(k))};
    add_bonded(sim, silt::fibre(middle - way, middle + way, spheres, {R, 1000}));
  }
  sim.add_wall(silt::box({0, 0, 0}, {width, width, 200 * R}), rubber, {.name = "box"});
  return sim;
}
template <class Sim>
double top(const Sim& sim) {
  double z = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) z = std::max(z, sim.position(k).z + R);
  return z;
}
template <class Sim>
double mean_height(const Sim& sim) {
  return sim.centre_of_mass().z;
}
template <class Sim>
void check_whole(const Sim& sim) {
  CHECK(sim.bonds() == fibres * (spheres - 1));
  CHECK(sim.broken_bonds() == 0);
  const auto parts = silt::fragments(sim);
  CHECK(parts.spheres == std::vector<std::size_t>(fibres, spheres));
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const auto p = sim.position(k);
    CHECK((p.x > 0.8 * R && p.x < width - 0.8 * R && p.y > 0.8 * R && p.y < width - 0.8 * R));
    CHECK(p.z > 0.8 * R);
  }
}

TEST_CASE("a mat of 50 fibres settles, gives way under a plate, and relaxes without it") {
  auto sim = mat();
  sim.threads = 1;
  sim.run(0.4);
  check_whole(sim);
  const double weight = sim.total_mass() * g;
  CHECK(-sim.wall("box").force.z == near(weight).epsilon(0.01));
  // At rest, beside what a fall through a radius gives.
  CHECK(sim.kinetic_energy() < 1e-4 * weight * R);
  const double loose = mean_height(sim);
  // Heights under a dead weight of 5, 10 and 20 times the mat's own.
  const double start = top(sim) + 0.1 * R;
  std::vector<double> heights;
  for (const double times : {5.0, 10.0, 20.0}) {
    const silt::Slide plate{.direction = {0, 0, 1}, .mass = times * sim.total_mass(), .damping = 1};
    if (heights.empty())
      sim.add_wall(silt::Plane{{0, 0, start}, {0, 0, -1}}, rubber,
                   {.name = "plate", .drive = plate});
    else
      sim.set_drive("plate", plate);
    sim.run(0.3);
    CHECK(sim.wall("plate").force.z == near(times * weight).epsilon(0.02));
    CHECK(-sim.wall("box").force.z == near((times + 1) * weight).epsilon(0.02));
    heights.push_back(mean_height(sim));
    check_whole(sim);
  }
  CHECK(heights[0] < loose);
  CHECK(heights[1] < 0.995 * heights[0]);
  CHECK(heights[2] < 0.995 * heights[1]);
  const auto pressed = sim.energy();
  CHECK(pressed.bonds > 1e-2 * weight * R);  // fibres are bent
  sim.set_motion("plate", silt::from(sim.time(), silt::translation({0, 0, 0.05})));
  sim.run(0.2);
  check_whole(sim);
  // Fibres that are let go straighten; how much of the height comes back depends on how they slid.
  CHECK(mean_height(sim) > 0.98 * heights[2]);
  CHECK(mean_height(sim) < loose);
  CHECK(sim.energy().bonds < 0.01 * pressed.bonds);
  INFO("mean height over radius: loose ", loose / R, ", ", heights[0] / R, ", ", heights[1] / R,
       ", ", heights[2] / R, ", released ", mean_height(sim) / R, "; bonds hold ", pressed.bonds,
       " J, then ", sim.energy().bonds, " J; residual ", sim.energy().residual(), " J of ",
       sim.energy().dissipated(), " J; step ", sim.step_length(), " s, at rest ",
       sim.kinetic_energy(), " J");
  CHECK(std::abs(sim.energy().residual()) < 1e-4 * sim.energy().dissipated());
}

TEST_CASE("a mat of fibres falls to the same bits on one thread and on two") {
  std::vector<silt::Vec3d> places[2];
  for (const int threads : {1, 2}) {
    auto sim = mat();
    sim.threads = threads;
    sim.run(0.08);
    CHECK(sim.touching_pairs() > 10);
    for (std::size_t k = 0; k < sim.rows(); ++k)
      places[threads - 1].push_back(sim.position(sim.find(static_cast<silt::ParticleId>(k))));
  }
  CHECK(places[0] == places[1]);
}

}  // namespace fibre_mat_test
