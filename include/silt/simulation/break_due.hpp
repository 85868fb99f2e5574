// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of BreakAccess: replaces particles that are due to break by fragments, between steps.

#include <algorithm>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/population/arrivals.hpp>
#include <silt/simulation/break_access.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Sim>
bool BreakAccess<Sim>::break_due() {
  auto& s = sim();
  s.breaks_.events.clear();
  auto& stage = s.breaks_;
  const bool follows = follows_sizes();
  bool looks = follows && (!stage.sizes.known() || s.step_ % LivingSizes::look_every == 0);
  if (follows) stage.sizes.safeguards = s.engine_.safeguards;
  if constexpr (Sim::has_ranks) return break_due_of_ranks() || looks;
  if (stage.due.empty()) return looks;
  DynArray<Parent> parents;
  typename Sim::ParticlesType fragments;
  for (const DueBreak& one : std::exchange(stage.due, {})) {
    const std::size_t k = s.engine_.find(one.id);
    if (k < s.rows())
      break_one(one, s.engine_.owner(k), s.engine_.volume_of(k), own_fields(k), k, parents,
                fragments);
  }
  const std::size_t from = s.rows();
  if constexpr (Sim::has_ledger)
    if (s.first_kick_) s.book_.was_there(energy_of_all());
  take_place(parents, fragments);
  if constexpr (Sim::has_ledger)
    if (s.first_kick_) s.book_.was_there(-energy_of_all());
  // The mass of a cell does not tell how thin it is.
  if (follows && Sim::of_bodies) looks = true;
  for (std::size_t k = from; follows && !looks && k < s.rows(); ++k)
    looks = stage.sizes.is_less(s.engine_, k);
  return looks;
}

template <class Sim>
bool BreakAccess<Sim>::break_due_of_ranks() {
  auto& s = sim();
  auto& stage = s.breaks_;
  auto& ranks = s.engine_.ranks;
  stage.some_born = false;
  if (!std::exchange(stage.some_due, false) && !std::exchange(s.engine_.breaks_due, false))
    return false;
  s.engine_.breaks_due = false;
  DynArray<BreakingParticle> own;
  for (const DueBreak& one : std::exchange(stage.due, {}))
    if (const std::size_t k = s.engine_.find(one.id); k < s.rows())
      own.push_back(breaking_at(one, k));
  ranks.meet("particles that break");
  auto all = gather(ranks.comm(), std::span<const BreakingParticle>(own)).values;
  if (all.empty()) return false;
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.due.id < b.due.id; });
  if constexpr (Sim::has_bonds)  // ends of bonds that were just made are not among the ghosts yet
    if (std::exchange(s.bonds_.fresh, false)) s.engine_.lists.forget(), s.renew_lists();
  // Ghosts at their present positions, for the energy of contacts and bonds that end.
  if constexpr (Sim::has_ledger || Sim::has_bonds) s.engine_.refresh_ghosts_now();
  OfRanks known;
  for (const BreakingParticle& one : all) known.gone.push_back(one.due.id);
  if constexpr (Sim::of_bodies) known.forms = used_forms(s.engine_.mover, ranks.comm());
  bool some_less = false;
  ranks.together("particles that break", [&] {
    DynArray<Parent> parents;
    typename Sim::ParticlesType fragments;
    for (const BreakingParticle& one : all) {
      const std::size_t k = s.engine_.find(one.due.id);
      break_one(one.due, one, one.volume, one, k < s.rows() ? k : nowhere, parents, fragments);
    }
    some_less = follows_sizes() && any_less(fragments);
    if constexpr (Sim::has_ledger)
      if (s.first_kick_) s.book_.was_there(energy_of_all());
    take_place(parents, fragments, known);
    if constexpr (Sim::has_ledger)
      if (s.first_kick_) s.book_.was_there(-energy_of_all());
  });
  ranks.discount(all.size());
  s.engine_.lists.forget();
  stage.some_born = true;
  return some_less;
}

template <class Sim>
template <class Particles>
bool BreakAccess<Sim>::any_less(const Particles& fragments) const {
  const auto& all = fragments.all();
  return std::any_of(all.begin(), all.end(), [this](const auto& p) {
    if constexpr (Sim::of_bodies) return true;  // the mass of a cell does not tell how thin it is
    const double m = mass_to_come(sim().engine_, p);
    return sim().breaks_.sizes.is_less(p.material, 1 / (1 / m), p.radius);  // as rows have it
  });
}

template <class Sim>
template <class Owner, class Fields, class Particles>
void BreakAccess<Sim>::break_one(const DueBreak& due, const Owner& p, double volume,
                                 const Fields& own, std::size_t k, DynArray<Parent>& parents,
                                 Particles& all) {
  auto& s = sim();
  auto& stage = s.breaks_;
  const auto& policy = s.breakage();
  const double density = p.mass() / volume;
  const Broken broken{equal_volume_diameter(volume), p.mass(), own.strength, due.load, due.speed};
  Random random = stage.random_of(policy, due.id, stage.of_fragments);
  FragmentSizes sizes =
      fragment_sizes(policy.sizes, broken, density,
                     {policy.rules.dust_below, policy.rules.most_fragments}, random);
  const std::size_t before = all.size();
  if constexpr (Sim::of_bodies)
    add_cells(p, sizes, density, random, all);
  else
    add_spheres(p, sizes, density, random, all);
  BreakEvent event{.id = due.id,
                   .material = p.material(),
                   .time = s.time_,
                   .position = p.centre(),
                   .velocity = p.velocity(),
                   .diameter = broken.diameter,
                   .mass = broken.mass,
                   .strength = own.strength,
                   .load = due.load,
                   .speed = due.speed,
                   .cause = due.cause,
                   .first = s.next_.particle + before,
                   .fragments = sizes.masses.size(),
                   .generation = static_cast<std::size_t>(own.generation),
                   .dust = sizes.dust};
  if (event.fragments == 0) event.first = no_particle;
  stage.template count<Sim::ContactsType::several_materials>(due.cause, p.material());
  stage.dust.template add<Sim::ContactsType::several_materials>(
      p.material(),
      [&](SizeTable& table) { add_dust(table, policy.sizes, broken, sizes, density, s.time_); });
  if (Sim::has_ranks && k == nowhere) return parents.push_back({nowhere, sizes.masses.size(), 0});
  if constexpr (Sim::has_ledger) {
    double potential = s.potential(k);  // [J] of the dust, where the fragments leave it
    for (std::size_t n = 0; n < sizes.masses.size(); ++n)
      potential += sizes.masses[n] * dot(s.gravity_booked_, all.all()[before + n].position);
    book(k, sizes.dust / broken.mass, potential);
  }
  if constexpr (Sim::FluidIs::sees_leaving)
    if (sizes.dust > 0) s.take_from_fluid(k, sizes.dust / broken.mass);
  // [s] in which the whole particle would have arrived
  const double passes = due.speed > 0 ? broken.diameter / due.speed : 0;
  parents.push_back({k, sizes.masses.size(), s.time_ + passes});
  stage.events.push_back(event);
}

template <class Sim>
template <class Particles>
void BreakAccess<Sim>::take_place(const DynArray<Parent>& parents, const Particles& fragments,
                                  const OfRanks& all) {
  auto& s = sim();
  auto& e = s.engine_;
  const std::size_t from = s.rows();
  const ParticleId first = s.next_.particle;
  DynArray<double> rests_until;
  DynArray<std::size_t> places;
  DynArray<char> own;  // which fragments are this rank's
  for (const Parent& p : parents) {
    rests_until.insert(rests_until.end(), p.fragments, p.rests_until);
    if constexpr (Sim::has_ranks) own.insert(own.end(), p.fragments, p.place != nowhere);
    if (p.place != nowhere) places.push_back(p.place);
  }
  const auto rows = rows_of(places);
  if constexpr (Sim::has_ledger) book_contacts(rows, all.gone);
  if constexpr (Sim::has_bonds)
    s.bonds_.end_of(e, s.domain_, Sim::has_ranks ? rows_of_ranks(all.gone) : rows,
                    s.first_kick_ ? 0 : s.dt_);
  s.breaks_.newborn_from = Sim::of_bodies ? s.next_.part : first;
  DynArray<std::size_t> forms;
  if constexpr (Sim::of_bodies)
    forms =
        take_in_cells(e.mover, fragments.forms(), Sim::has_ranks ? all.forms : used_forms(e.mover));
  s.join(std::span<const typename Particles::Particle>(fragments.all()), forms,
         std::span<const char>(own));
  if constexpr (Sim::has_ledger)  // the fragments' energy is not lost
    for (std::size_t n = from; n < s.rows(); ++n) s.book_.broke(-s.kinetic(n).sum());
  std::size_t k = from;
  for (const Parent& p : parents)
    for (std::size_t n = 0; n < p.fragments && p.place != nowhere; ++n, ++k) {
      copy_row(e.modules(), p.place, k);
      s.modules_.divide(e.modules(), k, e.volume_of(k) / e.volume_of(p.place));
      ++e.modules().template of<typename Sim::Composition::Breaking>()[k].generation;
      if constexpr (Sim::Fluid::active) {
        auto& displaced = e.fluid_loads().displaced;
        displaced[k] = displaced[p.place] * (e.volume_of(k) / e.volume_of(p.place));
      }
    }
  s.breaks_.start(e, s.breakage(), from, [&](ParticleId id) { return rests_until[id - first]; });
  e.remove_all(places, s.domain_, s.dt_);
}

}  // namespace silt::detail
