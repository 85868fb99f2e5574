// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <silt/core/threads.hpp>
#include <silt/engine/contact/coefficients.hpp>
#include <silt/engine/contact/contact_kernel.hpp>
#include <silt/engine/contact/contact_record.hpp>
#include <silt/engine/contact/offset.hpp>
#include <silt/engine/contact/step_times.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The packs of a block that must be tracked (ContactWatch). Their kinematics, which the loads
/// overwrite, are saved in the loop of the law; they are tracked after it.
template <class ContactsType, class Real, class Block>
class WatchedPacks {
  using Kernel = ContactKernel<ContactsType, Real>;
  using Watch = ContactWatch<ContactsType, Real>;
  static constexpr std::size_t W = sizeof(Real) / sizeof(ScalarOf<Real>);

 public:
  /// Before the law, for each pack; `begin`: the first stored value of each contact.
  SILT_INLINE void look(const Kinematics<Real>& kinematics, const RollingKinematics<Real>& rolling,
                        std::size_t k, const StepTimes& times,
                        const ContactCoefficients<ContactsType, Real>& coefficients,
                        const ScalarOf<Real>* begin) {
    if (!Watch::is_due(kinematics, Kernel::acting(kinematics, coefficients.law()), begin, times))
      return;
    which_[packs_++] = static_cast<std::uint16_t>(k);
    before_.put(k, kinematics), before_.put(k, rolling);
  }
  /// Called after the law.
  template <std::size_t H>
  void watch(const Block& block, const StepTimes& times,
             ContactCoefficients<ContactsType, Real> coefficients, const std::uint16_t* kinds,
             const std::array<ScalarOf<Real>*, H>& history, ContactNotes& notes) const {
    for (std::size_t p = 0; p < packs_; ++p) {
      const std::size_t k = which_[p];
      if (kinds != nullptr && ActsAtDistance<typename ContactsType::Law>)
        coefficients.choose(kinds + k);
      std::array<ScalarOf<Real>*, ContactsType::event_numbers> kept;
      for (std::size_t h = 0; h < kept.size(); ++h)
        kept[h] = history[ContactsType::events_from + h] + k;
      const auto kinematics = before_.template get<Real>(k);
      const auto loads = block.template get_load<Real>(k);
      Vec3<Real> couple{Real(0), Real(0), Real(0)};
      if constexpr (ContactsType::has_rolling) couple = loads.couple;
      Watch::step(kinematics, Kernel::acting(kinematics, coefficients.law()), loads, couple,
                  before_.template get_rolling<Real>(k).angular_velocity, kept.data(), times, k,
                  notes);
    }
  }

 private:
  std::size_t packs_ = 0;
  std::uint16_t which_[Block::size / W + 1];
  Block before_;
};

/// Adds to a recorded contact the parts of its force that the law provides: tangential spring and
/// cohesion, times `share` [-]. `c` has overlap, radii and masses, but no velocities.
template <class ContactsType, class Scalar>
void tell_parts(const Contact<double>& c, const typename ContactsType::LawCoefficients& p,
                Scalar* const* history, double share, RecordedContact& to) {
  using Law = typename ContactsType::Law;
  const auto h = history_of<Law>([&](std::size_t n) { return *history[n]; });
  if constexpr (SaysWhatItStores<Law> && is_frictional<Law>)
    to.spring += share * stored_by<Law, double>(c, p, h).spring;
  if constexpr (requires { Law::attraction(c, p, h); })
    to.cohesion += share * Law::attraction(c, p, h);
}

/// Power dissipated by friction and damping in each contact of a block in the last step [W]; this
/// variant for when it is not needed.
template <class Real, std::size_t N, bool Asked>
struct ContactLosses {
  template <class Energy>
  SILT_INLINE void begin(Energy&) {}
  template <class Energy>
  SILT_INLINE void end(std::size_t, const StepTimes&, Energy&) {}
  static const ScalarOf<Real>* data() { return nullptr; }
};
/// From the ledger: work on the bodies of all forces except normal springs. The elastic energy of
/// tangential springs counts as lost while they hold it.
template <class Real, std::size_t N>
struct ContactLosses<Real, N, true> {
  SILT_INLINE void begin(ContactEnergy<Real>& lanes) { others_ = lanes, lanes = no_energy<Real>(); }
  SILT_INLINE void end(std::size_t k, const StepTimes& times, ContactEnergy<Real>& lanes) {
    const Real scale(times.worked > 0 ? ScalarOf<Real>(-0.5) : ScalarOf<Real>(0));
    silt::store(of_ + k, scale * (lanes.dashpot + lanes.shear + lanes.couple));
    others_.add(lanes), lanes = others_;
  }
  const ScalarOf<Real>* data() const { return of_; }

 private:
  ContactEnergy<Real> others_;
  alignas(64) ScalarOf<Real> of_[N];
};

/// Rate of change of the overlap of each contact of a block over the last step [m/s], taken before
/// loads overwrite the velocities (Touching::growth); this variant for when it is not needed.
template <class Real, std::size_t N, bool Asked>
struct ContactGrowth {
  template <class Block>
  SILT_INLINE void take(const Block&, std::size_t, const StepTimes&) {}
  static const ScalarOf<Real>* data() { return nullptr; }
};
/// For a contact that began in the last step, limited to its overlap. In the first step it is 0.
template <class Real, std::size_t N>
struct ContactGrowth<Real, N, true> {
  template <class Block>
  SILT_INLINE void take(const Block& block, std::size_t count, const StepTimes& times) {
    constexpr std::size_t W = sizeof(Real) / sizeof(ScalarOf<Real>);
    const Real per_step(static_cast<ScalarOf<Real>>(1 / times.step));
    const Real lag(static_cast<ScalarOf<Real>>(times.lag));
    const Real was(times.worked > 0 ? ScalarOf<Real>(1) : ScalarOf<Real>(0));
    for (std::size_t k = 0; k < count; k += W) {
      const auto kin = block.template get<Real>(k);
      const Real towards = -dot(kin.velocity, kin.normal - lag * kin.change);
      silt::store(of_ + k, was * min(towards, kin.overlap * per_step));
    }
  }
  const ScalarOf<Real>* data() const { return of_; }

 private:
  alignas(64) ScalarOf<Real> of_[N];
};

/// Evaluates contacts that act at one point: law and rolling model there.
template <class Scalar>
struct AtOnePoint {
  const Scalar* shares = nullptr;  // [-] of each contact's force (SharedContacts); null: 1

  /// Loads of the first `count` contacts (whole packs) of a block; they overwrite the kinematics.
  template <class ContactsType, class Arch, class Block, std::size_t H, class Losses>
  SILT_INLINE void loads(Block& block, std::size_t count, const StepTimes& times,
                         const CoefficientTable<ContactsType>& table, const std::uint16_t* kinds,
                         const std::array<Scalar*, H>& history,
                         RunningTally<ContactsType, typename Lanes<Arch, Scalar>::Real>& tally,
                         [[maybe_unused]] Losses& losses) const {
    using Real = typename Lanes<Arch, Scalar>::Real;
    using Kernel = ContactKernel<ContactsType, Real>;
    constexpr std::size_t W = Lanes<Arch, Scalar>::width;
    const Real step(static_cast<Scalar>(times.step)), lag(static_cast<Scalar>(times.lag));
    ContactCoefficients<ContactsType, Real> coefficients(table);
    struct Nothing {};
    [[maybe_unused]] std::conditional_t<keeps_events<ContactsType>,
                                        WatchedPacks<ContactsType, Real, Block>, Nothing>
        packs;
    for (std::size_t k = 0; k < count; k += W) {
      if (kinds != nullptr) coefficients.choose(kinds + k);
      std::array<Scalar*, H> at{};
      for (std::size_t h = 0; h < ContactsType::history; ++h) at[h] = history[h] + k;
      const Real share =
          shares_contacts<ContactsType> && shares != nullptr ? load<Real>(shares + k) : Real(1);
      losses.begin(tally.lanes);
      if constexpr (keeps_events<ContactsType>)
        packs.look(block.template get<Real>(k), block.template get_rolling<Real>(k), k, times,
                   coefficients, at[ContactsType::events_from + WatchedNumbers::begin]);
      block.put_load(
          k, Kernel::load(block.template get<Real>(k), block.template get_rolling<Real>(k),
                          block.template get_radii<Real>(k), step, lag, times.ask,
                          coefficients.law(), coefficients.rolling(), at.data(), tally, share));
      losses.end(k, times, tally.lanes);
    }
    if constexpr (keeps_events<ContactsType>)
      packs.watch(block, times, coefficients, kinds, history, tally.sum.notes);
  }
  /// See tell_parts(); for contact k.
  template <class ContactsType, std::size_t H>
  void tell(const Contact<double>& c, const typename ContactsType::LawCoefficients& p,
            const std::array<Scalar*, H>& history, std::size_t k, RecordedContact& to) const {
    std::array<Scalar*, H> at{};
    for (std::size_t h = 0; h < ContactsType::law_history; ++h) at[h] = history[h] + k;
    const bool shared = shares_contacts<ContactsType> && shares != nullptr;
    tell_parts<ContactsType>(c, p, at.data(), shared ? static_cast<double>(shares[k]) : 1, to);
  }
};

/// The contact stage, common to all geometries. Spheres and convex parts, in contact with each
/// other or with walls, fill a block with kinematics; here the contacts get their loads, the ledger
/// its energies, events their begins and ends, and modules their fluxes. The geometry then applies
/// the loads to bodies and walls, because it knows the lever arms.
template <class ContactsType, class Arch, class Scalar, class Fluxes>
struct ContactStage {
  using Real = typename Lanes<Arch, Scalar>::Real;
  using Tally = RunningTally<ContactsType, Real>;

  const StepTimes& times;
  const CoefficientTable<ContactsType>& table;
  Fluxes* fluxes;  // of modules, if there are any

  /// Processes the first `count` contacts of a block, whose last pack is padded with inert
  /// contacts. `kinds`: index of each in the coefficient table, or null if it is the first for all.
  /// `history`: one pointer per component. `ends` identifies the partners: first(k) [row], and
  /// second(k) [row] or, with at_wall, wall(k); where(k, note) completes a begin or end by its
  /// index. `how`: AtOnePoint, or AtAreaPoints (convex/contact_area.hpp).
  template <class Block, class Ends, class How, std::size_t H>
  SILT_INLINE void run(Block& block, std::size_t count, const std::uint16_t* kinds,
                       const std::array<Scalar*, H>& history, const Ends& ends, Tally& tally,
                       const How& how) const {
    constexpr std::size_t W = Lanes<Arch, Scalar>::width;
    static_assert(!Fluxes::takes_loss || keeps_ledger<ContactsType>,
                  "a module takes the heat of friction and damping, which the ledger knows: give "
                  "the simulation a silt::EnergyLedger{}");
    if constexpr (keeps_impacts<ContactsType>)
      if constexpr (!ContactsType::impacts_by_force)
        ImpactWatch<ContactsType, Real, Block>::look(
            block, count, kinds, history[ContactsType::offset_from], ends, tally.sum.impacts);
    ContactLosses<Real, Block::size, Fluxes::takes_loss && keeps_ledger<ContactsType>> losses;
    ContactGrowth<Real, Block::size, Fluxes::needs_growth> growth;
    growth.take(block, pieces(count, W) * W, times);
    how.template loads<ContactsType, Arch>(block, pieces(count, W) * W, times, table, kinds,
                                           history, tally, losses);
    tally.end_block();
    if constexpr (keeps_impacts<ContactsType>) {
      if constexpr (ContactsType::impacts_by_force)
        ImpactWatch<ContactsType, Real, Block>::weigh(block, count, kinds,
                                                      history[ContactsType::impact_from],
                                                      times.weak_from, ends, tally.sum.impacts);
      if (times.parting > 0) part(block, count, kinds, history, tally.sum);
    }
    if constexpr (keeps_events<ContactsType>)
      tally.sum.notes.complete([&](NotedContact& note) {
        const std::size_t k = note.place;
        note.first = ends.first(k);
        if constexpr (Ends::at_wall)
          note.event.wall = ends.wall(k);
        else
          note.second = ends.second(k);
        ends.where(k, note);
      });
    if constexpr (Fluxes::active)
      fluxes->add(block, count, table, kinds, losses.data(), growth.data(), ends);
    if (times.record != nullptr) [[unlikely]]
      record(block, count, kinds, history, ends, how);
  }

 private:
  /// Lets the offsets of a block shrink. Contacts shrink theirs only while they store no more than
  /// 2 m* v^2 with v the parting speed, so that a pair of particles gains at most that energy.
  template <class Block, std::size_t H>
  void part(const Block& block, std::size_t count, const std::uint16_t* kinds,
            const std::array<Scalar*, H>& history, detail::Tally<ContactsType>& sum) const {
    constexpr std::size_t W = Lanes<Arch, Scalar>::width;
    Scalar* const offsets = history[ContactsType::offset_from];
    for (std::size_t k = 0; k < count; k += W)
      if (any(load<Real>(offsets + k) > Real(0))) [[unlikely]]
        for (std::size_t lane = k; lane < std::min(k + W, count); ++lane)
          if (offsets[lane] > 0) part_one(block, lane, kinds, history, sum);
  }
  template <class Block, std::size_t H>
  __attribute__((noinline, cold)) void part_one(const Block& block, std::size_t k,
                                                const std::uint16_t* kinds,
                                                const std::array<Scalar*, H>& history,
                                                detail::Tally<ContactsType>& sum) const {
    Scalar& offset = history[ContactsType::offset_from][k];
    const Scalar less = std::min(offset, static_cast<Scalar>(times.parting * times.step));
    using Law = typename ContactsType::Law;
    if constexpr (SaysWhatItStores<Law>) {
      using Kernel = ContactKernel<ContactsType, double>;
      Kinematics<double> kin = in_double(block.template get<Scalar>(k));
      kin.velocity = kin.spin = {0, 0, 0};  // overwritten by loads
      const auto radii = block.template get_radii<Scalar>(k);
      const auto h = history_of<Law>([&](std::size_t n) { return history[n][k]; });
      const auto c = Kernel::contact(
          kin, {static_cast<double>(radii.i), static_cast<double>(radii.j)}, times.step, times.lag);
      const auto stored = stored_by<Law, double>(c, table.law[kinds != nullptr ? kinds[k] : 0], h);
      if (stored.normal > 2 * kin.m_eff * times.parting * times.parting) return;
      // Half for the last step, half for the next, as in the leapfrog's work.
      sum.parted += stored.force * static_cast<double>(less);
    }
    // A contact whose offset is used up continues as an ordinary contact; it does not count as new
    // (ImpactWatch).
    offset = less < offset ? offset - less : Scalar(-1);
  }

  /// Passes the contacts of a block, whose loads are known, to the record: those that touch, and
  /// those with a force at a distance.
  template <class Block, class Ends, class How, std::size_t H>
  __attribute__((noinline, cold)) void record(const Block& block, std::size_t count,
                                              const std::uint16_t* kinds,
                                              const std::array<Scalar*, H>& history,
                                              const Ends& ends, const How& how) const {
    using Kernel = ContactKernel<ContactsType, double>;
    constexpr std::size_t kept = ContactsType::law_history + ContactsType::rolling_history;
    const bool whole = times.record->is_whole();
    std::array<RecordedForce, Block::size> found;
    std::array<RecordedParts, Block::size> parts;
    std::array<RecordedTurn, has_turns<Ends> ? Block::size : 1> turns;
    std::array<double, kept * Block::size + 1> numbers;
    std::size_t n = 0;
    for (std::size_t k = 0; k < count; ++k) {
      Kinematics<double> kin = in_double(block.template get<Scalar>(k));
      const auto load = block.template get_load<Scalar>(k);
      RecordedContact one{};
      one.normal = kin.normal, one.overlap = kin.overlap, one.force = in_double(load.force);
      if (!(kin.overlap > 0) && one.force == Vec3d{0, 0, 0}) continue;
      one.first = ends.first(k), one.order = ends.order(k);
      if constexpr (Ends::at_wall) {
        WallImage image = 0;
        if constexpr (requires { ends.image(k); }) image = ends.image(k);
        one.wall = static_cast<std::uint16_t>(ends.wall(k)), one.surface = ends.surface(k);
        one.second = RecordedForce::at_image(image);
      } else {
        one.second = ends.second(k);
      }
      kin.velocity = kin.spin = {0, 0, 0};  // overwritten by loads
      const auto radii = block.template get_radii<Scalar>(k);
      const Radii<double> both{static_cast<double>(radii.i), static_cast<double>(radii.j)};
      if (whole)
        how.template tell<ContactsType>(Kernel::contact(kin, both, times.step, times.lag),
                                        table.law[kinds != nullptr ? kinds[k] : 0], history, k,
                                        one);
      if constexpr (has_turns<Ends>) {
        turns[n] = {};
        if constexpr (ContactsType::has_rolling) turns[n] = couples_of(kin, both, load, one);
        if constexpr (requires { ends.finish(k, one, turns[n]); }) ends.finish(k, one, turns[n]);
      }
      for (std::size_t h = 0; whole && h < kept; ++h)
        numbers[n * kept + h] = static_cast<double>(history[h][k]);
      if (whole) parts[n] = one;
      found[n++] = one;
    }
    times.record->add({found.data(), n}, {parts.data(), whole ? n : 0},
                      {turns.data(), has_turns<Ends> ? n : 0},
                      {numbers.data(), whole ? kept * n : 0});
  }
  template <class Ends>
  static constexpr bool has_turns = ContactsType::has_rolling ||
                                    requires(const Ends& ends, RecordedContact& c,
                                             RecordedTurn& t) {
    ends.finish(0, c, t);
  };

  /// The couples of a rolling model: the part opposite on the two partners, and the part equal on
  /// both in addition to the moment of the tangential force.
  template <class Load>
  static RecordedTurn couples_of(const Kinematics<double>& kin, const Radii<double>& radii,
                                 const Load& load, const RecordedContact& c) {
    const Vec3d couple = in_double(load.couple);
    RecordedTurn turn{{0, 0, 0}, couple, -couple};
    if constexpr (of_own_rotation<typename ContactsType::Rolling>) {
      const Vec3d more = in_double(load.twirl) - kin.arm * cross(c.force, kin.normal);
      turn.couple_i += radii.i * more, turn.couple_j += radii.j * more;
    }
    return turn;
  }
  static Vec3d in_double(const Vec3<Scalar>& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
  }
  static Kinematics<double> in_double(const Kinematics<Scalar>& k) {
    Kinematics<double> out{};
    out.normal = in_double(k.normal), out.change = in_double(k.change);
    out.overlap = k.overlap, out.R_eff = k.R_eff, out.m_eff = k.m_eff;
    out.inverse_m_eff = k.inverse_m_eff;
    if constexpr (ContactsType::rotates) out.arm = k.arm, out.twist = k.twist;
    return out;
  }
};

}  // namespace silt::detail
