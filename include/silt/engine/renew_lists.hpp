// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Engine: updates of the lists when particles come, leave or change; renewal of the lists.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/contact/begin_contacts.hpp>
#include <silt/engine/contact/pair_kinds_of.hpp>
#include <silt/engine/engine.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Composition>
inline void Engine<Composition>::join_lists(const Domain& domain, double time_step,
                                            std::size_t first) {
  lists.join(scene(domain, time_step), first);
  for (std::size_t row = first; row < particles.size(); ++row) include_share(row);
}

template <class Composition>
inline void Engine<Composition>::join_pairs(const Domain& domain, double time_step,
                                            std::span<const IndexPair> pairs) {
  std::array<Scalar, ContactsType::history> start{};
  start[ContactsType::offset_from] = static_cast<Scalar>(whole_overlap);
  lists.join_pairs(scene(domain, time_step), pairs, start), offsets_ = true;
}

template <class Composition>
inline std::size_t Engine<Composition>::row_of(ParticleId id) const {
  const std::size_t k = this->find(id);
  if constexpr (of_ranks) {
    if (k < this->owners()) return k;
    if (ghosts_of_ != particles.changes) {
      ghost_rows_.clear(), ghosts_of_ = particles.changes;
      for (std::size_t row = particles.owned(); row < particles.size(); ++row)
        ghost_rows_[particles.id[row]] = row;
    }
    const auto found = ghost_rows_.find(id);
    // A removed ghost keeps its row until the next search.
    if (found == ghost_rows_.end() || particles.id[found->second] != id) return particles.size();
    return found->second;
  }
  return k;
}

template <class Composition>
inline void Engine<Composition>::remove_all(std::span<const std::size_t> places,
                                            const Domain& domain, double time_step) {
  DynArray<std::uint32_t> rows;
  for (const std::size_t k : places) {
    if constexpr (of_bodies) {
      const auto of = mover.rows_of(mover.bodies[k]);
      rows.insert(rows.end(), of.begin(), of.end());
    } else {
      rows.push_back(static_cast<std::uint32_t>(k));
    }
    this->park(k);
  }
  if constexpr (Fluxes::active) fluxes_.renew();
  if (!rows.empty()) lists.leave(scene(domain, time_step), rows);
}

template <class Composition>
inline void Engine<Composition>::set_radius(std::size_t k, double radius, const Domain& domain,
                                            double time_step) {
  Tables<Composition>::set_radius(k, radius, [&](std::size_t row, double growth, double way) {
    lists.follow_growth(scene(domain, time_step), row, growth, growth + way);
    include_share(row);
  });
  if constexpr (of_bodies) lists.follow_change();
}

template <class Composition>
inline void Engine<Composition>::renew_lists(Search& search, const Domain& domain,
                                             std::int64_t step, double time_step) {
  if constexpr (of_ranks)
    if (!lists.hold(walls)) ranks.finish_refresh(particles, mover);
  particles.keep_padding_apart(domain);
  lists.renew(scene(domain, time_step), search, step);
  if constexpr (Composition::has_bonds) begin_freed_at_walls(*this, ContactsType::offset_from);
  if (!lists.take_renewed()) return;
  if constexpr (of_bodies)
    if (lists.upkeep.searched_at == step) {
      this->follow(domain);
      if constexpr (of_ranks) follow_bodies(ranks.neighbours, particles);
    }
  if constexpr (shares) shared_.renew(lists.pairs, particles, mover.bodies.size());
  if constexpr (convex) {
    mover.renew_convex_rows(particles);
    if constexpr (of_ranks)
      ranks.meet("a look at bodies"), agree_on_convex_rows(ranks, particles, mover);
    const bool has_area = mover.convex_rows.has_area();
    lists.pairs.use_more_history(has_area);
    if constexpr (ContactsType::points > 1)  // of when there were bodies with flat sides
      if (!has_area)
        lists.walls.clear_history(ContactsType::memory_from, ContactsType::memory_radius);
  }
  if constexpr (ContactsType::several_materials)
    make_kinds(lists.pairs, particles.material, coefficients.materials, *team_, kinds_);
  sums_.resize(particles.size() * 4 * chunks, 0);  // all zero between steps
  particles.renew_pair_motion(*team_);
}

}  // namespace silt::detail
