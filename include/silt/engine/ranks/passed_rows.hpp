// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <tuple>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/ranks/rank_bodies.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What two ranks exchange in each step: owned rows that are ghosts on the other rank, and ghosts
/// that the other rank owns.
struct RankNeighbour {
  int rank;
  DynArray<std::uint32_t> send;      // owned rows
  std::uint32_t first = 0, end = 0;  // ghost rows
  // For bodies: the bodies to which these rows belong.
  DynArray<std::uint32_t> send_bodies{};
  std::uint32_t first_body = 0, end_body = 0;
};

/// An exchange of one value per owned row or body, read with get(k) and stored in the ghost with
/// set(k, value).
template <class Value, bool OfBodies, class Get, class Set>
struct PassedRows {
  static constexpr std::size_t bytes = sizeof(Value);
  Get get;
  Set set;
  static const auto& sent(const RankNeighbour& n) { return OfBodies ? n.send_bodies : n.send; }
  static std::uint32_t first(const RankNeighbour& n) { return OfBodies ? n.first_body : n.first; }
  static std::uint32_t end(const RankNeighbour& n) { return OfBodies ? n.end_body : n.end; }
  void put(const RankNeighbour& n, std::byte*& to) const {
    for (const std::uint32_t k : sent(n)) {
      const Value value = get(k);
      std::memcpy(to, &value, bytes), to += bytes;
    }
  }
  void take(const RankNeighbour& n, const std::byte*& from) const {
    for (std::uint32_t k = first(n); k < end(n); ++k) {
      Value value;
      std::memcpy(&value, from, bytes), from += bytes;
      set(k, value);
    }
  }
};
template <class Value, class Get, class Set>
auto pass_rows(Get get, Set set) {
  return PassedRows<Value, false, Get, Set>{get, set};
}
template <class Value, class Get, class Set>
auto pass_bodies(Get get, Set set) {
  return PassedRows<Value, true, Get, Set>{get, set};
}

/// Calls visit() with `passed`, and with what the fluxes of modules read of rows or bodies, if
/// anything.
template <bool OfBodies, class Columns, class Visit, class... Passed>
void with_fields([[maybe_unused]] Columns& columns, const Visit& visit, const Passed&... passed) {
  using Fields = typename Columns::ForFlux;
  if constexpr (std::tuple_size_v < Fields >> 0) {
    const auto get = [&](std::uint32_t k) { return columns.for_flux(k); };
    const auto set = [&](std::uint32_t k, const Fields& f) { columns.set_for_flux(k, f); };
    if constexpr (OfBodies)
      visit(passed..., pass_bodies<Fields>(get, set));
    else
      visit(passed..., pass_rows<Fields>(get, set));
  } else {
    visit(passed...);
  }
}
/// Calls visit() with all values that ghosts receive in each step.
template <class State, class Mover, class Visit>
void with_refreshed(State& particles, [[maybe_unused]] Mover& mover, const Visit& visit) {
  const auto rows = pass_rows<RowState<State, Mover>>(
      [&](std::uint32_t k) { return RowState<State, Mover>::of(particles, mover, k); },
      [&](std::uint32_t k, const auto& row) { row.give(particles, mover, k); });
  if constexpr (State::of_bodies)
    with_fields<true>(
        mover.modules, visit, rows,
        pass_bodies<BodyState>([&](std::uint32_t k) { return BodyState::of(mover, k); },
                               [&](std::uint32_t k, const BodyState& b) { b.give(mover, k); }));
  else
    with_fields<false>(particles.modules, visit, rows);
}

}  // namespace silt::detail
