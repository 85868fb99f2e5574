// silt - BSD-3-Clause, see LICENSE
// Two spheres collide askew, as users compile it (-O3): their masses stay, and ContactEvents leave
// every bit of their motion as it is. g++ 12.2 has made loads of them that changed the masses, by
// 1e-8 a step (core/row4.hpp, even_of()).

#include <cstdio>

#include <silt/silt.hpp>

namespace {

auto spheres(auto... policies) {
  silt::Particles<silt::Sphere> two;
  two.add({.position = {0, 0, 0}, .radius = 2.28e-3, .density = 2500, .velocity = {0, 1e-3, 0}});
  two.add({.position = {0, 1e-5, 4.579e-3},
           .radius = 2.3e-3,
           .density = 2500,
           .velocity = {0, 0, -0.02}});
  const silt::HertzMindlin::Material rubber{
      .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.4};
  silt::Simulation sim{std::move(two), silt::Contacts<silt::HertzMindlin>{rubber}, policies...};
  sim.time_step = 2e-5;
  sim.threads = 1;
  return sim;
}

/// Whether the masses are those of the start after a collision; the motion goes to `end`.
bool keeps_masses(const char* name, auto sim, silt::Vec3d (&end)[4]) {
  const double before[2] = {sim.mass(0), sim.mass(1)};
  sim.run(0.01);
  bool kept = true;
  for (std::size_t k = 0; k < 2; ++k) {
    kept = kept && sim.mass(k) == before[k];
    end[2 * k] = sim.velocity(k), end[2 * k + 1] = sim.angular_velocity(k);
  }
  if (!kept)
    std::printf("%s: masses became %.17g and %.17g of themselves\n", name, sim.mass(0) / before[0],
                sim.mass(1) / before[1]);
  return kept;
}

}  // namespace

int main() {
  silt::Vec3d plain[4], events[4], mixed[4];
  bool right = keeps_masses("plain", spheres(), plain);
  right = keeps_masses("events", spheres(silt::ContactEvents{}), events) && right;
  right =
      keeps_masses("mixed, events", spheres(silt::ContactEvents{}, silt::Mixed{}), mixed) && right;
  for (int k = 0; k < 4; ++k)
    if (plain[k] != events[k]) {
      right = false;
      std::printf("with events number %d is (%.17g %.17g %.17g), without (%.17g %.17g %.17g)\n", k,
                  events[k].x, events[k].y, events[k].z, plain[k].x, plain[k].y, plain[k].z);
    }
  if (!(norm(plain[0]) > 2e-3)) right = false, std::printf("they have not collided\n");
  return right ? 0 : 1;
}
