// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/ledger.hpp>
#include <silt/sph/liquid_check.hpp>
#include <silt/sph/near_liquid.hpp>
#include <silt/sph/row.hpp>
#include <silt/sph/trapped.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Maintenance of rows and lists of an SphCore. Lists are valid until a particle has moved by more
/// than its slack, which increases with its speed. With the same for all, the few fast particles of
/// drops and splashes would force new lists every second step.
/// @{

/// Whether solids far from liquid have no rows. Solids whose only state is in their rows keep them,
/// and grains need all solids around them.
template <class Core>
constexpr bool sph_chooses_solids = Core::Walls::mirrored && !Core::Grains::averaged;

/// Slack [m] of a particle with this `speed` [m/s]: what it goes in some steps. Few are fast. With
/// at most h an image that is not in the lists, at 4 h or more, stays outside the support.
template <class Core>
double sph_slack(const Core& core, double speed) {
  constexpr double steps = 5, most = 1.5;  // [-]
  const double h = core.setup.h(), step = core.setup.courant * h / core.liquid.sound_speed;
  return std::min({0.04 * core.setup.spacing + steps * step * speed, most * core.setup.spacing, h});
}
/// [m/s] Largest speed of the liquid.
template <class Core>
double sph_fastest(const Core& core, const Team& team) {
  std::array<double, Team::most_ranges> parts{};
  const auto& of = core.columns;
  team.for_ranges(of.size(), [&](std::size_t range, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      if (of.kind[k] != ClusterLists::Liquid || of.label[k] == ClusterLists::none) continue;
      const Vec3d v = of.rows[k].velocity();
      parts[range] = std::max(parts[range], dot(v, v));
    }
  });
  return std::sqrt(*std::max_element(parts.begin(), parts.end()));
}

/// Whether no particle has moved by more than its slack.
template <class Core>
bool sph_lists_hold(const Core& core, const Team& team) {
  const auto& of = core.columns;
  if (!core.solids.hold(core.lists, Core::Walls::mirrored, core.small_grains())) return false;
  for (const std::uint32_t row : core.openings.probes())
    if (!core.lists.hold(row, of.rows[row].position())) return false;
  std::atomic<bool> all{true};
  const std::size_t n = core.lists.first_pack(ClusterLists::Wall) * core.lists.width;
  team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
    bool hold = true;
    for (std::size_t k = from; k < to && hold; ++k)
      hold = of.label[k] == ClusterLists::none || core.lists.hold(k, of.rows[k].position());
    if (!hold) all = false;
  });
  return all;
}

template <class Core>
const DynArray<std::uint32_t>& sph_order(Core& core, std::span<const SphRow> rows,
                                         const Team& team) {
  const auto& of = core.columns;
  return core.lists.sort(
      rows,
      [&of](std::size_t k) {
        return of.label[k] == ClusterLists::none ? int{ClusterLists::Gone} : int{of.kind[k]};
      },
      team);
}
/// Lists of sorted columns, with the positions `then`.
template <class Core>
void sph_make_lists(Core& core, std::span<const SphRow> then, std::span<const double> slack,
                    const Team& team) {
  core.solids.find_rows(core.columns, core.lists.first_pack(ClusterLists::Wall) * core.lists.width,
                        core.small_grains().size());
  core.openings.find_rows(core.columns);
  core.lists.find(then, 2 * core.setup.h(), team, slack);
  core.fresh = true;
}
/// Lists of a state.
template <class Core>
void sph_restore_lists(Core& core, std::span<const SphRow> then, std::span<const double> slack) {
  const Team team;
  auto& of = core.columns;
  const auto& order = sph_order(core, then, team);
  require(order.size() == of.size(), "Sph: the particles of a state are not in a valid order");
  for (std::size_t k = 0; k < order.size(); ++k)
    require(order[k] == k || of.label[k] == ClusterLists::none,
            "Sph: the particles of a state are not in a valid order");
  make_room(of.volume, of.size()), make_room(of.rates, of.size());
  sph_make_lists(core, then, slack, team);
}

/// Wraps liquid in periodic directions, and removes what has left the region.
template <class Core>
void sph_wrap_liquid(Core& core) {
  auto& of = core.columns;
  const Repeats& repeats = core.lists.repeats;
  for (std::size_t k = 0; k < of.size(); ++k) {
    if (of.label[k] == ClusterLists::none) continue;
    SphRow& r = of.rows[k];
    if (!of.is_liquid(k)) {
      if (sph_chooses_solids<Core> && of.label[k] < SphColumns::of_openings) continue;  // put anew
      r.place(repeats.wrapped(r.position()));
      continue;
    }
    sph_check(core, r);
    // During a step its start is wrapped too.
    const Vec3d way = repeats.wrapped(r.position()) - r.position();
    SphRow& start = of.start[k];
    r.place(r.position() + way), start.place(start.position() + way);
    sph_goes_round(core, k, way);
    if (sph_is_out(core, r.position())) sph_goes(core, k, false), of.take_out(k), ++core.left;
  }
}
/// Sorts the particles into packs, and builds lists.
template <class Core>
void sph_renew(Core& core, const Team& team) {
  auto& of = core.columns;
  auto& solids = core.solids;
  const bool first = solids.walls.fresh() || !core.made;
  if (solids.walls.fresh())
    solids.walls.make(core.setup, [&core](const Vec3d& x) { return core.openings.hold(x); }),
        solids.thin = {};
  core.move_walls();
  if (!core.openings.empty())
    core.openings.put_into(of, core.gravity, core.liquid.density,
                           [&](const Vec3d& x) { return solids.walls.distance(x); });
  sph_wrap_liquid(core);
  SphTrapped(core).bring_out(team);
  const double fastest = sph_fastest(core, team), of_walls = solids.walls.fastest();
  const auto put = [&](const auto& is_near) {
    solids.put_into(of, core.liquid.density, Core::Walls::mirrored, core.small_grains(),
                    core.lists.repeats, is_near, team);
  };
  if constexpr (sph_chooses_solids<Core>) {
    double most = of_walls;
    solids.bodies.for_those_that_go_farthest(
        [&](std::size_t k) { most = std::max(most, solids.bodies.fastest(k)); });
    const double reach = 2 * core.setup.h() + sph_slack(core, most);
    const auto reach_of = [&](std::size_t k) {
      return reach + sph_slack(core, norm(of.rows[k].velocity()));
    };
    if (solids.size() > 0)
      core.near.find(of, core.lists.repeats, reach + 0.3 * core.setup.spacing, reach_of,
                     core.setup.spacing, core.setup.dimensions == 2, team);
    put(core.near);
  } else if (first) {
    put([](const Vec3d&) { return true; });
  }
  core.made = true;
  if (!solids.thin.known()) solids.thin.find(solids.walls, core.setup);
  solids.thin.check(solids.walls, of, core.lists.repeats, core.setup, core.steps, core.time);
  of.arrange(sph_order(core, of.rows, team), team);

  DynArray<double>& slack = core.slack;
  slack.assign(of.size(), 0);
  team.for_ranges(of.size(), [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      const std::uint32_t label = of.label[k];
      if (label == ClusterLists::none) continue;
      double speed = fastest;  // of openings' probes
      if (of.kind[k] == ClusterLists::Liquid)
        speed = norm(of.rows[k].velocity());
      else if (label < solids.walls.size())
        speed = of_walls;
      else if (label < solids.size())
        speed = solids.bodies.fastest(label - solids.walls.size());
      else if constexpr (Core::Grains::averaged)
        if (label < SphColumns::of_openings) speed = core.grains.speed(label - solids.size());
      slack[k] = sph_slack(core, speed);
    }
  });
  sph_make_lists(core, of.rows, slack, team);
  solids.walls.note_pose();
  core.stale = false;
}
/// @}

}  // namespace silt::detail
