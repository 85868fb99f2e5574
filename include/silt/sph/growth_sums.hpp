// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include <silt/core/threads.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/opening_sums.hpp>
#include <silt/sph/row.hpp>
#include <silt/sph/solid_sums.hpp>

namespace silt::inline SILT_TARGET::detail {

/// [kg/(m3 s)] Part of `parting` that acts on a density `from` [kg/m3] within `span` [s] beside its
/// other `rate`: it does not lower it below `rest`.
inline double sph_parting(double from, double rate, double parting, double rest, double span) {
  const double room = from + span * rate - rest;
  return room > 0 ? std::max(parting, -room / span) : 0;
}

/// Second half of the rates of LeapfrogTime, for a step of dt [s], at the same positions and with
/// the new velocities of the liquid: `rates` have the mean rate of density of the step afterwards,
/// `growth` that at its end. Both include diffusion, which does not depend on velocities.
template <class Core>
void sph_find_growth(Core& core, double dt, const Team& team) {
  using Lists = typename Core::Lists;
  constexpr std::size_t W = Core::Pairs::W;
  auto& of = core.columns;
  const auto pairs = core.pairs();
  const std::size_t walls = core.lists.first_pack(Lists::Wall),
                    probes = core.lists.first_pack(Lists::Probe);
  if (!core.openings.empty()) sph_set_buffers(core, team);  // they follow the liquid
  core.shorten_velocities(pairs, 0, walls, team, [](std::size_t) { return true; });
  if constexpr (Core::Walls::mirrored) {
    sph_mirror_velocities(core, pairs, team);
    core.shorten_velocities(pairs, walls, probes, team,
                            [&](std::size_t p) { return core.lists.sees_liquid(p); });
  }
  const auto change = [&](std::size_t pack, const SphGrowth* now, const auto& part) {
    for (std::size_t l = 0, k = pack * W; l < W; ++l, ++k) {
      const double more = now[l].density - of.growth[k].density,
                   parting = 0.5 * (now[l].parting + of.growth[k].parting);
      of.growth[k] = {of.rates[k].density + more, now[l].parting};
      of.rates[k].density += 0.5 * more;
      part(k, parting);
    }
  };
  team.for_ranges(walls, Lists::packs_a_range, [&](std::size_t, std::size_t from, std::size_t to) {
    SphGrowth now[W];
    for (std::size_t p = from; p < to; ++p) {
      pairs.growth_of_liquid(p, of.rows, of.volume, core.lists, now, of.brief, of.beside());
      change(p, now, [&](std::size_t k, double parting) {
        core.part(k, of.start[k].density, parting, dt);
      });
    }
  });
  if constexpr (!Core::Walls::mirrored)
    team.for_ranges(
        probes - walls, Lists::packs_a_range, [&](std::size_t, std::size_t from, std::size_t to) {
          SphGrowth now[W];
          for (std::size_t p = walls + from; p < walls + to; ++p) {
            pairs.growth_of_wall(p, of.rows, of.volume, core.lists, now, of.brief);
            change(p, now, [&](std::size_t k, double parting) { of.rates[k].density += parting; });
          }
        });
}

}  // namespace silt::detail
