// silt - BSD-3-Clause, see LICENSE
#pragma once

// The scene of settling: grains in a closed column of liquid, which is periodic across.
//
//   settling::Scene s;
//   auto grains = settling::lattice(s, 0.1);  // [-] of solids
//   auto sim = settling::make_simulation(s, grains, s.liquids[0], s.across, s.high, 3);
//   sim.run(1.0, silt::vtk_series("out", silt::every(0.05)));

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <silt/fluid.hpp>

namespace settling {

using Law = silt::HertzMindlin;
using Drag = silt::DiFelice;
using silt::Vec3d;

struct Scene {
  static constexpr double step = 2e-5;  // [s] of the grains
  double diameter = 0.5e-3;             // [m]
  double density = 2500;                // [kg/m3]
  double cell = 1e-3;                   // [m]
  int across = 5;                       // [cells] of the column: 10 diameters
  int high = 24;                        // [cells]
  double fall = 4;  // [diameters] that grains fall before they are measured, and then
  std::vector<double> fractions{0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3};  // [-]
  std::vector<silt::FluidProperties> liquids{{1100, 0.01}, {1100, 3e-3}, {1000, 1e-3}};

  double width() const { return across * cell; }                  // [m]
  double height() const { return high * cell; }                   // [m]
  double volume() const { return width() * width() * height(); }  // [m3]
  double terminal(const silt::FluidProperties& f) const {         // [m/s]
    return silt::terminal_velocity(Drag{}, diameter, density, f.density, f.viscosity);
  }
  /// [m/s] in a homogeneous suspension, relative to the volume flux: eps times the slip.
  double hindered(const silt::FluidProperties& f, double fraction) const {
    return silt::minimum_fluidisation_velocity(Drag{}, 1 - fraction, diameter, density, f.density,
                                               f.viscosity);
  }
  /// The exponent of J. F. Richardson and W. N. Zaki, Trans. Inst. Chem. Eng. 32 (1954) 35, without
  /// their wall terms.
  static double exponent(double Re) {
    if (Re < 0.2) return 4.65;
    if (Re < 1) return 4.35 * std::pow(Re, -0.03);
    return Re < 500 ? 4.45 * std::pow(Re, -0.1) : 2.39;
  }
  double reynolds(const silt::FluidProperties& f) const {
    return f.density * terminal(f) * diameter / f.viscosity;
  }
};

/// A closed column with these grains; `width` of the kernel in diameters.
inline auto make_simulation(const Scene& s, silt::Particles<silt::Sphere> grains,
                            const silt::FluidProperties& liquid, int across, int high,
                            double width) {
  const Vec3d corner{across * s.cell, across * s.cell, high * s.cell};
  silt::FlowSolver flow(
      silt::Grid({{0, 0, 0}, corner}, {across, across, high}, {true, true, false}), liquid);
  const Law::Material glass{
      .youngs_modulus = 2e5, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};
  silt::Simulation sim{std::move(grains), silt::Contacts<Law>{glass},
                       silt::PeriodicBox{{{0, 0, 0}, corner}, {true, true, false}},
                       silt::CoupledFlow{Drag{}, silt::Kernel{.width = width}, std::move(flow)}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = Scene::step;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.add_wall(silt::Plane{{0, 0, corner.z}, {0, 0, -1}}, glass);
  return sim;
}

/// The grains of a suspension: a lattice, with random displacements as far as there is room.
inline silt::Particles<silt::Sphere> lattice(const Scene& s, double fraction) {
  const double volume = silt::Sphere::volume(s.diameter / 2);
  silt::Particles<silt::Sphere> grains;
  const auto count = static_cast<std::size_t>(std::round(fraction * s.volume() / volume));
  silt::Random random(1);
  const auto along = [&](double length) {
    return static_cast<int>(std::min(std::ceil(length * std::cbrt(fraction / volume)),
                                     std::floor(length / s.diameter)));
  };
  const int n = along(s.width());
  const auto layers =
      static_cast<int>(std::ceil(static_cast<double>(count) / static_cast<double>(n * n)));
  const double across = s.width() / n, up = s.height() / layers;
  const auto shake = [&](double pitch) {
    const double room = std::max(0.0, 0.5 * (pitch - s.diameter));
    return random.uniform(-room, room);
  };
  for (int k = 0; k < static_cast<int>(count); ++k)
    grains.add({.position = {(k % n + 0.5) * across + shake(across),
                             (k / n % n + 0.5) * across + shake(across),
                             (k / (n * n) + 0.5) * up + shake(up)},
                .radius = s.diameter / 2,
                .density = s.density});
  return grains;
}

}  // namespace settling
