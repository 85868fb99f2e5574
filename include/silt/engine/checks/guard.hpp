// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include <silt/boundary/wall.hpp>
#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/checks/guard_finite.hpp>
#include <silt/engine/checks/guard_overlap.hpp>
#include <silt/engine/lists/list_upkeep.hpp>
#include <silt/engine/lists/wall_look.hpp>
#include <silt/engine/state/body.hpp>

namespace silt::inline SILT_TARGET {

/// Limits on a run. If one is exceeded, the run is aborted with a SimulationError.
/// docs/stability.md says what each limit prevents and why it has its default.
struct Guard {
  double max_overlap = 0.3;      // [-] relative to the smaller radius; per pair: set_max_overlap
  double max_time_step = 0.125;  // [-] relative to the shortest contact time at the largest speed
  double max_travel = 0.3;      // [-] of the smallest radius: tips of particles and walls, per step
  double max_rate = 1.25;       // [-] of a particle in its contacts: contact_rates.hpp
  bool through_meshes = false;  // true: particles may tunnel to the back of a mesh
  std::optional<Box> domain = {};  // [m] region that particles must not leave; empty: not checked
};

namespace detail {

/// InputError if a limit is no limit.
[[gnu::cold]] inline void check_limits(const Guard& guard) {
  require_positive("Guard.max_overlap", guard.max_overlap, "-");
  require_positive("Guard.max_time_step", guard.max_time_step, "-");
  require_positive("Guard.max_travel", guard.max_travel, "-");
  require_positive("Guard.max_rate", guard.max_rate, "-");
  if (!guard.domain) return;
  const auto& [min, max] = *guard.domain;
  require(min.x < max.x && min.y < max.y && min.z < max.z, "guard.domain from ", min, " to ", max,
          " [m] must have its min below its max in every direction");
}

/// Whether a shorter time step may cure the error: only if the limits that detect too long a step
/// in time have been disabled.
inline bool lets_long_steps_pass(const Guard& guard) {
  const Guard usual;
  return guard.max_time_step > usual.max_time_step || guard.max_travel > usual.max_travel ||
         guard.max_rate > usual.max_rate;
}

/// A recommended time step [s], rounded down to three digits.
inline std::string below(double time_step) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.3g", 0.999 * time_step);
  return digits;
}

/// A wall whose motion returned an invalid pose would act on nothing or in the wrong place.
inline void check_pose(std::span<const Wall> walls, std::size_t number, std::int64_t step,
                       double time) {
  const Wall& wall = walls[number];
  const Quaternion& q = wall.pose.rotation;
  const double length2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  const auto stop = [&](const char* what) {
    throw SimulationError(
        sentence("step ", step, ", t = ", time, " s: the motion of ", name_of_wall(walls, number),
                 " gives ", what,
                 wall.is_driven() ? "; its loads or its speed are not finite: look for "
                                    "particles that overlap it deeply"
                                  : "; mend the function that was given to add_wall"),
        step, {}, wall.pose.translation);
  };
  if (!is_finite(wall.pose.translation) || !std::isfinite(length2))
    stop("a pose that is not finite");
  if (std::abs(length2 - 1) > 1e-6) stop("a rotation whose quaternion is not of length 1");
}

/// [-] The time step is checked against its limit again where the largest speed has grown by this
/// factor.
inline constexpr double checked_again = 1.05;

/// Displacement per step [m] of the points of a moving wall where particles may be near.
template <class EngineType>
double travel_of(const EngineType& e, const Wall& w) {
  if (e.particles.size() == 0 && !EngineType::of_ranks) return 0;
  if (!w.moves()) return deformation_of(w);
  return deformation_of(w) +
         displacement_of(w, w.pose, w.last_pose, e.lists.searched_walls.region_of(w));
}
/// The largest such displacement.
template <class EngineType>
double wall_travel(const EngineType& e) {
  double most = 0;
  for (const Wall& w : e.walls) most = std::max(most, travel_of(e, w));
  return most;
}
template <class EngineType>
[[gnu::cold]] std::size_t fastest_wall(const EngineType& e) {
  std::size_t fastest = 0;
  for (std::size_t w = 1; w < e.walls.size(); ++w)
    if (travel_of(e, e.walls[w]) > travel_of(e, e.walls[fastest])) fastest = w;
  return fastest;
}

/// Speed of the surface of a particle, tips included (Body::tip_speed).
struct SurfaceSpeed {
  double centre = 0, by_spin = 0;  // [m/s] by_spin: 0 for spheres
  double spin = 0;                 // [rad/s]
  ParticleId id = no_particle;

  double sum() const { return centre + by_spin; }
  bool is_of_tips() const { return by_spin > 0.1 * centre; }
  /// The two contributions to the speed, for a message; empty if the rotation hardly contributes.
  std::string words() const {
    if (!is_of_tips()) return {};
    return sentence(" (of the tips of particle ", id, ": its velocity of ", centre, " m/s and ",
                    by_spin, " m/s by its spin of ", spin, " rad/s)");
  }
};

template <class EngineType>
SurfaceSpeed surface_speed(const EngineType& e, std::size_t place) {
  if constexpr (EngineType::of_bodies) {
    const Body& b = e.mover.bodies[place];
    const Vec3d w{b.momentum.x / b.inertia.x, b.momentum.y / b.inertia.y,
                  b.momentum.z / b.inertia.z};
    return {norm(b.velocity), b.tip_speed(w), norm(w), b.id};
  } else {
    return {norm(e.particles.motion[place].velocity()), 0, 0, e.particles.id[place]};
  }
}

struct FastestParticle {
  SurfaceSpeed speed{-1};
  Vec3d centre{0, 0, 0};  // [m]
};
template <class EngineType>
[[gnu::cold]] FastestParticle fastest_particle(const EngineType& e) {
  FastestParticle most;
  for (std::size_t k = 0; k < e.owners(); ++k) {
    const SurfaceSpeed s = surface_speed(e, k);
    if (s.id == no_particle || !(s.sum() > most.speed.sum())) continue;
    most.speed = s;
    if constexpr (EngineType::of_bodies)
      most.centre = e.mover.bodies[k].centre;
    else
      most.centre = e.particles.position[k].centre();
  }
  return most;
}

template <class EngineType>
[[noreturn, gnu::cold]] void throw_travel(const EngineType& e, double wall_way, std::int64_t step,
                                          double time, double dt, double limit) {
  const double way = e.largest_speed * dt, most = limit * e.least_radius();
  const FastestParticle fastest = fastest_particle(e);
  const bool is_wall = wall_way > way;
  const Vec3d where = is_wall ? Vec3d{} : fastest.centre;
  DynArray<ParticleId> ids;
  if (!is_wall) ids.push_back(fastest.speed.id);
  const auto who = is_wall ? sentence(name_of_wall(e.walls, fastest_wall(e)), " moves")
                   : fastest.speed.is_of_tips()
                       ? sentence("the tips of particle ", ids[0], " at ", where, " m move")
                       : sentence("particle ", ids[0], " at ", where, " m moves");
  throw SimulationError(
      sentence("step ", step, ", t = ", time, " s: ", who, " by ", std::max(way, wall_way),
               " m in a step, more than guard.max_travel = ", limit, " of the smallest radius ",
               e.least_radius(),
               " m, and may pass through others unseen; set "
               "Simulation::time_step to less than ",
               below(dt * most / std::max(way, wall_way)), " s",
               !is_wall && fastest.speed.is_of_tips()
                   ? sentence(", or lower the spin", fastest.speed.words())
                   : std::string()),
      step, ids, where);
}

/// Particles and walls that move too far in a step may pass through each other undetected.
template <class EngineType>
void check_travel(const EngineType& e, double wall_way, std::int64_t step, double time, double dt,
                  double limit) {
  const double way = e.largest_speed * dt, most = limit * e.least_radius();
  if (!(way <= most && wall_way <= most)) throw_travel(e, wall_way, step, time, dt, limit);
}

/// A mesh so fine and curved that a sphere touches it in more places than there are contact slots.
template <class EngineType>
void check_crowded(const EngineType& e, std::int64_t step, double time, double back) {
  const auto crowded = e.crowded();
  if (!crowded) return;
  const auto id = e.id_of(crowded->particle);
  const Vec3d where = place_before(e, crowded->particle, back);
  throw SimulationError(
      sentence(
          "step ", step, ", t = ", time, " s: particle ", id, " at ", where,
          " m touches the mesh of ", name_of_wall(e.walls, crowded->wall), " in more than ",
          TriangleMesh::max_contacts,
          " places at once, and silt computes no more; give TriangleMesh a larger smooth_angle, or "
          "a coarser or flatter mesh there"),
      step, {id}, where);
}

template <class EngineType>
void check_inside(const EngineType& e, const Box& domain, std::int64_t step, double time) {
  for (std::size_t k = 0; k < e.particles.owned(); ++k) {
    const Vec3d p = e.particles.position[k].centre();
    if (domain.contains(p) || e.particles.is_parked(k)) continue;
    throw SimulationError(
        sentence(
            "step ", step, ", t = ", time, " s: particle ", e.id_of(k), " at ", p,
            " m is outside guard.domain from ", domain.min, " to ", domain.max,
            " m; close the walls, add an outlet where particles may leave, or enlarge the domain"),
        step, {e.id_of(k)}, p);
  }
}

}  // namespace detail
}  // namespace silt
