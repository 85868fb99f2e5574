// silt - BSD-3-Clause, see LICENSE
//
// A stopped run is continued. A rotating drum is filled by an inlet; the run stops halfway and
// continues from a checkpoint. The result is bitwise equal to that of a run without a stop.
//
// picture: draw restart/particles.pvd --colour velocity --time 0.2 0.5 1 --width 1200 -o restart.png

#include <algorithm>
#include <cstdio>

#include <silt/silt.hpp>

// The initial scene. A program that continues builds the same scene, then loads the checkpoint.
auto drum() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e6,  // [Pa]
      .poisson_ratio = 0.25,
      .restitution = 0.7,
      .friction = 0.5,
  };
  silt::Simulation sim{
      silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
      silt::PeriodicBox{{{-0.03, 0, -0.03}, {0.03, 0.02, 0.03}}, {false, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cylinder{{0, -0.02, 0}, {0, 0.04, 0}, 0.03, silt::Side::Inside}, glass,
               silt::rotation({0, 0, 0}, {0, 1, 0}, 6));  // [rad/s]
  sim.add_inlet(silt::Box{{-0.01, 0.002, 0.005}, {0.01, 0.018, 0.02}},
                {.radius = silt::uniform(0.8e-3, 1.2e-3),  // [m]
                 .density = 2500,                          // [kg/m3]
                 .rate = 2000,                             // [1/s]
                 .total = 1200});
  return sim;
}

int main() {
  auto whole = drum();
  whole.run(1);

  {
    auto stopped = drum();
    stopped.run(0.5, silt::vtk_series("restart", silt::every(0.05)));
    silt::save_checkpoint(stopped, "restart/drum.silt");
  }  // all that the run knew is gone

  auto again = drum();
  silt::load_checkpoint(again, "restart/drum.silt");
  // The remaining time, as the run stopped at the first step after 0.5 s. The file series continues
  // too.
  again.run(1 - again.time(), silt::vtk_series("restart", silt::every(0.05)), silt::progress());

  double largest = 0, speed = 0;  // [m], [m/s]
  for (std::size_t k = 0; k < whole.size(); ++k) {
    const std::size_t other = again.find(whole.id(k));
    largest = std::max(largest, norm(again.position(other) - whole.position(k)));
    speed = std::max(speed, norm(again.velocity(other) - whole.velocity(k)));
  }
  std::printf("%zu beads after %.1f s; largest difference of places %g m, of velocities %g m/s\n",
              again.size(), again.time(), largest, speed);
  // Fails if a checkpoint lacks anything: contact springs, the drum's angle, the inlet's random
  // state.
  return whole.size() > 1000 && again.size() == whole.size() && largest == 0 && speed == 0 ? 0 : 1;
}
