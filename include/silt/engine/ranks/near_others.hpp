// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>

#include <silt/core/dyn_array.hpp>
#include <silt/core/position_row.hpp>
#include <silt/engine/ranks/choose_ghosts.hpp>
#include <silt/engine/ranks/near_reach.hpp>
#include <silt/engine/ranks/no_ranks.hpp>
#include <silt/engine/ranks/packed.hpp>
#include <silt/engine/state/module_columns.hpp>
#include <silt/module/concept.hpp>
#include <silt/parallel/comm.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What modules that act in pairs look at before a run on several ranks: the time step depends on
/// it, but ghosts may not be known yet, or not be up to date. Each rank then receives the particles
/// of others that its own may be near to.
template <class... Ms>
class NearOthers<ModuleList<Ms...>> {
 public:
  /// Evaluates the pair interactions, and their rates (collective).
  template <class Near, class Engine, class Domain>
  static void look(Near& near, const std::tuple<Ms...>& modules, const Engine& e,
                   const Domain& domain, double time) {
    const auto& ranks = e.ranks;
    const auto forget = [&near] { (near.template of_others<Ms>().clear(), ...); };
    forget();  // what is left of a look that has thrown
    DynArray<PositionRow> grown;
    ranks.together("particles near each other", [&] {
      near.see(e, e.owners(), time);
      const NearReach reach = Near::reach(modules);
      for (const Seen& p : near.particles.seen)
        if (p.id != no_particle)
          grown.push_back({p.position.x, p.position.y, p.position.z, reach.around(p.radius)});
    });
    if (ranks.size() > 1) receive(near, e, send(near, e, grown, domain));
    ranks.together("modules that act in pairs",
                   [&] { near.look_at_seen(modules, e, domain, true, true); });
    forget();
  }

 private:
  /// What each rank needs of this one's particles; `grown` has those that are present.
  template <class Near, class Engine, class Domain>
  static DynArray<Packed> send(const Near& near, const Engine& e,
                               std::span<const PositionRow> grown, const Domain& domain) {
    DynArray<std::uint32_t> present;
    for (std::uint32_t k = 0; k < near.particles.own; ++k)
      if (near.particles.seen[k].id != no_particle) present.push_back(k);
    DynArray<Packed> out;
    for (const auto& rows : ghosts_in_reach(e.ranks.comm(), grown, domain)) {
      out.emplace_back();
      for (const std::uint32_t n : rows) {
        out.back().put(near.particles.seen[present[n]]);
        (put_fields<Ms>(e, present[n], out.back()), ...);
      }
    }
    return out;
  }
  template <class Near, class Engine>
  static void receive(Near& near, const Engine& e, const DynArray<Packed>& out) {
    DynArray<Outgoing> messages;
    for (std::size_t r = 0; r < out.size(); ++r)
      if (!out[r].bytes().empty()) messages.push_back({static_cast<int>(r), out[r].bytes()});
    e.ranks.meet("particles of other ranks");
    for (const Arrival& came : deliver(e.ranks.comm(), messages))
      for (Unpacked from(came.bytes); !from.done();) {
        near.particles.seen.push_back(from.get<Seen>());
        (take_fields<Ms>(near, from), ...);
      }
  }
  template <class M, class Engine>
  static void put_fields(const Engine& e, std::size_t k, Packed& out) {
    if constexpr (ActsInPairs<M> && has_fields<M>) out.put(e.modules().template of<M>()[k]);
  }
  template <class M, class Near>
  static void take_fields(Near& near, Unpacked& from) {
    if constexpr (ActsInPairs<M> && has_fields<M>)
      near.template of_others<M>().push_back(from.get<FieldsOf<M>>());
  }
};

}  // namespace silt::detail
