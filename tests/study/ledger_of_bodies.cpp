// silt - BSD-3-Clause, see LICENSE
//
// The energy ledger with bodies of each kind, on planes and on meshes.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <silt/shape/mix.hpp>
#include <silt/silt.hpp>

namespace ledger_of_bodies_test {

using silt::Vec3d;

namespace {

using Grains = silt::Mix<silt::Sphere, silt::MultiSphere, silt::SuperEllipsoid, silt::Polyhedron>;

std::vector<Vec3d> corners_of_cube(double a) {
  std::vector<Vec3d> all;
  for (int k = 0; k < 8; ++k) all.push_back({k & 1 ? a : -a, k & 2 ? a : -a, k & 4 ? a : -a});
  return all;
}

/// How far the losses of a run fall back at most, over the energy [-].
struct Backwards {
  double friction = 0, damping = 0, normal = 0, least = 0;
};
template <class Sim>
Backwards losses_of(Sim& sim, double duration) {
  Backwards b;
  std::array<double, 3> most{};
  sim.run(duration, [&](const auto& s) {
    const auto e = s.energy();
    const double losses[] = {e.friction, e.tangential_damping, e.normal_damping};
    double* back[] = {&b.friction, &b.damping, &b.normal};
    for (int k = 0; k < 3; ++k) {
      most[k] = std::max(most[k], losses[k]);
      *back[k] = std::max(*back[k], (most[k] - losses[k]) / e.initial);
    }
    b.least = std::min({b.least, e.normal / e.initial, e.tangential / e.initial});
  });
  return b;
}

/// Two bodies, `kinds`, that fall on a plane or a mesh with spin, the upper one on the lower.
auto falling(const std::array<int, 2>& kinds, bool on_mesh, silt::Random& random) {
  silt::Particles<Grains> grains;
  const std::array forms{
      grains.add_form(silt::Sphere{}),
      grains.add_form(silt::MultiSphere{{{{-0.6e-3, 0, 0}, 0.7e-3}, {{0.5e-3, 0, 0}, 0.8e-3}}}),
      grains.add_form(silt::SuperEllipsoid{1e-3, 1e-3, 0.6e-3, 4, 3}),
      grains.add_form(silt::Polyhedron::from_points(corners_of_cube(0.8e-3)))};
  for (int k = 0; k < 2; ++k)
    grains.add(
        {.form = forms[kinds[k]],
         .position = {0, 0, k == 0 ? 1.5e-3 : 4e-3},
         .radius = 1e-3,
         .density = 2500,
         .velocity = {2 * random.normal(), 2 * random.normal(), k == 0 ? -0.5 : -2.0},
         .angular_velocity = Vec3d{random.normal(), random.normal(), random.normal()} * 500.0});
  const silt::HertzMindlin::Material m{1e7, 0.25, random.uniform(0.3, 0.95),
                                       random.uniform(0.05, 1)};
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{m},
                       silt::EnergyLedger{}};
  if (on_mesh)
    sim.add_wall(silt::TriangleMesh(std::vector<std::array<Vec3d, 3>>{
                     {Vec3d{-1, -1, 0}, Vec3d{1, -1, 0}, Vec3d{1, 1, 0}},
                     {Vec3d{-1, -1, 0}, Vec3d{1, 1, 0}, Vec3d{-1, 1, 0}}}),
                 m);
  else
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, m);
  sim.guard.max_overlap = 0.6;
  return sim;
}

}  // namespace

TEST_CASE("ledger: losses only grow in random impacts of all shapes, on planes and meshes") {
  silt::Random random(5);
  for (int run = 0; run < 16; ++run) {
    CAPTURE(run);
    auto sim = falling({run % 4, (run + run / 4) % 4}, run & 1, random);
    sim.time_step = 1e-6;
    const auto back = losses_of(sim, 3e-3);
    CHECK(sim.energy().friction > 0);
    CHECK(back.friction == 0);
    CHECK(back.damping < 5e-6);
    CHECK(back.normal < 5e-6);
    CHECK(back.least >= 0);
  }
}

/// Leaves huge numbers where functions that are called next have their variables.
#if defined(__GNUC__)
__attribute__((noinline))
#endif
void fill_stack() {
  volatile double rest[1 << 15];  // 256 KiB
  for (auto& x : rest) x = 1e200;
}

// One pair of polyhedra does not fill a pack of lanes. What memory held in the other lanes went
// into the books, times 0: a NaN where their velocity overflowed.
TEST_CASE("ledger: one pair of cubes, whatever the stack held before") {
  silt::Particles<Grains> grains;
  const std::size_t cube =
      grains.add_form(silt::Polyhedron::from_points(corners_of_cube(1e-3 / std::sqrt(3))));
  for (int k = 0; k < 2; ++k)
    grains.add({.form = cube,
                .position = {0, 0, k == 0 ? 0 : 1.3e-3},
                .radius = 1e-3,
                .density = 2500,
                .velocity = {0, k == 0 ? 0.1 : 0, k == 0 ? 0.5 : -0.5}});
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{{1e7, 0.25, 0.5, 0.5}},
                       silt::EnergyLedger{}};
  sim.threads = 1;
  sim.time_step = 1e-6;
  double most = 0;
  fill_stack();
  sim.run(6e-4, [&](const auto& s) {
    const auto e = s.energy();
    most = std::max(most, std::isfinite(e.residual()) ? std::abs(e.residual()) : INFINITY);
    fill_stack();
  });
  CHECK(sim.energy().normal_damping > 0.1 * sim.energy().initial);
  CHECK(most < 1e-3 * sim.energy().initial);
}

}  // namespace ledger_of_bodies_test
