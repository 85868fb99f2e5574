// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/opening_sums.hpp>
#include <silt/sph/solid_sums.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Present loads of the liquid on the particles of walls, read between steps. A reading needs the
/// rates of the present positions. In a Simulation the next step begins with the particles' own
/// positions, so rates found before it would leave a trace (lists, and densities between
/// unresolved grains): there the reading works on a copy of the liquid.
struct SphWallReading {
  struct Part {
    std::size_t wall;
    Vec3d place, force;  // [m], [N]
  };
  DynArray<Part> parts{};
  Vec3d gravity{0, 0, 0};  // [m/s2] of the reading
  bool known = false;

  /// Force [N] and torque [N m] about `about` [m].
  std::pair<Vec3d, Vec3d> load(std::size_t wall, const Vec3d& about) const {
    Vec3d force{0, 0, 0}, torque{0, 0, 0};
    for (const Part& p : parts)
      if (p.wall == wall) force += p.force, torque += cross(p.place - about, p.force);
    return {force, torque};
  }
  /// Finds the loads; `core` has the rates of the present positions afterwards.
  template <class Core>
  void find(Core& core, const Team& team) {
    parts.clear();
    const auto& solid = core.solids.walls;
    core.find_rates(team);
    const bool open = !core.openings.empty();
    if (open)
      sph_without_buffers(core, team, [&] { sph_solid_rates(core, team); });
    else if constexpr (Core::Walls::mirrored)
      sph_solid_rates(core, team);
    for (std::size_t k = 0; k < solid.size(); ++k)
      if (core.solids.has_row(k))
        parts.push_back({solid.wall_of(k), solid.place(k),
                         core.solids.force_on(k, core.columns, core.particle_mass())});
    auto gaps = core.gaps;  // the core's follow the steps
    gaps.find(core, team);
    for (const auto& push : gaps.pushes())
      parts.push_back({push.wall, core.solids.bodies.place(push.point), -1.0 * push.force});
    if (open && !Core::Walls::mirrored) sph_solid_rates(core, team);  // as they were
  }
};

}  // namespace silt::detail
