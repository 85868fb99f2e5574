// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <silt/core/lanes.hpp>
#include <silt/core/storage.hpp>
#include <silt/engine/contact_kernel.hpp>

namespace silt::detail {

/// Chunks of four doubles in the row of one contact: force; with rotation torque over radius; with
/// rolling resistance the couple.
template <class ContactsType>
inline constexpr std::size_t load_chunks = 1 + ContactsType::rotates + ContactsType::has_rolling;

/// Writes the loads of a pack of contacts as consecutive rows of 4 * chunks doubles.
template <std::size_t Chunks, class Real>
inline void write_rows(double* rows, const PairLoad<Real>& load) {
  const Vec3<Real> parts[3] = {load.force, load.twirl, load.couple};
  if constexpr (is_batch<Real>) {
    constexpr std::size_t W = Real::size;
    for (std::size_t c = 0; c < Chunks; ++c) {
      if constexpr (W == 4) {
        Real v[4] = {parts[c].x, parts[c].y, parts[c].z, Real(0)};
        transpose(v);
        for (std::size_t lane = 0; lane < 4; ++lane)
          v[lane].store_aligned(rows + (lane * Chunks + c) * 4);
      } else {
        alignas(Real) double xyz[3][W];
        parts[c].x.store_aligned(xyz[0]), parts[c].y.store_aligned(xyz[1]);
        parts[c].z.store_aligned(xyz[2]);
        for (std::size_t lane = 0; lane < W; ++lane)
          for (std::size_t d = 0; d < 4; ++d)
            rows[(lane * Chunks + c) * 4 + d] = d < 3 ? xyz[d][lane] : 0.0;
      }
    }
  } else {
    for (std::size_t c = 0; c < Chunks; ++c) {
      rows[4 * c] = parts[c].x, rows[4 * c + 1] = parts[c].y;
      rows[4 * c + 2] = parts[c].z, rows[4 * c + 3] = 0;
    }
  }
}

/// One thread's share of the pairs at a time. Loads on particles in [low, high) are added to their
/// sums at once, in the order of the pairs; no two shares have a particle in common. The load of a
/// pair with a particle outside goes into a row of its own, and is added to the sum when all shares
/// are done. Shares and orders follow from the lists alone, so that sums are bit-identical for
/// every number of threads.
struct PairShare {
  std::size_t from, to;     // pairs; multiples of the padding, but for the end
  std::uint32_t low, high;  // particles
  std::size_t first_row;    // of the pairs with a particle outside

  bool owns(std::uint32_t particle) const { return particle - low < high - low; }
};

/// Which rows of their own act on each particle: loads from other shares and from walls, in a fixed
/// order. Six slots a side, row 0 (zero) as padding; what does not fit stands in an overflow list
/// sorted by particle.
class ReductionTable {
 public:
  static constexpr std::size_t slots = 6;
  struct Slots {
    std::uint32_t plus[slots], minus[slots];
  };
  struct Extra {
    std::uint32_t particle, row;
    bool plus;
  };

  void clear(std::size_t particles) {
    slots_.assign(particles, Slots{});
    used_.assign(particles, {0, 0});
    extra_.clear();
  }
  /// Row `row` (>= 1) acts on `particle` as it stands.
  void add_plus(std::uint32_t particle, std::uint32_t row) {
    auto& used = used_[particle].plus;
    if (used < slots)
      slots_[particle].plus[used++] = row;
    else
      extra_.push_back({particle, row, true});
  }
  /// Row `row` acts on `particle` as the partner: force and couple with opposite sign.
  void add_minus(std::uint32_t particle, std::uint32_t row) {
    auto& used = used_[particle].minus;
    if (used < slots)
      slots_[particle].minus[used++] = row;
    else
      extra_.push_back({particle, row, false});
  }
  void finish() {
    std::sort(extra_.begin(), extra_.end(), [](const Extra& a, const Extra& b) {
      return a.particle != b.particle ? a.particle < b.particle : a.row < b.row;
    });
  }

  const Slots& of(std::size_t particle) const { return slots_[particle]; }
  const std::vector<Extra>& extra() const { return extra_; }
  /// The first overflow entry at or after `particle`.
  std::size_t extra_from(std::size_t particle) const {
    return static_cast<std::size_t>(
        std::lower_bound(extra_.begin(), extra_.end(), particle,
                         [](const Extra& e, std::size_t p) { return e.particle < p; }) -
        extra_.begin());
  }
  std::size_t bytes() const {
    return slots_.capacity() * (sizeof(Slots) + sizeof(Used)) + extra_.capacity() * sizeof(Extra);
  }

 private:
  struct Used {
    std::uint8_t plus, minus;
  };
  std::vector<Slots> slots_;
  std::vector<Used> used_;
  std::vector<Extra> extra_;
};

/// The pack that holds a row of four doubles, or a part of it.
template <class Arch>
using RowPack = typename PackOf<(Lanes<Arch>::width < 4 ? Lanes<Arch>::width : 4)>::type;

/// sum += row for the first partner of a contact, or what acts on the second: force and couple with
/// the opposite sign, the twirl (chunk 1) with the same.
template <class Pack, std::size_t Chunks, bool Second>
SILT_INLINE void add_row(double* sum, const double* row) {
  constexpr std::size_t G = sizeof(Pack) / sizeof(double);
  for (std::size_t p = 0; p < 4 * Chunks; p += G) {
    const Pack s = silt::load<Pack>(sum + p), r = silt::load<Pack>(row + p);
    silt::store(sum + p, Second && p / 4 != 1 ? s - r : s + r);
  }
}

/// Adds to `sum` the rows that act on `particle`; `extra` is the cursor into the overflow list.
template <class Pack, std::size_t Chunks>
SILT_INLINE void add_table_rows(const ReductionTable& table, const double* rows,
                                std::size_t particle, std::size_t& extra, double* sum) {
  const auto plus = [&](std::uint32_t row) {
    add_row<Pack, Chunks, false>(sum, rows + std::size_t{row} * 4 * Chunks);
  };
  const auto minus = [&](std::uint32_t row) {
    add_row<Pack, Chunks, true>(sum, rows + std::size_t{row} * 4 * Chunks);
  };
  const auto& s = table.of(particle);
  if ((s.plus[0] | s.minus[0]) == 0) return;  // slots are filled from the front
  for (std::size_t k = 0; k < ReductionTable::slots && s.plus[k] != 0; ++k) plus(s.plus[k]);
  for (std::size_t k = 0; k < ReductionTable::slots && s.minus[k] != 0; ++k) minus(s.minus[k]);
  for (; extra < table.extra().size() && table.extra()[extra].particle == particle; ++extra) {
    const auto& e = table.extra()[extra];
    e.plus ? plus(e.row) : minus(e.row);
  }
}

}  // namespace silt::detail
