// silt - BSD-3-Clause, see LICENSE
//
// Bodies of convex parts on the rims of cylinders and cones: against spheres, energy, a block at
// rest.
#include <silt/shape/mix.hpp>
#include <silt/silt.hpp>

#include "engine/body_totals.hpp"
#include "engine/stones.hpp"
#include "engine/support.hpp"
#include "near.hpp"

namespace rims_test {

namespace {

using namespace engine_test;
using silt::Polyhedron;
using Grains = silt::Mix<silt::SuperEllipsoid, Polyhedron>;

silt::Particles<Grains> of_all_forms() {
  silt::Particles<Grains> grains;
  const silt::SuperEllipsoid pill{.a = 1e-3, .b = 1e-3, .c = 0.6e-3, .s1 = 6, .s2 = 2};
  grains.add_form(pill);
  grains.add_form(silt::SuperEllipsoid{.a = 0.9e-3, .b = 0.9e-3, .c = 0.9e-3, .s1 = 8, .s2 = 8});
  grains.add_form(block(0.5e-3, 0.7e-3, 0.6e-3, 0.3e-3));
  grains.add_form(block(0.8e-3, 0.6e-3, 0.7e-3));
  return grains;
}

const silt::Cylinder tube{{0, 0, 0}, {0, 0, -0.05}, 4e-3, silt::Side::Inside};

}  // namespace

TEST_CASE("Balls as super-ellipsoids bounce off rims as spheres do") {
  const auto run = [](auto particles, const silt::Surfaces& wall, double time_step) {
    silt::Simulation sim{std::move(particles), silt::Contacts<HertzMindlin>{stone(0.7, 0.5)}};
    sim.gravity = {0.5, 0, -9.81};
    sim.time_step = time_step;
    sim.add_wall(wall, stone(0.7, 0.5));
    sim.run(0.012);
    return std::array{sim.velocity(0), sim.angular_velocity(0) * 1e-3};
  };
  const auto apart = [&](const silt::Surfaces& wall, double time_step) {
    const Vec3d from{3.3e-3, 0.3e-3, 2e-3}, v{0.1, 0.05, -0.5}, w{30, 40, 50};
    silt::Particles<Sphere> sphere;
    sphere.add({from, 1e-3, 2500, v, w});
    silt::Particles<Grains> body;
    body.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 1e-3, .c = 1e-3});
    body.add({.position = from,
              .orientation = silt::rotation_about({0.6, 0, 0.8}, 1),
              .density = 2500,
              .velocity = v,
              .angular_velocity = w});
    const auto a = run(sphere, wall, time_step), b = run(body, wall, time_step);
    CHECK(norm(a[0] - v) > 0.3);  // it has met the rim
    return std::max(norm(a[0] - b[0]), norm(a[1] - b[1]));
  };
  const silt::Cone outlet{{0, 0, 0}, {0, 0, 0.02}, 4e-3, 8e-3, silt::Side::Inside};
  // A hopper: both surfaces end in the same rim, which counts once.
  const silt::Surfaces hopper(std::vector<silt::Surface>{outlet, tube});
  for (const silt::Surfaces& wall : {silt::Surfaces(tube), hopper}) {
    // First order in the step: arms of contacts are those of now, velocities half a step older.
    const double coarse = apart(wall, 8e-6), fine = apart(wall, 1e-6);
    CHECK(coarse < 5e-5);
    CHECK(fine < std::max(coarse / 4, 1e-9));
  }
}

TEST_CASE("Rims without friction take no energy from any shape") {
  const silt::Cone spike{{0, 0, 0}, {0, 0, -0.05}, 4e-3, 8e-3, silt::Side::Outside};
  silt::Random random(8);
  for (const silt::Surfaces& wall : {silt::Surfaces(tube), silt::Surfaces(spike)})
    for (std::size_t form = 0; form < of_all_forms().forms().size(); ++form) {
      auto one = of_all_forms();
      one.add({.form = form,
               .position = {3.9e-3, 0, 3e-3},
               .orientation = silt::random_orientation(random),
               .density = 2500,
               .velocity = {0, 0.05, -1},
               .angular_velocity = {100, 50, -200}});
      const auto error = [&](double time_step) {
        silt::Simulation sim{one, silt::Contacts<HertzMindlin>{stone(1, 0)}};
        sim.time_step = time_step;
        sim.add_wall(wall, stone(1, 0));
        sim.run(0);
        const double before = totals(sim).energy;
        sim.run(0.004);
        CHECK(norm(sim.velocity(0) - Vec3d{0, 0.05, -1}) > 0.1);  // it has met the rim
        return std::abs(totals(sim).energy / before - 1);
      };
      INFO("form ", form);
      // Second order in the step; but corners of the sharp cube hand over to the rim by jumps.
      const bool sharp = form == 3;
      CHECK(error(2e-6) < (sharp ? 2e-3 : 2e-5));
      CHECK(error(0.5e-6) < (sharp ? 2e-3 : 2e-6));
    }
}

TEST_CASE("A block across the rim of an upright tube stays where it is") {
  for (const double dilation : {0., 0.3e-3})
    for (const double half : {3e-3, 6e-3}) {  // [m] narrower than the mouth, and wider
      silt::Particles<Grains> one;
      one.add_form(block(8e-3 - dilation, half - dilation, 2e-3 - dilation, dilation));
      one.add({.position = {0.3e-3, 0.2e-3, 2e-3}, .density = 2500});
      silt::Simulation sim{std::move(one), silt::Contacts<HertzMindlin>{stone(0.3, 0.5)}};
      sim.gravity = {0, 0, -9.81};
      sim.add_wall(tube, stone(0.3, 0.5));
      sim.run(0.2);
      const Vec3d from = sim.position(0);
      sim.run(0.3);
      const auto q = sim.orientation(0);
      INFO("dilation ", dilation, " half width ", half);
      CHECK(norm(sim.position(0) - from) < 1e-6);
      CHECK(norm(sim.position(0) - Vec3d{0.3e-3, 0.2e-3, 2e-3}) < 2e-5);
      CHECK(norm(Vec3d{q.x, q.y, q.z}) < 1e-3);
    }
}

}  // namespace rims_test
