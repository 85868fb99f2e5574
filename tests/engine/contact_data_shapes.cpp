// silt - BSD-3-Clause, see LICENSE
//
// for_each_contact() of shapes with narrow phases of their own: the same sums as of spheres.
#include "engine/contact_sums.hpp"
#include "engine/stones.hpp"
#include "near.hpp"

#include <silt/shape/mix.hpp>

namespace contact_data_shapes_test {

using namespace engine_test;
using silt::Vec3d;

const HertzMindlin::Material rock = stone(0.5, 0.5);

/// A floor of four triangles in a wall that shakes.
void add_floor(auto& sim, double w, double z) {
  const Vec3d a{0, 0, z}, b{w, 0, z}, c{w, w, z}, d{0, w, z}, m{0.5 * w, 0.5 * w, z - 1e-3};
  sim.add_wall(silt::TriangleMesh({{a, b, m}, {b, c, m}, {c, d, m}, {d, a, m}}), rock,
               silt::vibration({0, 0, 0.2e-3}, 60));
}

TEST_CASE(
    "contact data: ellipsoids and boxes with round edges, on planes in lanes and a cylinder") {
  // Contacts of the boxes have an area: three points with a memory each, and a moment.
  for (const double s : {2.0, 5.0}) {
    silt::Particles<silt::SuperEllipsoid> p;
    p.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 0.8e-3, .c = 1.2e-3, .s1 = s, .s2 = s});
    p.fill({{0.1e-3, 0.1e-3, 4e-3}, {9.9e-3, 9.9e-3, 30e-3}},
           {.radius = 1.2e-3, .density = 2500, .count = 60, .velocity = {0.1, 0, -0.4}});
    silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rock}};
    sim.gravity = {0, 0, -9.81};
    sim.add_wall(silt::box({0, 0, 0}, {0.01, 0.01, 0.1}), rock);
    sim.add_wall(
        silt::Cylinder{{5e-3, -0.01, 1e-3}, {5e-3, 0.02, 1e-3}, 1.5e-3, silt::Side::Outside}, rock);
    const auto check = check_sums(sim, 0.08, 20, 1e-8);
    CHECK(check.contacts > 1000);
  }
}

TEST_CASE("contact data: a periodic mix of balls, ellipsoids and stones on a mesh that shakes") {
  using Grains = silt::Mix<Sphere, silt::SuperEllipsoid, silt::Polyhedron>;
  silt::Particles<Grains> p;
  p.add_form(Sphere{});
  p.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 1e-3, .c = 0.7e-3, .s1 = 4, .s2 = 2});
  p.add_form(block(0.6e-3, 0.7e-3, 0.8e-3));
  for (std::size_t form = 0; form < 3; ++form)
    p.fill({{0, 0, 0.5e-3}, {0.01, 0.01, 0.06}}, {.radius = silt::uniform(1e-3, 1.2e-3),
                                                  .density = 2500,
                                                  .count = 25,
                                                  .velocity = {0.2, 0, -0.4},
                                                  .form = form});
  silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rock},
                       silt::PeriodicBox{{{0, 0, 0}, {0.01, 0.01, 1}}, {true, false, false}}};
  sim.gravity = {0, 0, -9.81};
  add_floor(sim, 0.01, 0);
  sim.add_wall(silt::Plane{{0, 0, -2e-3}, {0, 0, 1}}, rock);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, rock);
  sim.add_wall(silt::Plane{{0, 0.01, 0}, {0, -1, 0}}, rock);
  const auto check = check_sums(sim, 0.1, 20, 1e-8);
  CHECK(check.contacts > 1000);
  // Ends in the order of ids, whichever shape the narrow phase calls the first; centres apart by
  // the branch, to the nearest image.
  std::size_t wrapped = 0, facets = 0;
  sim.for_each_contact([&](const ContactSeen& c) {
    if (c.wall != silt::no_wall) {
      facets += c.facet != silt::no_facet;
      return;
    }
    const Vec3d apart = sim.position(c.place_a) - sim.position(c.place_b);
    CHECK(norm(sim.domain().shortest(apart) - c.branch) < 1e-12);
    wrapped += norm(apart - c.branch) > 1e-3;
    CHECK(norm(sim.domain().shortest(c.point - sim.position(c.place_a))) < 1.3e-3);
  });
  CHECK(wrapped > 0);
  CHECK(facets > 3);
}

}  // namespace contact_data_shapes_test
