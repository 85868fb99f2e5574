// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <unordered_set>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/setup.hpp>
#include <silt/sph/wall_particles.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Finds walls so thin that liquid on one side interacts with liquid on the other: opposite
/// surfaces closer than 2 h - spacing. They are refused once there is liquid on both sides. Corners
/// and tips of wedges of more than 25 degrees are accepted, although liquid interacts through them
/// too.
class ThinWalls {
 public:
  void find(const WallParticles& walls, const SphSetup& setup) {
    places_.clear(), known_ = true;
    const double s = setup.spacing, least = 2 * setup.h() - s;
    constexpr double opposite = -0.9;  // [-] product of the normals
    for (std::size_t k = 0; k < walls.size(); ++k) {
      const WallParticles::Nearest here = walls.nearest(walls.place(k));
      const double deep = std::abs(here.distance);
      if (!(deep <= 0.8 * s)) continue;  // the first layer is sufficient
      const Vec3d way = -1.0 * here.normal, surface = walls.place(k) - deep * way;
      for (double t = deep + 0.1 * s; t < least; t += 0.1 * s) {
        const WallParticles::Nearest there = walls.nearest(surface + t * way);
        if (!(there.distance > 0)) continue;
        const Vec3d middle = surface + 0.5 * t * way;
        if (dot(there.normal, here.normal) < opposite &&
            is_far_from_edges(walls, middle, way, setup))
          places_.push_back({walls.to_wall(walls.wall_of(k), surface - 0.5 * s * way),
                             walls.to_wall(walls.wall_of(k), surface + (t + 0.5 * s) * way), t,
                             walls.wall_of(k)});
        break;
      }
    }
  }
  /// Errors: SimulationError if there is liquid within 1.5 spacings of both sides.
  void check(const WallParticles& walls, const SphColumns& columns, const Repeats& repeats,
             const SphSetup& setup, std::int64_t step, double time) const {
    if (places_.empty()) return;
    std::unordered_set<std::uint64_t> wet;  // cells of a spacing
    const auto cell = [&](const Vec3d& x, int i, int j, int k) {
      const Vec3d at = (1 / setup.spacing) * (x - setup.region.min);
      const auto of = [](double a, int more) {
        return static_cast<std::uint64_t>(std::floor(a) + more + 1e6) & 0x1fffff;
      };
      return of(at.x, i) | of(setup.dimensions == 2 ? 0 : at.y, j) << 21 | of(at.z, k) << 42;
    };
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (columns.is_liquid(k)) wet.insert(cell(columns.rows[k].position(), 0, 0, 0));
    const auto is_wet = [&](const Vec3d& x) {
      const int across = setup.dimensions == 2 ? 0 : 1;
      for (int i = -1; i <= 1; ++i)
        for (int j = -across; j <= across; ++j)
          for (int k = -1; k <= 1; ++k)
            if (wet.count(cell(repeats.wrapped(x), i, j, k)) != 0) return true;
      return false;
    };
    for (const Place& p : places_) {
      const Vec3d one = walls.to_space(p.wall, p.one);
      if (!is_wet(one) || !is_wet(walls.to_space(p.wall, p.other))) continue;
      throw SimulationError(
          sentence(
              "the liquid's step ", step, ", t = ", time, " s: wall ", walls.called(p.wall), " is ",
              p.thickness, " m thin near ", one,
              " m and has liquid on both sides, which interacts through it; make it thicker than "
              "2 h = ",
              2 * setup.h(), " m, or use a spacing of at most ",
              p.thickness * setup.spacing / (2 * setup.h()), " m"),
          step, {}, one);
    }
  }

  /// Whether the wall extends to all sides as far as the kernel reaches.
  static bool is_far_from_edges(const WallParticles& walls, const Vec3d& middle,
                                const Vec3d& across, const SphSetup& setup) {
    const Vec3d any = std::abs(across.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    const Vec3d one = normalised(cross(across, any)), other = cross(across, one);
    constexpr int directions = 8;
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * std::numbers::pi * k / directions;
      Vec3d along = std::cos(angle) * one + std::sin(angle) * other;
      if (setup.dimensions == 2) along.y = 0;
      if (walls.distance(middle + 2 * setup.h() * along) > 0) return false;
    }
    return true;
  }
  bool known() const { return known_; }

 private:
  struct Place {
    Vec3d one, other;  // [m] half a spacing before both surfaces, in the wall's coordinates
    double thickness;  // [m] accurate to a tenth of a spacing
    std::size_t wall;
  };
  DynArray<Place> places_;
  bool known_ = false;  // not after a restart
};

}  // namespace silt::detail
