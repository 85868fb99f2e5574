// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/engine/lists/wall_candidate.hpp>
#include <silt/engine/lists/wall_images.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Finds the spheres near surfaces and, in a periodic box, near their images.
template <bool Repeats>
class WallSearch {
 public:
  /// Determines which images of each surface these spheres may touch.
  template <class Domain>
  void choose(std::span<const Wall> walls, std::span<const PositionRow> rows, double reach,
              const Domain& domain) {
    Box region;
    for (const PositionRow& p : rows)
      region.include(Box{p.centre(), p.centre()}.grown(p.r + reach));
    images_.clear();
    for (const Wall& wall : walls)
      for (const Surface& surface : wall.surfaces)
        images_.push_back(rows.empty() ? ImageRange{} : images_of(wall, surface, domain, region));
  }

  struct Range {
    std::size_t from, to;  // rows
    double reach;          // [m]
  };
  /// Adds the spheres of a range that are nearer than the reach to a surface, sphere by sphere.
  template <class Candidate>
  void find(std::span<const Wall> walls, std::span<const PositionRow> rows, const Range& range,
            [[maybe_unused]] const Vec3d& period, WallFinds<Candidate>& found) const {
    [[maybe_unused]] std::size_t number = 0;  // of the surface, among all
    for (std::size_t w = 0; w < walls.size(); ++w)
      for (std::size_t s = 0; s < walls[w].surfaces.size(); ++s) {
        const Surface& its = walls[w].surfaces[s];
        const auto look = [&](const auto& seen) {
          visit_surface(its, [&](const auto& surface) {
            found.search(surface, walls[w], w, s, rows, range.from, range.to, range.reach, seen);
          });
        };
        if constexpr (Repeats) {
          const ImageRange& images = images_[number++];
          if (!images.is_plain()) {
            const Box bounds = bounds_in_space(walls[w], its);
            images.for_each([&](WallImage image) {
              look(SeenElsewhere{image, way_of(image, period), bounds});
            });
            continue;
          }
        }
        look(SeenHere{});
      }
    std::sort(found.candidates.begin(), found.candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.key() < b.key(); });
  }

 private:
  DynArray<ImageRange> images_;  // per surface, wall by wall
};

}  // namespace silt::detail
