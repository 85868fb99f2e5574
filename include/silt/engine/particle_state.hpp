// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include <silt/core/storage.hpp>
#include <silt/engine/rows.hpp>

namespace silt::detail {

/// All that is known of the particles: rows, ids, and materials if there are several.
/// Two rows more than particles: spheres of no radius, the partners of padding pairs.
template <bool Rotates, bool SeveralMaterials>
class ParticleState {
 public:
  using Motion = MotionRow<Rotates>;
  static constexpr std::size_t bytes_per_particle = sizeof(PositionRow) + sizeof(Motion) +
                                                    sizeof(std::uint32_t) +
                                                    (SeveralMaterials ? sizeof(std::uint16_t) : 0);

  AlignedVector<PositionRow> position;
  AlignedVector<Motion> motion;
  std::vector<std::uint32_t> id;
  std::vector<std::uint16_t> material;

  std::size_t size() const { return id.size(); }
  std::span<const PositionRow> rows() const { return {position.data(), size()}; }

  ParticleState() { pad(); }

  void add(const PositionRow& p, const Motion& m, std::uint32_t new_id, std::uint16_t of) {
    position.resize(size()), motion.resize(size());
    position.push_back(p), motion.push_back(m);
    id.push_back(new_id);
    if constexpr (SeveralMaterials) material.push_back(of);
    pad();
  }

  /// Keeps particle order[k] in place k; particles not named are dropped.
  void reorder(std::span<const std::uint32_t> order) {
    gather(position, order), gather(motion, order), gather(id, order);
    if constexpr (SeveralMaterials) gather(material, order);
    pad();
  }

  void pad() {
    position.resize(size()), motion.resize(size());
    for (int k = 0; k < 2; ++k) {
      position.push_back({static_cast<double>(k), 0, 0, 0});
      Motion m{};
      m.inv_m = 1;
      if constexpr (Rotates) m.inv_r = 1;
      motion.push_back(m);
    }
  }

 private:
  template <class V>
  static void gather(V& values, std::span<const std::uint32_t> order) {
    V sorted(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = values[order[k]];
    values.swap(sorted);
  }
};

}  // namespace silt::detail
