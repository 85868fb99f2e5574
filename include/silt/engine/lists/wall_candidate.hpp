// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <span>
#include <tuple>
#include <type_traits>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/position_row.hpp>
#include <silt/engine/lists/wall_images.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A sphere near a surface, and the slots that store its contacts with it.
struct WallCandidate {
  std::uint32_t particle;
  std::uint16_t wall, surface;        // surface of this wall
  std::uint32_t slot;                 // its first slot
  std::uint32_t facets, facet_count;  // its triangles in the pool, if the surface is a mesh
  std::uint32_t origin;               // in the inner list: its place in the outer list
  auto key() const { return std::tie(particle, wall, surface); }
};
/// The same for an image of a surface in a periodic box. Non-periodic boxes use the smaller type.
struct ImageCandidate : WallCandidate {
  WallImage image = 0;
  auto key() const { return std::tie(particle, wall, surface, image); }
};
inline constexpr WallImage image_of(const WallCandidate&) { return 0; }
inline constexpr WallImage image_of(const ImageCandidate& c) { return c.image; }

/// Slots of spheres that are near the same plane at rest.
struct PlaneRun {
  std::uint16_t wall, surface;
  Vec3d normal;          // [-] unit
  double offset;         // [m] of the plane from the origin along the normal
  std::size_t from, to;  // slots; `from` is the first of a whole pack
};

/// A point [m] in the coordinates of a wall.
inline Vec3d in_wall(const Wall& wall, const Vec3d& point) {
  return wall.moves() ? wall.pose.to_body(point) : point;
}

/// The result of one range of spheres or candidates, with its own pool of triangles.
template <class Candidate>
struct WallFinds {
  DynArray<Candidate> candidates;
  DynArray<std::uint32_t> facets, near;
  void clear() { candidates.clear(), facets.clear(); }
  void add(Candidate c, std::span<const std::uint32_t> of) {
    c.facets = static_cast<std::uint32_t>(facets.size());
    c.facet_count = static_cast<std::uint32_t>(of.size());
    facets.insert(facets.end(), of.begin(), of.end());
    candidates.push_back(c);
  }

  /// Adds the spheres from ... to-1 that are nearer to a surface than `reach` [m]; `seen` gives
  /// their positions relative to the image.
  template <class S, class Seen>
  void search(const S& surface, const Wall& wall, std::size_t w, std::size_t s,
              std::span<const PositionRow> rows, std::size_t from, std::size_t to, double reach,
              const Seen& seen) {
    Candidate c{};
    c.wall = static_cast<std::uint16_t>(w), c.surface = static_cast<std::uint16_t>(s);
    if constexpr (std::is_same_v<Candidate, ImageCandidate>) c.image = seen.image;
    for (std::size_t p = from; p < to; ++p) {
      const double within = rows[p].r + reach;
      const Vec3d place = seen(rows[p].centre());
      if (!seen.may_reach(place, within)) continue;
      const Vec3d centre = in_wall(wall, place);
      near.clear();
      if constexpr (requires { surface.triangles_near(centre, within, near); }) {
        if (!surface.bounds().grown(within).contains(centre)) continue;
        surface.triangles_near(centre, within, near);
        if (near.empty()) continue;
      } else {
        SurfacePoint point[S::max_contacts];
        if (surface.contacts(centre, within, point) == 0) continue;
      }
      c.particle = static_cast<std::uint32_t>(p);
      add(c, near);
    }
  }

  /// Keeps the candidate if it is within reach, with those of its triangles that are.
  template <class S>
  void keep(const S& surface, const Candidate& c, const Vec3d& centre, double within,
            std::span<const std::uint32_t> outer_facets) {
    near.clear();
    if constexpr (requires { surface.triangles_near(centre, within, near); }) {
      for (std::uint32_t k = c.facets; k < c.facets + c.facet_count; ++k)
        if (surface.distance_to(outer_facets[k], centre) < within) near.push_back(outer_facets[k]);
      if (near.empty()) return;
    } else {
      SurfacePoint point[S::max_contacts];
      if (surface.contacts(centre, within, point) == 0) return;
    }
    add(c, near);
  }
};

}  // namespace silt::detail
