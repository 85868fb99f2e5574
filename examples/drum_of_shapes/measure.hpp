// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured while the drum turns: torque, the surface of the bed, energies of impacts.

#include <array>
#include <cstddef>

#include "drum_of_shapes/scene.hpp"
#include "support/bed_profile.hpp"
#include "support/impact_spectrum.hpp"

namespace drum_of_shapes {

using example::ImpactSpectrum;
using example::Occupancy;

/// Of the last turn.
struct Measured {
  Occupancy bed;
  ImpactSpectrum impacts{};
  double start = 0;                 // [s] when the drum begins to turn
  double torque = 0, samples = 0;   // [N m] sum of what the drum bears
  double lever = 0;                 // [N m] sum of the grains' weight about the axis
  double particle_steps_per_s = 0;  // [1/s] of wall time

  Measured(const Scene& s, double now) : bed(s.radius, s.length), start(now) {}
  double power(const Scene& s) const { return -torque / samples * s.rate(); }  // [W]
  bool is_last_turn(const Scene& s, double time) const {
    return time - start >= (s.turns - 1) * s.turn();
  }

  /// Looks at the drum, and returns a row: time since the start, power, kinetic energy, contacts a
  /// grain.
  template <class Sim>
  std::array<double, 4> look(const Sim& at, const Scene& s) {
    const bool measured = is_last_turn(s, at.time() + 1e-9);
    if (measured) add_bed(at), torque += at.wall(0).torque.y, samples += 1;
    double energy = 0;
    for (std::size_t k = 0; k < at.rows(); ++k) {
      energy += 0.5 * at.mass(k) * dot(at.velocity(k), at.velocity(k));
      if (measured) lever += at.mass(k) * 9.81 * at.position(k).x;
    }
    return {at.time() - start, -at.wall(0).torque.y * s.rate(), energy,
            2.0 * static_cast<double>(at.touching_pairs()) / static_cast<double>(at.size())};
  }

 private:
  template <class Sim>
  void add_bed(const Sim& sim) {
    bed.next_sample();
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      const double scale = sim.scale(k);
      bed.add_grain(sim.position(k).x, sim.position(k).z,
                    sim.forms()[sim.form(k)].mass.volume * scale * scale * scale);
    }
  }
};

}  // namespace drum_of_shapes
