// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/state/body.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The bounding box of the centres of all particles that have not left.
template <class State>
Box occupied_region(const State& particles, const Team& team) {
  std::array<Box, Team::most_ranges> of;
  team.for_ranges(particles.owned(), [&](std::size_t r, std::size_t from, std::size_t to) {
    Box region;
    for (std::size_t k = from; k < to; ++k)
      if (!particles.is_parked(k)) region.include(particles.position[k].centre());
    of[r] = region;
  });
  Box region;
  for (const Box& b : of) region.include(b);
  return region;
}

/// Checks that no pair can interact through two faces of a periodic box at once. `range` [m] of the
/// contact law. Errors: InputError.
template <class Domain, class State>
void check_range(const Domain& domain, const State& particles, double range) {
  const double least = 4 * particles.largest_radius + 2 * range;
  for (int d = 0; d < 3; ++d)
    require(!domain.repeats(d) || domain.length(d) >= least, Domain::policy_name, ": its length ",
            domain.length(d), " [m] in ", "xyz"[d], " must be at least ", least,
            " m, two diameters and twice the range ", range, " m of the contact law",
            deforms<Domain> ? "; a box that shrinks so far has too few particles in it" : "");
}
/// A box that shrinks must not become shorter than a body, which would meet itself.
template <class Domain>
void check_bodies(const Domain& domain, std::span<const Body> bodies) {
  double least = 0;
  for (const Body& b : bodies)
    if (b.id != no_particle) least = std::max(least, 2 * b.radius);
  for (int d = 0; d < 3; ++d)
    require(domain.length(d) >= least, Domain::policy_name, ": its length ", domain.length(d),
            " [m] in ", "xyz"[d], " must be at least ", least,
            " m, the diameter of its largest body; a box that shrinks so far has too few particles "
            "in it");
}

}  // namespace silt::detail
