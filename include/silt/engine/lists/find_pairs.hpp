// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of NearLists: the search for pairs of spheres and for spheres near walls.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/lists/near_lists.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Composition, class Pairs, class Walls, class Mover>
void NearLists<Composition, Pairs, Walls, Mover>::find_pairs(const Scene& scene, Search& search,
                                                             double wall_speed, std::int64_t step) {
  std::size_t before = scene.particles.size();
  take_stock(scene, step);
  choose_skins(scene, search, wall_speed);
  reach_out(scene, wall_speed);
  const bool is_found = sort_rows(scene, search, step);
  if constexpr (State::of_ranks)
    scene.ranks.meet("the order of a search"), add_ghosts(scene), before = change_.places();
  if (!is_found) find_near(scene, search);
  pairs.set_outer(found_, scene.particles, before, scene.team);
  if constexpr (State::of_ranks) pairs.take_in(change_.pairs_brought(rows_of(scene)));
  if (found_.size() > 1000000) found_ = {};  // unused until the next search
  const double of_walls = upkeep.outer_wall + scene.range / 2;
  find_walls(scene, of_walls);
  if constexpr (State::of_ranks) scene.ranks.meet("a search");
  mark_places(scene, of_walls);
  first_pruning_ = true;
}

template <class Composition, class Pairs, class Walls, class Mover>
void NearLists<Composition, Pairs, Walls, Mover>::take_stock(const Scene& scene,
                                                             std::int64_t step) {
  previous_.resize(scene.particles.size());
  std::iota(previous_.begin(), previous_.end(), 0u);
  if constexpr (flows && State::of_bodies) scene.mover.wrap_in_flow(scene.particles, scene.domain);
  if constexpr (State::of_ranks)
    change_ranks(scene, step);
  else if (scene.particles.parked > 0)
    drop_parked(scene);
  if constexpr (Domain::periodic) {
    if constexpr (!State::of_ranks && !(flows && State::of_bodies)) wrap(scene);
    check_range(scene.domain, scene.particles, scene.range);
    if constexpr (flows && State::of_bodies) check_bodies(scene.domain, scene.mover.bodies);
  }
}

template <class Composition, class Pairs, class Walls, class Mover>
bool NearLists<Composition, Pairs, Walls, Mover>::sort_rows([[maybe_unused]] const Scene& scene,
                                                            Search& search,
                                                            [[maybe_unused]] std::int64_t step) {
  [[maybe_unused]] auto& find = finder_of(search);
  if constexpr (requires { find.order(grown(), 0.0, scene.domain, scene.team, order_); }) {
    if (!is_to_sort(search, step)) return false;
    if constexpr (flows)
      find.order(grown(), 0.0, OpenDomain{}, scene.team, order_);
    else
      find.order(grown(), 0.0, scene.domain, scene.team, order_);
    apply_order(scene);
    if constexpr (!flows && !State::of_ranks &&
                  requires { find.find_ordered(0.0, scene.domain, scene.team, found_); }) {
      find.find_ordered(0.0, scene.domain, scene.team, found_);
      return true;
    }
  }
  return false;
}

template <class Composition, class Pairs, class Walls, class Mover>
void NearLists<Composition, Pairs, Walls, Mover>::find_near(const Scene& scene, Search& search) {
  auto& find = finder_of(search);
  if constexpr (flows) {
    if constexpr (State::of_bodies)  // parts of bodies at the faces are outside
      for (PositionRow& row : grown_) {
        const Vec3d p = scene.domain.wrapped(row.centre());
        row = {p.x, p.y, p.z, row.r};
      }
    images_.find(find, grown().rows, largest_grown_, scene.domain, scene.team, found_);
    flow.search();
  } else {
    find.find(grown(), 0.0, scene.domain, scene.team, found_);
  }
}

template <class Composition, class Pairs, class Walls, class Mover>
void NearLists<Composition, Pairs, Walls, Mover>::find_walls(const Scene& scene, double reach) {
  const State& particles = scene.particles;
  walls.search(scene.walls, {grown_.data(), particles.owned()}, reach, previous_, scene.domain,
               scene.team, particles.size());
  if constexpr (State::of_ranks) walls.take_in(change_.walls_brought());
  if constexpr (State::bonded)
    erase_if(walls.found(), [&bonds = particles.bonds, &id = particles.id](const WallCandidate& c) {
      return bonds.holds(id[c.particle], bonds.id_of_wall(c.wall));
    });
}

template <class Composition, class Pairs, class Walls, class Mover>
void NearLists<Composition, Pairs, Walls, Mover>::mark_places(const Scene& scene, double of_walls) {
  const State& particles = scene.particles;
  reference.resize(particles.size());
  scene.team.for_ranges(particles.size(), [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) reference[k] = particles.position[k].centre();
  });
  searched_walls.set(scene.walls, occupied_region(scene).grown(largest_grown_ + of_walls));
}

template <class Composition, class Pairs, class Walls, class Mover>
void NearLists<Composition, Pairs, Walls, Mover>::change_ranks(const Scene& scene,
                                                               std::int64_t step) {
  if constexpr (Domain::periodic) {
    wrap(scene);
    if constexpr (State::of_bodies) scene.mover.wrap(scene.particles, scene.domain);
  }
  scene.ranks.meet("the start of a search");
  walls.set_aside();
  change_.move(scene.ranks, rows_of(scene), pairs, walls, step);
}

template <class Composition, class Pairs, class Walls, class Mover>
void NearLists<Composition, Pairs, Walls, Mover>::add_ghosts(const Scene& scene) {
  const std::size_t owned = scene.particles.size();
  if constexpr (Composition::Modules::in_pairs)
    change_.add_ghosts(scene.ranks, rows_of(scene), grown_by_modules(scene), scene.domain,
                       upkeep.outer);
  else
    change_.add_ghosts(scene.ranks, rows_of(scene), {grown_.data(), owned}, scene.domain,
                       upkeep.outer);
  grown_.resize(scene.particles.size());
  for (std::size_t k = owned; k < grown_.size(); ++k) {
    grown_[k] = scene.particles.position[k];
    grown_[k].r += upkeep.outer[k] + scene.range / 2;
  }
  for (const PositionRow& p : grown_) largest_grown_ = std::max(largest_grown_, p.r);
  largest_grown_ = scene.ranks.max_of(largest_grown_);
}

/// The owned rows, grown until those of particles that modules see together, or will before the
/// next search, overlap.
template <class Composition, class Pairs, class Walls, class Mover>
DynArray<PositionRow> NearLists<Composition, Pairs, Walls, Mover>::grown_by_modules(
    const Scene& scene) const {
  DynArray<PositionRow> rows(grown_.begin(), grown_.end());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    double radius, aside = 0;
    if constexpr (State::of_bodies) {
      const auto& part = scene.particles.part[k];
      const Body& body = scene.mover.bodies[part.body];
      radius = body.radius, aside = norm(body.centre + part.image - rows[k].centre());
    } else {
      radius = scene.particles.position[k].r;
    }
    rows[k].r = std::max(rows[k].r, scene.ranks.reach.around(radius) + upkeep.outer[k] + aside);
  }
  return rows;
}

template <class Composition, class Pairs, class Walls, class Mover>
double NearLists<Composition, Pairs, Walls, Mover>::last_way(const Scene& scene, std::size_t k) {
  constexpr double slack = 1.5;  // velocities of this step instead of the last
  const PositionRow& row = scene.particles.position[k];
  const Vec3d v = scene.particles.motion[k].velocity();
  double speed = norm(v);
  if constexpr (flows) {
    const Upper3& gradient = scene.domain.gradient();
    speed = norm(v - scene.domain.flow_at(row.centre())) +
            std::sqrt(inner(gradient, gradient)) * (row.r + scene.range);
  }
  return slack * scene.time_step * speed;
}

template <class Composition, class Pairs, class Walls, class Mover>
void NearLists<Composition, Pairs, Walls, Mover>::wrap(const Scene& scene) {
  auto& position = scene.particles.position;
  if constexpr (Composition::has_ledger && !State::of_bodies && !flows)
    for (std::size_t k = 0; k < scene.particles.owned(); ++k) {  // in order, for any team
      const double inv_m = scene.particles.motion[k].inv_m;
      if (inv_m == 0 || scene.particles.is_parked(k)) continue;
      const Vec3d at = position[k].centre();
      wrapped += (1 / inv_m) * (scene.domain.wrapped(at) - at);
    }
  scene.team.for_ranges(scene.particles.size(), [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      const Vec3d p = scene.domain.wrapped(position[k].centre());
      if constexpr (State::of_bodies) scene.particles.part[k].image += p - position[k].centre();
      if constexpr (flows)
        scene.particles.add_velocity(k, scene.domain.carried(p - position[k].centre()));
      position[k] = {p.x, p.y, p.z, position[k].r};
    }
  });
}

template <class Composition, class Pairs, class Walls, class Mover>
void NearLists<Composition, Pairs, Walls, Mover>::drop_parked(const Scene& scene) {
  order_.clear();
  for (std::uint32_t k = 0; k < scene.particles.size(); ++k)
    if (!scene.particles.is_parked(k)) order_.push_back(k);
  scene.particles.reorder(order_, scene.team);
  gather(previous_, order_, scene.team), gather(anticipated_, order_, scene.team);
  scene.particles.parked = 0;
  scene.particles.measure();
}

template <class Composition, class Pairs, class Walls, class Mover>
void NearLists<Composition, Pairs, Walls, Mover>::apply_order(const Scene& scene) {
  scene.particles.reorder(order_, scene.team);
  gather(previous_, order_, scene.team);
  gather(upkeep.outer, order_, scene.team), gather(grown_, order_, scene.team);
}

}  // namespace silt::detail
