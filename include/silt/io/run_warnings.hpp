// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/io/scene_warnings.hpp>

/// Warnings that a run gives: once its first forces are known, and at its end.
/// Tests: tests/io/scene_warnings.cpp, tests/sph/volume.cpp.

namespace silt::inline SILT_TARGET {

/// Warnings once the forces of step 0 are known (in the first run, or after sim.run(0)): particles
/// that start deep in each other or in a wall. Empty later, and without them. On many ranks equal
/// on each, and collective.
template <class Sim>
[[gnu::cold]] DynArray<std::string> overlap_warnings(const Sim& sim) {
  const auto own = sim.overlap_at_start(WarningLimits::start_overlap);
  const double n = sim.sum_over_ranks(static_cast<double>(own.beyond));
  if (!(n > 0)) return {};
  const auto& e = sim.engine();
  const double most = sim.largest_over_ranks(own.overlap);
  const double of = sim.largest_over_ranks(own.overlap == most ? sim.rank() : -1);
  std::array<double, 4> who{};  // both ids, the wall, and whether there is one
  if (sim.rank() == of)
    who = {static_cast<double>(e.id_of(own.a)),
           own.with_wall ? 0 : static_cast<double>(e.id_of(own.b)), static_cast<double>(own.wall),
           own.with_wall ? 1.0 : 0.0};
  sim.sum_over_ranks(std::span<double>(who));
  const auto number = [&](std::size_t k) { return static_cast<std::size_t>(who[k]); };
  return {
      text(static_cast<std::size_t>(n), n > 1 ? " contacts overlap" : " contact overlaps",
           " by more than ", detail::about(100 * WarningLimits::start_overlap),
           " % of the smaller radius at the start, at most by ", detail::about(100 * most), " % (",
           who[3] > 0 ? text("particle ", number(0), " and ", sim.wall_name(number(2)))
                      : text("particles ", std::min(number(0), number(1)), " and ",
                             std::max(number(0), number(1))),
           "); they will be pushed apart; ",
           e.came_from_outside > 0
               ? text(e.came_from_outside,
                      " particles were outside the periodic box and were "
                      "moved into it by whole periods, perhaps onto others; place them inside, ")
               : "place them without overlaps, as fill() does, ",
           "or take the speed out of them before the run that counts")};
}

namespace detail {

/// Position of an inlet that has placed nothing, if this is the reason; otherwise empty.
template <class Sim>
std::string why_nothing_came(const Sim& sim, const Inlet& inlet) {
  if (inlet.placed > 0) return {};
  if (const auto walls = walls_before(sim, inlet.bounds); !walls.empty())
    return text("is behind ", walls, " (a plane is infinite); move it to the other side");
  return {};
}

}  // namespace detail

/// Warnings after a run: inlets that placed fewer particles than due. A delay of at most one
/// insertion does not count, or of half of one where there were two and it cannot be made up.
template <class Sim>
[[gnu::cold]] DynArray<std::string> inlet_warnings(const Sim& sim) {
  DynArray<std::string> out;
  for (std::size_t k = 0; k < sim.inlets(); ++k) {
    const Inlet& inlet = sim.inlet(k);
    const auto waiting = static_cast<double>(inlet.waiting);
    const std::uint64_t due = inlet.placed + inlet.waiting;
    const double of_one = (inlet.insertions > 2 ? 1 : 0.5) * inlet.flow.rate * inlet.interval;
    if (waiting <= WarningLimits::waiting_share * static_cast<double>(due) || waiting <= 1 + of_one)
      continue;
    if (const std::string why = detail::why_nothing_came(sim, inlet); !why.empty()) {
      out.push_back(text("inlet ", k, " has placed none of the ", due,
                         " particles that were due: ", inlet.region, " ", why));
      continue;
    }
    out.push_back(text("inlet ", k, " has placed ", inlet.placed, " of the ", due,
                       " particles that were due into ", inlet.region, ": ", inlet.why()));
  }
  return out;
}

/// Warnings after a run of a fluid that has some: an Sph whose liquid has left its region.
template <class Sim>
[[gnu::cold]] DynArray<std::string> fluid_warnings(const Sim& sim) {
  if constexpr (requires {
                  { sim.fluid().warnings() } -> std::convertible_to<DynArray<std::string>>;
                })
    return sim.fluid().warnings();
  else
    return {};
}

}  // namespace silt
