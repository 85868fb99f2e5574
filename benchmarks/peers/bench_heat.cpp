// silt - BSD-3-Clause, see LICENSE
// Heat conduction through a bed at rest, for heat.py: reads "x y z temperature" of spheres of one
// radius, writes their temperatures after some steps. Uses LIGGGHTS' contact circle, for identical
// results.
//   bench_heat FILE radius density conductivity heat_capacity time_step steps OUT

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/module/heat/conduction.hpp>
#include <silt/simulation.hpp>

/// LIGGGHTS has Q = 2 k sqrt(A) with A the area of the circle in which two equal spheres intersect:
/// a is replaced by sqrt(A), A = pi (R^2 - r^2/4), r = 2 R - d the distance.
struct CutCircle {
  template <class Real>
  static Real radius(const silt::Touching<Real>& c) {
    const Real R = Real(2) * c.R_eff, d = c.overlap;
    return sqrt(Real(3.14159265358979323846) * max(R * d - Real(0.25) * d * d, Real(0)));
  }
};

int main(int argc, char** argv) {
  if (argc != 9) return 2;
  const auto number = [argv](int k) { return std::atof(argv[k]); };
  const double radius = number(2), density = number(3);
  std::ifstream in(argv[1]);
  silt::Particles<silt::Sphere> spheres;
  std::vector<double> temperatures;
  for (double x, y, z, T; in >> x >> y >> z >> T; temperatures.push_back(T))
    spheres.add({.position = {x, y, z}, .radius = radius, .density = density});
  // So soft that nothing moves: LIGGGHTS' bed is not integrated either.
  const silt::HertzMindlin::Material still{.youngs_modulus = 1e-9, .poisson_ratio = 0.3};
  using Heat = silt::HeatConductionBy<CutCircle>;
  silt::Simulation sim{
      std::move(spheres), silt::Contacts<silt::HertzMindlin>{still},
      Heat{.conductivity = number(4), .heat_capacity = number(5), .flux_every = 1}};
  sim.time_step = number(6);
  sim.threads = 1;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.field<silt::Temperature>(sim.find(k)) = temperatures[k];
  const auto begin = std::chrono::steady_clock::now();
  sim.run(number(6) * number(7));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::ofstream out(argv[8]);
  out.precision(17);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    out << sim.field<silt::Temperature>(sim.find(k)) << '\n';
  std::printf("seconds %g contacts %zu\n", took.count(), sim.touching_pairs());
}
