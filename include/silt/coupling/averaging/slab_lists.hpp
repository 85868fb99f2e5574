// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/coupling/averaging/stencil_rows.hpp>
#include <silt/fluid/grid.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Planes in the range of a particle: `count` from `first` on, wrapped; none: 0.
struct Planes {
  int first, count;
};

/// Lists of particles by slabs of planes of a grid, in their order. A slab of five fields fits a
/// core's own cache, and there are enough slabs for the team. Sums by slab do not depend on the
/// division into slabs.
class SlabLists {
 public:
  std::size_t size() const { return first_.size() - 1; }
  int lower(std::size_t slab) const {
    return std::min(planes_, static_cast<int>(slab) * thickness_);
  }
  std::span<const std::uint32_t> members(std::size_t slab) const {
    return {members_.data() + first_[slab], first_[slab + 1] - first_[slab]};
  }
  std::size_t bytes() const { return members_.size() * sizeof(std::uint32_t); }

  /// planes_of(p) for particles 0 ... n-1.
  template <class PlanesOf>
  void make(const Grid& grid, std::size_t n, const PlanesOf& planes_of, const Team& team) {
    planes_ = grid.nz();
    const std::size_t plane_bytes = 5 * sizeof(double) * grid.plane_stride();
    const int fit = static_cast<int>(std::clamp<std::size_t>(500000 / plane_bytes, 1, 65536));
    const int shared = team.threads() == 1 ? planes_ : planes_ / (4 * team.threads());
    thickness_ = std::max(1, std::min(fit, shared));
    const auto slabs = static_cast<std::size_t>((planes_ + thickness_ - 1) / thickness_);
    counts_.assign(Team::most_ranges * slabs, 0);
    const auto for_slabs = [&](const Planes& of, const auto& use) {
      for_runs(of.first, of.count, planes_, [&](int first, int done, int count) {
        const int last = (first + count - 1) / thickness_, own = of.first / thickness_;
        for (int slab = first / thickness_; slab <= last; ++slab)
          if (done == 0 || slab < own) use(static_cast<std::size_t>(slab));
      });
    };
    const auto for_particles = [&](const auto& use) {
      team.for_ranges(n, [&](std::size_t range, std::size_t from, std::size_t to) {
        for (std::size_t p = from; p < to; ++p)
          if (const Planes of = planes_of(p); of.count > 0)
            for_slabs(of, [&](std::size_t slab) { use(counts_[range * slabs + slab], p); });
      });
    };
    for_particles([](std::size_t& count, std::size_t) { ++count; });
    first_.assign(slabs + 1, 0);
    std::size_t sum = 0;
    for (std::size_t slab = 0; slab < slabs; ++slab) {
      first_[slab] = sum;
      for (std::size_t range = 0; range < Team::most_ranges; ++range) {
        const std::size_t own = counts_[range * slabs + slab];
        counts_[range * slabs + slab] = sum;
        sum += own;
      }
    }
    first_[slabs] = sum;
    make_room(members_, sum);
    for_particles([&](std::size_t& place, std::size_t p) {
      members_[place++] = static_cast<std::uint32_t>(p);
    });
  }

 private:
  int planes_ = 0, thickness_ = 1;
  DynArray<std::size_t> first_{0};   // first member of each slab, and their number
  DynArray<std::uint32_t> members_;  // particles, by slab
  DynArray<std::size_t> counts_;
};

}  // namespace silt::inline SILT_TARGET::detail
