// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <variant>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/engine/lists/wall_candidate.hpp>

/// Which candidates are spheres near planes at rest and near nothing else, and their order.

namespace silt::inline SILT_TARGET::detail {

/// Cosine of the angle between two planes above which one sphere's contacts with both are evaluated
/// together, because they may be one contact.
inline constexpr double nearly_one_plane = 0.9;

inline const Plane* plane_at_rest(std::span<const Wall> walls, const WallCandidate& c) {
  return walls[c.wall].moves() ? nullptr : std::get_if<Plane>(&walls[c.wall].surfaces[c.surface]);
}

/// Whether all candidates of one sphere are planes at rest that touch it at separate points.
template <class Candidate>
bool are_planes(std::span<const Wall> walls, std::span<const Candidate> of_one) {
  for (std::size_t a = 0; a < of_one.size(); ++a) {
    const Plane* const plane = plane_at_rest(walls, of_one[a]);
    if (plane == nullptr) return false;
    for (std::size_t b = 0; b < a; ++b)
      if (dot(plane->unit().normal, plane_at_rest(walls, of_one[b])->unit().normal) >
          nearly_one_plane)
        return false;
  }
  return true;
}

/// Moves the candidates at planes to the end, in pieces, and plane by plane within a piece; without
/// `apart` there are none. Returns the first candidate of each piece, and the end.
template <class Candidate>
DynArray<std::size_t> put_planes_last(std::span<const Wall> walls, bool apart,
                                      DynArray<Candidate>& all) {
  constexpr std::size_t piece_size = 256;  // approximate number of candidates
  DynArray<Candidate> others, at_planes;
  DynArray<std::size_t> begin{0};
  for (std::size_t k = 0, next = 0; k < all.size(); k = next) {
    while (next < all.size() && all[next].particle == all[k].particle) ++next;
    const std::span<const Candidate> of_one{all.data() + k, next - k};
    auto& to = apart && are_planes(walls, of_one) ? at_planes : others;
    to.insert(to.end(), of_one.begin(), of_one.end());
    if (at_planes.size() >= begin.back() + piece_size) begin.push_back(at_planes.size());
  }
  if (begin.back() < at_planes.size()) begin.push_back(at_planes.size());
  for (std::size_t p = 0; p + 1 < begin.size(); ++p)
    std::stable_sort(at_planes.begin() + static_cast<std::ptrdiff_t>(begin[p]),
                     at_planes.begin() + static_cast<std::ptrdiff_t>(begin[p + 1]),
                     [](const WallCandidate& a, const WallCandidate& b) {
                       return std::tie(a.wall, a.surface) < std::tie(b.wall, b.surface);
                     });
  for (std::size_t& b : begin) b += others.size();
  others.insert(others.end(), at_planes.begin(), at_planes.end());
  all = std::move(others);
  return begin;
}

}  // namespace silt::detail
