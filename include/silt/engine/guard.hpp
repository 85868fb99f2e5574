// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <silt/boundary/wall.hpp>
#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/body.hpp>
#include <silt/engine/convex_look.hpp>
#include <silt/engine/list_upkeep.hpp>
#include <silt/engine/wall_look.hpp>

namespace silt::inline SILT_TARGET {

/// Limits that a run must keep; where one is broken it stops with a SimulationError. What each of
/// them prevents, and why it has its default: docs/stability.md.
struct Guard {
  double max_overlap = 0.3;      // [-] of the smaller radius; of pairs: set_max_overlap
  double max_time_step = 0.125;  // [-] of the shortest contact time at the largest speed
  double max_travel = 0.3;       // [-] of the smallest radius: tips of particles and walls, a step
  double max_rate = 1.25;        // [-] of a particle in its contacts: contact_rates.hpp
  bool through_meshes = false;   // true: particles may come out behind a mesh, if limits let them
  std::optional<Box> domain = {};  // [m] particles must stay inside; left out: not checked
};

namespace detail {

/// Whether a shorter time step may mend what a run was stopped for: only where the limits that see
/// too long ones in time have been lifted.
inline bool lets_long_steps_pass(const Guard& guard) {
  const Guard usual;
  return guard.max_time_step > usual.max_time_step || guard.max_travel > usual.max_travel ||
         guard.max_rate > usual.max_rate;
}

/// Spins that are not finite act on velocities of spheres only where there is friction.
template <class EngineType>
void check_spins(const EngineType& e, std::int64_t step, double time, bool shorter) {
  if constexpr (EngineType::rotates)
    for (std::size_t k = 0; k < e.particles.size(); ++k)
      if (!e.particles.is_parked(k) && !is_finite(e.particles.motion[k].spin_velocity()))
        throw SimulationError(
            text("step ", step, ", t = ", time, " s: the angular velocity of particle ", e.id_of(k),
                 " is not finite near ", e.lists.reference[k],
                 shorter ? " m; lower the time step, as limits of the guard are lifted, or look "
                         : " m; look ",
                 "at the law and the rolling model"),
            step, {e.id_of(k)}, e.lists.reference[k]);
}

/// Looks for the particle that has become not a number; says where, and what to change.
template <class EngineType>
[[noreturn, gnu::cold]] void throw_not_finite(const EngineType& e, std::int64_t step, double time,
                                              bool shorter) {
  const auto mend = shorter ? "; lower the time step, as limits of the guard are lifted, or look "
                              "for overlapping particles at the start"
                            : "; look at gravity and at the forces and laws that you gave, and for "
                              "overlapping particles at the start";
  for (std::size_t k = 0; k < e.particles.size(); ++k) {
    const auto& m = e.particles.motion[k];
    const auto& p = e.particles.position[k];
    if (e.particles.is_parked(k) || (is_finite(m.velocity()) && is_finite(p.centre()))) continue;
    throw SimulationError(
        text("step ", step, ", t = ", time, " s: the velocity of particle ", e.id_of(k),
             " is not finite near ", e.lists.reference[k], " m", mend),
        step, {e.id_of(k)}, e.lists.reference[k]);
  }
  check_spins(e, step, time, shorter);  // that of a body moves its tips
  throw SimulationError(
      text("step ", step, ", t = ", time, " s: the squared velocities overflow", mend), step, {},
      {});
}

/// A time step [s] to advise, to three digits and safely below.
inline std::string below(double time_step) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.3g", 0.999 * time_step);
  return digits;
}

/// The limits of the overlap: one for all contacts, and those of single pairs of materials.
class OverlapLimits {
 public:
  void set(std::size_t a, std::size_t b, double limit) { of_pairs_[std::minmax(a, b)] = limit; }
  bool empty() const { return of_pairs_.empty(); }
  double of(std::size_t a, std::size_t b, double otherwise) const {
    const auto found = of_pairs_.find(std::minmax(a, b));
    return found == of_pairs_.end() ? otherwise : found->second;
  }
  double least(double otherwise) const {
    for (const auto& [pair, limit] : of_pairs_) otherwise = std::min(otherwise, limit);
    return otherwise;
  }
  double greatest(double otherwise) const {
    for (const auto& [pair, limit] : of_pairs_) otherwise = std::max(otherwise, limit);
    return otherwise;
  }
  /// The largest of a material's.
  double most(std::size_t material, double otherwise) const {
    for (const auto& [pair, limit] : of_pairs_)
      if (pair.first == material || pair.second == material) otherwise = std::max(otherwise, limit);
    return otherwise;
  }

 private:
  std::map<std::pair<std::size_t, std::size_t>, double> of_pairs_;  // the lower number first
};

/// Material of a row of particles.
template <class EngineType>
std::size_t material_of([[maybe_unused]] const EngineType& e, [[maybe_unused]] std::size_t row) {
  if constexpr (EngineType::Contacts::several_materials)
    return e.particles.material[row];
  else
    return 0;
}

/// A contact and how far it is above its limit.
struct DeepContact {
  double excess = -1, overlap = 0, limit = 0;  // [-] overlap over limit; of the smaller radius
  std::uint32_t a = 0, b = 0;
  std::size_t material_a = 0, material_b = 0, wall = 0;
  bool with_wall = false;
};

/// The contact whose overlap is the largest share of its limit, measured `back` [s] ago.
template <class EngineType, class Domain>
[[gnu::cold]] DeepContact deepest_contact(const EngineType& e, const Domain& domain, double back,
                                          double limit, const OverlapLimits& limits) {
  DeepContact most;
  const auto look = [&](std::uint32_t a, std::uint32_t b, std::size_t wall, bool with_wall,
                        double overlap) {
    const std::size_t i = material_of(e, a);
    const std::size_t j = with_wall ? e.walls[wall].material : material_of(e, b);
    const double own = limits.of(i, j, limit);
    if (overlap / own > most.excess)
      most = {overlap / own, overlap, own, a, b, i, j, wall, with_wall};
  };
  if constexpr (EngineType::convex) {
    for_each_convex_contact(e, domain, back, [&](const SeenContact& c) {
      const bool with_wall = c.j == no_particle;
      look(c.i, with_wall ? 0 : c.j, c.wall, with_wall, c.share);
    });
  } else {
    e.lists.pairs.for_each([&](std::size_t k) {
      const std::uint32_t i = e.lists.pairs.first()[k], j = e.lists.pairs.second()[k];
      const double r = e.particles.position[i].r, q = e.particles.position[j].r;
      Vec3d d = place_before(e, i, back) - place_before(e, j, back);
      if constexpr (Domain::periodic) d = domain.shortest(d);
      look(i, j, 0, false, (r + q - norm(d)) / std::min(r, q));
    });
    for_each_wall_contact(e, back, [&](const WallCandidate& c, const SurfacePoint& point) {
      look(c.particle, 0, c.wall, true, 1 - point.distance / e.particles.position[c.particle].r);
    });
  }
  return most;
}

/// The overlaps of a step are above the least limit: names the contact that is above its own, if
/// there is one. `longer` says whether the time step is longer than silt chooses, so that the
/// overlap may be an error of it; `name` says the name of a material.
template <class EngineType, class Domain, class Longer, class Name>
[[gnu::cold]] void check_overlaps(const EngineType& e, const Domain& domain, std::int64_t step,
                                  double time, double back, double limit,
                                  const OverlapLimits& limits, const Longer& longer,
                                  const Name& name) {
  const DeepContact c = deepest_contact(e, domain, back, limit, limits);
  if (!(c.excess > 1) && !limits.empty() && e.largest_overlap <= limits.greatest(limit)) return;
  const auto advice = [&] {
    return text("; use a stiffer material",
                longer() ? ", a lower speed or a smaller time step" : " or a lower speed",
                ", or start without overlaps");
  };
  if (!(c.excess > 0.99))  // gone: parts of bodies that turn fast are not quite where they were
    throw SimulationError(
        text("step ", step, ", t = ", time, " s: two particles, or one and a wall, overlapped by ",
             e.largest_overlap, " of the smaller radius, above the limit ", limits.greatest(limit),
             ", and have parted within the step", advice()),
        step, {}, {});
  const bool is_common = c.limit == limit;
  const Vec3d where = place_before(e, c.a, back);
  const auto head = text("step ", step, ", t = ", time, " s: ");
  const std::string both = name(c.material_a) + " and " + name(c.material_b);
  const auto tail = text(limits.empty() ? e.largest_overlap : c.overlap,
                         " of the smaller radius, above the limit ",
                         is_common ? text("guard.max_overlap = ", limit)
                                   : text(c.limit, " that set_max_overlap gives to ", both),
                         advice(),
                         is_common ? text(". Where a heavy body may press light grains in deeper, "
                                          "Simulation::set_max_overlap raises the limit for ",
                                          both, " alone")
                                   : std::string());
  if (c.with_wall)
    throw SimulationError(text(head, "particle ", e.id_of(c.a), " at ", where, " m overlaps wall ",
                               c.wall, " by ", tail),
                          step, {e.id_of(c.a)}, where);
  throw SimulationError(text(head, "particles ", e.id_of(c.a), " and ", e.id_of(c.b), " near ",
                             where, " m overlap by ", tail),
                        step, {e.id_of(c.a), e.id_of(c.b)}, where);
}

/// A wall whose motion has given a pose that is none would act on nothing, or on other places.
inline void check_pose(const Wall& wall, std::size_t number, std::int64_t step, double time) {
  const Quaternion& q = wall.pose.rotation;
  const double length2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  const auto stop = [&](const char* what) {
    throw SimulationError(text("step ", step, ", t = ", time, " s: the motion of wall ", number,
                               " gives ", what, "; mend the function that was given to add_wall"),
                          step, {}, wall.pose.translation);
  };
  if (!is_finite(wall.pose.translation) || !std::isfinite(length2))
    stop("a pose that is not finite");
  if (std::abs(length2 - 1) > 1e-6) stop("a rotation whose quaternion is not of length 1");
}

/// The longest way [m] that points of moving walls go in a step, where particles may be near them.
template <class EngineType>
double wall_travel(const EngineType& e) {
  double most = 0;
  if (e.particles.size() == 0) return most;
  for (const Wall& w : e.walls)
    if (w.moves())
      most = std::max(most,
                      largest_displacement(w.pose, w.last_pose, e.lists.searched_walls.region()));
  return most;
}

/// How fast the surface of a particle is, with its tips (Body::tip_speed).
struct SurfaceSpeed {
  double centre = 0, by_spin = 0;  // [m/s] by_spin: 0 of spheres
  double spin = 0;                 // [rad/s]
  std::uint32_t id = no_particle;

  double sum() const { return centre + by_spin; }
  bool is_of_tips() const { return by_spin > 0.1 * centre; }
  /// What the speed is made of, for a sentence; nothing where the spin is hardly a part of it.
  std::string words() const {
    if (!is_of_tips()) return {};
    return text(" (of the tips of particle ", id, ": its velocity of ", centre, " m/s and ",
                by_spin, " m/s by its spin of ", spin, " rad/s)");
  }
};

template <class EngineType>
SurfaceSpeed surface_speed(const EngineType& e, std::size_t place) {
  if constexpr (EngineType::has_bodies) {
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
  for (std::size_t k = 0; k < e.rows_of_particles(); ++k) {
    const SurfaceSpeed s = surface_speed(e, k);
    if (s.id == no_particle || !(s.sum() > most.speed.sum())) continue;
    most.speed = s;
    if constexpr (EngineType::has_bodies)
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
  std::vector<std::uint32_t> ids;
  if (!is_wall) ids.push_back(fastest.speed.id);
  const auto who = is_wall ? std::string("a wall moves")
                   : fastest.speed.is_of_tips()
                       ? text("the tips of particle ", ids[0], " at ", where, " m move")
                       : text("particle ", ids[0], " at ", where, " m moves");
  throw SimulationError(text("step ", step, ", t = ", time, " s: ", who, " by ",
                             std::max(way, wall_way), " m in a step, more than guard.max_travel = ",
                             limit, " of the smallest radius ", e.least_radius(),
                             " m, and may pass through others unseen; set "
                             "Simulation::time_step to less than ",
                             below(dt * most / std::max(way, wall_way)), " s",
                             !is_wall && fastest.speed.is_of_tips()
                                 ? text(", or lower the spin", fastest.speed.words())
                                 : std::string()),
                        step, ids, where);
}

/// Particles and walls that go too far in a step may pass through each other unseen.
template <class EngineType>
void check_travel(const EngineType& e, double wall_way, std::int64_t step, double time, double dt,
                  double limit) {
  const double way = e.largest_speed * dt, most = limit * e.least_radius();
  if (!(way <= most && wall_way <= most)) throw_travel(e, wall_way, step, time, dt, limit);
}

/// Where a mesh is so fine and bent that a sphere touches more places than it has contacts for.
template <class EngineType>
void check_crowded(const EngineType& e, std::int64_t step, double time, double back) {
  const auto crowded = e.crowded();
  if (!crowded) return;
  const auto id = e.id_of(crowded->particle);
  const Vec3d where = place_before(e, crowded->particle, back);
  throw SimulationError(
      text(
          "step ", step, ", t = ", time, " s: particle ", id, " at ", where,
          " m touches the mesh of wall ", crowded->wall, " in more than ",
          TriangleMesh::max_contacts,
          " places at once, and silt computes no more; give TriangleMesh a larger smooth_angle, or "
          "a coarser or flatter mesh there"),
      step, {id}, where);
}

template <class EngineType>
void check_inside(const EngineType& e, const Box& domain, std::int64_t step, double time) {
  for (std::size_t k = 0; k < e.particles.size(); ++k) {
    const Vec3d p = e.particles.position[k].centre();
    if (domain.contains(p) || e.particles.is_parked(k)) continue;
    throw SimulationError(
        text("step ", step, ", t = ", time, " s: particle ", e.id_of(k), " at ", p,
             " m is outside guard.domain from ", domain.min, " to ", domain.max,
             " m; close the walls, add an outlet where particles may leave, or enlarge the domain"),
        step, {e.id_of(k)}, p);
  }
}

}  // namespace detail
}  // namespace silt
