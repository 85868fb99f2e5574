// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of BreakAccess: the energy of breaking particles in the ledger.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/checks/ended_contacts.hpp>
#include <silt/engine/checks/ended_solid_contacts.hpp>
#include <silt/simulation/break_access.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Sim>
void BreakAccess<Sim>::book(std::size_t k, double of_dust, double potential) {
  auto& s = sim();
  const auto kinetic = s.kinetic(k);
  const double m = s.mass(k), share = kinetic.sum() * of_dust;
  s.book_.broke(kinetic.sum() - share);
  const double ago = !s.first_kick_ && Sim::Integrator::first_kick == 0.5 ? 0.5 * s.dt_ : 0;  // [s]
  const Vec3d v = s.velocity(k), now = v + ago * s.gravity;
  s.book_.bring_in(-share - potential - 0.5 * of_dust * m * (dot(now, now) - dot(v, v)));
}

template <class Sim>
double BreakAccess<Sim>::energy_of_all() const {
  const auto& s = sim();
  double sum = 0;
  for (std::size_t k = 0; k < s.rows(); ++k)
    if (s.is_present(k) && std::isfinite(s.mass(k))) sum += s.kinetic(k).sum() + s.potential(k);
  if constexpr (Sim::has_bonds) sum += s.own_bond_energy();
  return sum;
}

template <class Sim>
DynArray<std::uint32_t> BreakAccess<Sim>::rows_of(const DynArray<std::size_t>& places) const {
  DynArray<std::uint32_t> rows;
  [[maybe_unused]] const auto& mover = sim().engine_.mover;
  for (const std::size_t k : places)
    if constexpr (Sim::of_bodies)
      rows.push_back(mover.rows_of(mover.bodies[k]).front());
    else
      rows.push_back(static_cast<std::uint32_t>(k));
  std::sort(rows.begin(), rows.end());
  return rows;
}

template <class Sim>
DynArray<std::uint32_t> BreakAccess<Sim>::rows_of_ranks(std::span<const ParticleId> ids) const {
  const auto& e = sim().engine_;
  DynArray<std::uint32_t> rows;
  for (const ParticleId id : ids)
    if (const std::size_t row = e.row_of(id); row < e.particles.size())
      rows.push_back(static_cast<std::uint32_t>(row));
  std::sort(rows.begin(), rows.end());
  return rows;
}

template <class Sim>
void BreakAccess<Sim>::book_contacts(const DynArray<std::uint32_t>& rows,
                                     [[maybe_unused]] std::span<const ParticleId> gone) {
  auto& s = sim();
  auto& e = s.engine_;
  const auto book = [&s](const auto& ended) {
    s.book_.ended(ended.work), s.book_.broke(ended.normal);
  };
  if constexpr (Sim::of_bodies) {
    e.mover.renew_convex_rows(e.particles);  // rows added since the last step, or read from a file
    book(EndedSolidContacts(e, s.domain_, rows, s.dt_));
  } else {
    book(EndedContacts(e, s.domain_, rows, s.dt_, s.dt_));
  }
  if constexpr (Sim::has_ranks) book_contacts_with_ghosts(gone, book);
}

template <class Sim>
template <class Book>
void BreakAccess<Sim>::book_contacts_with_ghosts(std::span<const ParticleId> gone,
                                                 const Book& book) {
  auto& s = sim();
  const auto& e = s.engine_;
  const auto& pairs = e.lists.pairs;
  const auto is_gone = [gone](ParticleId id) {
    return std::binary_search(gone.begin(), gone.end(), id);
  };
  using Engine = typename Sim::Engine;
  using Domain = typename Sim::Domain;
  const auto ended = [&](std::size_t k) {
    if constexpr (Sim::of_bodies) {
      using Ended = EndedSolidContacts<Engine, Domain>;
      return Ended(e, s.domain_, typename Ended::OfPair{k}, s.dt_);
    } else {
      using Ended = EndedContacts<Engine, Domain>;
      return Ended(e, s.domain_, typename Ended::OfPair{k}, s.dt_, s.dt_);
    }
  };
  pairs.for_each([&](std::size_t k) {
    std::size_t own = pairs.first()[k], other = pairs.second()[k];
    if (own >= e.particles.owned()) std::swap(own, other);
    if (other < e.particles.owned()) return;
    const ParticleId mine = e.id_of(own), its = e.id_of(other);
    if (is_gone(mine) && (mine < its || !is_gone(its))) book(ended(k));
  });
}

}  // namespace silt::detail
