// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured: the pieces that the pellets have become.

#include <algorithm>
#include <array>
#include <cstddef>

#include "pellet/scene.hpp"

namespace pellet {

/// Pieces of spheres that bonds hold together.
struct Pieces {
  double fines, largest, count;  // [-] share of all mass, of a pellet's; number of pieces
  double mass;                   // [kg] of all
};
template <class Sim>
Pieces pieces_of(const Sim& sim, const Scene& s, double pellet) {
  const auto all = silt::fragments(sim);
  Pieces p{0, 0, static_cast<double>(all.mass.size()), 0};
  for (const double m : all.mass) {
    p.mass += m, p.largest = std::max(p.largest, m / pellet);
    if (m < s.sieve * pellet) p.fines += m;
  }
  p.fines /= p.mass;
  return p;
}

/// Marks each sphere with its piece, for pictures.
template <class Sim>
void mark_pieces(Sim& sim, double pellet) {
  const auto all = silt::fragments(sim);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.template field<"piece over pellet [-]">(k) = all.mass[all.of[k]] / pellet;
}

/// The pellets as they were made, and what comes off them over the turns of the drum.
struct Tumbling {
  double start = 0, mass = 0;  // [s]; [kg] of a pellet
  std::size_t bonds = 0;
  double lost = 0;   // [J] by bonds that broke
  double grown = 0;  // [-] the most by which the fines became less, which they cannot
  double fines = 0;  // [-] at the last look

  /// Looks at the pieces, and returns a row.
  template <class Sim>
  std::array<double, 6> look(const Sim& at, const Scene& s) {
    const Pieces p = pieces_of(at, s, mass);
    grown = std::max(grown, fines - p.fines), fines = p.fines;
    return {at.time() - start,
            (at.time() - start) / s.turn(),
            static_cast<double>(at.broken_bonds()) / static_cast<double>(bonds),
            p.fines,
            p.largest,
            p.count};
  }
};

}  // namespace pellet
