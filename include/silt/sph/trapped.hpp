// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/ledger.hpp>
#include <silt/sph/liquid_check.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Brings liquid out of bodies. Where a body hits a floor or another body, the liquid between them
/// may be pressed through the particles of a surface. Nothing brings it out again, its density
/// drifts, and the pressure of gaps at walls (dry_gaps.hpp) was taken from it: a block twice as
/// heavy as water rose from the floor.
///
/// A particle deeper than half a spacing is moved to the nearest free place, half a spacing in
/// front of the surface, with its velocity and without pressure: along the axes, and for spheres
/// along the radius. If there is none, it is removed, and counted as displaced.
///
/// Source: silt's own.
/// Tests:  tests/sph/trapped.cpp.
template <class Core>
class SphTrapped {
 public:
  explicit SphTrapped(Core& core) : core_(core), s_(core.setup.spacing) {
    const auto& bodies = core.solids.bodies.bodies;
    const Repeats& repeats = core.lists.repeats;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      most_ = std::max(most_, bodies[b].reach);
      const double x = repeats.wrapped(bodies[b].centre).x;
      for (const int image : {0, -1, 1})
        if (image == 0 || repeats.length.x > 0)
          along_x_.push_back({x + image * repeats.length.x, static_cast<std::uint32_t>(b)});
    }
    std::sort(along_x_.begin(), along_x_.end());
  }
  void bring_out(const Team& team) {
    if (along_x_.empty()) return;
    auto& of = core_.columns;
    std::array<DynArray<std::size_t>, Team::most_ranges> found;
    team.for_ranges(of.size(), [&](std::size_t range, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k)
        if (of.is_liquid(k) && body_around(of.rows[k].position(), deep_) != none)
          found[range].push_back(k);
    });
    for (const auto& part : found)
      for (const std::size_t k : part) bring_out(k);
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  /// Body that contains a point and its neighbours at this distance [m] along the axes.
  std::size_t body_around(const Vec3d& x, double distance) const {
    const auto& bodies = core_.solids.bodies;
    auto next = std::lower_bound(along_x_.begin(), along_x_.end(),
                                 std::pair{x.x - most_, std::uint32_t{0}});
    for (; next != along_x_.end() && next->first <= x.x + most_; ++next) {
      const auto& body = bodies.bodies[next->second];
      const Vec3d arm = core_.lists.repeats.shortest(x - body.centre);
      if (dot(arm, arm) > body.reach * body.reach) continue;
      bool all = bodies.holds(body, arm);
      for (int d = 0; all && distance > 0 && d < 3; ++d)
        if (d != 1 || core_.setup.dimensions == 3)
          all = bodies.holds(body, arm + along(d, distance)) &&
                bodies.holds(body, arm - along(d, distance));
      if (all) return next->second;
    }
    return none;
  }
  static Vec3d along(int d, double distance) {
    return {d == 0 ? distance : 0, d == 1 ? distance : 0, d == 2 ? distance : 0};
  }
  bool is_free(const Vec3d& x) const {
    const auto& walls = core_.solids.walls;
    return body_around(x, 0) == none && !sph_is_out(core_, x) &&
           (walls.walls() == 0 || walls.distance(x) > 0.4 * s_);
  }
  void bring_out(std::size_t k) {
    auto& of = core_.columns;
    SphRow &r = of.rows[k], &start = of.start[k];
    const Vec3d x = r.position();
    const std::size_t b = body_around(x, deep_);
    if (b == none) return;
    const auto& body = core_.solids.bodies.bodies[b];
    const Vec3d arm = core_.lists.repeats.shortest(x - body.centre);
    DynArray<Vec3d> ways;
    if (const double r0 = norm(arm); body.form == BodyPoints::sphere && r0 > 0)
      ways.push_back((1 / r0) * arm);
    for (int d = 0; d < 3; ++d)
      if (d != 1 || core_.setup.dimensions == 3)
        ways.push_back(along(d, 1)), ways.push_back(along(d, -1));
    double least = INFINITY;
    Vec3d best{0, 0, 0};
    for (const Vec3d& way : ways) {
      double far = deep_;
      while (far < least && core_.solids.bodies.holds(body, arm + far * way)) far += 0.25 * s_;
      far += 0.5 * s_;
      if (far < least && is_free(x + far * way)) least = far, best = far * way;
    }
    sph_goes(core_, k, true);
    if (!(least < INFINITY)) {
      of.take_out(k), ++core_.displaced;
      return;
    }
    const Vec3d to = core_.lists.repeats.wrapped(x + best) - x;
    r.place(x + to), start.place(start.position() + to);
    r.density = start.density = core_.liquid.density;
    sph_returns(core_, k);
  }

  Core& core_;
  double s_, deep_ = 0.5 * s_, most_ = 0;               // [m] spacing, depth, largest reach
  DynArray<std::pair<double, std::uint32_t>> along_x_;  // x [m] of each body, and of its images
};

}  // namespace silt::detail
