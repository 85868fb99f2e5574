// silt - BSD-3-Clause, see LICENSE
#pragma once

// BodyMotion: reordering of bodies after their parts.

#include <silt/core/dyn_array.hpp>
#include <silt/engine/advance/body_motion.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Composition, class State>
void BodyMotion<Composition, State>::follow(State& particles) {
  DynArray<std::uint32_t> place(bodies.size(), no_place);
  DynArray<Body> sorted;
  DynArray<Synchronous> recorded;
  DynArray<std::uint32_t> order;
  std::uint32_t next = 0;
  [[maybe_unused]] std::size_t own = 0;  // number owned by this rank, which come first
  sorted.reserve(bodies.size());
  for (std::size_t r = 0; r < particles.size(); ++r) {
    auto& part = particles.part[r];
    if (place[part.body] == no_place) {
      place[part.body] = static_cast<std::uint32_t>(sorted.size());
      sorted.push_back(bodies[part.body]);
      order.push_back(part.body);
      if (!synchronous.empty() && part.body < synchronous.size())
        recorded.push_back(synchronous[part.body]);
      sorted.back().first = next;
      next += static_cast<std::uint32_t>(forms[sorted.back().form].parts.size());
    }
    part.body = place[part.body];
    if (r + 1 == particles.owned()) own = sorted.size();
  }
  if constexpr (State::of_ranks) ghosts = sorted.size() - own;
  bodies.swap(sorted), synchronous.swap(recorded);
  gather_rows(fluid, order, Team()), gather_rows(modules, order, Team());
  number_rows(particles);
}

template <class Composition, class State>
void BodyMotion<Composition, State>::number_rows(const State& particles) {
  std::size_t count = 0;
  for (const Body& b : bodies) count += forms[b.form].parts.size();
  rows.assign(count, no_place);
  for (std::size_t r = 0; r < particles.size(); ++r)
    rows[bodies[particles.part[r].body].first + particles.part[r].local] =
        static_cast<std::uint32_t>(r);
}

template <class Composition, class State>
template <class Domain>
void BodyMotion<Composition, State>::wrap_in_flow(State& particles, const Domain& domain) {
  for (Body& b : bodies) {
    const Vec3d shift = domain.wrapped(b.centre) - b.centre;
    if (b.id == no_particle || dot(shift, shift) == 0) continue;
    b.centre += shift, b.velocity += domain.carried(shift);
    for (const std::uint32_t row : rows_of(b)) {
      PositionRow& p = particles.position[row];
      p.x += shift.x, p.y += shift.y, p.z += shift.z;
    }
    put_in_place(particles, b);
  }
}

}  // namespace silt::detail
