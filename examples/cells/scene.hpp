// silt - BSD-3-Clause, see LICENSE
#pragma once

// The scene of the triaxial test and the shear cell: spheres in a box that repeats on all sides and
// deforms.
//
//   cells::Sample s;
//   auto sim = cells::make_cell(s, threads);
//   cells::compress(sim, s);
//   cells::make_rough(sim);

#include <algorithm>
#include <cmath>

#include <silt/silt.hpp>

namespace cells {

using silt::Vec3d;
using Law = silt::HertzMindlin;

struct Sample {
  double spheres = 1000;   // [-]
  double diameter = 1e-3;  // [m] the mean; sizes from 0.8 to 1.2 of it
  double density = 2600;   // [kg/m3]
  double pressure = 1e4;   // [Pa]
  double friction = 0.5;   // [-] between particles
  double start = 0.45;     // [-] solid fraction
  // Overlaps of (p/E)^(2/3) of the diameter, about 1/1000: nearly rigid.
  Law::Material material(double mu) const {
    return {
        .youngs_modulus = 2e4 * pressure, .poisson_ratio = 0.2, .restitution = 0.5, .friction = mu};
  }
  /// [s] in which the pressure accelerates a sphere over its diameter.
  double inertial_time() const { return diameter * std::sqrt(density / pressure); }
};

/// A loose cloud of grains on a grid, initially frictionless: rough() gives them friction.
inline auto make_cell(const Sample& s, int threads) {
  silt::Particles<silt::Sphere> grains;
  silt::Random random(5);
  const int n = static_cast<int>(std::lround(std::cbrt(s.spheres)));
  const double volume = M_PI / 6 * std::pow(s.diameter, 3) * 1.04;  // mean of the cubes
  const double pitch = std::cbrt(volume / s.start);
  for (int k = 0; k < n * n * n; ++k) {
    const auto any = [&] { return 2 * random.uniform() - 1; };
    const double r = 0.5 * s.diameter * (1 + 0.2 * any());
    const double x = any(), y = any(), z = any();
    grains.add({.position = pitch * Vec3d{k % n + 0.5, k / n % n + 0.5, k / (n * n) + 0.5},
                .radius = std::min(r, 0.499 * pitch),
                .density = s.density,
                .velocity = 0.1 * s.diameter / s.inertial_time() * Vec3d{x, y, z}});
  }
  const double length = n * pitch;
  silt::Contacts<Law, silt::SeveralMaterials> contacts{{s.material(0), s.material(s.friction)}};
  contacts.set_pair(s.material(0), s.material(s.friction), {.restitution = 0.5, .friction = 0});
  silt::Simulation sim{std::move(grains), contacts,
                       silt::DeformingBox{{{0, 0, 0}, {length, length, length}}}};
  sim.threads = threads;
  return sim;
}
template <class Sim>
void make_rough(Sim& sim) {
  for (std::size_t k = 0; k < sim.rows(); ++k) sim.set_material(sim.id(k), 1);
}

/// Solid fraction [-].
template <class Sim>
double solid_fraction(const Sim& sim) {
  double volume = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) volume += silt::Sphere::volume(sim.radius(k));
  return volume / sim.domain().volume();
}
/// [-] contacts per particle.
template <class Sim>
double coordination(const Sim& sim) {
  return 2.0 * static_cast<double>(sim.touching_pairs()) / static_cast<double>(sim.size());
}
/// [J] relative to the flow, over pressure times volume [-]: 0 in a sample at rest.
template <class Sim>
double unrest(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d c = sim.velocity(k) - sim.domain().flow_at(sim.position(k));
    sum += 0.5 * sim.mass(k) * dot(c, c);
  }
  return sum / (sim.domain().stress().pressure() * sim.domain().volume());
}

/// Compresses the sample to its pressure until it is at rest; the shape stays as nearly cubic as
/// possible.
template <class Sim>
void compress(Sim& sim, const Sample& s) {
  const silt::BoxDrive to{.stress = s.pressure, .most_rate = 0.05 / s.inertial_time()};
  sim.deform({.x = to, .y = to, .z = to});
  for (int k = 0; k < 40; ++k) {
    sim.run(20 * s.inertial_time());
    const auto& now = sim.domain().stress();
    const double off = std::max({std::abs(now.x / s.pressure - 1), std::abs(now.y / s.pressure - 1),
                                 std::abs(now.z / s.pressure - 1)});
    if (off < 5e-3 && unrest(sim) < 1e-6) return;
  }
}

}  // namespace cells
