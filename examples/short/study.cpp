// silt - BSD-3-Clause, see LICENSE
//
// Error against run time. A bead bounces off a plate with several stiffnesses and time steps. The
// study prints the cost of each variant, its error in the landing point (against a stiff bead), and
// which to use.
//
// picture: study/pareto.png

#include <cmath>
#include <cstdio>
#include <vector>

#include <silt/silt.hpp>
#include <silt/study/study.hpp>

/// A bead thrown at a plate at 45 degrees: its position after 30 ms [m]. `steps`: per contact.
std::vector<double> bounce(silt::StudyRun& run, double modulus, double steps) {
  const double radius = 1e-3, density = 2500, speed = 1;  // [m], [kg/m3], [m/s] along and down
  const silt::HertzMindlin::Material glass{.youngs_modulus = modulus,  // [Pa]
                                           .poisson_ratio = 0.25,
                                           .restitution = 0.8,
                                           .friction = 0.4};
  silt::Particles<silt::Sphere> bead;
  bead.add({.position = {0, 0, 3e-3},
            .radius = radius,
            .density = density,
            .velocity = {speed, 0, -speed}});
  silt::Simulation sim{std::move(bead), silt::Contacts<silt::HertzMindlin>{glass}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);

  // Hertz contact time of an elastic bead and a plate of the same material.
  const double m = sim.total_mass(), E = modulus / (2 * (1 - 0.25 * 0.25));
  sim.time_step = 2.87 * std::pow(m * m / (radius * E * E * speed), 0.2) / steps;
  run.time([&] { sim.run(0.03); });
  return {sim.position(0).x, sim.position(0).z};
}

int main() {
  silt::Study study{"A bead that bounces: stiffness and time step"};
  study.reference("1e10 Pa, t_c/100",
                  [](silt::StudyRun& run) { run.value("place", bounce(run, 1e10, 100)); });
  for (const double modulus : {1e6, 1e7, 1e8, 1e9})
    for (const double steps : {10, 20, 40})
      study.variant(silt::text(modulus, " Pa, t_c/", steps),
                    [=](silt::StudyRun& run) { run.value("place", bounce(run, modulus, steps)); });
  study.accept("error of place", 0.01);
  study.run({.repeats = 3});
  study.report("study");

  // Fails if stiffness has no effect, or if the stiff bead with small steps is wrong.
  const auto& rows = study.results().rows;
  const auto error = [&](std::size_t k) { return std::abs(rows[k].errors.at(0).value); };
  return error(2) > 3 * error(11) && error(11) < 0.01 ? 0 : 1;
}
