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

/// Which rows act on each particle: the map from contacts to particles, in a fixed order, so that
/// sums are bit-identical for every number of threads. Six slots a side, row 0 (zero) as padding;
/// what does not fit stands in an overflow list sorted by particle.
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
    std::sort(extra_.begin(), extra_.end(),
                     [](const Extra& a, const Extra& b) {
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

/// The summed load on one particle: force, torque over radius, couple.
template <std::size_t Chunks>
struct alignas(32) LoadSum {
  double value[4 * Chunks];
};

/// Adds up the rows of `particle`; `extra` is the cursor into the overflow list.
template <class Arch, std::size_t Chunks>
SILT_INLINE LoadSum<Chunks> sum_rows(const ReductionTable& table, const double* rows,
                                     std::size_t particle, std::size_t& extra) {
  // A chunk is four doubles: packs of at most four lanes add it.
  constexpr std::size_t W = Lanes<Arch>::width, G = W < 4 ? W : 4;
  using Pack = typename PackOf<G>::type;
  constexpr std::size_t packs = 4 * Chunks / G;
  Pack sum[packs];
  for (auto& s : sum) s = Pack(0);
  const auto plus = [&](std::uint32_t row) {
    for (std::size_t p = 0; p < packs; ++p)
      sum[p] = sum[p] + silt::load<Pack>(rows + std::size_t{row} * 4 * Chunks + p * G);
  };
  const auto minus = [&](std::uint32_t row) {
    for (std::size_t p = 0; p < packs; ++p) {
      const Pack value = silt::load<Pack>(rows + std::size_t{row} * 4 * Chunks + p * G);
      // The twirl (chunk 1) has the same sign on both partners.
      sum[p] = p * G / 4 == 1 ? sum[p] + value : sum[p] - value;
    }
  };
  const auto& s = table.of(particle);
  // Slots are filled from the front; most particles use at most three a side.
  constexpr std::size_t half = ReductionTable::slots / 2;
  const bool touched = (s.plus[0] | s.minus[0]) != 0;
  for (std::size_t k = 0; touched && k < half; ++k) plus(s.plus[k]), minus(s.minus[k]);
  if ((s.plus[half] | s.minus[half]) != 0)
    for (std::size_t k = half; k < ReductionTable::slots; ++k) plus(s.plus[k]), minus(s.minus[k]);
  for (; extra < table.extra().size() && table.extra()[extra].particle == particle; ++extra) {
    const auto& e = table.extra()[extra];
    e.plus ? plus(e.row) : minus(e.row);
  }
  LoadSum<Chunks> out;
  for (std::size_t p = 0; p < packs; ++p) silt::store(out.value + p * G, sum[p]);
  return out;
}

}  // namespace silt::detail
