// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/row8.hpp>
#include <silt/engine/contact_kernel.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Chunks of four scalars in the row of one contact: force; with rotation torque over radius; with
/// rolling resistance the couple.
template <class ContactsType>
inline constexpr std::size_t load_chunks = 1 + ContactsType::rotates + ContactsType::has_rolling;

/// Writes the loads of a pack of contacts as consecutive rows of 4 * chunks scalars.
template <std::size_t Chunks, class Arch, class Pack>
SILT_INLINE void write_rows(ScalarOf<Pack>* rows, const PairLoad<Pack>& load) {
  constexpr std::size_t W = Lanes<Arch, ScalarOf<Pack>>::width;
  if constexpr (Chunks == 2 && std::is_same_v<ScalarOf<Pack>, float>) {
    const Pack force[4] = {load.force.x, load.force.y, load.force.z, Pack(0)};
    const Pack twirl[4] = {load.twirl.x, load.twirl.y, load.twirl.z, Pack(0)};
    Row8<Arch> row[W];
    columns_to_rows<Arch>(force, twirl, row);
    for (std::size_t lane = 0; lane < W; ++lane) row[lane].store(rows + lane * 8);
    return;
  }
  const Vec3<Pack> parts[3] = {load.force, load.twirl, load.couple};
  for (std::size_t c = 0; c < Chunks; ++c) {
    const Pack columns[4] = {parts[c].x, parts[c].y, parts[c].z, Pack(0)};
    Row4<Arch, ScalarOf<Pack>> row[W];
    columns_to_rows<Arch, ScalarOf<Pack>>(columns, row);
    for (std::size_t lane = 0; lane < W; ++lane) row[lane].store(rows + (lane * Chunks + c) * 4);
  }
}

/// sum += row for the first partner of a contact, or what acts on the second: force and couple with
/// the opposite sign, the twirl (chunk 1) with the same. Row and sum may differ in precision.
template <class Arch, std::size_t Chunks, bool Second, class Sum, class Scalar>
SILT_INLINE void add_row(Sum* sum, const Scalar* row) {
  if constexpr (Chunks == 2 && std::is_same_v<Sum, float> && std::is_same_v<Scalar, float>) {
    const auto s = Row8<Arch>::load(sum), r = Row8<Arch>::load(row);
    (Second ? s + Row8<Arch>::of(-1, -1, 1, 1) * r : s + r).store(sum);
    return;
  }
  for (std::size_t c = 0; c < Chunks; ++c) {
    const auto s = Row4<Arch, Sum>::load(sum + 4 * c);
    const auto r = convert<Sum>(Row4<Arch, Scalar>::load(row + 4 * c));
    (Second && c != 1 ? s - r : s + r).store(sum + 4 * c);
  }
}

}  // namespace silt::detail
