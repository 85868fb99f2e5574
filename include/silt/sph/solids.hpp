// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/sph/body_points.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/solid_frames.hpp>
#include <silt/sph/solid_hold.hpp>
#include <silt/sph/thin_walls.hpp>
#include <silt/sph/wall_particles.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Solids in a liquid: the particles of walls, then those of bodies, each with a mirror image in
/// the liquid, and their rows; and the rows of unresolved grains, which are only probes, numbered
/// from size() on.
class SphSolids {
 public:
  WallParticles walls;
  ThinWalls thin;
  BodyPoints bodies;
  SolidHold holding;  // of their particles
  DynArray<std::uint32_t> wall_row, probe_row;
  std::optional<double> plane;  // [m] y of a liquid in 2D, exact for all particles

  std::size_t size() const { return walls.size() + bodies.size(); }
  bool is_wall(std::size_t k) const { return k < walls.size(); }
  Vec3d place(std::size_t k) const {
    return flat(is_wall(k) ? walls.place(k) : bodies.place(k - walls.size()));
  }
  Vec3d ghost(std::size_t k) const {
    return flat(is_wall(k) ? walls.ghost(k) : bodies.ghost(k - walls.size()));
  }
  /// [m/s] of the surface between a particle and its mirror image.
  Vec3d velocity(std::size_t k) const {
    Vec3d v = is_wall(k) ? walls.velocity(k) : bodies.velocity(k - walls.size());
    if (plane) v.y = 0;
    return v;
  }
  /// [m/s] of the particle itself in the rotating solid; times a force it gives the power.
  Vec3d own_velocity(std::size_t k) const {
    Vec3d v = is_wall(k) ? walls.own_velocity(k) : bodies.own_velocity(k - walls.size());
    if (plane) v.y = 0;
    return v;
  }
  /// [-] share of a particle's volume and mass.
  double share(std::size_t k) const { return is_wall(k) ? 1 : bodies.share(k - walls.size()); }

  /// Puts the needed particles into columns, in place of the present ones; with probes at their
  /// mirror images, or without. is_near(x): whether liquid may be near a point. At least one
  /// particle of each body and of walls is included, to track their displacement.
  template <class IsNear>
  void put_into(SphColumns& columns, double density, bool mirrored, std::span<const Vec3d> grains,
                const Repeats& repeats, const IsNear& is_near, const Team& team) {
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (columns.label[k] < SphColumns::of_openings && columns.kind[k] != ClusterLists::Liquid)
        columns.take_out(k);
    places_.resize(size()), needed_.resize(size());
    team.for_ranges(size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        places_[k] = repeats.wrapped(place(k));
        needed_[k] = is_near(places_[k]) || tells_way(k);
      }
    });
    SphRow r{};
    r.density = density;
    for (std::uint32_t k = 0; k < size(); ++k) {
      if (needed_[k] == 0) continue;
      r.place(places_[k]), columns.add(r, ClusterLists::Wall, k);
      if (mirrored) r.place(repeats.wrapped(ghost(k))), columns.add(r, ClusterLists::Probe, k);
    }
    for (std::uint32_t p = 0; p < grains.size(); ++p) {
      r.place(repeats.wrapped(grains[p]));
      columns.add(r, ClusterLists::Probe, static_cast<std::uint32_t>(size()) + p);
    }
  }
  /// Finds their rows from `first` on; ClusterLists::none: no row.
  void find_rows(const SphColumns& columns, std::size_t first, std::size_t grains) {
    wall_row.assign(size(), ClusterLists::none);
    probe_row.assign(size() + grains, ClusterLists::none);
    for (std::size_t k = first; k < columns.size(); ++k)
      if (const std::uint32_t label = columns.label[k]; label < SphColumns::of_openings) {
        auto& rows = columns.kind[k] == ClusterLists::Wall ? wall_row : probe_row;
        require(label < rows.size(), "Sph: a state has a solid particle ", label, " of ",
                rows.size());
        rows[label] = static_cast<std::uint32_t>(k);
      }
    first_row_ = first, frames_.rows.clear();
  }
  /// Their own coordinates, when all walls and bodies are known.
  void find_frames(const SphColumns& columns, const Team& team) {
    const std::size_t first = first_row_;
    frames_.rows.assign(columns.size() - first, {});
    team.for_ranges(size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        if (!has_row(k)) continue;
        const std::size_t body = k - walls.size();
        const bool goes_along = !plane && (!is_wall(k) || walls.goes_along(k));
        const Vec3d at = is_wall(k) ? walls.own_place(k) : bodies.own_place(body),
                    ghost = is_wall(k) ? walls.own_ghost(k) : bodies.own_ghost(body);
        SolidFrames::Own own{at, 0.5 * (at + ghost)};
        own.share = share(k);
        if (goes_along)
          own.frame = static_cast<std::uint32_t>(is_wall(k) ? walls.wall_of(k)
                                                            : walls.walls() + bodies.body_of(body));
        frames_.rows[wall_row[k] - first] = own;
        if (probe_row[k] == ClusterLists::none) continue;
        own.at = ghost, own.wall_row = wall_row[k];
        frames_.rows[probe_row[k] - first] = own;
      }
    });
  }
  /// [m/s] of the surface at the particle k, with its row or that of its image.
  Vec3d velocity(std::size_t k, std::size_t row) const {
    const SolidFrames::Own& own = frames_.rows[row - first_row_];
    return own.frame == SolidFrames::none ? velocity(k) : frames_.velocity(own);
  }
  /// What is stored with a row of walls, bodies and their images.
  const SolidFrames::Own& of_row(std::size_t row) const { return frames_.rows[row - first_row_]; }
  bool has_row(std::size_t k) const { return wall_row[k] != ClusterLists::none; }
  bool have_rows(std::size_t grains) const {
    return wall_row.size() == size() && probe_row.size() == size() + grains;
  }
  std::span<const std::uint32_t> grain_rows() const {
    return std::span(probe_row).subspan(std::min(size(), probe_row.size()));
  }
  /// Whether no particle has moved by more than its slack in the lists.
  bool hold(const ClusterLists& lists, bool mirrored, std::span<const Vec3d> grains) const {
    if (walls.size() > 0 && walls.way() > lists.slack(wall_row[0])) return false;
    bool all = true;
    const auto look = [&](std::uint32_t row, const Vec3d& now) {
      const Vec3d then = lists.built(row);
      all = all && lists.hold(row, then + lists.repeats.shortest(now - then));
    };
    bodies.for_those_that_go_farthest([&](std::size_t body) {
      const std::size_t k = walls.size() + body;
      look(wall_row[k], place(k));
      if (mirrored) look(probe_row[k], ghost(k));
    });
    for (std::size_t p = 0; p < grains.size(); ++p) look(probe_row[size() + p], flat(grains[p]));
    return all;
  }
  /// Moves their rows to the present positions, in the same periodic image: those near liquid by
  /// the lists, or all. Without probes they have the velocity of their surface.
  void move_rows(SphColumns& columns, const ClusterLists& lists, bool walls_too, bool mirrored,
                 std::span<const Vec3d> grains, bool all, const Team& team) {
    if (frames_.rows.empty()) find_frames(columns, team);
    frames_.set(walls, bodies);
    const auto move = [&](SphRow& r, const Vec3d& to) {
      r.place(r.position() + lists.repeats.shortest(to - r.position()));
    };
    const std::size_t first = lists.first_pack(ClusterLists::Wall), n = lists.packs() - first;
    team.for_ranges(
        n, ClusterLists::packs_a_range, [&](std::size_t, std::size_t from, std::size_t to) {
          for (std::size_t p = first + from; p < first + to; ++p) {
            if (!all && !lists.sees_liquid(p)) continue;
            for (std::size_t row = p * lists.width; row < (p + 1) * lists.width; ++row) {
              const std::uint32_t k = columns.label[row];
              if (k >= SphColumns::of_openings || (!walls_too && k < walls.size())) continue;
              SphRow& r = columns.rows[row];
              const SolidFrames::Own& own = frames_.rows[row - first_row_];
              if (k >= size())
                move(r, flat(grains[k - size()]));
              else if (own.frame != SolidFrames::none)
                move(r, frames_.place(own));
              else
                move(r, columns.kind[row] == ClusterLists::Probe ? ghost(k) : place(k));
              if (!mirrored && k < size() && columns.kind[row] == ClusterLists::Wall)
                r.move(velocity(k, row));
            }
          }
        });
  }
  /// [N] of the liquid on one particle, after its rates; `mass` [kg] of a particle.
  Vec3d force_on(std::size_t k, const SphColumns& columns, double mass) const {
    if (!has_row(k)) return {0, 0, 0};
    return (share(k) * mass) * columns.rates[wall_row[k]].acceleration;
  }

 private:
  bool tells_way(std::size_t k) const {
    return is_wall(k) ? k == 0 : bodies.tells_way(k - walls.size());
  }
  Vec3d flat(Vec3d x) const {
    if (plane) x.y = *plane;
    return x;
  }
  SolidFrames frames_;
  DynArray<Vec3d> places_;
  DynArray<char> needed_;
  std::size_t first_row_ = 0;
};

}  // namespace silt::detail
