// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/advance/wall_motion.hpp>
#include <silt/engine/checks/contact_rates.hpp>
#include <silt/engine/convex/convex_walls.hpp>
#include <silt/engine/lists/wall_look.hpp>

/// Stiffness of the contacts of a driven wall. It determines the speed of a servo, and whether a
/// free wall is too light for the time step. Tests: tests/engine/free_walls.cpp.

namespace silt::inline SILT_TARGET::detail {

inline constexpr std::int64_t looks_at_rates_every = 1000;  // [steps]

/// A contact of a wall.
struct ContactAtWall {
  std::uint32_t particle;
  Vec3d normal, point;  // [-], [m] on the wall
  double overlap;       // [m]
  double R_eff;         // [m]
  double inverse_mass;  // [1/kg] of the particle along the normal; 0: fixed
};

/// Calls visit(ContactAtWall) for the overlapping contacts of wall w.
template <class EngineType, class Visit>
void for_each_contact_of_wall(const EngineType& e, std::size_t w, const Visit& visit) {
  const Wall& wall = e.walls[w];
  const auto& list = e.lists.walls;
  const auto all = list.candidates();
  for (std::size_t first = 0, next = 1; first < all.size(); first = next++) {
    const auto& c = all[first];
    if constexpr (std::remove_cvref_t<decltype(list)>::repeats) next = end_of_images(all, first);
    if (c.wall != w || c.surface >= wall.surfaces.size()) continue;
    const auto images = all.subspan(first, next - first);
    const auto& motion = e.particles.motion[c.particle];
    const Vec3d centre = e.particles.position[c.particle].centre();
    if constexpr (EngineType::convex) {
      const auto& rows = e.mover.convex_rows;
      for_each_joined(
          rows, centre, wall, list, images, [&](const SolidContact& at, const auto& image) {
            if (!(at.overlap > 0)) return;
            const double inverse_mass =
                motion.inv_m == 0 ? 0
                                  : at.gradient * at.gradient *
                                        body_at_contact(motion, rows, c.particle)
                                            .inverse_mass(at.point - centre, at.normal, at.couple);
            visit(ContactAtWall{c.particle, at.normal, list.seen(image, at.point), at.overlap,
                                at.R_eff, inverse_mass});
          });
    } else {
      const double r = e.particles.position[c.particle].r;
      for_each_contact_of_images(e, images, 0, [&](const auto& image, const SurfacePoint& point) {
        visit(ContactAtWall{c.particle, point.normal,
                            list.seen(image, centre) - point.distance * point.normal,
                            r - point.distance, r, motion.inv_m});
      });
    }
  }
}

/// Stiffness and damping of such a contact along its normal, obtained from the law.
template <class EngineType>
LinearContact linear_at_wall(const EngineType& e, std::size_t w, const ContactAtWall& at,
                             double time_step) {
  using ContactsType = typename EngineType::Contacts;
  std::size_t own = 0;
  if constexpr (ContactsType::several_materials) own = e.particles.material[at.particle];
  const auto& table = e.coefficients;
  const Wall& wall = e.walls[w];
  const double inverse =
      at.inverse_mass == 0
          ? inverse_mass_at_fixed(wall.drive, wall.state, at.point, at.normal, at.R_eff)
          : at.inverse_mass + inverse_mass_of(wall.drive, wall.state, at.point, at.normal);
  Contact<double> c{};
  c.normal = at.normal, c.overlap = at.overlap, c.R_eff = at.R_eff;
  c.m_eff = 1 / inverse, c.inverse_m_eff = inverse, c.radius_i = at.R_eff, c.radius_j = 0;
  c.time_step = time_step;
  c.slip_mobility = InertiaOf<ContactsType>::slip_mobility();
  return linearised<typename ContactsType::Law>(
      c, table.law[own * table.materials + e.walls[w].material]);
}

/// Sum of stiffness and damping of the contacts of wall w along the direction, or about the axis,
/// of its servo.
template <class EngineType>
LinearContact linear_of_servo(const EngineType& e, std::size_t w, LinearContact sum = {}) {
  const Wall& wall = e.walls[w];
  const auto* const torque = std::get_if<ServoTorque>(&wall.drive);
  const Vec3d axis = torque != nullptr ? normalised(torque->axis) : Vec3d{};
  for_each_contact_of_wall(e, w, [&](const ContactAtWall& c) {
    double arm2 = 1;
    if (torque != nullptr) {
      const Vec3d arm = cross(axis, c.point - torque->centre);
      arm2 = dot(arm, arm);
    }
    const LinearContact linear = linear_at_wall(e, w, c, 1e-9);
    sum.k += linear.k * arm2, sum.c += linear.c * arm2;
  });
  return sum;
}

/// Updates the stiffness and damping that set a servo's speed: if the load has changed by a tenth
/// of its target since the last look, else every 20 steps. One look in 20 steps costs a few per
/// cent of the wall's contacts. linear(the liquid's values): sums over all contacts with the
/// liquid.
template <class Linear>
void look_at_stiffness(Wall& wall, const Linear& linear) {
  constexpr double looks_every = 20;  // [steps] of a contact
  WallState& s = wall.state;
  const auto* const torque = std::get_if<ServoTorque>(&wall.drive);
  const auto* const force = std::get_if<ServoForce>(&wall.drive);
  const Vec3d axis = normalised(torque != nullptr ? torque->axis : force->direction);
  const double load = torque != nullptr ? dot(torque_on_drive(wall, torque->centre), axis)
                                        : dot(wall.force + wall.liquid_force, axis);
  const double wanted = torque != nullptr ? torque->torque : force->force;
  const bool touched = s.stiffness > 0;
  if (touched == (load != 0) && s.steps_since_look + 1 < looks_every &&
      std::abs(load - s.load_at_look) <= 0.1 * std::abs(wanted)) {
    s.steps_since_look += 1;
    return;
  }
  s.steps_since_look = 0, s.load_at_look = load;
  const LinearContact all = linear({wall.liquid_stiffness, wall.liquid_damping});
  s.stiffness = all.k, s.damping = all.c;
}

/// The contact frequencies of a wall with mass.
struct FreeWallRates {
  double k = 0, c = 0;  // [1/s2], [1/s]
};
template <class EngineType>
FreeWallRates rates_of_free_wall(const EngineType& e, std::size_t w, double dt) {
  const Wall& wall = e.walls[w];
  FreeWallRates all;
  for_each_contact_of_wall(e, w, [&](const ContactAtWall& at) {
    if (!(at.overlap > 0)) return;
    const double own = inverse_mass_of(wall.drive, wall.state, at.point, at.normal);
    const LinearContact linear = linear_at_wall(e, w, at, dt);
    const double both = own + std::sqrt(own * at.inverse_mass);
    all.k += linear.k * both, all.c += linear.c * both;
  });
  return all;
}

/// Refuses a wall that is so light for its contact stiffness that the step does not resolve its
/// motion; as ContactRates does for particles.
template <class EngineType>
[[gnu::cold]] void check_free_wall(const EngineType& e, std::size_t w, const FreeWallRates& of,
                                   std::int64_t step, double time, double dt, double limit) {
  const double rate = rate_of<typename EngineType::IntegratorType>(dt * std::sqrt(of.k), dt * of.c);
  if (rate > limit)
    throw SimulationError(
        sentence("step ", step, ", t = ", time, " s: ", name_of_wall(e.walls, w),
                 " is too light for its contacts at the time step ", dt, " s: rate ", rate,
                 ", above guard.max_rate = ", limit, "; set Simulation::time_step to less than ",
                 below(dt * limit / rate), " s, or give the wall a larger mass or inertia"),
        step, {}, e.walls[w].pose.translation);
}
template <class EngineType>
[[gnu::cold]] void check_free_walls(const EngineType& e, std::int64_t step, double time, double dt,
                                    double limit) {
  for (std::size_t w = 0; w < e.walls.size(); ++w)
    if (is_free(e.walls[w].drive))
      check_free_wall(e, w, rates_of_free_wall(e, w, dt), step, time, dt, limit);
}

/// The same for the contacts on all ranks (collective).
template <class EngineType>
[[gnu::cold]] void check_free_walls_together(const EngineType& e, std::int64_t step, double time,
                                             double dt, double limit) {
  DynArray<double> rates(2 * e.walls.size());
  e.ranks.together("the rates of free walls", [&] {
    for (std::size_t w = 0; w < e.walls.size(); ++w)
      if (is_free(e.walls[w].drive)) {
        const FreeWallRates own = rates_of_free_wall(e, w, dt);
        rates[2 * w] = own.k, rates[2 * w + 1] = own.c;
      }
  });
  e.ranks.sum_of(rates);
  e.ranks.together("the limit of free walls", [&] {
    for (std::size_t w = 0; w < e.walls.size(); ++w)
      if (is_free(e.walls[w].drive))
        check_free_wall(e, w, {rates[2 * w], rates[2 * w + 1]}, step, time, dt, limit);
  });
}

}  // namespace silt::detail
