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
    double sign;
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
      extra_.push_back({particle, row, 1.0});
  }
  /// Row `row` acts on `particle` as the partner: force and couple with opposite sign.
  void add_minus(std::uint32_t particle, std::uint32_t row) {
    auto& used = used_[particle].minus;
    if (used < slots)
      slots_[particle].minus[used++] = row;
    else
      extra_.push_back({particle, row, -1.0});
  }
  void finish() {
    std::stable_sort(extra_.begin(), extra_.end(),
                     [](const Extra& a, const Extra& b) { return a.particle < b.particle; });
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
template <std::size_t Chunks>
inline LoadSum<Chunks> sum_rows(const ReductionTable& table, const double* rows,
                                std::size_t particle, std::size_t& extra) {
  constexpr std::size_t n = 4 * Chunks;
  // The twirl (chunk 1) has the same sign on both partners.
  const auto add = [rows](double* sum, std::uint32_t row, double sign) {
    const double* r = rows + std::size_t{row} * n;
    for (std::size_t d = 0; d < n; ++d) sum[d] += (d / 4 == 1 ? 1.0 : sign) * r[d];
  };
  LoadSum<Chunks> sum{};
  const auto& s = table.of(particle);
  for (std::size_t k = 0; k < ReductionTable::slots; ++k) add(sum.value, s.plus[k], 1.0);
  for (std::size_t k = 0; k < ReductionTable::slots; ++k) add(sum.value, s.minus[k], -1.0);
  for (; extra < table.extra().size() && table.extra()[extra].particle == particle; ++extra)
    add(sum.value, table.extra()[extra].row, table.extra()[extra].sign);
  return sum;
}

}  // namespace silt::detail
