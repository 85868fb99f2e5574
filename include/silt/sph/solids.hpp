// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <silt/sph/body_points.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/thin_walls.hpp>
#include <silt/sph/wall_particles.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What is solid in a liquid: the particles of walls, then those of bodies, each with a mirror
/// image in the liquid, and the rows in which both stand; and the rows of grains that are not
/// resolved, which are probes alone, numbered from size() on.
class SphSolids {
 public:
  WallParticles walls;
  ThinWalls thin;
  BodyPoints bodies;
  std::vector<std::uint32_t> wall_row, probe_row;
  std::optional<double> plane;  // [m] y of a liquid in 2D: all stays in it, to the last bit

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
  /// [m/s] of the particle itself, as the solid turns: with a force on it, the power.
  Vec3d own_velocity(std::size_t k) const {
    Vec3d v = is_wall(k) ? walls.own_velocity(k) : bodies.own_velocity(k - walls.size());
    if (plane) v.y = 0;
    return v;
  }
  /// [-] of a particle's volume and mass.
  double share(std::size_t k) const { return is_wall(k) ? 1 : bodies.share(k - walls.size()); }

  /// Puts them into columns in which there are none, or others; with probes at their mirror images,
  /// or without.
  void put_into(SphColumns& columns, double density, bool mirrored, std::span<const Vec3d> grains) {
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (columns.label[k] != ClusterLists::none && columns.kind[k] != ClusterLists::Liquid)
        columns.take_out(k);
    for (std::uint32_t k = 0; k < size(); ++k) {
      SphRow r{};
      r.density = density;
      r.place(place(k)), columns.add(r, ClusterLists::Wall, k);
      if (mirrored) r.place(ghost(k)), columns.add(r, ClusterLists::Probe, k);
    }
    for (std::uint32_t p = 0; p < grains.size(); ++p) {
      SphRow r{};
      r.density = density;
      r.place(grains[p]);
      columns.add(r, ClusterLists::Probe, static_cast<std::uint32_t>(size()) + p);
    }
  }
  /// Notes the rows from `first` on in which they stand.
  void find_rows(const SphColumns& columns, std::size_t first, std::size_t grains) {
    wall_row.assign(size(), 0), probe_row.assign(size() + grains, 0);
    for (std::size_t k = first; k < columns.size(); ++k)
      if (const std::uint32_t label = columns.label[k]; label != ClusterLists::none) {
        auto& rows = columns.kind[k] == ClusterLists::Wall ? wall_row : probe_row;
        require(label < rows.size(), "Sph: a state has a solid particle ", label, " of ",
                rows.size());
        rows[label] = static_cast<std::uint32_t>(k);
      }
  }
  bool have_rows(std::size_t grains) const {
    return wall_row.size() == size() && probe_row.size() == size() + grains;
  }
  std::span<const std::uint32_t> grain_rows() const {
    return std::span(probe_row).subspan(std::min(size(), probe_row.size()));
  }
  /// Moves their rows to where they are now, each in the image that its row is in; returns how far
  /// the farthest went [m]. Without probes they have the velocity of their surface.
  double move_rows(SphColumns& columns, const Repeats& repeats, bool walls_too, bool mirrored,
                   std::span<const Vec3d> grains) const {
    double most = 0;
    const auto move = [&](SphRow& r, const Vec3d& to) {
      const Vec3d way = repeats.shortest(to - r.position());
      most = std::max(most, norm(way));
      r.place(r.position() + way);
    };
    for (std::size_t k = walls_too ? 0 : walls.size(); k < size(); ++k) {
      move(columns.rows[wall_row[k]], place(k));
      if (mirrored)
        move(columns.rows[probe_row[k]], ghost(k));
      else
        columns.rows[wall_row[k]].move(velocity(k));
    }
    for (std::size_t p = 0; p < grains.size(); ++p)
      move(columns.rows[probe_row[size() + p]], flat(grains[p]));
    return most;
  }
  /// [N] of the liquid on one, after its rates were found; `mass` [kg] of a particle.
  Vec3d force_on(std::size_t k, const SphColumns& columns, double mass) const {
    return (share(k) * mass) * columns.rates[wall_row[k]].acceleration;
  }

 private:
  Vec3d flat(Vec3d x) const {
    if (plane) x.y = *plane;
    return x;
  }
};

}  // namespace silt::detail
