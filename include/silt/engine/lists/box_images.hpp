// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/search/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Pairs of spheres in a sheared periodic box, found by a search that does not know images: it is
/// given the spheres and those of their images that may touch a sphere. Of two images H n and -H n
/// one suffices; every pair is found once.
class BoxImages {
 public:
  /// `rows` lie inside domain.box().
  template <class Finder, class Domain>
  void find(Finder& finder, std::span<const PositionRow> rows, double largest_radius,
            const Domain& domain, const Team& team, std::vector<IndexPair>& found) {
    add_images(rows, largest_radius, domain);
    finder.find(SphereSet{{all_.data(), all_.size()}, largest_radius}, 0.0, OpenDomain{}, team,
                found);
    const auto n = static_cast<std::uint32_t>(rows.size());
    const auto own = [&](std::uint32_t k) { return k < n ? k : of_[k - n]; };
    std::size_t kept = 0;
    for (const auto [a, b] : found) {
      if (a >= n && b >= n) continue;
      const IndexPair pair{std::min(own(a), own(b)), std::max(own(a), own(b))};
      if (pair.a != pair.b) found[kept++] = pair;
    }
    found.resize(kept);
    const double shortest = std::min({domain.length(0), domain.length(1), domain.length(2)});
    if (shortest > 4 * largest_radius) return;  // else two images may be near
    const auto before = [](const IndexPair& p, const IndexPair& q) {
      return p.a != q.a ? p.a < q.a : p.b < q.b;
    };
    std::sort(found.begin(), found.end(), before);
    found.erase(std::unique(found.begin(), found.end(),
                            [](const IndexPair& p, const IndexPair& q) {
                              return p.a == q.a && p.b == q.b;
                            }),
                found.end());
  }

 private:
  template <class Domain>
  void add_images(std::span<const PositionRow> rows, double largest_radius, const Domain& domain) {
    all_.assign(rows.begin(), rows.end());
    of_.clear();
    const Upper3& h = domain.edges();
    const Box box = domain.box();
    for (int z = 0; z <= 1; ++z)
      for (int y = z == 0 ? 0 : -2; y <= 2; ++y)
        for (int x = z == 0 && y == 0 ? 1 : -2; x <= 2; ++x) {
          const Vec3d shift = h * Vec3d{double(x), double(y), double(z)};
          for (std::uint32_t k = 0; k < rows.size(); ++k) {
            const Vec3d p = rows[k].centre() + shift;
            if (!box.grown(rows[k].r + largest_radius).contains(p)) continue;
            all_.push_back({p.x, p.y, p.z, rows[k].r}), of_.push_back(k);
          }
        }
  }

  DynArray<PositionRow> all_;
  DynArray<std::uint32_t> of_;  // sphere of each image
};

}  // namespace silt::detail
