// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <silt/core/target.hpp>

/// The forms of bodies: first those that users added, which stay, then those of cells of polyhedra
/// that broke (BodyMotion::cells). A cell's form is that of one fragment. When no body has it any
/// more, the next cell takes its place: there are as many as fragments at one time.
/// Tests: tests/breakage/cell_forms.cpp.

namespace silt::inline SILT_TARGET::detail {

/// How many forms users added.
template <class Mover>
std::size_t added_forms(const Mover& mover) {
  return mover.forms.size() - mover.cells;
}

/// Adds a form behind those that users added before; the numbers of cells grow by 1.
template <class Mover, class Form>
void add_form(Mover& mover, const Form& form) {
  const std::size_t number = added_forms(mover);
  mover.forms.insert(mover.forms.begin() + static_cast<std::ptrdiff_t>(number), form);
  if (mover.cells == 0) return;
  for (auto& b : mover.bodies)
    if (b.form >= number) ++b.form;
}

/// Takes in the forms of new cells, which are equal to no other: in the places of those that no
/// body has, the first ones first, then at the end. Returns the number of each.
template <class Mover, class Form>
std::vector<std::size_t> take_in_cells(Mover& mover, const std::vector<Form>& cells) {
  const std::size_t first = added_forms(mover);
  std::vector<bool> used(mover.forms.size(), false);
  for (const auto& b : mover.bodies) used[b.form] = true;
  std::size_t end = used.size();
  while (end > first && !used[end - 1]) --end;
  mover.forms.erase(mover.forms.begin() + static_cast<std::ptrdiff_t>(end), mover.forms.end());
  std::vector<std::size_t> numbers;
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
