// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Engine that are used with several ranks only.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <numeric>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/engine.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Composition>
void Engine<Composition>::join_own(std::size_t more) requires(Composition::has_ranks) {
  const std::size_t own = particles.owned() - more, ghosts = particles.ghosts;
  DynArray<std::uint32_t> order(particles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::rotate(order.begin() + static_cast<std::ptrdiff_t>(own),
              order.end() - static_cast<std::ptrdiff_t>(more), order.end());
  if (more > 0 && ghosts > 0) particles.reorder(order, *team_);
  lists.pairs.make_way(own, more, particles.size()), ranks.make_way(more);
  record.make_way(own, more);
  if constexpr (of_bodies)
    if (more > 0 && ghosts > 0) {
      mover.follow(particles), follow_bodies(ranks.neighbours, particles);
      if (!mover.synchronous.empty()) mover.synchronous.resize(mover.owned());
    }
  lists.forget();
}

template <class Composition>
template <class IsGone>
void Engine<Composition>::park_ghosts(const IsGone& is_gone) requires(Composition::has_ranks) {
  const std::size_t parked = particles.parked;
  for (std::size_t k = this->owners(); k < this->places(); ++k)
    if (const ParticleId id = this->owner(k).id(); id != no_particle && is_gone(id)) this->park(k);
  particles.parked = parked;  // counts owned particles only
}

template <class Composition>
inline void Engine<Composition>::prepare_ghost_fluxes([[maybe_unused]] double time) requires(
    Composition::has_ranks) {
  if constexpr (Fluxes::active)
    fluxes_.prepare_ghosts(
        this->modules(), particles.owned(), particles.size(),
        [this](std::size_t row) { return this->owner_of(row); },
        [this, time](std::size_t k) { return this->seen(k, time); }, *team_);
}

template <class Composition>
inline void Engine<Composition>::ghost_forces(
    const Domain& domain, const StepTimes& times) requires(Composition::has_ranks) {
  if constexpr (apart) {
    ranks.finish_refresh(particles, mover);
    prepare_ghost_fluxes(times.now);
    if (particles.ghosts > 0) include(sphere_pairs<PairsOf::Ghosts>(domain, times));
  }
}

template <class Composition>
template <class Stage>
void Engine<Composition>::follow_reach(const Stage& stage) requires(Composition::has_ranks) {
  const auto now = stage.near.reach(stage.modules);
  if (!ranks.reach.covers(now)) lists.forget();
  ranks.reach = now;
}

template <class Composition>
void Engine<Composition>::look_at_servos() requires(Composition::has_ranks) {
  ranks.of_servos.assign(walls.size(), {});
  for (std::size_t w = 0; w < walls.size(); ++w)
    if (is_servo(walls[w].drive)) {
      const LinearContact own = linear_of_servo(*this, w);
      ranks.of_servos[w] = {own.k, own.c};
    }
}

template <class Composition>
template <class Work>
inline void Engine<Composition>::together(const char* call, double time_step, const bool& observed,
                                          const Work& work) requires(Composition::has_ranks) {
  std::exception_ptr error;
  try {
    work();
  } catch (...) {
    error = std::current_exception();
  }
  agree(call, error);
  ranks.share_loads(walls, observed);
  if (!observed) lists.upkeep.used += largest_share * time_step;
}

template <class Composition>
inline void Engine<Composition>::agree(const char* call, const std::exception_ptr& error) requires(
    Composition::has_ranks) {
  std::array<double, 7> most{largest_speed,
                             largest_share,
                             largest_overlap,
                             lists.upkeep.searched_at < 0 ? 1.0 : 0.0,
                             0.0,
                             0.0,
                             0.0};
  if constexpr (Fluxes::active) most[4] = fluxes_.is_to_renew() ? 1.0 : 0.0;
  if constexpr (Composition::has_bonds) most[5] = bonds_break ? 1.0 : 0.0;
  if constexpr (Composition::has_breakage) most[6] = breaks_due ? 1.0 : 0.0;
  ranks.agree(call, error, most);
  if constexpr (Composition::has_bonds) bonds_break = most[5] > 0;
  if constexpr (Composition::has_breakage) breaks_due = most[6] > 0;
  largest_speed = most[0], largest_share = most[1], largest_overlap = most[2];
  if (most[3] > 0) lists.forget();
  if constexpr (Fluxes::active)
    if (most[4] > 0) fluxes_.renew();
}

}  // namespace silt::detail
