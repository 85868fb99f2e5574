// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

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

}  // namespace silt::detail
