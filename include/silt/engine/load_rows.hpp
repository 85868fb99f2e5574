// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include <silt/core/row4.hpp>
#include <silt/engine/contact_kernel.hpp>

namespace silt::detail {

/// Chunks of four doubles in the row of one contact: force; with rotation torque over radius; with
/// rolling resistance the couple.
template <class ContactsType>
inline constexpr std::size_t load_chunks = 1 + ContactsType::rotates + ContactsType::has_rolling;

/// Writes the loads of a pack of contacts as consecutive rows of 4 * chunks doubles.
template <std::size_t Chunks, class Arch>
SILT_INLINE void write_rows(double* rows, const PairLoad<typename Lanes<Arch>::Real>& load) {
  using Pack = typename Lanes<Arch>::Real;
  const Vec3<Pack> parts[3] = {load.force, load.twirl, load.couple};
  for (std::size_t c = 0; c < Chunks; ++c) {
    const Pack columns[4] = {parts[c].x, parts[c].y, parts[c].z, Pack(0)};
    Row4<Arch> row[Lanes<Arch>::width];
    columns_to_rows<Arch>(columns, row);
    for (std::size_t lane = 0; lane < Lanes<Arch>::width; ++lane)
      row[lane].store(rows + (lane * Chunks + c) * 4);
  }
}

/// sum += row for the first partner of a contact, or what acts on the second: force and couple with
/// the opposite sign, the twirl (chunk 1) with the same.
template <class Arch, std::size_t Chunks, bool Second>
SILT_INLINE void add_row(double* sum, const double* row) {
  using Row = Row4<Arch>;
  for (std::size_t c = 0; c < Chunks; ++c) {
    const Row s = Row::load(sum + 4 * c), r = Row::load(row + 4 * c);
    (Second && c != 1 ? s - r : s + r).store(sum + 4 * c);
  }
}

/// Which rows of their own act on each particle, in the order of the rows: the loads of pairs that
/// are in the last group.
class RowTable {
 public:
  /// Row `k` (0 ... count-1) acts on first[k] as it stands and on second[k] as the partner.
  void make(const std::uint32_t* first, const std::uint32_t* second, std::size_t count,
            std::size_t particles) {
    begin_.clear(), entries_.resize(2 * count);
    if (count == 0) return;
    begin_.assign(particles + 2, 0);
    for (std::size_t k = 0; k < count; ++k) ++begin_[first[k] + 2], ++begin_[second[k] + 2];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    for (std::size_t k = 0; k < count; ++k) {
      entries_[begin_[first[k] + 1]++] = static_cast<std::uint32_t>(2 * k);
      entries_[begin_[second[k] + 1]++] = static_cast<std::uint32_t>(2 * k + 1);
    }
  }
  bool is_empty() const { return begin_.empty(); }

  /// Adds to `sum` the rows that act on `particle`.
  template <class Arch, std::size_t Chunks>
  SILT_INLINE void add_to(double* sum, std::size_t particle, const double* rows) const {
    for (std::uint32_t e = begin_[particle]; e < begin_[particle + 1]; ++e) {
      const double* row = rows + (entries_[e] / 2) * std::size_t{4 * Chunks};
      if (entries_[e] % 2 == 0)
        add_row<Arch, Chunks, false>(sum, row);
      else
        add_row<Arch, Chunks, true>(sum, row);
    }
  }
  std::size_t bytes() const { return (begin_.capacity() + entries_.capacity()) * 4; }

 private:
  std::vector<std::uint32_t> begin_;    // first entry of each particle
  std::vector<std::uint32_t> entries_;  // twice the row, and one for the second partner
};

}  // namespace silt::detail
