// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <vector>

#include <silt/core/position_row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A place for each id, in pages: of those that are in use alone, so that a high id costs no more
/// memory than a low one. Both calls take constant time.
class IdTable {
 public:
  std::uint32_t& at(ParticleId id) {
    const std::size_t p = id / page;
    if (p >= pages_.size()) pages_.resize(p + 1);
    if (pages_[p].empty()) pages_[p].assign(page, no_place);
    return pages_[p][id % page];
  }
  std::uint32_t find(ParticleId id) const {
    const std::size_t p = id / page;
    return p < pages_.size() && !pages_[p].empty() ? pages_[p][id % page] : no_place;
  }
  void clear() { pages_.clear(); }

 private:
  static constexpr std::size_t page = 1 << 12;
  std::vector<std::vector<std::uint32_t>> pages_;
};

}  // namespace silt::detail
