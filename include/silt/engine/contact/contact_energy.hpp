// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <silt/contact/concept.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/vec3.hpp>
#include <silt/engine/contact/contact_events.hpp>
#include <silt/engine/contact/impacts.hpp>
#include <silt/engine/contact/virial.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Interval [steps] at which the ledger evaluates the stored energy of contacts and the dissipation
/// of their tangential dashpots, in addition to observed steps. The work of each force is booked in
/// every step.
inline constexpr int ledger_asks_every = 4;

/// The energy terms of one contact, or sums over many.
template <class Real>
struct ContactEnergy {
  // Only in steps that evaluate them: [J] stored now in springs, [W] dissipated now by tangential
  // dashpots.
  Real normal, tangential, rolling, shear_damping;
  // Work on the bodies since the last step [J]: of the non-elastic part of the normal force; of the
  // tangential force; of the couple; half of the work of the normal force.
  Real dashpot, shear, couple, turned_over;
  Real stiffening;  // [J] gained without work by tangential springs since the last step

  template <class Other>
  void add(const ContactEnergy<Other>& more) {
    auto all = values(*this);
    const auto others = ContactEnergy<Other>::values(more);
    for (std::size_t k = 0; k < all.size(); ++k) all[k] += sum(others[k]);
    *this = std::bit_cast<ContactEnergy>(all);
  }
  void halve() {
    auto all = values(*this);
    for (Real& one : all) one *= Real(0.5);
    *this = std::bit_cast<ContactEnergy>(all);
  }
  /// Converts sums of force times velocity [W], as the kernel computes them, to work.
  void worked(const Real& half_time) {
    dashpot *= half_time, shear *= half_time, couple *= half_time, turned_over *= half_time;
  }
  static auto values(const ContactEnergy& e) {
    return std::bit_cast<std::array<Real, sizeof(ContactEnergy) / sizeof(Real)>>(e);
  }

 private:
  template <class Other>
  static Real sum(const Other& lanes) {
    if constexpr (std::is_same_v<Other, Real>) {
      return lanes;
    } else {
      using Scalar = ScalarOf<Other>;
      alignas(Other) Scalar each[sizeof(Other) / sizeof(Scalar)];
      silt::store(each, lanes);
      Real all(0);
      for (const Scalar one : each) all += static_cast<Real>(one);
      return all;
    }
  }
};

/// Zero energy.
template <class Real>
inline ContactEnergy<Real> no_energy() {
  const Real zero(0);
  return {zero, zero, zero, zero, zero, zero, zero, zero, zero};
}

/// A Contacts type whose contacts store, behind the histories of law and rolling model, the values
/// of the last step that the ledger needs: the non-elastic normal force, the tangential force, the
/// couple.
template <class ContactsType>
struct WithLedger : ContactsType {
  static constexpr std::size_t kept_from = ContactsType::history;
  static constexpr std::size_t kept_couple = 1 + 3 * is_frictional<typename ContactsType::Law>;
  static constexpr std::size_t history =
      ContactsType::history + kept_couple + 3 * ContactsType::has_rolling;
  static constexpr bool keeps_ledger = true;
};
template <class ContactsType>
inline constexpr bool keeps_ledger = requires {
  requires ContactsType::keeps_ledger;
};

/// A Contacts type whose contacts apply only a share of their force (SharedContacts).
template <class ContactsType>
struct WithShares : ContactsType {
  static constexpr bool shares_contacts = true;
};
template <class ContactsType>
inline constexpr bool shares_contacts = requires {
  requires ContactsType::shares_contacts;
};

/// Replaces the energy where there is no ledger.
struct NoEnergy {
  void halve() {}
  template <class Other>
  void add(const Other&) {}
};
template <class ContactsType, class Real>
using EnergyOf = std::conditional_t<keeps_ledger<ContactsType>, ContactEnergy<Real>, NoEnergy>;
template <class ContactsType, class Real>
SILT_INLINE EnergyOf<ContactsType, Real> start_energy() {
  if constexpr (keeps_ledger<ContactsType>)
    return no_energy<Real>();
  else
    return {};
}

/// Adds what the last forces of a contact did in the step in which it ended, if its stage does not
/// see it any more, in the units of the sums [W] (ContactKernel::Books). kept(k): the values of
/// WithLedger; `velocity` [m/s] of the first at the contact, relative to the second; `turning`
/// [rad/s] the same.
template <class ContactsType, class Kept>
void add_last_work(const Kept& kept, const Vec3d& normal, const Vec3d& velocity,
                   [[maybe_unused]] const Vec3d& turning, ContactEnergy<double>& energy) {
  const auto at = [&](std::size_t k) { return Vec3d{kept(k), kept(k + 1), kept(k + 2)}; };
  const double apart = dot(velocity, normal);
  energy.dashpot += kept(0) * apart;
  if constexpr (is_frictional<typename ContactsType::Law>)
    energy.shear += dot(at(1), velocity - apart * normal);
  if constexpr (ContactsType::has_rolling)
    energy.couple += dot(at(ContactsType::kept_couple), turning);
}

/// Results of a contact stage besides the loads.
template <class ContactsType>
struct Tally {
  double largest = 0;            // [-] overlap relative to the smaller radius
  std::uint64_t safeguards = 0;  // [-] contacts in which the law's safeguard became active
  EnergyOf<ContactsType, double> energy = start_energy<ContactsType, double>();
  [[no_unique_address]] NotesOf<ContactsType> notes;  // contacts that began or ended
  [[no_unique_address]] ImpactsOf<ContactsType> impacts;
  [[no_unique_address]] VirialOf<ContactsType> virial;
  double parted = 0;  // [J] released by shrinking offsets

  /// For contacts with ghosts, which another rank counts too.
  void halve_energy() { energy.halve(), parted *= 0.5; }
  void add(const Tally& other) {
    largest = other.largest > largest ? other.largest : largest;
    safeguards += other.safeguards;
    energy.add(other.energy);
    notes.add(other.notes), impacts.add(other.impacts);
    parted += other.parted;
    if constexpr (sums_virial<ContactsType>) virial = virial + other.virial;
  }
};
/// The same during summation: energies lane by lane. Floats are converted to double early.
template <class ContactsType, class Real>
struct RunningTally {
  Tally<ContactsType> sum;
  EnergyOf<ContactsType, Real> lanes = start_energy<ContactsType, Real>();

  void end_block() {
    if constexpr (sizeof(ScalarOf<Real>) == sizeof(float)) add_lanes();
  }
  Tally<ContactsType> end() {
    add_lanes();
    return sum;
  }

 private:
  void add_lanes() {
    sum.energy.add(lanes);
    lanes = start_energy<ContactsType, Real>();
  }
};

}  // namespace silt::detail
