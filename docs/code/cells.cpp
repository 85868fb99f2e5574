// silt - BSD-3-Clause, see LICENSE
// The program of docs/cells.md.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.4};
  const silt::Box space{{0, 0, 0}, {8e-3, 8e-3, 8e-3}};
  silt::Particles<silt::Sphere> beads;
  beads.fill(space, {.radius = silt::uniform(0.4e-3, 0.5e-3), .density = 2500, .count = 400});

  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::DeformingBox{space}};
  const silt::BoxDrive kept{.stress = 1000, .most_rate = 8};  // [Pa], [1/s]
  sim.deform({.x = kept, .y = kept, .z = kept});
  sim.run(0.15);

  sim.deform({.x = kept, .y = kept, .z = kept, .xy = {.rate = 5}});
  sim.run(0.1);
  double pressure = 0, shear = 0, samples = 0;
  sim.run(0.1, silt::at(silt::every(1e-4), [&](const auto& now) {
            const silt::BoxStress& stress = now.domain().stress();
            pressure += stress.y, shear += stress.xy, samples += 1;
          }));

  std::printf("%.0f Pa, stress ratio %.3f, strain %.2f, box %.2f x %.2f x %.2f mm\n",
              pressure / samples, shear / pressure, sim.domain().strain().xy,
              1e3 * sim.domain().length(0), 1e3 * sim.domain().length(1),
              1e3 * sim.domain().length(2));

  // Fails if the servo does not hold, if the shear has another rate, and if the stress has the
  // wrong sign or no friction: spheres without friction have a ratio of 0.1, with friction 0.3 to
  // 0.4.
  if (std::abs(pressure / samples - 1000) < 30 && std::abs(sim.domain().strain().xy - 1) < 1e-3 &&
      shear / pressure > 0.25 && shear / pressure < 0.5)
    return 0;
  std::printf("wrong: 1000 Pa, a ratio of 0.25 to 0.5 and a strain of 1 were expected\n");
  return 1;
}
