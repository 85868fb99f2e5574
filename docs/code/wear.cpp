// silt - BSD-3-Clause, see LICENSE
// Wear of a chute, of docs/wear.md: a bead lands on it and slides down.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

using silt::Vec3d;
using Sliding = silt::Wear<silt::Archard>;
using Cutting = silt::Wear<silt::Finnie>;

int main() {
  const silt::LinearSpringFriction::Material glass{.stiffness = 1e4, .restitution = 0.2};
  const double R = 2e-3, slope = 0.5, g = 9.81, fall = 0.05;  // [m], [rad], [m/s2], [m]
  silt::Particles<silt::Sphere> bead;
  bead.add({.position = {0, 0, R + fall}, .radius = R, .density = 2500});

  silt::Simulation sim{std::move(bead), silt::Contacts<silt::LinearSpringFriction>{glass},
                       Sliding{{.coefficient = 1e-4, .hardness = 2e9}},
                       Cutting{{.flow_stress = 1e9, .share_cutting = 0.5}}};
  // The chute lies in z = 0, and gravity is inclined.
  sim.gravity = {g * std::sin(slope), 0, -g * std::cos(slope)};
  sim.add_wall(silt::TriangleMesh({{Vec3d{-1, -1, 0}, Vec3d{1, -1, 0}, Vec3d{1, 1, 0}},
                                   {Vec3d{-1, -1, 0}, Vec3d{1, 1, 0}, Vec3d{-1, 1, 0}}}),
               glass, {.name = "chute"});
  sim.run(0.3);

  const double slid = silt::worn_volume<Sliding>(sim, "chute");  // [m3]
  const double cut = silt::worn_volume<Cutting>(sim, "chute");
  silt::write_wear<Sliding>("chute.vtp", sim, "chute");

  // v = g_x t along the chute, F = m (g_z + dv_z/dt) across it: however the bead bounces before it
  // comes to rest on it, the integral of F v over time is m g_x (g_z t^2/2 + fall).
  const double g_x = sim.gravity.x, g_z = -sim.gravity.z, t = sim.time();
  const double expected = 1e-4 / 2e9 * sim.mass(0) * g_x * (g_z * t * t / 2 + fall);
  std::printf("slid %.4g m3, %.4g expected; cut %.4g m3\n", slid, expected, cut);
  return std::abs(slid / expected - 1) < 1e-3 && cut > 0 ? 0 : 1;
}
