// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/parallel/comm.hpp>

/// The forms of bodies: first those that users added, which are permanent, then those of cells from
/// broken polyhedra (BodyMotion::cells). Each cell form belongs to one fragment; when no body has
/// it any more it is reused for the next cell, so that their number is the largest number of
/// fragments at one time. All ranks have the same forms, those of each other's cells included.
/// Tests: tests/breakage/cell_forms.cpp, tests/parallel/breaking_stones.cpp.

namespace silt::inline SILT_TARGET::detail {

/// Number of forms that users added.
template <class Mover>
std::size_t added_forms(const Mover& mover) {
  return mover.forms.size() - mover.cells;
}

/// Adds a form behind those of users; the numbers of cell forms increase by 1.
template <class Mover, class Form>
void add_form(Mover& mover, const Form& form) {
  const std::size_t number = added_forms(mover);
  mover.forms.insert(mover.forms.begin() + static_cast<std::ptrdiff_t>(number), form);
  if (mover.cells == 0) return;
  for (auto& b : mover.bodies)
    if (b.form >= number) ++b.form;
}

/// For each form whether a body has it, also one that has left but is still in the table.
template <class Mover>
DynArray<bool> used_forms(const Mover& mover) {
  DynArray<bool> used(mover.forms.size(), false);
  for (const auto& b : mover.bodies) used[b.form] = true;
  return used;
}
/// The same of the bodies of all ranks (collective).
template <class Mover, class Comm>
DynArray<bool> used_forms(const Mover& mover, const Comm& comm) {
  DynArray<bool> used = used_forms(mover);
  DynArray<std::uint64_t> bits(used.size() / 64 + 1, 0);
  for (std::size_t k = 0; k < used.size(); ++k) bits[k / 64] |= std::uint64_t{used[k]} << (k % 64);
  const auto all = gather(comm, std::span<const std::uint64_t>(bits));
  for (int r = 0; r < all.ranks(); ++r)
    for (std::size_t k = 0; k < used.size(); ++k)
      if (all[r][k / 64] >> (k % 64) & 1) used[k] = true;
  return used;
}

/// Adds the forms of new cells, which are all different: first in the places that no body uses,
/// lowest first, then at the end. Returns the number of each. `used`: used_forms().
template <class Mover, class Form>
DynArray<std::size_t> take_in_cells(Mover& mover, const DynArray<Form>& cells,
                                    const DynArray<bool>& used) {
  const std::size_t first = added_forms(mover);
  std::size_t end = used.size();
  while (end > first && !used[end - 1]) --end;
  mover.forms.erase(mover.forms.begin() + static_cast<std::ptrdiff_t>(end), mover.forms.end());
  DynArray<std::size_t> numbers;
  for (std::size_t at = first; const Form& form : cells) {
    while (at < end && used[at]) ++at;
    if (at < end)
      mover.forms[at] = form;
    else
      mover.forms.push_back(form);
    numbers.push_back(at++);
  }
  mover.cells = mover.forms.size() - first;
  return numbers;
}

}  // namespace silt::detail
