// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <vector>

// Parts of Simulation: bonds that break.

#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Removes the bonds that this step has overloaded, whose particles may touch from now on, and
/// those of particles that broke before it.
template <class... Policies>
void Simulation<Policies...>::break_bonds() {
  if constexpr (has_bonds) {
    bonds_broken_ = bonds_.take_broken(time_);
    if (bonds_broken_.empty()) return;
    std::vector<IndexPair> pairs;
    for (const BondBreak& bond : bonds_broken_) {
      if constexpr (has_ledger) book_.bond_broken(bond.energy);
      auto& held = engine_.particles.bonds;
      const bool has_both = !has_breakage || (find(bond.a) < rows() &&
                                              (bond.b == no_particle || find(bond.b) < rows()));
      if (bond.b == no_particle) {
        if (!held.holds(bond.a, held.id_of_wall(bond.wall)) ||
            bonds_.at_walls.exclude(bond.a, bond.wall))
          continue;
        held.remove(bond.a, held.id_of_wall(bond.wall));
        if (!has_both) continue;
        engine_.lists.forget();
        held.freed_at_walls.push_back({bond.a, bond.wall});
        continue;
      }
      held.remove(bond.a, bond.b);
      if (!has_both) continue;
      pairs.push_back({static_cast<std::uint32_t>(engine_.find(bond.a)),
                       static_cast<std::uint32_t>(engine_.find(bond.b))});
    }
    engine_.join_pairs(domain_, dt_, pairs);
  }
}

/// The same with several ranks, after a step in which any of them has overloaded bonds: all remove
/// their copies (collective).
template <class... Policies>
void Simulation<Policies...>::break_bonds_of_ranks() {
  if constexpr (has_bonds && has_ranks) {
    bonds_broken_.clear();
    if (!engine_.bonds_break) return;
    auto& held = engine_.particles.bonds;
    std::vector<IndexPair> pairs;
    bool freed = false;
    const auto row_of = [&](ParticleId which) {
      return static_cast<std::uint32_t>(engine_.row_of(which));
    };
    bonds_broken_ = bonds_.take_broken(engine_, time_, [&](const auto& bond) {
      const auto is_there = [&](ParticleId which) {
        return !has_breakage || which == no_particle || row_of(which) < engine_.particles.size();
      };
      const bool has_both = is_there(bond.a) && is_there(bond.b);
      if (bond.b == no_particle) {
        if (!held.holds(bond.a, held.id_of_wall(bond.wall)) ||
            bonds_.at_walls.exclude(bond.a, bond.wall))
          return;
        held.remove(bond.a, held.id_of_wall(bond.wall));
        if (has_both) held.freed_at_walls.push_back({bond.a, bond.wall}), freed = true;
        return;
      }
      if (!held.holds(bond.a, bond.b)) return;  // bonds of other ranks
      held.remove(bond.a, bond.b);
      if (has_both) pairs.push_back({row_of(bond.a), row_of(bond.b)});
    });
    for ([[maybe_unused]] const BondBreak& bond : bonds_broken_)
      if constexpr (has_ledger) book_.bond_broken(bond.energy);
    engine_.join_pairs(domain_, dt_, pairs);
    if (engine_.ranks.any(freed)) engine_.lists.forget();
  }
}

}  // namespace silt
