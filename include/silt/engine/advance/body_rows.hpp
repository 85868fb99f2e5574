// silt - BSD-3-Clause, see LICENSE
#pragma once

// BodyMotion: how bodies follow the rows of their parts.

#include <silt/engine/advance/body_motion.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Composition, class State>
void BodyMotion<Composition, State>::follow(State& particles) {
  std::vector<std::uint32_t> place(bodies.size(), no_place);
  std::vector<Body> sorted;
  std::vector<Synchronous> recorded;
  std::vector<std::uint32_t> order;
  std::uint32_t next = 0;
  [[maybe_unused]] std::size_t own = 0;  // of this rank, whose rows are the first
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
template <class Agree>
void BodyMotion<Composition, State>::agree_on_rows(const State& particles, bool one,
                                                   const Agree& agree) requires convex {
  auto& rows_now = convex_rows;
  constexpr double none = -std::numeric_limits<double>::infinity();
  std::array<double, 6> most{
      none, none, none, none, static_cast<double>(rows_now.exponents), -rows_now.least_radius};
  if (!bodies.empty()) {
    // A rank with several forms says so by numbers that none has.
    const auto form = static_cast<double>(bodies.front().form);
    most[0] = one ? form : -none, most[1] = one ? -form : -none;
    most[2] = bodies.front().scale, most[3] = -bodies.front().scale;
  }
  agree(std::span<double>(most));
  rows_now.exponents = static_cast<Exponents>(static_cast<int>(most[4]));
  rows_now.least_radius = -most[5];
  if (one && !(most[0] == -most[1] && most[2] == -most[3]) && particles.size() > 0)
    rows_now.form.assign(particles.size(),
                         typename decltype(rows_now.form)::value_type(rows_now.form.front()));
}

}  // namespace silt::detail
