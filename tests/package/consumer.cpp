// silt - BSD-3-Clause, see LICENSE
// A user's program: a ball bounces. Exit status 0 if it came back up.
#include <silt/silt.hpp>

// Names of silt's too, which it shadows: with the user's warnings as errors (CMakeLists.txt).
const double g = 9.81, k = 50;  // [m/s2], [N/m]

int main() {
  silt::Particles<silt::Sphere> ball;
  ball.add({.position = {0, 0, 2e-3}, .radius = 1e-3, .density = 2500});
  const silt::LinearSpring::Material rubber{.stiffness = k};
  silt::Simulation sim{std::move(ball), silt::Contacts<silt::LinearSpring>{rubber}};
  sim.gravity = {0, 0, -g};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  sim.run(0.02);
  return sim.velocity(0).z > 0 ? 0 : 1;
}
