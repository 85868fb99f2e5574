// silt - BSD-3-Clause, see LICENSE
// Natural frequencies of a clamped fibre: see beams.cpp for rest.
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace bond_vibration_test {

using silt::Vec3d;
constexpr double R = 1e-3, E = 1e7, density = 2000, pi = std::numbers::pi;

/// The angular frequencies [1/s] of the first two bending modes of a clamped fibre of n spheres
/// beyond the clamped one, by the phases of its modes' shapes in free vibration.
std::vector<double> frequencies(int n, double T1) {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Bonds{silt::ParallelBond{.youngs_modulus = E, .damping = 0}}};
  auto all = silt::fibre({0, 0, 0}, {2 * R * n, 0, 0}, static_cast<std::size_t>(n) + 1,
                         {.radius = R, .density = density});
  all.spheres[0].fixed = true;
  all.spheres.back().density = density / 2;  // half of it stands for what is beyond the end
  add_bonded(sim, all);
  // Small: 1e-4 of the length.
  sim.set_velocity(static_cast<silt::ParticleId>(n), {0, 0, 0.01});
  sim.threads = 1;
  // Tip over time, and its spectrum near both frequencies.
  std::vector<double> t, z;
  sim.run(0);
  const double dt = T1 / 400;
  while (sim.time() < 20 * T1) {
    sim.run(dt);
    t.push_back(sim.time()),
        z.push_back(sim.position(sim.find(static_cast<silt::ParticleId>(n))).z);
  }
  const auto power = [&](double w) {
    std::complex<double> sum = 0;
    for (std::size_t k = 0; k < t.size(); ++k) {
      const double window = 0.5 - 0.5 * std::cos(2 * pi * t[k] / t.back());
      sum += window * z[k] * std::exp(std::complex<double>(0, -w * t[k]));
    }
    return std::abs(sum);
  };
  std::vector<double> found;
  for (const double guess : {2 * pi / T1, 2 * pi / T1 * 22.034 / 3.516}) {
    double low = 0.7 * guess, high = 1.2 * guess, best = guess;
    for (int refine = 0; refine < 4; ++refine) {
      double most = 0;
      const double step = (high - low) / 60;
      for (double w = low; w <= high; w += step)
        if (const double p = power(w); p > most) most = p, best = w;
      low = best - 2 * step, high = best + 2 * step;
    }
    found.push_back(best);
  }
  return found;
}

TEST_CASE("bonds: first two natural frequencies of a clamped fibre") {
  // Euler and Bernoulli: w = (b/L)^2 sqrt(E I/(rho A)), b = 1.8751, 4.6941; the mass of a length is
  // that of its spheres.
  double off[2] = {0, 0};
  for (const int n : {5, 10, 20}) {
    const double L = 2 * R * n, I = pi * R * R * R * R / 4;
    const double per_length = density * silt::sphere_volume(R) / (2 * R);
    const double w0 = std::sqrt(E * I / per_length) / (L * L);
    const auto w = frequencies(n, 2 * pi / (3.516 * w0));
    const double now[2] = {1 - w[0] / (3.51602 * w0), 1 - w[1] / (22.0345 * w0)};
    for (int mode = 0; mode < 2; ++mode) {
      CAPTURE(n);
      CAPTURE(mode);
      CHECK(now[mode] > 0);  // shear and the spheres' own inertia make it slower
      if (n > 5) CHECK(off[mode] / now[mode] > 3.3);  // second order in 1/n
      if (n > 5) CHECK(off[mode] / now[mode] < 4.3);
      off[mode] = now[mode];
    }
  }
  CHECK(off[0] < 2.2e-3);
  CHECK(off[1] < 1.1e-2);
}

}  // namespace bond_vibration_test
