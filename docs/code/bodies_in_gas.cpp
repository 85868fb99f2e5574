// silt - BSD-3-Clause, see LICENSE
// The bodies in a gas of docs/fluid.md: rods that fall side by side through air at rest.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <silt/fluid.hpp>

int main() {
  const double width = 0.03;  // [m]
  silt::Particles<silt::SuperEllipsoid> rods;
  rods.add_form(silt::SuperEllipsoid{.a = 3, .b = 1, .c = 1});
  for (int k = 0; k < 3; ++k)  // horizontal, inclined and upright
    rods.add({.position = {0.005 + 0.01 * k, 0.015, 0.025},
              .orientation = silt::rotation_about({0, 1, 0}, 0.785 * k),
              .radius = 1.5e-3,
              .density = 300});

  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {width, width, width}}, {6, 6, 6}),
                        {.density = 1.2, .viscosity = 1.8e-5});
  silt::CoupledFlow gas{silt::OrientedDrag{}, silt::Kernel{}, flow, silt::InclinedLift{},
                        silt::EllipsoidTorque{}};
  silt::Simulation sim{std::move(rods), silt::Contacts<silt::HertzMindlin>{{1e6, 0.3, 0.8, 0.3}},
                       gas};
  sim.gravity = {0, 0, -9.81};
  sim.run(0.05);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    std::printf("falls with %.4f m/s, glides with %.4f m/s\n", -sim.velocity(k).z,
                sim.velocity(k).x);

  // Fails if drag does not depend on the orientation of a rod (broadside it must be 1.15 to 2 times
  // that along the axis), if lift is missing or has the wrong direction (only the inclined rod
  // glides, towards its lower end), or if there is no drag at all.
  const auto braked = [&](std::size_t k) {
    return 9.81 * sim.time() + sim.velocity(k).z;
  };  // [m/s]
  const auto glide = [&](std::size_t k) { return sim.velocity(k).x; };
  const bool drag = braked(2) > 0.005 && braked(0) < 0.05 && braked(1) > braked(2) &&
                    braked(0) > braked(1) && braked(0) > 1.15 * braked(2) &&
                    braked(0) < 2 * braked(2);
  const bool lift = glide(1) > 1e-3 && glide(1) < 0.01 &&
                    std::max(std::abs(glide(0)), std::abs(glide(2))) < 0.05 * glide(1);
  if (drag && lift) return 0;
  std::printf("wrong: %s\n", !drag ? "a level rod must be braked most, an upright one least"
                                   : "the askew rod must glide to its lower end, the others not");
  return 1;
}
