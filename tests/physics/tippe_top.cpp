// silt - BSD-3-Clause, see LICENSE
#include <cmath>

#include <silt/silt.hpp>

#include "physics/support.hpp"

namespace tippe_top_test {

// A tippe top: a ball whose centre of mass is below its centre stands up as it spins. Friction at
// one point of a sphere keeps Jellett's constant -L . x, with x from the centre of mass to that
// point (J. H. Jellett, A Treatise on the Theory of Friction, 1872; recalled), whatever the
// friction law; proof: dL/dt = x times F is normal to x, and L . dx/dt = 0 for a body of
// revolution.

namespace {

using silt::Vec3d;

constexpr double R = 0.02, below = 0.004;  // [m]
constexpr double I1 = 0.36 * R * R, I3 = 0.38 * R * R;

// Per mass [m3/s].
double jellett(const auto& sim) {
  const Vec3d axis = silt::rotate(sim.orientation(0), {0, 0, 1}), w = sim.angular_velocity(0);
  const Vec3d L = I1 * w + (I3 - I1) * dot(w, axis) * axis;
  return -dot(L, below * axis - Vec3d{0, 0, R});
}

}  // namespace

TEST_CASE("a tippe top turns over and keeps Jellett's constant") {
  const double V = 4.0 / 3 * M_PI * R * R * R;
  silt::MultiSphere top{.balls = {{{0, 0, below}, R}}};
  top.mass = silt::MassProperties{
      .volume = V, .centroid = {}, .inertia = {V * I1, V * I1, V * I3}, .axes = {}};
  silt::Particles<silt::MultiSphere> tops;
  const auto form = tops.add_form(top);
  tops.add({.form = form,
            .position = {0, 0, R - below * std::cos(0.1)},
            .orientation = silt::rotation_about({1, 0, 0}, 0.1),
            .density = 1000,
            .angular_velocity = {0, 0, 200}});
  const silt::HertzMindlin::Material wood{
      .youngs_modulus = 1e8, .poisson_ratio = 0.2, .restitution = 0.5, .friction = 0.3};
  silt::Simulation sim{std::move(tops), silt::Contacts<silt::HertzMindlin>{wood}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, wood);

  const double before = jellett(sim), energy = sim.kinetic_energy();
  double largest = 0;
  sim.run(1.5, silt::at(silt::every(0.05), [&](const auto& s) {
            largest = std::max(largest, std::abs(jellett(s) / before - 1));
          }));
  // Upside down, its centre of mass above the centre of the ball by nearly `below`.
  CHECK(silt::rotate(sim.orientation(0), {0, 0, 1}).z < -0.95);
  CHECK(sim.position(0).z > R + 0.9 * below);
  // It pays for the height, and for friction, with spin.
  CHECK(sim.kinetic_energy() < 0.5 * energy);
  // The point where the force acts is nearer by half of the overlap, 3e-5 of R, and the time step
  // leaves 2e-4.
  CHECK(largest < 4e-4);
}

}  // namespace tippe_top_test
