// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <silt/core/quaternion.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/body_points.hpp>
#include <silt/sph/cluster_lists.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Pressure in gaps between bodies and walls that are too narrow for a particle. Without it a body
/// on a floor is pressed down by the liquid above: even a cork would stay down, because its lower
/// side is dry. Floors and bodies are taken as rough: liquid fills the gap with the hydrostatic
/// pressure of its surroundings:
///
///   f_k = -2 V_k p_k M_k,  M_k = -sum_own V grad W - sum_liquid V grad W
///
/// M_k is the missing part of the kernel gradient at the particle k of a body, compared with liquid
/// on all sides; the latter is the opposite of the sum over the body's own particles. With the
/// whole M_k the sum over the body is its buoyancy; where there is liquid, the pair sums include
/// its part. p_k is the pressure at the surface in front of k: the mean over the liquid within the
/// kernel's reach of the body's surface along that wall, closer than 2 h to the wall, extrapolated
/// by rho g, and not below 0. The wall gets -f_k at the same point.
///
/// Source: silt's own.
/// Valid:  gaps between bodies and walls; not between bodies. No suction: p_k >= 0.
/// Tests:  tests/sph/body_on_floor.cpp.
template <class Kernel>
class DryGaps {
 public:
  struct Push {
    std::size_t point;  // index in BodyPoints; gets `force`
    std::size_t wall;   // gets the opposite
    Vec3d force{0, 0, 0};
  };
  std::span<const Push> pushes() const { return pushes_; }

  /// Finds the forces for the present densities and lists.
  template <class Core>
  void find(const Core& core, const Team& team) {
    pushes_.clear();
    const BodyPoints& of = core.solids.bodies;
    if (of.empty() || core.solids.walls.walls() == 0) return;
    if (made_ != of.version()) find_own(of, core.setup), made_ = of.version();
    const double reach = 2 * core.setup.h();
    sites_.clear();
    for (std::size_t k = 0; k < of.size();) {
      const std::size_t b = of.body_of(k), from = k;
      while (k < of.size() && of.body_of(k) == b) ++k;
      const auto& body = of.bodies[b];
      if (!is_wet(core, from, k) || core.solids.walls.distance(body.centre) > body.reach + reach)
        continue;
      const std::size_t first = sites_.size();
      for (std::size_t p = from; p < k; ++p) {
        const Vec3d surface = 0.5 * (of.place(p) + of.ghost(p));
        const auto wall = core.solids.walls.nearest(surface);
        if (wall.distance < reach) sites_.push_back({p, wall.wall, wall.distance, surface});
      }
      look(core, first, team);
      push(core, first);
    }
  }

 private:
  struct Site {
    std::size_t point, wall;
    double gap;     // [m]
    Vec3d surface;  // [m]
    // Sums over the liquid: V grad W [1/m], V W [-], V W (P - rho g.x) [Pa].
    Vec3d slope{0, 0, 0};
    double weight = 0, level = 0;
  };
  /// For each kind of body: its points are in the same order.
  void find_own(const BodyPoints& of, const SphSetup& setup) {
    own_.assign(of.size(), {0, 0, 0});
    const double h = setup.h(), a = Kernel::normalisation(setup.dimensions, h) / (h * h),
                 V = setup.volume();
    std::map<std::pair<std::uint32_t, double>, std::size_t> known;
    for (std::size_t from = 0, to = 0; from < of.size(); from = to) {
      const auto& body = of.bodies[of.body_of(from)];
      while (to < of.size() && of.body_of(to) == of.body_of(from)) ++to;
      const auto [same, is_new] = known.try_emplace({body.form, body.radius}, from);
      for (std::size_t k = from; k < to; ++k) {
        if (!is_new) {
          own_[k] = own_[same->second + k - from];
          continue;
        }
        for (std::size_t b = from; b < to; ++b) {
          const Vec3d r = of.own_place(k) - of.own_place(b);
          own_[k] += a * V * of.share(b) * Kernel::slope(norm(r) / h) * r;
        }
      }
    }
  }
  /// Whether liquid is near any of a body's points, by the lists.
  template <class Core>
  static bool is_wet(const Core& core, std::size_t from, std::size_t to) {
    for (std::size_t k = core.solids.walls.size() + from; k < core.solids.walls.size() + to; ++k)
      if (core.solids.has_row(k) &&
          !core.lists.liquid(core.solids.wall_row[k] / core.lists.width).empty())
        return true;
    return false;
  }
  template <class Core>
  void look(const Core& core, std::size_t first, const Team& team) {
    const double h = core.setup.h(), a = Kernel::normalisation(core.setup.dimensions, h);
    const Vec3d rho_g = core.liquid.density * core.weight();
    const std::size_t walls = core.solids.walls.size();
    team.for_ranges(sites_.size() - first, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t n = first + from; n < first + to; ++n) {
        Site& s = sites_[n];
        if (!core.solids.has_row(walls + s.point)) continue;  // no liquid nearby
        const std::size_t row = core.solids.wall_row[walls + s.point];
        const Vec3d here = core.columns.rows[row].position(),
                    place = core.solids.bodies.place(s.point);
        for (const auto entry : core.lists.liquid(row / core.lists.width)) {
          const auto& b = core.columns.rows[entry.row()];
          Vec3d r = here - b.position();
          if (entry.image() != ClusterLists::here) r -= core.lists.shift(entry.image());
          if (dot(r, r) >= 4 * h * h) continue;
          const double q = norm(r) / h, V = core.columns.volume[entry.row()];
          s.slope += a / (h * h) * V * Kernel::slope(q) * r;
          const double w = a * V * Kernel::weight(q);
          s.weight += w, s.level += w * (b.pressure - dot(rho_g, place - r));
        }
      }
    });
  }
  /// Forces on one body, wall by wall.
  template <class Core>
  void push(const Core& core, std::size_t first) {
    const double s = core.setup.spacing, V = core.setup.volume();
    const Vec3d rho_g = core.liquid.density * core.weight();
    std::map<std::size_t, std::pair<double, double>> around;  // by wall: weight, level
    for (std::size_t n = first; n < sites_.size(); ++n)
      around[sites_[n].wall].first += sites_[n].weight,
          around[sites_[n].wall].second += sites_[n].level;
    for (std::size_t n = first; n < sites_.size(); ++n) {
      const Site& site = sites_[n];
      const auto [weight, level] = around[site.wall];
      if (!(weight > 0.1)) continue;
      const Vec3d all = -1.0 * core.solids.bodies.turned(site.point, own_[site.point]);
      const double whole = dot(all, all), h = core.setup.h();
      if (!(whole * h * h > 1e-3)) continue;
      const double wet = dot(site.slope, all) / whole,
                   share = std::clamp(5 * (0.9 - wet), 0.0, 1.0) *
                           std::clamp(2.5 - site.gap / s, 0.0, 1.0);
      const double p = level / weight + dot(rho_g, site.surface);
      if (!(share > 0 && p > 0)) continue;
      const double volume = V * core.solids.bodies.share(site.point);
      pushes_.push_back({site.point, site.wall, -2 * share * volume * p * (all - site.slope)});
    }
  }

  std::uint64_t made_ = 0;
  std::vector<Vec3d> own_;  // [1/m] sum of V grad W over a body's own particles, in its frame
  std::vector<Site> sites_;
  std::vector<Push> pushes_;
};

}  // namespace silt::detail
