// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/pair_sums.hpp>
#include <silt/sph/row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Particles of an Sph, in the order of its packs: liquid, walls, probes.
struct SphColumns {
  AlignedVector<SphRow> rows;
  AlignedVector<SphRow> start;    // at the start of the step, or one step ago
  DynArray<char> kind;            // ClusterLists::Kind
  DynArray<std::uint32_t> label;  // number of the liquid's or the wall's particle; none: empty
                                  // lane
  /// Labels from here on belong to openings: particles of a buffer (kind Liquid), or their probes.
  static constexpr std::uint32_t of_openings = 1u << 31;
  AlignedVector<double> volume;  // [m3]
  // [m/s] For no-slip walls and bodies, else empty: the part of a row's velocity that enters only
  // friction (SphPairs).
  AlignedVector<Vec3d> sticking;
  DynArray<char>
      holds;  // of mirrored walls and bodies: 1 where they may pull the liquid (SolidHold)
  AlignedVector<SphRates> rates;
  // Of the last sums; with LeapfrogTime between steps those at the end of the step, with diffusion.
  AlignedVector<SphGrowth> growth;
  AlignedVector<SphImage> images;  // of the rows of probes, from the first on
  // With UnresolvedGrains, else empty: void fraction [-] at a particle, its share of a particle's
  // mass, and how full its kernel is (div r over dimensions).
  AlignedVector<double> voidage, share, fullness;
  AlignedVector<SphBrief> brief;    // of mixed precision
  AlignedVector<SphStress> stress;  // with SpsTurbulence
  AlignedVector<double> viscosity;  // [m2/s] with HerschelBulkley; of solids 0

  std::size_t size() const { return rows.size(); }
  bool is_liquid(std::size_t k) const {
    return kind[k] == ClusterLists::Liquid && label[k] < of_openings;
  }
  bool is_of_opening(std::size_t k) const {
    return label[k] >= of_openings && label[k] != ClusterLists::none;
  }
  SphBeside beside() const { return {sticking, holds, viscosity}; }
  void add(const SphRow& row, int of_kind, std::uint32_t number) {
    rows.push_back(row), start.push_back(row);
    kind.push_back(static_cast<char>(of_kind)), label.push_back(number);
    if (!voidage.empty()) voidage.push_back(1), share.push_back(1), fullness.push_back(0);
    if (!growth.empty()) growth.push_back({});
  }
  void take_out(std::size_t k) {
    kind[k] = static_cast<char>(ClusterLists::Gone), label[k] = ClusterLists::none;
  }
  /// Applies an order of ClusterLists.
  void arrange(const DynArray<std::uint32_t>& order, const Team& team) {
    for (auto* const of : {&rows, &start}) permute(*of, spare_.rows, order, SphRow::nobody(), team);
    permute(kind, spare_.kind, order, static_cast<char>(ClusterLists::Gone), team);
    permute(label, spare_.label, order, ClusterLists::none, team);
    if (!voidage.empty())
      for (auto* const of : {&voidage, &share, &fullness})
        permute(*of, spare_.numbers, order, 1.0, team);
    if (!growth.empty()) permute(growth, spare_.growth, order, SphGrowth{}, team);
    make_room(volume, size()), make_room(rates, size());
  }
  double share_of(std::size_t k) const { return share.empty() ? 1 : share[k]; }
  double voidage_of(std::size_t k) const { return voidage.empty() ? 1 : voidage[k]; }
  std::size_t bytes() const {
    return (rows.capacity() + start.capacity() + spare_.rows.capacity()) * sizeof(SphRow) +
           2 * kind.capacity() + holds.capacity() + 2 * label.capacity() * sizeof(std::uint32_t) +
           (volume.capacity() + 4 * voidage.capacity()) * sizeof(double) +
           (growth.capacity() + spare_.growth.capacity()) * sizeof(SphGrowth) +
           images.capacity() * sizeof(SphImage) + (sticking.capacity() * sizeof(Vec3d)) +
           rates.capacity() * sizeof(SphRates) + brief.capacity() * sizeof(SphBrief) +
           stress.capacity() * sizeof(SphStress) + viscosity.capacity() * sizeof(double);
  }

 private:
  template <class Column, class Value>
  static void permute(Column& column, Column& next, const DynArray<std::uint32_t>& order,
                      const Value& nobody, const Team& team) {
    next.resize(order.size());
    team.for_ranges(order.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k)
        next[k] = order[k] == ClusterLists::none ? nobody : column[order[k]];
    });
    column.swap(next);
  }

  // Memory for permute(): fresh pages at each search would cost more than the copies.
  struct Spare {
    AlignedVector<SphRow> rows;
    DynArray<char> kind;
    DynArray<std::uint32_t> label;
    AlignedVector<double> numbers;
    AlignedVector<SphGrowth> growth;
  } spare_;
};

}  // namespace silt::detail
