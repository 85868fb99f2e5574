// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/ranks/packed.hpp>
#include <silt/engine/ranks/rank_stage.hpp>

// Bonds on several ranks. A rank stores the bonds of its own particles with all their data. Both
// ranks have a copy of a bond between their particles; the copies are bitwise equal, as the numbers
// of a bond do not change. The other particle is a ghost, however far away it is.

namespace silt::inline SILT_TARGET::detail {

/// The bonds of a simulation while a search migrates particles.
template <class Stage, class Engine>
class RankBonds final : public BondsAtSearch {
  using Bond = typename Stage::Bond;
  using AtWall = typename Stage::AtWalls::Bond;

 public:
  RankBonds(Stage& stage, Engine& engine) : stage_(stage), e_(engine) { e_.ranks.bonds = this; }
  ~RankBonds() override { e_.ranks.bonds = nullptr; }
  RankBonds(const RankBonds&) = delete;
  RankBonds& operator=(const RankBonds&) = delete;

  void leave(std::span<const int> to) override {
    leaving_.assign(static_cast<std::size_t>(e_.ranks.size()), {});
    const auto rank_of = [&](ParticleId id) {
      const std::size_t k = e_.find(id);
      return k < to.size() && to[k] != e_.ranks.rank() ? to[k] : -1;
    };
    const auto of = [&](int rank) -> Leaving& { return leaving_[static_cast<std::size_t>(rank)]; };
    stage_.list.for_each_bond([&](const Bond& b) {
      const int i = rank_of(b.i), j = rank_of(b.j);
      if (i >= 0) of(i).bonds.push_back(b);
      if (j >= 0 && j != i) of(j).bonds.push_back(b);
    });
    for (const AtWall& b : stage_.at_walls.all)
      if (const int r = rank_of(b.i); r >= 0) of(r).at_walls.push_back(b);
    for (const auto& one : e_.particles.bonds.freed_at_walls)
      if (const int r = rank_of(one.first); r >= 0) of(r).freed.push_back(one);
  }

  DynArray<DynArray<std::uint32_t>> pass() override {
    DynArray<Packed> out(leaving_.size());
    for (std::size_t r = 0; r < out.size(); ++r) {
      const Leaving& all = leaving_[r];
      if (all.bonds.empty() && all.at_walls.empty() && all.freed.empty()) continue;
      put(all.bonds, out[r]), put(all.at_walls, out[r]);
      out[r].put(all.freed.size());
      for (const auto& [id, wall] : all.freed) out[r].put(id), out[r].put(wall);
    }
    for (const Arrival& came : e_.ranks.pass(out)) take(came.bytes);
    return rows_wanted();
  }

 private:
  struct Leaving {
    DynArray<Bond> bonds;
    DynArray<AtWall> at_walls;
    DynArray<std::pair<ParticleId, std::uint64_t>> freed;
  };
  template <class T>
  static void put(const DynArray<T>& all, Packed& out) {
    out.put(all.size());
    for (const T& one : all) out.put(one);
  }
  void take(std::span<const std::byte> bytes) {
    auto& held = e_.particles.bonds;
    Unpacked from(bytes);
    for (auto n = from.get<std::size_t>(); n > 0; --n) {
      const Bond b = from.get<Bond>();
      if (held.holds(b.i, b.j)) continue;  // already received with its other end
      held.add(b.i, b.j), stage_.list.add(b);
    }
    for (auto n = from.get<std::size_t>(); n > 0; --n) {
      stage_.at_walls.all.push_back(from.get<AtWall>());
      if (const AtWall& b = stage_.at_walls.all.back(); b.excludes)
        held.add(b.i, held.id_of_wall(b.wall));
    }
    for (auto n = from.get<std::size_t>(); n > 0; --n) {
      const auto id = from.get<ParticleId>();
      held.freed_at_walls.push_back({id, from.get<std::uint64_t>()});
    }
  }
  /// For each rank, the owned rows at the other ends of its bonds.
  DynArray<DynArray<std::uint32_t>> rows_wanted() const {
    const auto is_own = [&](ParticleId id) { return e_.find(id) < e_.owners(); };
    DynArray<ParticleId> wanted;
    stage_.list.for_each_bond([&](const Bond& b) {
      const bool i = is_own(b.i), j = is_own(b.j);
      if (i != j) wanted.push_back(i ? b.j : b.i);
    });
    const auto all = gather(e_.ranks.comm(), std::span<const ParticleId>(wanted));
    DynArray<DynArray<std::uint32_t>> rows(leaving_.size());
    for (int r = 0; r < all.ranks(); ++r)
      if (r != e_.ranks.rank())
        for (const ParticleId id : all[r])
          if (const std::size_t k = e_.find(id); k < e_.owners())
            rows[static_cast<std::size_t>(r)].push_back(static_cast<std::uint32_t>(k));
    return rows;
  }

  Stage& stage_;
  Engine& e_;
  DynArray<Leaving> leaving_;  // per receiving rank
};

}  // namespace silt::detail
