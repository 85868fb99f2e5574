// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The index of each pair in the coefficient table, from the materials of both ends.
template <class Pairs, class Materials>
void make_kinds(const Pairs& pairs, const Materials& material, std::size_t materials,
                const Team& team, DynArray<std::uint16_t>& kinds) {
  kinds.assign(pairs.padded_size(), 0);
  pairs.for_each_inner(team, [&](std::size_t k) {
    kinds[k] = static_cast<std::uint16_t>(material[pairs.first()[k]] * materials +
                                          material[pairs.second()[k]]);
  });
}

}  // namespace silt::detail
