// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include <silt/io/observers.hpp>

#include "rank_scenes.hpp"

// Bulk figures of chaotic scenes on many ranks, against the scatter of runs of one process whose
// gravity differs by parts in 1e9: a scene on other ranks is one more such run.

namespace parallel_bulk_test {

namespace {

constexpr silt::HertzMindlin::Material beads{
    .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.6, .friction = 0.4};

/// A block of jittered spheres of 1.5 to 2.5 mm.
silt::Particles<silt::Sphere> block(const silt::Vec3d& from, const std::array<int, 3>& numbers) {
  silt::Random random(7);
  silt::Particles<silt::Sphere> all;
  for (int i = 0; i < numbers[0]; ++i)
    for (int j = 0; j < numbers[1]; ++j)
      for (int k = 0; k < numbers[2]; ++k) {
        const auto at = [&](int n) { return 0.0052 * n + 0.0001 * random.uniform(); };
        all.add({.position = from + silt::Vec3d{at(i), at(j), at(k)},
                 .radius = random.uniform(0.0015, 0.0025),
                 .density = 2500});
      }
  return all;
}

using Figures = std::vector<double>;

/// Mean over time of the kinetic energy of all [J], and of how far their centre is along x [m].
class Means {
 public:
  template <class Sim>
  void add(const Sim& sim) {
    energy_ += sim.kinetic_energy();
    double moment = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) moment += sim.mass(k) * sim.position(k).x;
    centre_ += sim.sum_over_ranks(moment) / sim.total_mass();
    ++looks_;
  }
  double energy() const { return energy_ / looks_; }
  double centre() const { return centre_ / looks_; }

 private:
  double energy_ = 0, centre_ = 0, looks_ = 0;
};

template <class Sim>
void prepare(Sim& sim, double gravity) {
  sim.threads = 1, sim.gravity = {0, 0, -9.81 * gravity};
}

/// A bin that runs out through a slot in its floor: mass that has left, and the means of what
/// moves.
template <class... Policies>
Figures bin(double gravity, Policies... policies) {
  silt::Simulation sim{block({0.003, 0.003, 0.003}, {10, 4, 12}),
                       silt::Contacts<silt::HertzMindlin>{beads}, policies...};
  prepare(sim, gravity);
  sim.add_wall(silt::box({0, 0, 0}, {0.055, 0.024, 0.2}), beads);
  sim.run(0.12);
  sim.add_outlet({{0.01, 0, -0.01}, {0.022, 0.024, 0.0027}});
  Means means;
  auto look = silt::at(silt::every(1e-3), [&](const auto& s) { means.add(s); });
  sim.run(0.12, look);
  return {sim.outlet(0).mass, means.energy(), means.centre()};
}
/// A drum that turns: torque on its shell, and the means.
template <class... Policies>
Figures drum(double gravity, Policies... policies) {
  silt::Simulation sim{block({-0.021, 0.003, -0.024}, {9, 4, 9}),
                       silt::Contacts<silt::HertzMindlin>{beads}, policies...};
  prepare(sim, gravity);
  sim.add_wall(silt::Cylinder{{0, 0, 0}, {0, 0.024, 0}, 0.036, silt::Side::Inside}, beads,
               silt::rotation({0, 0, 0}, {0, 1, 0}, 8));
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, beads);
  sim.add_wall(silt::Plane{{0, 0.024, 0}, {0, -1, 0}}, beads);
  sim.run(0.3);
  Means means;
  double torque = 0;
  auto look = silt::at(silt::every(1e-3),
                       [&](const auto& s) { means.add(s), torque += s.wall(0).torque.y; });
  sim.run(0.4, look);
  return {torque, means.energy(), means.centre()};
}
/// A bed on a tilted floor between periodic sides, sheared by its own weight: the load of the
/// floor, and the means.
template <class... Policies>
Figures chute(double gravity, Policies... policies) {
  silt::Simulation sim{
      block({0.002, 0.002, 0.0065}, {10, 4, 9}), silt::Contacts<silt::HertzMindlin>{beads},
      silt::PeriodicBox{{{0, 0, -1}, {0.052, 0.021, 1}}, {true, true, false}}, policies...};
  prepare(sim, gravity);
  const double tilt = 0.46;  // [rad]
  sim.gravity = 9.81 * gravity * silt::Vec3d{std::sin(tilt), 0, -std::cos(tilt)};
  for (int k = 0; k < 13; ++k)  // a rough floor
    sim.add_wall(
        silt::Cylinder{
            {0.004 * k + 0.002, -0.1, 0}, {0.004 * k + 0.002, 0.2, 0}, 0.0017, silt::Side::Outside},
        beads);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, beads);
  sim.run(0.25);
  Means means;
  auto look = silt::at(silt::every(1e-3), [&](const auto& s) { means.add(s); });
  double height = 0;
  sim.run(0.3, look);
  for (std::size_t k = 0; k < sim.rows(); ++k) height += sim.position(k).z;
  return {sim.sum_over_ranks(height), means.energy()};
}

/// Compares each figure on 2 and 4 ranks with those of `runs` runs of one process: it may be 6
/// standard deviations off, as one more of them would be once in 300 (Student, 7 degrees of
/// freedom, with the error of the mean). Three figures, three scenes and two numbers of ranks: one
/// in 20 sets of seeds would fail.
template <class Run>
void compare(const std::string& name, const Run& run) {
  constexpr int runs = 8;
  std::vector<Figures> ones;
  for (int k = 0; k < runs; ++k) ones.push_back(run(1 + 1e-9 * k));
  for (const int n : {2, 4}) {
    Figures many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      const Figures got = run(1, silt::Ranks{comm, silt::Bisection{}});
      if (comm.rank() == 0) many = got;
    });
    for (std::size_t f = 0; f < many.size(); ++f) {
      double mean = 0, square = 0;
      for (const auto& one : ones) mean += one[f] / runs;
      for (const auto& one : ones) square += (one[f] - mean) * (one[f] - mean);
      const double scatter = std::sqrt(square / (runs - 1));
      CAPTURE(name);
      CAPTURE(n);
      CAPTURE(f);
      CAPTURE(mean);
      CAPTURE(scatter);
      CHECK(scatter > 1e-6 * std::abs(mean));  // the runs have parted
      CHECK(std::abs(many[f] - mean) < 6 * scatter);
    }
  }
}

}  // namespace

// Catches: what makes many ranks another material and no single contact would show: contacts that
// lose friction or damping as they pass on, ghosts that are late by a step, loads counted twice.
TEST_CASE(
    "ranks: bulk figures of a bin, a drum and a chute are within the scatter of one process") {
  compare("bin", [](double gravity, auto... ranks) { return bin(gravity, ranks...); });
  compare("drum", [](double gravity, auto... ranks) { return drum(gravity, ranks...); });
  compare("chute", [](double gravity, auto... ranks) { return chute(gravity, ranks...); });
}

}  // namespace parallel_bulk_test
