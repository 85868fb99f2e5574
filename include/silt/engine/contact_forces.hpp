// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Engine: contact forces, and the module fluxes through contacts.

#include <silt/engine/engine.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Composition>
template <class Stage>
inline void Engine<Composition>::prepare_fluxes([[maybe_unused]] const Stage& stage,
                                                [[maybe_unused]] double time,
                                                [[maybe_unused]] FluxLook look) {
  if constexpr (Fluxes::active || Fluxes::wears)
    fluxes_.prepare(
        stage.modules, this->modules(), particles.owned(),
        {time, walls.size(), look != FluxLook::Hold, look == FluxLook::Measure},
        [this](std::size_t row) { return this->owner_of(row); },
        [this, time](std::size_t k) { return this->seen(k, time); }, *team_);
}

template <class Composition>
inline void Engine<Composition>::collect_fluxes() {
  if constexpr (Fluxes::active) {
    const auto owner_of = [this](std::size_t row) { return this->owner_of(row); };
    if constexpr (of_ranks)
      fluxes_.collect(this->modules(), particles.owned(), owner_of, [this](double own) {
        ranks.meet("what a wall gives");
        ranks.sum_of({&own, 1});
        return own;
      });
    else
      fluxes_.collect(this->modules(), particles.size(), owner_of, nullptr);
  }
}

template <class Composition>
inline void Engine<Composition>::pair_forces(const Domain& domain, const StepTimes& times) {
  if constexpr (of_ranks && !apart)
    ranks.finish_refresh(particles, mover), prepare_ghost_fluxes(times.now);
  if constexpr (convex) {
    using Pairs =
        ConvexPairs<typename ConvexRowsOf<ShapeType>::type, ContactsType, Domain, Arch, Fluxes>;
    if constexpr (deforms<Domain>)
      mover.convex_rows.measure_pace_in_flow(particles.position.data(), particles.motion.data(),
                                             lists.upkeep.inner, domain, *team_);
    else
      mover.convex_rows.measure_pace(particles.motion.data(), *team_, has_agreed_mean());
    return take(Pairs::run({particles.position.data(), particles.motion.data(), &mover.convex_rows,
                            kinds_.data(), particles.material.data(), times},
                           lists.pairs, coefficients, domain, sums_.data(), *team_, &fluxes_));
  } else {
    constexpr PairsOf first = apart ? PairsOf::Own : PairsOf::All;
    take(sphere_pairs<first>(domain, times));
  }
}

template <class Composition>
template <PairsOf Which>
inline Tally<typename Engine<Composition>::Contacts> Engine<Composition>::sphere_pairs(
    const Domain& domain, const StepTimes& times) {
  using Pipeline = PairPipeline<ContactsType, Domain, Arch, Scalar, Fluxes>;
  const bool large = Pipeline::working_set(particles.size(), lists.pairs.size()) > beyond_caches;
  return Pipeline::template run<Which>(
      {particles.position.data(), particles.pair_motion(), kinds_.data(), particles.largest_radius,
       particles.smallest_radius, times, large, share_pairs(domain), &fluxes_, offsets_},
      lists.pairs, coefficients, domain, sums_.data(), *team_);
}

template <class Composition>
inline void Engine<Composition>::take(const Tally<ContactsType>& tally) {
  largest_overlap = tally.largest, contact_energy = tally.energy;
  safeguards += tally.safeguards;
  if constexpr (has_events) events.clear(), note(tally.notes);
  if constexpr (Composition::has_breakage) impacts.add(tally.impacts), parted += tally.parted;
  if constexpr (deforms<Domain>) virial = tally.virial;
}

template <class Composition>
inline void Engine<Composition>::wall_forces(const StepTimes& times) {
  if (walls.empty()) return;
  include(wall_pipeline_.run(wall_input(times), lists.walls, coefficients, walls, sums_.data(),
                             *team_));
}

template <class Composition>
template <class MoreTally>
inline void Engine<Composition>::include(const MoreTally& tally) {
  largest_overlap = std::max(largest_overlap, tally.largest);
  contact_energy.add(tally.energy);
  safeguards += tally.safeguards;
  if constexpr (has_events) note(tally.notes);
  if constexpr (Composition::has_breakage) impacts.add(tally.impacts), parted += tally.parted;
}

template <class Composition>
inline void Engine<Composition>::note(const ContactNotes& notes) {
  const auto id_of = [this](std::size_t row) {
    return particles.is_parked(row) ? no_particle : this->id_of(row);
  };
  if constexpr (of_ranks)
    events.take(notes, id_of, [this](std::size_t row) { return row < particles.owned(); });
  else
    events.take(notes, id_of);
}

template <class Composition>
inline const typename Engine<Composition>::Scalar* Engine<Composition>::share_pairs(
    [[maybe_unused]] const Domain& domain) {
  if constexpr (shares)
    if (share_contacts) {
      shared_.share_pairs(lists.pairs, particles, domain, energy_exponent<ContactsType>, *team_);
      return shared_.shares();
    }
  return nullptr;
}

template <class Composition>
inline const SharedContacts<typename Engine<Composition>::Scalar>*
Engine<Composition>::share_walls() {
  if constexpr (shares)
    if (share_contacts) {
      shared_.share_walls(*this, energy_exponent<ContactsType>);
      return &shared_;
    }
  return nullptr;
}

template <class Composition>
inline auto Engine<Composition>::wall_input(const StepTimes& times) {
  using Input = typename WallStage::Input;
  if constexpr (convex) {
    wall_pipeline_.fluxes = &fluxes_;
    return Input{particles.position.data(), particles.motion.data(),
                 &mover.convex_rows,        nullptr,
                 particles.material.data(), times};
  } else
    return Input{particles.position.data(),
                 particles.motion.data(),
                 particles.pair_motion(),
                 particles.material.data(),
                 times,
                 parts(),
                 share_walls(),
                 &fluxes_};
}

template <class Composition>
Vec3d Engine<Composition>::contact_force(std::size_t k) const {
  const auto of = [&](std::size_t row) { return load_part<chunks>(sums_.data(), row, 0); };
  if constexpr (of_bodies) {
    Vec3d sum{0, 0, 0};
    for (const std::uint32_t row : mover.rows_of(mover.bodies[k])) sum += of(row);
    return sum;
  } else {
    return of(k);
  }
}

template <class Composition>
std::size_t Engine<Composition>::touching_pairs(const Domain& domain) const {
  std::size_t count = 0;
  lists.pairs.for_each([&](std::size_t k) {
    const std::uint32_t a = lists.pairs.first()[k], b = lists.pairs.second()[k];
    if constexpr (of_ranks)
      if (a >= particles.owned()) return;
    if constexpr (convex)
      count += lists.pairs.history(ContactsType::memory_radius, k) > 0 && !particles.is_parked(a) &&
               !particles.is_parked(b);
    else
      count += within_reach(particles.position[a], particles.position[b], 0, domain);
  });
  return count;
}

}  // namespace silt::detail
