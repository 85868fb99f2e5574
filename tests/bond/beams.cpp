// silt - BSD-3-Clause, see LICENSE
#include <cmath>
#include <cstdio>
#include <numbers>

#include <doctest/doctest.h>

#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/module/body_force.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace bond_beams_test {
using silt::Vec3d;
constexpr double R = 1e-3, E = 1e7, density = 2000, pi = std::numbers::pi;

template <class... More>
auto beam(int n, double damping, const More&... more) {
  silt::Particles<silt::Sphere> p;
  for (int k = 0; k < n; ++k)
    p.add({.position = {2 * R * k, 0, 0}, .radius = R, .density = density, .fixed = k == 0});
  silt::Simulation sim{
      std::move(p),
      silt::Contacts<silt::HertzMindlin>{
          {.youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5}},
      silt::Bonds{silt::ParallelBond{.youngs_modulus = E, .damping = damping}}, more...};
  for (std::size_t k = 0; k + 1 < static_cast<std::size_t>(n); ++k) sim.bond(k, k + 1);
  sim.threads = 1;
  return sim;
}
const double I = pi * R * R * R * R / 4, A = pi * R * R;

TEST_CASE("beams: a cantilever under its own weight sinks by w L^4/(8 E I) and its shear") {
  for (const int n : {6, 11, 21}) {
    const double L = 2 * R * (n - 1);
    const double m = silt::sphere_volume(R) * density;
    const double deflection = 1e-3 * L;
    // point weights
    double unit = 0;
    for (int k = 1; k < n; ++k) {
      const double a = 2 * R * k;
      unit += m * (a * a * (3 * L - a) / (6 * E * I) + a * 2.5 / (E * A));
    }
    const double g = deflection / unit;
    const double T1 = 2 * pi * L * L / 3.516 * std::sqrt(m / (2 * R) / (E * I));
    const double c = 2 * m * 2 * pi / T1;
    auto sim = beam(n, 0.1, silt::BodyForce{[c](const silt::Seen& p) { return -c * p.velocity; }});
    sim.gravity = {0, 0, -g};
    sim.run(5 * T1);
    const double sinks = -sim.position(sim.find(n - 1)).z;
    std::printf("n %d: %g, off %g, steps %ld, dt %g\n", n, sinks / deflection,
                sinks / deflection - 1, sim.step(), sim.step_length());
  }
}
}
