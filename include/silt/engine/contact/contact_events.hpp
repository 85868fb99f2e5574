// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <silt/contact/concept.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/position_row.hpp>
#include <silt/engine/contact/kinematics.hpp>

namespace silt::inline SILT_TARGET {

/// Policy of a Simulation that tracks each contact from begin to end, for on_contact_begin() and
/// on_contact_end(). Without it they cost nothing.
///
///   silt::Simulation sim{beads, silt::Contacts<silt::HertzMindlin>{glass}, silt::ContactEvents{}};
///   sim.run(1.0, silt::on_contact_end(
///                    [&](const silt::ContactEvent& c) { lost += c.lost_energy; }));
///
/// Tests: tests/engine/contact_events.cpp.
/// Source: none.
/// Valid:  every contact that lasts at least one step.
/// Units:  SI.
/// Errors: none.
struct ContactEvents {
  static constexpr bool is_contact_events = true;
};

inline constexpr std::size_t no_wall = std::numeric_limits<std::size_t>::max();

/// A contact of two particles, or of a particle and a wall, while the law acts between them: while
/// they overlap or, with cohesion, attract each other. Bodies have one contact for each pair of
/// parts; at a wall there is one for each place where the particle touches one of its surfaces.
struct ContactEvent {
  ParticleId a = no_particle;   // the one with the lower id of two particles
  ParticleId b = no_particle;   // no_particle: the partner is a wall
  std::size_t wall = no_wall;   // the wall's number, or no_wall
  double begin = 0, end = 0;    // [s] first step in contact, first step after it
  Vec3d point{0, 0, 0};         // [m] contact point, now
  Vec3d normal{0, 0, 0};        // [-] from b, or the wall, to a
  double normal_speed = 0;      // [m/s] of approach at first touch; negative: receding
  double tangential_speed = 0;  // [m/s] sliding speed at first touch, rotation included
  double largest_force = 0;     // [N] with friction; known at the end, like lost_energy
  double lost_energy = 0;  // [J] that the contact has dissipated: minus the work of its force on
                           // the motion of both relative to each other, mean of two steps times
                           // displacement. What a moving wall brings in is not in it
  double duration() const { return end - begin; }  // [s]
};

namespace detail {

/// Values stored for a tracked contact.
struct WatchedNumbers {
  // Two values for the time, because one float would not be precise enough; the first is not 0
  // during contact, and negative at rest. For the largest force [N], its square. `calm`: regular
  // evaluations in a row at which the surfaces hardly moved.
  static constexpr std::size_t begin = 0, normal_speed = 2, tangential_speed = 3, largest = 4,
                               work = 5, calm = 6, force = 7, couple = 10;
};
/// Whether the contact forces come with couples: rolling resistance, or contacts with an area.
template <class ContactsType>
inline constexpr bool gives_couples = [] {
  if constexpr (requires { ContactsType::points; })
    return ContactsType::points > 1;
  else
    return ContactsType::has_rolling;
}();

/// A Contacts type whose contacts store, behind all else, the values needed for events.
template <class ContactsType>
struct WithEvents : ContactsType {
  static constexpr std::size_t events_from = ContactsType::history;
  static constexpr std::size_t event_numbers =
      WatchedNumbers::couple + 3 * gives_couples<ContactsType>;
  static constexpr std::size_t history = events_from + event_numbers;
};
template <class ContactsType>
inline constexpr bool keeps_events = requires {
  ContactsType::events_from;
};
/// History values other than those of events.
template <class ContactsType>
inline constexpr std::size_t numbers_before_events = [] {
  if constexpr (keeps_events<ContactsType>)
    return ContactsType::events_from;
  else
    return ContactsType::history;
}();

/// A begin or an end as recorded by a contact stage: rows instead of ids.
struct NotedContact {
  static constexpr std::uint32_t no_row = std::numeric_limits<std::uint32_t>::max();
  ContactEvent event;
  bool ended;
  std::uint32_t place;  // of the contact in its block
  double overlap;       // [m]
  std::uint32_t first = no_row, second = no_row;
};

struct NoNotes {
  template <class Other>
  void add(const Other&) {}
};

/// Records of one stage, in the order of its lists.
class ContactNotes {
 public:
  void add(const ContactNotes& more) {
    noted_.insert(noted_.end(), more.noted_.begin(), more.noted_.end());
  }
  void add(const NotedContact& one) { noted_.push_back(one); }
  /// Adds a record that already has its rows and point; all records before it are complete.
  void add_complete(const NotedContact& one) { noted_.push_back(one), completed_ = noted_.size(); }
  /// Completes the other records with rows and point: where(note).
  template <class Where>
  void complete(const Where& where) {
    for (; completed_ < noted_.size(); ++completed_) where(noted_[completed_]);
  }
  const DynArray<NotedContact>& noted() const { return noted_; }

 private:
  DynArray<NotedContact> noted_;
  std::size_t completed_ = 0;
};
template <class ContactsType>
using NotesOf = std::conditional_t<keeps_events<ContactsType>, ContactNotes, NoNotes>;

/// The stored values of a contact, as an event that ends now.
template <class NumberAt>
ContactEvent kept_event(const NumberAt& number, double now) {
  using N = WatchedNumbers;
  ContactEvent e;
  e.begin = std::abs(number(N::begin)) + number(N::begin + 1), e.end = now;
  e.normal_speed = number(N::normal_speed), e.tangential_speed = number(N::tangential_speed);
  e.largest_force = std::sqrt(number(N::largest)), e.lost_energy = -number(N::work);
  return e;
}
/// Ends a contact outside its stage: records it if requested, and clears its history. number(k):
/// references to its values; `velocity` [m/s] of a at the contact, relative to its partner.
template <class ContactsType, class Number, class Times>
void end_watched(const Number& number, const Vec3d& velocity, const Times& times, NotedContact note,
                 NotesOf<ContactsType>& notes) {
  using N = WatchedNumbers;
  if constexpr (keeps_events<ContactsType>) {
    if (number(N::begin) == 0) return;
    if (times.watched) {
      const auto numbers = [&](std::size_t k) { return static_cast<double>(number(k)); };
      ContactEvent kept = kept_event(numbers, times.now);
      kept.lost_energy -=
          0.5 * times.worked *
          dot(Vec3d{numbers(N::force), numbers(N::force + 1), numbers(N::force + 2)}, velocity);
      const Vec3d point = note.event.point, normal = note.event.normal;
      const std::size_t wall = note.event.wall;
      note.event = kept, note.event.point = point, note.event.normal = normal;
      note.event.wall = wall, note.ended = true;
      notes.add_complete(note);
    }
    for (std::size_t k = 0; k < ContactsType::event_numbers; ++k) number(k) = 0;
  }
}

/// Tracks packs of contacts. The work of a force is its mean over the step times the displacement,
/// as in the energy ledger. Contacts at rest are evaluated only in some steps (StepTimes), for all
/// the steps between; their end is detected in any step. At rest are those whose surfaces have
/// moved so slowly at several of these evaluations, and still do, that the force hardly changes
/// from one to the next.
template <class ContactsType, class Real>
class ContactWatch {
  using Scalar = ScalarOf<Real>;
  using N = WatchedNumbers;
  static constexpr std::size_t W = sizeof(Real) / sizeof(Scalar);

 public:
  /// Whether a pack of contacts must be tracked in this step; `begin`: the first value of each.
  template <class Touching, class Times>
  static SILT_INLINE bool is_due(const Kinematics<Real>& kin, const Touching& touching,
                                 const Scalar* begin, const Times& times) {
    const Real begun = silt::load<Real>(begin);
    const auto known = touching || begun != Real(0), at_rest = touching && begun < Real(0);
    return any(known && !(at_rest && is_slow(kin, times))) || (times.look_at_rest && any(known));
  }

  /// Contacts k and following, after the law. `load`: 0 where the law does not act; `couple` [N m]:
  /// the other moments, with `turning` [rad/s] as angular velocity; `kept`: one pointer per value,
  /// at this pack; `gradient` [-]: the kinematics include this factor, the load does not
  /// (SolidContact).
  template <bool HasGradient = false, class Touching, class Times>
  static SILT_INLINE void step(const Kinematics<Real>& kin, const Touching& touching,
                               const PairLoad<Real>& load, const Vec3<Real>& couple,
                               const Vec3<Real>& turning, Scalar* const* kept, const Times& times,
                               std::size_t k, ContactNotes& notes, const Real& gradient = Real(1)) {
    const Real zero(0), begun = silt::load<Real>(kept[N::begin]);
    const auto touched = begun != zero, slow = is_slow(kin, times), rested = begun < zero,
               at_rest = touching && rested && slow;
    Vec3<Real> velocity = kin.velocity, turn = turning, force = load.force, moment = couple;
    if constexpr (HasGradient) {
      const Real per_gradient = Real(1) / gradient;
      velocity = per_gradient * velocity, turn = per_gradient * turn;
      force = gradient * force, moment = gradient * moment;
    }
    const Real worked(static_cast<Scalar>(times.worked)), size = dot(force, force);
    Real power = dot(force, velocity);
    if constexpr (ContactsType::rotates) power += dot(load.twirl, kin.spin);
    if constexpr (gives_couples<ContactsType>) power += dot(moment, turn);
    // A regular evaluation at rest represents half the steps since the last and half of those until
    // the next.
    constexpr double every = Times::look_at_rest_every;
    const Real of_rest(static_cast<Scalar>(times.look_at_rest ? every : 0));
    if (times.look_at_rest && !any((touching || touched) && !at_rest)) {  // most packs of a bed
      keep(kept + N::force, force);
      if constexpr (gives_couples<ContactsType>) keep(kept + N::couple, moment);
      const Real work = select(at_rest, worked * (of_rest * power), zero);
      silt::store(kept[N::work], silt::load<Real>(kept[N::work]) + work);
      keep_largest(touching, size, kept);
      return;
    }
    const Vec3<Real> before =
        silt::load3<Real>(kept[N::force], kept[N::force + 1], kept[N::force + 2]);
    Real power_before = dot(before, velocity);
    if constexpr (ContactsType::rotates)  // the last force acted along the last normal
      power_before -= kin.arm * dot(before, cross(kin.spin, kin.normal - kin.change));
    const auto passed_over = at_rest && silt::Mask<Real>(!times.look_at_rest);
    keep(kept + N::force, select(passed_over, before, force));
    if constexpr (gives_couples<ContactsType>) {
      const Vec3<Real> moment_before =
          silt::load3<Real>(kept[N::couple], kept[N::couple + 1], kept[N::couple + 2]);
      power_before += dot(moment_before, turn);
      keep(kept + N::couple, select(passed_over, moment_before, moment));
    }
    // Where rest ends, the steps passed over had about this power, but were slow.
    const Real passed(static_cast<Scalar>(times.since_look - 1 - every / 2)),
        ahead(static_cast<Scalar>(every / 2)), half(Scalar(0.5));
    const auto ends_rest = rested && !at_rest;
    auto begins_rest = touching && !touching;  // none
    if (times.look_at_rest)
      begins_rest = count_calm(slow, begun, kept, times) && !rested && touching;
    else if (any(ends_rest))
      end_rest(ends_rest, begun, kept);
    Real work = select(at_rest, of_rest * power, half * (power + power_before));
    work += select(ends_rest, passed * slowed(power, kin, times), zero);
    work += select(begins_rest, ahead * power, zero);
    work = select(work == work, work, zero);  // NaN: the partner has left
    silt::store(kept[N::work], silt::load<Real>(kept[N::work]) + worked * work);
    keep_largest(touching, size, kept);
    tell_changes(kin, velocity, touching, touched, kept, times, k, notes);
  }

 private:
  /// Squares of the distance [m] that the surfaces move until the next regular evaluation, over the
  /// part of the overlap that this may be at rest.
  template <class Times>
  static SILT_INLINE Real moved_squared(const Kinematics<Real>& kin, const Times& times) {
    Vec3<Real> sliding = kin.velocity;
    if constexpr (ContactsType::rotates) sliding -= kin.arm * cross(kin.spin, kin.normal);
    const Real per_move(
        static_cast<Scalar>(times.step * Times::look_at_rest_every / Times::move_at_rest));
    return per_move * per_move * dot(sliding, sliding);
  }
  template <class Times>
  static SILT_INLINE auto is_slow(const Kinematics<Real>& kin, const Times& times) {
    return kin.overlap > Real(0) && moved_squared(kin, times) < kin.overlap * kin.overlap;
  }
  /// The power [W] at the largest speed of rest, if that is lower.
  template <class Times>
  static SILT_INLINE Real slowed(const Real& power, const Kinematics<Real>& kin,
                                 const Times& times) {
    const Real overlap = max(kin.overlap, Real(0)), moved = moved_squared(kin, times);
    return power * sqrt(min(Real(1), overlap * overlap / max(moved, smallest<Scalar>())));
  }
  template <class Touching, class Touched, class Times>
  static SILT_INLINE void tell_changes(const Kinematics<Real>& kin, Vec3<Real> velocity,
                                       const Touching& touching, const Touched& touched,
                                       Scalar* const* kept, const Times& times, std::size_t k,
                                       ContactNotes& notes) {
    const std::uint64_t began = lane_bits(touching) & ~lane_bits(touched),
                        ended = lane_bits(touched) & ~lane_bits(touching);
    if ((began | ended) == 0) [[likely]]
      return;
    Change change;
    change.k = k, change.began = began, change.ended = ended;
    if constexpr (ContactsType::rotates) velocity -= kin.arm * cross(kin.spin, kin.normal);
    silt::store(change.normal[0], kin.normal.x), silt::store(change.normal[1], kin.normal.y);
    silt::store(change.normal[2], kin.normal.z), silt::store(change.velocity[0], velocity.x);
    silt::store(change.velocity[1], velocity.y), silt::store(change.velocity[2], velocity.z);
    silt::store(change.overlap, kin.overlap);
    note(change, kept, times, notes);
  }
  template <class Touching>
  static SILT_INLINE void keep_largest(const Touching& touching, const Real& size,
                                       Scalar* const* kept) {
    const Real last = silt::load<Real>(kept[N::largest]);
    if (any(touching && size > last))
      silt::store(kept[N::largest], select(touching, max(last, size), last));
  }
  /// Counts regular evaluations at which a contact was slow; returns whether it is at rest now.
  template <class Slow, class Times>
  static SILT_INLINE auto count_calm(const Slow& slow, const Real& begun, Scalar* const* kept,
                                     const Times& times) {
    const Real calm = select(slow, silt::load<Real>(kept[N::calm]) + Real(1), Real(0)),
               time = max(begun, -begun), enough(static_cast<Scalar>(Times::calm_at_rest));
    const auto rests = calm >= enough && time < Real(static_cast<Scalar>(times.at_rest_from));
    silt::store(kept[N::calm], min(calm, enough));
    silt::store(kept[N::begin], select(rests, -time, time));
    return rests;
  }
  /// Contacts that move again.
  template <class Where>
  static SILT_INLINE void end_rest(const Where& where, const Real& begun, Scalar* const* kept) {
    silt::store(kept[N::calm], select(where, Real(0), silt::load<Real>(kept[N::calm])));
    silt::store(kept[N::begin], select(where, -begun, begun));
  }

  /// A pack in which contacts begin or end.
  struct Change {
    std::size_t k;               // of its first contact, in the block
    std::uint64_t began, ended;  // lanes
    alignas(64) Scalar normal[3][W], velocity[3][W], overlap[W];
  };

  static SILT_INLINE void keep(Scalar* const* kept, const Vec3<Real>& v) {
    silt::store(kept[0], v.x), silt::store(kept[1], v.y), silt::store(kept[2], v.z);
  }

  template <class Times>
  __attribute__((noinline)) static void note(const Change& change, Scalar* const* kept,
                                             const Times& times, ContactNotes& notes) {
    for (std::size_t lane = 0; lane < W; ++lane) {
      const auto bit = std::uint64_t{1} << lane;
      const bool began = (change.began & bit) != 0, ended = (change.ended & bit) != 0;
      if (!began && !ended) continue;
      const auto at = [lane](const Scalar(&v)[3][W]) {
        return Vec3d{v[0][lane], v[1][lane], v[2][lane]};
      };
      const Vec3d normal = at(change.normal), velocity = at(change.velocity);
      if (began) {
        const double along = dot(velocity, normal);
        const Scalar high = std::max(static_cast<Scalar>(times.now), smallest<Scalar>());
        kept[N::begin][lane] = high;
        kept[N::begin + 1][lane] = static_cast<Scalar>(times.now - static_cast<double>(high));
        kept[N::normal_speed][lane] = static_cast<Scalar>(-along);
        kept[N::tangential_speed][lane] = static_cast<Scalar>(norm(velocity - along * normal));
      }
      if (times.watched) {
        NotedContact one;
        one.event = kept_event([&](std::size_t m) { return static_cast<double>(kept[m][lane]); },
                               times.now);
        one.event.normal = normal, one.ended = ended;
        one.place = static_cast<std::uint32_t>(change.k + lane), one.overlap = change.overlap[lane];
        if (began) one.event.largest_force = one.event.lost_energy = 0;
        notes.add(one);
      }
      if (ended)
        for (std::size_t m = 0; m < ContactsType::event_numbers; ++m) kept[m][lane] = 0;
    }
  }
};

}  // namespace detail
}  // namespace silt
