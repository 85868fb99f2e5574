// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/contact/offset.hpp>
#include <silt/engine/convex/convex_look.hpp>
#include <silt/engine/lists/wall_look.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Overlap limits: one for all contacts, and those set for pairs of materials.
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
  /// The largest limit of a material.
  double most(std::size_t material, double otherwise) const {
    for (const auto& [pair, limit] : of_pairs_)
      if (pair.first == material || pair.second == material) otherwise = std::max(otherwise, limit);
    return otherwise;
  }

 private:
  std::map<std::pair<std::size_t, std::size_t>, double> of_pairs_;  // lower number first
};

/// Material of the particle in this row.
template <class EngineType>
std::size_t material_of([[maybe_unused]] const EngineType& e, [[maybe_unused]] std::size_t row) {
  if constexpr (EngineType::Contacts::several_materials)
    return e.particles.material[row];
  else
    return 0;
}

/// A contact and how far it exceeds its limit.
struct DeepContact {
  double excess = -1, overlap = 0,
         limit = 0;  // [-] excess: overlap over limit
  std::uint32_t a = 0, b = 0;
  std::size_t material_a = 0, material_b = 0, wall = 0;
  bool with_wall = false;
  std::size_t beyond = 0;  // contacts beyond their limits, each on one rank
};

/// Calls visit(a, b, wall, with_wall, overlap [-] relative to the smaller radius) for the contacts
/// of rows at the positions of `back` [s] ago; b is 0 for a wall.
template <class EngineType, class Domain, class Visit>
[[gnu::cold]] void for_each_overlap(const EngineType& e, const Domain& domain, double back,
                                    const Visit& visit) {
  if constexpr (EngineType::convex) {
    for_each_convex_contact(e, domain, back, [&](const SeenContact& c) {
      const bool with_wall = c.j == no_place;
      visit(c.i, with_wall ? 0 : c.j, c.wall, with_wall, c.share);
    });
  } else {
    e.lists.pairs.for_each([&](std::size_t k) {
      const std::uint32_t i = e.lists.pairs.first()[k], j = e.lists.pairs.second()[k];
      const double r = e.particles.position[i].r, q = e.particles.position[j].r;
      Vec3d d = place_before(e, i, back) - place_before(e, j, back);
      if constexpr (Domain::periodic) d = domain.shortest(d);
      visit(i, j, 0, false, (r + q - norm(d) - offset_of_pair(e, k)) / std::min(r, q));
    });
    for_each_wall_contact(e, back, [&](const WallCandidate& c, const SurfacePoint& point) {
      if (e.particles.motion[c.particle].inv_m == 0 && !e.walls[c.wall].is_driven()) return;
      visit(c.particle, 0, c.wall, true, 1 - point.distance / e.particles.position[c.particle].r);
    });
  }
}

/// The contact with the largest overlap relative to its limit, `back` [s] ago.
template <class EngineType, class Domain>
[[gnu::cold]] DeepContact deepest_contact(const EngineType& e, const Domain& domain, double back,
                                          double limit, const OverlapLimits& limits) {
  DeepContact most;
  std::size_t beyond = 0;
  for_each_overlap(
      e, domain, back,
      [&](std::uint32_t a, std::uint32_t b, std::size_t wall, bool with_wall, double overlap) {
        const std::size_t i = material_of(e, a);
        const std::size_t j = with_wall ? e.walls[wall].material : material_of(e, b);
        const double own = limits.of(i, j, limit);
        beyond += overlap > own && a < e.particles.owned();
        if (overlap / own > most.excess)
          most = {overlap / own, overlap, own, a, b, i, j, wall, with_wall};
      });
  most.beyond = beyond;
  return most;
}

/// Centre [m] of the particle that a row is or belongs to, `back` [s] ago.
template <class EngineType>
Vec3d centre_of_owner(const EngineType& e, std::size_t row, double back) {
  if constexpr (EngineType::of_bodies) {
    const Body& b = e.mover.bodies[e.owner_of(row)];
    return b.centre - back * b.velocity;
  } else {
    return place_before(e, row, back);
  }
}

/// Explains an overlap of two particles at the start of a run, and what to change.
template <class EngineType, class Domain>
[[gnu::cold]] std::string twin_words(const EngineType& e, [[maybe_unused]] const Domain& domain,
                                     double back, const DeepContact& c) {
  constexpr double near = 0.5;  // [-] of the smaller radius
  Vec3d d = centre_of_owner(e, c.a, back) - centre_of_owner(e, c.b, back);
  if constexpr (Domain::periodic) d = domain.shortest(d);
  const double r = std::min(e.particles.position[c.a].r, e.particles.position[c.b].r);
  if (e.came_from_outside > 0)
    return sentence("; ", e.came_from_outside,
                    e.came_from_outside > 1 ? " particles were" : " particle was",
                    " placed outside the periodic box and moved into it by whole periods, perhaps "
                    "onto others: place all of them inside, as by filling the box itself");
  if (norm(d) > near * r)
    return "; start without overlaps: move them apart, or let fill() place them";
  return "; their centres lie at nearly the same place, as of a particle that was added twice: "
         "leave one of them out";
}

/// The same for a particle and a wall: the wall may be inverted, or lie inside the bed.
template <class EngineType, class Domain>
[[gnu::cold]] std::string behind_words(const EngineType& e, const Domain& domain, double back,
                                       const DeepContact& c) {
  DynArray<bool> is_behind(e.owners(), false);
  for_each_overlap(
      e, domain, back,
      [&](std::uint32_t a, std::uint32_t, std::size_t wall, bool with_wall, double overlap) {
        if (with_wall && wall == c.wall && overlap > 1) is_behind[e.owner_of(a)] = true;
      });
  DynArray<bool> is_there(e.owners(), false);
  for (std::size_t k = 0; k < e.particles.owned(); ++k)
    if (!e.particles.is_parked(k)) is_there[e.owner_of(k)] = true;
  const auto behind = std::count(is_behind.begin(), is_behind.end(), true);
  const auto all = std::count(is_there.begin(), is_there.end(), true);
  if (behind == 0) return "; start without overlaps: move the particle or the wall";
  if (behind == all)
    return sentence(
        "; ", all == 1 ? "the particle lies" : sentence("all ", all, " particles lie"),
        " behind this wall: turn it over, so that the normal of a plane, or the Side of a "
        "cylinder or cone, is that of the particles, or move it");
  return sentence(
      "; ", behind, " of ", all,
      " particles lie behind this wall and the others in front of it: it stands inside the "
      "bed, or a part of it is turned over (the normal of a plane and the Side of a "
      "cylinder or cone are those of the particles); move the wall, or leave those "
      "particles out");
}

/// Information for a message about an overlap. `at_start`: no step has been done with these
/// particles and walls, so the overlap is in the initial state; `longer`: the time step is longer
/// than silt's choice and may be the cause; `name` of a material; `inlet_at`: the inlet whose
/// region contains a position, if any; `edit_of`: the function that changed the size of a particle
/// in this step, or null.
template <class Longer, class Name, class InletAt, class EditOf>
struct OverlapWords {
  bool at_start;
  Longer longer;
  Name name;
  InletAt inlet_at;
  EditOf edit_of;
};
template <class... Words>
OverlapWords(bool, Words...) -> OverlapWords<Words...>;

/// The same for an overlap caused by a change of size; empty if there was none.
template <class EditOf>
[[gnu::cold]] std::string edit_words(const EditOf& edit_of, ParticleId a, ParticleId b) {
  const char* const of_a = edit_of(a);
  const char* const function = of_a != nullptr ? of_a : b == no_particle ? nullptr : edit_of(b);
  if (function == nullptr) return {};
  return sentence("; ", function, " of particle ", of_a != nullptr ? a : b,
                  " has made it: change the size in smaller steps, or move what is in its "
                  "way");
}

/// The first wall that is driven by a load, which may exceed what the particles support; empty if
/// there is none.
[[gnu::cold]] inline std::string drive_words(std::span<const Wall> walls) {
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const auto say = [&](const char* what, double load, const char* unit) {
      return sentence(
          "; ", name_of_wall(walls, w), " presses with a ", what, " of ", load, " ", unit,
          ", which may be more than the particles bear: lower it (a force is a pressure "
          "times the area)");
    };
    const WallDrive& drive = walls[w].drive;
    if (!(norm(walls[w].force) > 0)) continue;
    if (const auto* d = std::get_if<ServoForce>(&drive)) return say("ServoForce", d->force, "N");
    if (const auto* d = std::get_if<ServoTorque>(&drive))
      return say("ServoTorque", d->torque, "N m");
  }
  return {};
}

/// Called if an overlap of the step exceeds the smallest limit: finds the contact that exceeds its
/// own limit, if any.
template <class EngineType, class Domain, class Words>
[[gnu::cold]] void check_overlaps(const EngineType& e, const Domain& domain, std::int64_t step,
                                  double time, double back, double limit,
                                  const OverlapLimits& limits, const Words& words) {
  const bool at_start = words.at_start;
  const DeepContact c = deepest_contact(e, domain, back, limit, limits);
  if (!(c.excess > 1) && !limits.empty() && e.largest_overlap <= limits.greatest(limit)) return;
  const auto advice = [&]() -> std::string {
    if (at_start) return "; start without overlaps";
    return sentence(drive_words(e.walls), "; use a stiffer material",
                    words.longer() ? ", a lower speed or a smaller time step" : " or a lower speed",
                    ", or start without overlaps");
  };
  if (!(c.excess > 0.99))  // not found: bodies rotate fast, positions are approximate
    throw SimulationError(
        sentence("step ", step, ", t = ", time,
                 " s: two particles, or one and a wall, overlapped by ", e.largest_overlap,
                 " of the smaller radius, above the limit ", limits.greatest(limit),
                 ", and have parted within the step", advice()),
        step, {}, {});
  const bool is_common = c.limit == limit;
  const auto& radii = e.particles.position;  // the smaller one is nearer to the contact
  const bool at_b = !c.with_wall && radii[c.b].r < radii[c.a].r;
  const Vec3d where = place_before(e, at_b ? c.b : c.a, back);
  const auto head = sentence("step ", step, ", t = ", time, " s: ");
  const std::string both = words.name(c.material_a) + " and " + words.name(c.material_b);
  const bool is_given_so = at_start && c.overlap > 1;  // larger than any material would allow
  const std::optional<std::size_t> inlet =
      c.with_wall && c.overlap > 1 ? words.inlet_at(centre_of_owner(e, c.a, back)) : std::nullopt;
  const std::string by_edit =
      edit_words(words.edit_of, e.id_of(c.a), c.with_wall ? no_particle : e.id_of(c.b));
  const auto cause = !by_edit.empty() ? by_edit
                     : inlet
                         ? sentence("; the region of inlet ", *inlet,
                                    " reaches behind this wall: move the region to the side of the "
                                    "wall where particles are to be")
                     : !at_start   ? advice()
                     : c.with_wall ? behind_words(e, domain, back, c)
                                   : twin_words(e, domain, back, c);
  const auto tail = sentence(
      limits.empty() ? e.largest_overlap : c.overlap, " of the smaller radius, above the limit ",
      is_common ? sentence("guard.max_overlap = ", limit)
                : sentence(c.limit, " that set_max_overlap gives to ", both),
      cause,
      is_common && !is_given_so && by_edit.empty()
          ? sentence(". Where a heavy body may press light grains in deeper, "
                     "Simulation::set_max_overlap raises the limit for ",
                     both, " alone")
          : std::string());
  if (c.with_wall)
    throw SimulationError(sentence(head, "particle ", e.id_of(c.a), " at ", where, " m overlaps ",
                                   name_of_wall(e.walls, c.wall), " by ", tail),
                          step, {e.id_of(c.a)}, where);
  throw SimulationError(sentence(head, "particles ", e.id_of(c.a), " and ", e.id_of(c.b), " near ",
                                 where, " m overlap by ", tail),
                        step, {e.id_of(c.a), e.id_of(c.b)}, where);
}

}  // namespace silt::detail
