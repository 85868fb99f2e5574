// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/sph/setup.hpp>
#include <silt/sph/wall_particles.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Refuses liquid whose lattice does not match plane walls normal to an axis. The first row should
/// be half a spacing from the wall. Otherwise there is a gap or a compression; more than `most` of
/// the volume, along all axes together, is refused. Walls that the liquid does not touch, within
/// half a row, do not count.
inline void refuse_misfit(const WallParticles& walls, std::span<const Vec3d> liquid,
                          const SphSetup& setup) {
  constexpr double most = 0.05;  // [-]
  const double s = setup.spacing;
  struct Side {
    std::size_t wall;
    double off = 0, at = 0;  // [m] deviation of the first row from half a spacing, and position of
                             // the wall
  };
  double before = 0;  // [-] along the axes so far
  for (int axis = 0; axis < 3; ++axis) {
    if (liquid.empty() || (axis == 1 && setup.dimensions == 2)) continue;
    const auto along = [axis](const Vec3d& x) { return axis == 0 ? x.x : axis == 1 ? x.y : x.z; };
    DynArray<Side> sides;
    double rows = 1;
    walls.for_each_plane([&](std::size_t wall, const Vec3d& point, const Vec3d& normal) {
      const double sign = along(normal);
      if (std::abs(sign) < 1 - 1e-9) return;
      const auto distance = [&](const Vec3d& x) { return (along(x) - along(point)) / sign; };
      double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;
      for (const Vec3d& x : liquid)
        nearest = std::min(nearest, distance(x)), farthest = std::max(farthest, distance(x));
      const double layers = std::round((farthest - nearest) / s) + 1;
      const auto first = std::count_if(liquid.begin(), liquid.end(), [&](const Vec3d& x) {
        return distance(x) < nearest + 0.5 * s;
      });
      if (nearest < 0 || nearest > 1.5 * s ||
          2 * static_cast<double>(first) * layers < static_cast<double>(liquid.size()))
        return;
      sides.push_back({wall, nearest - 0.5 * s, along(point)}), rows = std::max(rows, layers);
    });
    double off = 0;
    const Side* worst = nullptr;
    for (const Side& side : sides) {
      off += side.off;
      if (worst == nullptr || std::abs(side.off) > std::abs(worst->off)) worst = &side;
    }
    const double share = std::abs(off) / (rows * s + off);
    before += share;
    if (worst == nullptr || before <= most) continue;
    throw InputError(sentence(
        "Sph: the first row of the liquid is ", (worst->off + 0.5 * s) / s, " spacings from wall ",
        walls.called(worst->wall), " at ", "xyz"[axis], " = ", worst->at,
        " m, not half a spacing; its ", rows, " rows along ", "xyz"[axis], " leave ", 100 * share,
        off > 0 ? " % empty" : " % too few room",
        before > share
            ? text(", and other directions ", std::round(1e3 * (before - share)) / 10, " %")
            : "",
        "; put SphSetup.region.min a whole number of spacings from the wall, and use a "
        "spacing that divides the distance of walls that face each other"));
  }
}

/// Refuses liquid of which whole rows lie on oblique walls, as on those at 45 degrees through the
/// corner of the region: half of these sites should be liquid, and none is.
inline void refuse_sites_on_walls(std::size_t on_walls, std::size_t liquid, const SphSetup& setup) {
  constexpr double most = 0.015;  // [-]
  const double lost = 0.5 * static_cast<double>(on_walls) / static_cast<double>(liquid);
  if (!(lost > most)) return;
  throw InputError(
      sentence("Sph::fill: ", on_walls,
               " places of the lattice lie on oblique walls and stay empty, which "
               "leaves out ",
               100 * lost, " % of the liquid; move SphSetup.region.min by a quarter of a spacing, ",
               0.25 * setup.spacing, " m, along an axis"));
}

}  // namespace silt::detail
