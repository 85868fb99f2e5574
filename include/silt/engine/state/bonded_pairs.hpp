// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <unordered_set>
#include <utility>

#include <silt/core/position_row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Which pairs of particles are bonded, by their ids: they are no contacts.
class BondedPairs {
 public:
  bool holds(ParticleId a, ParticleId b) const {
    return !pairs_.empty() && pairs_.contains(std::minmax(a, b));
  }
  bool add(ParticleId a, ParticleId b) { return pairs_.insert(std::minmax(a, b)).second; }
  void remove(ParticleId a, ParticleId b) { pairs_.erase(std::minmax(a, b)); }

 private:
  using Pair = std::pair<ParticleId, ParticleId>;
  struct Hash {
    std::size_t operator()(const Pair& p) const {
      return (p.first * 0x9e3779b97f4a7c15u) ^ (p.second * 0xc2b2ae3d27d4eb4fu + (p.first >> 7));
    }
  };
  std::unordered_set<Pair, Hash> pairs_;
};
struct NoPairs {};

}  // namespace silt::detail
