// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/row8.hpp>
#include <silt/engine/contact/kinematics.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Number of chunks of four scalars in the load row of a contact: force; with rotation, torque over
/// radius; with rolling resistance, the couple.
template <class ContactsType>
inline constexpr std::size_t load_chunks = 1 + ContactsType::rotates + ContactsType::has_rolling;

/// Writes the loads of a pack of contacts as consecutive rows of 4 * chunks scalars.
template <std::size_t Chunks, class Arch, class Pack>
SILT_INLINE void write_rows(ScalarOf<Pack>* rows, const PairLoad<Pack>& load) {
  constexpr std::size_t W = Lanes<Arch, ScalarOf<Pack>>::width;
  if constexpr (Chunks == 2 && has_row8<Arch, ScalarOf<Pack>> && sizeof(ScalarOf<Pack>) == 4) {
    const Pack force[4] = {load.force.x, load.force.y, load.force.z, Pack(0)};
    const Pack twirl[4] = {load.twirl.x, load.twirl.y, load.twirl.z, Pack(0)};
    Row8<Arch, ScalarOf<Pack>> row[W];
    columns_to_rows<Arch, ScalarOf<Pack>>(force, twirl, row);
    SILT_UNROLL
    for (std::size_t lane = 0; lane < W; ++lane) row[lane].store(rows + lane * 8);
    return;
  }
  const Vec3<Pack> parts[3] = {load.force, load.twirl, load.couple};
  SILT_UNROLL
  for (std::size_t c = 0; c < Chunks; ++c) {
    const Pack columns[4] = {parts[c].x, parts[c].y, parts[c].z, Pack(0)};
    Row4<Arch, ScalarOf<Pack>> row[W];
    columns_to_rows<Arch, ScalarOf<Pack>>(columns, row);
    SILT_UNROLL
    for (std::size_t lane = 0; lane < W; ++lane) row[lane].store(rows + (lane * Chunks + c) * 4);
  }
}

/// The loads of a block as consecutive rows.
template <class ContactsType, class Arch, class Block, class Scalar>
SILT_INLINE void write_rows(const Block& block, std::size_t count, Scalar* rows) {
  using Real = typename Lanes<Arch, Scalar>::Real;
  constexpr std::size_t W = Lanes<Arch, Scalar>::width, chunks = load_chunks<ContactsType>;
  for (std::size_t k = 0; k < count; k += W)
    write_rows<chunks, Arch, Real>(rows + k * 4 * chunks, block.template get_load<Real>(k));
}

/// sum += row for the first partner of a contact; for the second, force and couple have the
/// opposite sign and the twirl (chunk 1) the same.
template <class Arch, std::size_t Chunks, bool Second, class Scalar>
SILT_INLINE void add_row(Scalar* sum, const Scalar* row) {
  if constexpr (Chunks == 2 && has_row8<Arch, Scalar> && sizeof(Scalar) == 4) {
    using Row = Row8<Arch, Scalar>;
    const auto s = Row::load(sum), r = Row::load(row);
    (Second ? s + Row::of(-1, -1, 1, 1) * r : s + r).store(sum);
  } else {
    using Row = Row4<Arch, Scalar>;
    SILT_UNROLL
    for (std::size_t c = 0; c < Chunks; ++c) {
      const auto s = Row::load(sum + 4 * c), r = Row::load(row + 4 * c);
      (Second && c != 1 ? s - r : s + r).store(sum + 4 * c);
    }
  }
}

}  // namespace silt::detail
