// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured: the velocity of a single grain, and that of the grains in the middle of a
// column.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "settling/scene.hpp"

namespace settling {

/// Downward velocity [m/s] of a single grain, in a column 32 diameters wide. The wider the kernel
/// that spreads the grain's reaction on the liquid, the smaller its effect on the grain itself.
inline double lone_grain(const Scene& s, const silt::FluidProperties& liquid, int threads) {
  silt::Particles<silt::Sphere> grain;
  const int across = 16, high = 32;
  grain.add({.position = {0.5 * across * s.cell, 0.5 * across * s.cell, 0.7 * high * s.cell},
             .radius = s.diameter / 2,
             .density = s.density});
  auto sim = make_simulation(s, std::move(grain), liquid, across, high, 8);
  sim.threads = threads;
  const double v = s.terminal(liquid), fall = 12 * s.diameter;
  // Accelerated with its own mass: some parts in a thousand remain after five relaxation times.
  const double relaxed = 5 * v / 9.81 * s.density / (s.density - liquid.density);
  sim.run(relaxed + fall / v);
  const double from = sim.position(0).z, start = sim.time();
  sim.run(fall / v);
  return (from - sim.position(0).z) / (sim.time() - start);
}

struct Settled {
  double velocity;  // [m/s] downwards
  double fraction;  // [-] of solids where it was measured
};

/// A suspension, once it has fallen for a while; leaves its grains at the path `picture`, if there
/// is one.
inline Settled suspension(const Scene& s, const silt::FluidProperties& liquid, double fraction,
                          int threads, const std::string& picture) {
  auto sim = make_simulation(s, lattice(s, fraction), liquid, s.across, s.high, 3);
  sim.threads = threads;
  const double v = s.hindered(liquid, fraction), fall = s.fall * s.diameter;
  sim.run(fall / v);
  // Grains that are in the middle half of the column now.
  std::vector<double> from;  // [m] by their ids
  double number = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (std::abs(sim.position(k).z / s.height() - 0.5) < 0.25) {
      if (sim.id(k) >= from.size()) from.resize(sim.id(k) + 1, std::nan(""));
      from[sim.id(k)] = sim.position(k).z, ++number;
    }
  const double start = sim.time(),
               solids = number * silt::Sphere::volume(s.diameter / 2) / (0.5 * s.volume());
  sim.run(fall / v);
  if (!picture.empty()) silt::write_particles(picture, sim);
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.id(k) < from.size() && std::isfinite(from[sim.id(k)]))
      sum += from[sim.id(k)] - sim.position(k).z;
  return {sum / number / (sim.time() - start), solids};
}

}  // namespace settling
