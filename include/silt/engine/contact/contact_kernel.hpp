// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include <silt/contact/contacts.hpp>
#include <silt/contact/spring_slider.hpp>
#include <silt/core/lanes.hpp>
#include <silt/engine/contact/contact_energy.hpp>
#include <silt/engine/contact/kinematics.hpp>
#include <silt/engine/contact/shape_inertia.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The law and rolling model of one Contacts type on packs of lanes; independent of particle
/// storage.
template <class ContactsType, class Real>
struct ContactKernel {
  using Law = typename ContactsType::Law;
  using Rolling = typename ContactsType::Rolling;
  static_assert(WorksOnLanes<Law, Real>,
                "the contact law works on one double, but not on a pack of lanes: make force() a "
                "template of Real, as silt/contact/concept.hpp says, or give KernelsFor<OneLane>");
  static_assert(!keeps_ledger<ContactsType> || SaysWhatItStores<Law>,
                "EnergyLedger needs to know what the contact law stores: give it a function "
                "stored(), as silt/contact/concept.hpp says");
  using Energy = EnergyOf<ContactsType, Real>;
  using Inertia = InertiaOf<ContactsType>;
  using LawCoefficients = typename Law::template Coefficients<Real>;
  using RollingCoefficients = typename Rolling::template Coefficients<Real>;

  static SILT_INLINE Contact<Real> contact(const Kinematics<Real>& k, const Radii<Real>& radii,
                                           const Real& time_step, const Real& lag) {
    Contact<Real> c;
    c.radius_i = radii.i, c.radius_j = radii.j;
    c.normal = k.normal;
    c.overlap = ActsAtDistance<Law> ? k.overlap : max(k.overlap, Real(0));
    c.R_eff = k.R_eff, c.m_eff = k.m_eff, c.inverse_m_eff = k.inverse_m_eff;
    c.time_step = time_step, c.lag = Real(2) * lag * time_step;
    c.slip_mobility = Real(static_cast<ScalarOf<Real>>(Inertia::slip_mobility()));
    const Vec3<Real> middle = k.normal - lag * k.change;  // at the time of the velocities
    c.normal_velocity = dot(k.velocity, middle);
    if constexpr (ContactsType::rotates) {
      Vec3<Real> slip = k.velocity - c.normal_velocity * middle - k.arm * cross(k.spin, middle);
      c.tangential_velocity = slip - dot(slip, k.normal) * k.normal;
      c.turn = cross(k.normal, k.change) + (time_step * k.twist) * k.normal;
    }
    return c;
  }

  /// The lanes in which the law acts.
  static SILT_INLINE auto acting(const Kinematics<Real>& k,
                                 [[maybe_unused]] const LawCoefficients& law) {
    if constexpr (ActsAtDistance<Law>)
      return k.overlap > -Law::range(law, k.R_eff);
    else
      return k.overlap > Real(0);
  }
  /// The force pressing the bodies together, used by rolling resistance [N].
  static SILT_INLINE Real pressing(const Contact<Real>& c, const LawCoefficients& law,
                                   const Real& normal) {
    if constexpr (requires { Law::pressing(c, law, normal); })
      return Law::pressing(c, law, normal);
    else
      return max(normal, Real(0));
  }

  /// `history`: one pointer per component, at this pack; lanes out of contact are set to zero.
  /// `ask`: whether the ledger needs the stored energy. `share` [-] of its force that the contact
  /// applies (SharedContacts).
  static SILT_INLINE PairLoad<Real> load(const Kinematics<Real>& k,
                                         const RollingKinematics<Real>& r, const Radii<Real>& radii,
                                         const Real& time_step, const Real& lag,
                                         [[maybe_unused]] bool ask, const LawCoefficients& law,
                                         [[maybe_unused]] const RollingCoefficients& rolling,
                                         ScalarOf<Real>* const* history,
                                         [[maybe_unused]] RunningTally<ContactsType, Real>& tally,
                                         [[maybe_unused]] const Real& share) {
    const Contact<Real> c = contact(k, radii, time_step, lag);
    const auto touching = acting(k, law);
    const Real zero(0);
    PairLoad<Real> out;

    [[maybe_unused]] Books books;
    if constexpr (keeps_ledger<ContactsType>)
      books = Books(c, history + ContactsType::kept_from, tally.lanes);

    typename HistoryOf<Law, Real>::type h;
    load_history<ContactsType::law_history>(h, history);
    [[maybe_unused]] const auto before = h;
    auto answer = law_force<Law, Real>(c, law, h);
    if constexpr (shares_contacts<ContactsType>) answer = shared(answer, share);
    if constexpr (has_safeguard<Law>)
      tally.sum.safeguards += static_cast<std::uint64_t>(
          std::popcount(lane_bits(touching) & lane_bits(Law::safeguarded(before, h))));
    store_history<ContactsType::law_history>(h, touching, history);

    Real normal_force;
    if constexpr (is_frictional<Law>) {
      normal_force = select(touching, answer.normal, zero);
      const Vec3<Real> none{zero, zero, zero};
      const Vec3<Real> tangential = select(touching, answer.tangential, none);
      out.force = normal_force * k.normal + tangential;
      out.twirl = k.arm * cross(tangential, k.normal);
    } else {
      normal_force = select(touching, answer, zero);
      out.force = normal_force * k.normal;
      if constexpr (ContactsType::rotates) out.twirl = {zero, zero, zero};
    }
    if constexpr (keeps_ledger<ContactsType>) {
      Vec3<Real> tangential{zero, zero, zero};
      if constexpr (is_frictional<Law>)
        tangential = select(touching, answer.tangential, tangential);
      books.add(c, law, h, touching, normal_force, tangential, ask, share, tally.lanes);
      if constexpr (has_safeguard<Law>)
        tally.lanes.dashpot -= ended_by_safeguard(c, law, before, h, touching);
    }
    if constexpr (ContactsType::has_rolling)
      roll(k, r, c, radii, touching, normal_force, ask, law, rolling,
           history + ContactsType::law_history, tally, out);
    return out;
  }

 private:
  /// Adds the couples of the rolling model. `history`: its own, followed by the values of the
  /// ledger.
  template <class M>
  static SILT_INLINE void roll(const Kinematics<Real>& k, const RollingKinematics<Real>& r,
                               const Contact<Real>& c, [[maybe_unused]] const Radii<Real>& radii,
                               const M& touching, const Real& normal_force,
                               [[maybe_unused]] bool ask, const LawCoefficients& law,
                               const RollingCoefficients& rolling, ScalarOf<Real>* const* history,
                               [[maybe_unused]] RunningTally<ContactsType, Real>& tally,
                               PairLoad<Real>& out) {
    const Real zero(0);
    const Vec3<Real> none{zero, zero, zero};
    const Real twist = dot(r.angular_velocity, k.normal);
    const RollingContact<Real> rc{k.normal,
                                  r.angular_velocity - twist * k.normal,
                                  twist,
                                  k.spin,
                                  c.overlap,
                                  select(touching, pressing(c, law, normal_force), zero),
                                  Law::stiffness(c, law),
                                  k.R_eff,
                                  r.inertia_eff,
                                  c.turn,
                                  c.time_step,
                                  Real(static_cast<ScalarOf<Real>>(Inertia::share_of_rolling())),
                                  unloading(c, law),
                                  shrinking(c)};
    if constexpr (of_own_rotation<Rolling>) {
      // Couples that are not opposite, split into an opposite part (couple) and an equal part
      // (twirl).
      const Real per_arm = Real(1) / (radii.i + radii.j);
      const OwnRotations<Real> own{per_arm * (k.spin + radii.j * r.angular_velocity),
                                   per_arm * (k.spin - radii.i * r.angular_velocity), radii.i,
                                   radii.j};
      const OwnCouples<Real> t = Rolling::torque(rc, own, rolling);
      const Vec3<Real> twirl = select(touching, per_arm * (t.on_i + t.on_j), none);
      out.twirl += twirl;
      out.couple = select(touching, per_arm * (radii.j * t.on_i - radii.i * t.on_j), none);
      if constexpr (keeps_ledger<ContactsType>)  // first order in the step
        tally.lanes.couple +=
            known(Real(2) * (dot(out.couple, r.angular_velocity) + dot(twirl, k.spin)));
    } else {
      typename HistoryOf<Rolling, Real>::type m;
      load_history<ContactsType::rolling_history>(m, history);
      Vec3<Real> couple;
      if constexpr (HasHistory<Rolling>)
        couple = Rolling::torque(rc, rolling, m);
      else
        couple = Rolling::torque(rc, rolling);
      store_history<ContactsType::rolling_history>(m, touching, history);
      out.couple = select(touching, couple, none);
      if constexpr (keeps_ledger<ContactsType>) {
        ScalarOf<Real>* const* const kept =
            history + ContactsType::rolling_history + ContactsType::kept_couple;
        tally.lanes.couple += known(dot(with_kept(out.couple, kept), r.angular_velocity));
        if constexpr (requires { Rolling::stored(rc, rolling, m); })
          if (ask) tally.lanes.rolling += select(touching, Rolling::stored(rc, rolling, m), zero);
      }
    }
  }
  /// Books the work of the forces of a pack of contacts since the last step. The work of a force is
  /// its mean over the step times the displacement, which is the half-step velocity times the step.
  /// The sum of all works then equals the change of the leapfrog's kinetic energy. Summed up here
  /// is twice the mean force times the velocity. The last forces are added before the law is
  /// evaluated and the present ones after it, which needs fewer registers.
  struct Books {
    ScalarOf<Real>* const* kept;  // of the last step: one pointer per component, at this pack
    Real velocity;                // [m/s] along the normal; NaN if the partner has left
    Vec3<Real> slip;              // [m/s]

    Books() = default;
    SILT_INLINE Books(const Contact<Real>& c, ScalarOf<Real>* const* kept_forces, Energy& energy)
        : kept(kept_forces) {
      const Real zero(0);
      const auto is_there = c.normal_velocity == c.normal_velocity;
      velocity = select(is_there, c.normal_velocity, zero);
      energy.dashpot += silt::load<Real>(kept[0]) * velocity;
      if constexpr (is_frictional<Law>) {
        slip = select(is_there, c.tangential_velocity, {zero, zero, zero});
        energy.shear += dot(silt::load3<Real>(kept[1], kept[2], kept[3]), slip);
      }
    }

    template <class H, class M>
    SILT_INLINE void add(const Contact<Real>& c, const LawCoefficients& law, const H& now,
                         const M& touching, const Real& normal, const Vec3<Real>& tangential,
                         bool ask, [[maybe_unused]] const Real& share, Energy& energy) const {
      const Real zero(0);
      Stored<Real> stored = stored_by<Law, Real>(c, law, now);
      if constexpr (shares_contacts<ContactsType>)
        stored = {share * stored.force,      share * stored.normal,  share * stored.spring,
                  share * stored.tangential, share * stored.damping, share * stored.stiffening};
      const Real dashpot = select(touching, normal - stored.force, zero);
      energy.dashpot += dashpot * velocity;
      energy.turned_over += abs(normal * velocity);
      silt::store(kept[0], dashpot);
      if (ask) energy.normal += select(touching, stored.normal, zero);
      if constexpr (is_frictional<Law>) {
        energy.shear += dot(tangential, slip);
        energy.stiffening += select(touching, stored.stiffening, zero);
        if (ask) {
          energy.tangential += select(touching, stored.tangential, zero);
          // The non-elastic part is c u, with u the velocity of the spring itself; its power is c
          // u^2.
          const Vec3<Real> damping = tangential - stored.spring;
          const Real taken = dot(damping, damping) / max(stored.damping, smallest<Real>());
          energy.shear_damping +=
              select(touching, select(stored.damping > zero, taken, zero), zero);
        }
        silt::store(kept[1], tangential.x), silt::store(kept[2], tangential.y),
            silt::store(kept[3], tangential.z);
      }
    }
  };
  /// The energy of a spring that a safeguard has released in this step, in the units of the sums
  /// [W]: that of the last step, less the half of its work that the mean force omits.
  template <class H, class M>
  static SILT_INLINE Real ended_by_safeguard(const Contact<Real>& c, const LawCoefficients& law,
                                             const H& before, const H& now, const M& touching) {
    const Real zero(0);
    const Stored<Real> spring = stored_by<Law, Real>(c, law, before);
    const Real ended = Real(2) * spring.normal / c.time_step + spring.force * c.normal_velocity;
    return select(touching, select(Law::safeguarded(before, now), ended, zero), zero);
  }
  /// The law's stiffness relative to that one step ago, if the contact is unloading [-].
  static SILT_INLINE Real unloading(const Contact<Real>& c, const LawCoefficients& law) {
    if constexpr (requires { Law::unloading(c, law); }) {
      return Law::unloading(c, law);
    } else {
      Contact<Real> last = c;
      last.overlap = c.overlap + c.time_step * c.normal_velocity;
      const Real then = max(Law::stiffness(last, law), smallest<Real>());
      return min(Law::stiffness(c, law) / then, Real(1));
    }
  }
  template <class Answer>
  static SILT_INLINE Answer shared(const Answer& answer, const Real& share) {
    if constexpr (is_frictional<Law>)
      return {share * answer.normal, share * answer.tangential};
    else
      return share * answer;
  }
  /// The sum of a force and that of the last step; stores it for the next step.
  static SILT_INLINE Vec3<Real> with_kept(const Vec3<Real>& force, ScalarOf<Real>* const* kept) {
    const Vec3<Real> last = silt::load3<Real>(kept[0], kept[1], kept[2]);
    silt::store(kept[0], force.x), silt::store(kept[1], force.y), silt::store(kept[2], force.z);
    return last + force;
  }
  /// Replaces NaN by zero: the partner has left.
  static SILT_INLINE Real known(const Real& work) { return select(work == work, work, Real(0)); }

  template <std::size_t N, class H>
  static void load_history(H& h, ScalarOf<Real>* const* history) {
    if constexpr (N > 0) {
      std::array<Real, N> values;
      for (std::size_t n = 0; n < N; ++n) values[n] = silt::load<Real>(history[n]);
      h = std::bit_cast<H>(values);
    }
  }
  template <std::size_t N, class H, class M>
  static void store_history(const H& h, const M& touching, ScalarOf<Real>* const* history) {
    if constexpr (N > 0) {
      const auto values = std::bit_cast<std::array<Real, N>>(h);
      for (std::size_t n = 0; n < N; ++n)
        silt::store(history[n], select(touching, values[n], Real(0)));
    }
  }
};

}  // namespace silt::detail
