// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Engine: integration of driven walls, particles and a deforming box.

#include <silt/engine/advance/box_flow.hpp>
#include <silt/engine/engine.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Composition>
inline void Engine<Composition>::push_walls(const Vec3d& gravity, double kick_time,
                                            double time_step, bool first_kick) {
  for (std::size_t w = 0; w < walls.size(); ++w)
    if (walls[w].is_driven()) {
      if (is_servo(walls[w].drive))
        look_at_stiffness(walls[w], [&](const LinearContact& of_liquid) {
          if constexpr (of_ranks)
            return LinearContact{ranks.of_servos[w][0], ranks.of_servos[w][1]};
          else
            return linear_of_servo(*this, w, of_liquid);
        });
      push_wall(walls[w], gravity, kick_time, time_step, first_kick);
    }
}

template <class Composition>
inline void Engine<Composition>::integrate(Advance how, const Vec3d& gravity, double kick_time,
                                           double time_step, bool first_kick) {
  if constexpr (of_ranks) forget_loads_of_ghosts();
  const auto pace =
      mover.integrate({particles, sums_.data(), lists.upkeep.per_inner2.data(), *team_}, how,
                      {gravity, kick_time, time_step, first_kick});
  largest_speed = pace.largest_speed, largest_share = pace.largest_share, finite = pace.finite;
  if (how == Advance::KickAndDrift && !deforms<Domain> && !of_ranks)
    lists.upkeep.used += largest_share * time_step;
}

template <class Composition>
inline void Engine<Composition>::drift(double time_step) {
  // Particles added since the lists were made have no reach yet; the next step searches.
  const auto& reach = lists.upkeep.per_inner2;
  const double* const per_inner2 = reach.size() < particles.size() ? nullptr : reach.data();
  largest_share =
      mover.drift({particles, sums_.data(), per_inner2, *team_}, time_step, largest_share);
  if constexpr (of_ranks) agree("a drift");
  if constexpr (!deforms<Domain>) lists.upkeep.used += largest_share * time_step;
}

template <class Composition>
inline void Engine<Composition>::kick_box(Domain& box, double time_step, bool first,
                                          bool observed) {
  if constexpr (of_bodies)
    if constexpr (!Mover::in_lanes) {
      const auto load_of = [this](std::size_t row) {
        return load_part<chunks>(sums_.data(), row, 0);
      };
      virial = virial - virial_of_arms(particles, mover.bodies, load_of, *team_);
    }
  box_kick_ = box.choose_rates({virial, largest_overlap, of_bonds}, time_step, first);
  if constexpr (of_bodies)
    mover.flow = {box.gradient(), box.centre()},
    add_flow_to_bodies(mover.bodies, box_kick_.all, box.centre(), *team_);
  else
    add_flow(particles, box_kick_.all, box.centre(), *team_);
  if (!observed) box_kick_ = {};
}

template <class Composition>
inline void Engine<Composition>::record_flow(const Domain& box) {
  for (std::size_t k = 0; k < this->owners(); ++k)
    if (const auto p = this->owner(k); p.id() != no_particle)
      mover.synchronous[k].velocity -= box_kick_.too_much * (p.centre() - box.centre());
}

template <class Composition>
inline void Engine<Composition>::move_box(Domain& box, double time_step) {
  const auto& reach = lists.upkeep.per_inner2;
  FlowPace pace;
  if constexpr (of_bodies)
    pace = pace_of_bodies(particles, mover.bodies, box, time_step, *team_),
    pace.largest_share = largest_share;
  else
    pace = pace_in_flow(particles, box, reach.size() < particles.size() ? nullptr : reach.data(),
                        time_step, *team_);
  box.set_kinetic(pace.kinetic, pace.momentum, pace.mass, pace.count);
  const double s = 1 - time_step * box.squeeze_rate();
  lists.flow.follow(box.advance(time_step), s);
  lists.upkeep.used += pace.largest_share * time_step / lists.flow.pruned;
}

}  // namespace silt::detail
