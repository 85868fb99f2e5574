// silt - BSD-3-Clause, see LICENSE

#include <utility>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

#include "near.hpp"

namespace bodies_in_fluid_test {

using silt::Contacts;
using silt::CoupledFlow;
using silt::FlowSolver;
using silt::Grid;
using silt::HertzMindlin;
using silt::Particles;
using silt::Simulation;
using silt::Sphere;

namespace {

const HertzMindlin::Material glass{2e5, 0.3, 0.8, 0.3};

}  // namespace

TEST_CASE("bodies settle in a fluid") {
  // A ball as super-ellipsoid and the same as sphere: the same way down.
  const auto fall = [](auto particles) {
    FlowSolver flow(Grid({{0, 0, 0}, {0.012, 0.012, 0.03}}, {12, 12, 30}), {1000, 1e-2});
    Simulation sim{std::move(particles), Contacts<HertzMindlin>{glass},
                   CoupledFlow{silt::Stokes{}, silt::Kernel{.width = 6}, flow}};
    sim.gravity = {0, 0, -9.81};
    sim.time_step = 2e-5;
    sim.run(0.1);
    return sim.velocity(0).z;
  };
  Particles<Sphere> sphere;
  sphere.add({.position = {6e-3, 6e-3, 0.025}, .radius = 0.25e-3, .density = 2500});
  Particles<silt::SuperEllipsoid> body;
  body.add({.form = body.add_form(silt::SuperEllipsoid{1, 1, 1}),
            .position = {6e-3, 6e-3, 0.025},
            .radius = 0.25e-3,
            .density = 2500});
  Particles<silt::MultiSphere> pair;
  pair.add({.form = pair.add_form(silt::MultiSphere{{{{0, 0, 0}, 1.0}}}),
            .position = {6e-3, 6e-3, 0.025},
            .radius = 0.25e-3,
            .density = 2500});
  const double of_sphere = fall(std::move(sphere));
  // d^2 (rho_p - rho) g/(18 mu); in its own wake in the cells around it a little faster.
  CHECK(of_sphere == near(-0.5e-3 * 0.5e-3 * 1500 * 9.81 / 0.18).epsilon(0.05));
  CHECK(fall(std::move(body)) == near(of_sphere).epsilon(1e-6));
  // The volume of spheres joined is integrated: of this one 8.4e-6 too large.
  CHECK(fall(std::move(pair)) == near(of_sphere).epsilon(8.5e-6));
}

}  // namespace bodies_in_fluid_test
