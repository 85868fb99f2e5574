// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/ledger.hpp>
#include <silt/sph/liquid_check.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Brings liquid out of bodies and walls. Where a body hits a floor or another body, the liquid
/// between them may be pressed through the particles of a surface. Nothing brings it out again, its
/// density drifts, and the pressure of gaps at walls (dry_gaps.hpp) was taken from it: a block
/// twice as heavy as water rose from the floor. In a floor it sinks until it leaves the region.
///
/// A particle deeper than half a spacing in a body is moved to the nearest free place, half a
/// spacing in front of the surface, with its velocity and without pressure: along the axes, and for
/// spheres along the radius. If there is none, it is removed, and counted as displaced.
///
/// One that is a tenth of a spacing or more behind a wall gets at least the velocity with which it
/// would be out after 50 h/c: the continuity equation sees this, and volume is kept. Beyond 0.75
/// spacings it would soon leave the region, and is moved as out of bodies.
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
  /// With the lists of earlier rows, if there are any.
  void bring_out(const Team& team) {
    if (!along_x_.empty()) {
      find(core_.columns.size(), team, [&](std::size_t from, std::size_t to, Found& out) {
        for (std::size_t k = from; k < to; ++k)
          if (core_.columns.is_liquid(k) &&
              body_around(core_.columns.rows[k].position(), deep_) != none)
            out.push_back(k);
      });
      for (const auto& part : found_)
        for (const std::size_t k : part) out_of_body(k);
    }
    if (core_.solids.walls.walls() == 0 || core_.lists.version() == 0 || !core_.made) return;
    find(core_.lists.first_pack(ClusterLists::Wall), team,
         [&](std::size_t from, std::size_t to, Found& out) {
           for (std::size_t pack = from; pack < to; ++pack)
             if (!core_.lists.walls(pack).empty()) find_in_walls(pack, out);
         });
    for (const auto& part : found_)
      for (const std::size_t k : part) turn_back(k);
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  using Found = DynArray<std::size_t>;  // rows

  template <class Look>
  void find(std::size_t n, const Team& team, const Look& look) {
    for (Found& part : found_) part.clear();
    team.for_ranges(n, ClusterLists::packs_a_range,
                    [&](std::size_t range, std::size_t from, std::size_t to) {
                      look(from, to, found_[range]);
                    });
  }
  /// Liquid of a pack deep in walls. Only what is nearer to a particle of a wall than a spacing can
  /// be: others are not compared with surfaces.
  void find_in_walls(std::size_t pack, Found& out) const {
    const std::size_t W = core_.lists.width;
    const auto& of = core_.columns;
    double least[ClusterLists::most_width];
    std::fill_n(least, W, INFINITY);
    for (const auto& e : core_.lists.walls(pack)) {
      const Vec3d x = of.rows[e.row()].position() + core_.lists.shift(e.image());
      for (std::size_t l = 0; l < W; ++l) {
        const SphRow& r = of.rows[pack * W + l];
        const double dx = r.x - x.x, dy = r.y - x.y, dz = r.z - x.z;
        least[l] = std::min(least[l], dx * dx + dy * dy + dz * dz);
      }
    }
    for (std::size_t l = 0; l < W; ++l)
      if (const std::size_t k = pack * W + l; of.is_liquid(k) && least[l] < 0.81 * s_ * s_)
        if (core_.solids.walls.distance(of.rows[k].position()) < -shallow_) out.push_back(k);
  }
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
  void turn_back(std::size_t k) {
    const Vec3d x = core_.columns.rows[k].position();
    const auto wall = core_.solids.walls.nearest(x);
    if (wall.distance < -lost_) return out_of_wall(k, wall.distance, wall.normal);
    const Vec3d u = core_.solids.walls.velocity_at(wall.wall, x);
    const double out = -wall.distance * core_.liquid.sound_speed / (slow_ * core_.setup.h());
    sph_goes(core_, k, true);
    for (SphRow* r : {&core_.columns.rows[k], &core_.columns.start[k]}) {
      const double lacks = out - dot(r->velocity() - u, wall.normal);
      if (lacks > 0) r->move(r->velocity() + lacks * wall.normal);
    }
    sph_returns(core_, k);
  }
  void out_of_wall(std::size_t k, double distance, const Vec3d& normal) {
    const Vec3d x = core_.columns.rows[k].position();
    Vec3d way = (deep_ - distance) * normal;
    if (const std::size_t b = body_around(x + way, 0); b != none) {
      const auto beside = way_out(b, x + way, 0);
      if (!beside) return;
      way += *beside;
    }
    if (sph_is_out(core_, x + way)) return;
    sph_goes(core_, k, true), put(k, way);
  }
  void out_of_body(std::size_t k) {
    const Vec3d x = core_.columns.rows[k].position();
    const std::size_t b = body_around(x, deep_);
    if (b == none) return;
    const auto way = way_out(b, x, deep_);
    sph_goes(core_, k, true);
    if (way)
      put(k, *way);
    else
      core_.columns.take_out(k), ++core_.displaced;
  }
  /// [m] from a point in a body, `deep` [m] or more, to the nearest free place.
  std::optional<Vec3d> way_out(std::size_t b, const Vec3d& x, double deep) const {
    const auto& body = core_.solids.bodies.bodies[b];
    const Vec3d arm = core_.lists.repeats.shortest(x - body.centre);
    DynArray<Vec3d> ways;
    if (const double r0 = norm(arm); body.form == BodyPoints::sphere && r0 > 0)
      ways.push_back((1 / r0) * arm);
    for (int d = 0; d < 3; ++d)
      if (d != 1 || core_.setup.dimensions == 3)
        ways.push_back(along(d, 1)), ways.push_back(along(d, -1));
    double least = INFINITY;
    std::optional<Vec3d> best;
    for (const Vec3d& way : ways) {
      double far = deep;
      while (far < least && core_.solids.bodies.holds(body, arm + far * way)) far += 0.25 * s_;
      far += 0.5 * s_;
      if (far < least && is_free(x + far * way)) least = far, best = far * way;
    }
    return best;
  }
  /// Moves the particle of a row, which has gone as displaced.
  void put(std::size_t k, const Vec3d& way) {
    SphRow &r = core_.columns.rows[k], &start = core_.columns.start[k];
    const Vec3d x = r.position(), to = core_.lists.repeats.wrapped(x + way) - x;
    r.place(x + to), start.place(start.position() + to);
    r.density = start.density = core_.liquid.density;
    sph_returns(core_, k);
  }

  Core& core_;
  static constexpr double slow_ = 50;  // [-] h/c in which a particle would leave a wall
  double s_, deep_ = 0.5 * s_, shallow_ = 0.1 * s_, lost_ = 0.75 * s_,
             most_ = 0;                                 // [m] spacing, depths, reach
  DynArray<std::pair<double, std::uint32_t>> along_x_;  // x [m] of each body, and of its images
  std::array<Found, Team::most_ranges> found_{};
};

}  // namespace silt::detail
