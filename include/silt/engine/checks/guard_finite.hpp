// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/state/body.hpp>
#include <silt/engine/state/rows.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Angular velocities that are not finite reach the velocities of spheres only through friction.
template <class EngineType>
void check_spins(const EngineType& e, std::int64_t step, double time, bool shorter) {
  if constexpr (EngineType::rotates)
    for (std::size_t k = 0; k < e.particles.owned(); ++k)
      if (!e.particles.is_parked(k) && !is_finite(e.particles.motion[k].spin_velocity()))
        throw SimulationError(
            sentence("step ", step, ", t = ", time, " s: the angular velocity of particle ",
                     e.id_of(k), " is not finite near ", e.lists.reference[k],
                     shorter
                         ? " m; lower the time step, as limits of the guard are lifted, or look "
                         : " m; look ",
                     "at the law and the rolling model"),
            step, {e.id_of(k)}, e.lists.reference[k]);
}

/// Two particles at the same position have no normal; names them if there are any.
template <class EngineType>
[[gnu::cold]] void check_coincident(const EngineType& e, std::int64_t step, double time) {
  e.lists.pairs.for_each([&](std::size_t k) {
    const std::uint32_t i = e.lists.pairs.first()[k], j = e.lists.pairs.second()[k];
    const Vec3d& where = e.lists.reference[i];
    const double r = std::min(e.particles.position[i].r, e.particles.position[j].r);
    if (norm(where - e.lists.reference[j]) < 1e-12 * r)
      throw SimulationError(
          sentence("step ", step, ", t = ", time, " s: particles ", e.id_of(i), " and ", e.id_of(j),
                   " are at the same place, ", where,
                   " m, as of a particle that was added twice, and the direction of "
                   "their contact is not defined; leave one of them out"),
          step, {e.id_of(i), e.id_of(j)}, where);
  });
}

/// InputError for what cannot be in a DeformingBox.
template <class EngineType>
void check_in_flow(const EngineType& e, const Vec3d& gravity) {
  require(!e.particles.some_fixed,
          "DeformingBox: a fixed particle cannot follow it; leave Particle.fixed out");
  require(dot(gravity, gravity) == 0, "DeformingBox: Simulation::gravity = ", gravity,
          " [m/s2] must be 0, as nothing holds the particles: what falls out returns on the "
          "other side, faster each time");
}

/// Checks gravity and particles after changes by observers, or by the program between two runs.
template <class EngineType>
void check_given(const EngineType& e, const Vec3d& gravity, std::int64_t step, double time) {
  const auto stop = [&](const std::string& what, DynArray<ParticleId> ids, const Vec3d& at) {
    throw SimulationError(
        sentence("step ", step, ", t = ", time, " s: ", what,
                 ", which must be finite; an observer, or the program between two "
                 "runs, has set it"),
        step, std::move(ids), at);
  };
  if (!is_finite(gravity)) stop(sentence("Simulation::gravity = ", gravity, " [m/s2]"), {}, {});
  if constexpr (std::remove_cvref_t<decltype(e.lists)>::flows) check_in_flow(e, gravity);
  const auto look = [&](ParticleId id, const Vec3d& place, const Vec3d& velocity) {
    if (!is_finite(place))
      stop(sentence("the place of particle ", id, " is ", place, " m"), {id}, {});
    if (!is_finite(velocity))
      stop(sentence("the velocity of particle ", id, " at ", place, " m is ", velocity, " m/s"),
           {id}, place);
  };
  if constexpr (EngineType::of_bodies) {
    for (std::size_t k = 0; k < e.owners(); ++k)
      if (const auto b = e.owner(k); b.is_there()) look(b.id(), b.centre(), b.velocity());
  } else {
    for (std::size_t k = 0; k < e.particles.owned(); ++k)
      if (!e.particles.is_parked(k))
        look(e.id_of(k), e.particles.position[k].centre(), e.particles.motion[k].velocity());
  }
}

/// Finds the particle whose state is NaN; says where it is and what to change.
template <class EngineType>
[[noreturn, gnu::cold]] void throw_not_finite(const EngineType& e, std::int64_t step, double time,
                                              bool shorter) {
  check_coincident(e, step, time);
  const auto mend = shorter ? "; lower the time step, as limits of the guard are lifted, or look "
                              "for overlapping particles at the start"
                            : "; look at gravity and at the forces and laws that you gave, and for "
                              "overlapping particles at the start";
  for (std::size_t k = 0; k < e.particles.owned(); ++k) {
    const auto& m = e.particles.motion[k];
    const auto& p = e.particles.position[k];
    if (e.particles.is_parked(k) || (is_finite(m.velocity()) && is_finite(p.centre()))) continue;
    throw SimulationError(
        sentence("step ", step, ", t = ", time, " s: the velocity of particle ", e.id_of(k),
                 " is not finite near ", e.lists.reference[k], " m", mend),
        step, {e.id_of(k)}, e.lists.reference[k]);
  }
  check_spins(e, step, time, shorter);  // for a body it moves the tips
  throw SimulationError(
      sentence("step ", step, ", t = ", time, " s: the squared velocities overflow", mend), step,
      {}, {});
}

}  // namespace silt::detail
