// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <silt/core/threads.hpp>
#include <silt/engine/contact/coefficients.hpp>
#include <silt/engine/contact/contact_kernel.hpp>
#include <silt/engine/contact/step_times.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The packs of a block that have something to be watched (ContactWatch): what of their kinematics
/// the loads take the places of is set aside before the law, so that its loop is the same for all.
template <class ContactsType, class Real, class Block>
class WatchedPacks {
  using Kernel = ContactKernel<ContactsType, Real>;
  using Watch = ContactWatch<ContactsType, Real>;
  static constexpr std::size_t W = sizeof(Real) / sizeof(ScalarOf<Real>);

 public:
  template <std::size_t H>
  void look(const Block& block, std::size_t count, const StepTimes& times,
            ContactCoefficients<ContactsType, Real> coefficients, const std::uint16_t* kinds,
            const std::array<ScalarOf<Real>*, H>& history) {
    for (std::size_t k = 0; k < count; k += W) {
      if (kinds != nullptr && ActsAtDistance<typename ContactsType::Law>)
        coefficients.choose(kinds + k);
      const auto kinematics = block.template get<Real>(k);
      if (!Watch::is_due(Kernel::acting(kinematics, coefficients.law()),
                         history[ContactsType::events_from + WatchedNumbers::begin] + k, times))
        continue;
      which_[packs_++] = static_cast<std::uint16_t>(k);
      before_.put(k, kinematics), before_.put(k, block.template get_rolling<Real>(k));
    }
  }
  /// After the law.
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

/// How contacts act that touch in a point: law and rolling model there.
template <class Scalar>
struct AtOnePoint {
  const Scalar* shares = nullptr;  // [-] of each contact's force (SharedContacts); null: all of it

  /// Loads of the first `count` contacts (whole packs) of a block; they take the places of the
  /// kinematics.
  template <class ContactsType, class Arch, class Block, std::size_t H>
  SILT_INLINE void loads(
      Block& block, std::size_t count, const StepTimes& times,
      const CoefficientTable<ContactsType>& table, const std::uint16_t* kinds,
      const std::array<Scalar*, H>& history,
      RunningTally<ContactsType, typename Lanes<Arch, Scalar>::Real>& tally) const {
    using Real = typename Lanes<Arch, Scalar>::Real;
    using Kernel = ContactKernel<ContactsType, Real>;
    constexpr std::size_t W = Lanes<Arch, Scalar>::width;
    const Real step(static_cast<Scalar>(times.step)), lag(static_cast<Scalar>(times.lag));
    ContactCoefficients<ContactsType, Real> coefficients(table);
    struct Nothing {};
    [[maybe_unused]] std::conditional_t<keeps_events<ContactsType>,
                                        WatchedPacks<ContactsType, Real, Block>, Nothing>
        packs;
    if constexpr (keeps_events<ContactsType>)
      packs.look(block, count, times, coefficients, kinds, history);
    for (std::size_t k = 0; k < count; k += W) {
      if (kinds != nullptr) coefficients.choose(kinds + k);
      std::array<Scalar*, H> at{};
      for (std::size_t h = 0; h < ContactsType::history; ++h) at[h] = history[h] + k;
      const Real share =
          shares_contacts<ContactsType> && shares != nullptr ? load<Real>(shares + k) : Real(1);
      block.put_load(
          k, Kernel::load(block.template get<Real>(k), block.template get_rolling<Real>(k),
                          block.template get_radii<Real>(k), step, lag, times.ask,
                          coefficients.law(), coefficients.rolling(), at.data(), tally, share));
    }
    if constexpr (keeps_events<ContactsType>)
      packs.watch(block, times, coefficients, kinds, history, tally.sum.notes);
  }
};

/// The contact stage, one for all geometries: spheres and convex parts, at each other and at walls,
/// fill a block with kinematics, and here the contacts get their loads, the ledger its energies,
/// events their begins and ends, modules their fluxes. What the loads then do to bodies and walls
/// is the geometry's again, as it knows the arms.
template <class ContactsType, class Arch, class Scalar, class Fluxes>
struct ContactStage {
  using Real = typename Lanes<Arch, Scalar>::Real;
  using Tally = RunningTally<ContactsType, Real>;

  const StepTimes& times;
  const CoefficientTable<ContactsType>& table;
  Fluxes* fluxes;  // of modules, if there are any

  /// The first `count` contacts of a block, whose last pack is filled up with what does not touch.
  /// `kinds`: the place of each in the table of coefficients, or null if it is the first for all.
  /// `history`: one pointer a component. `ends` knows whose they are: first(k) [row], and second(k)
  /// [row] or wall(k) by its at_wall; where(k, note) completes a begin or end by its place.
  /// `how`: AtOnePoint, or AtAreaPoints (convex/contact_area.hpp).
  template <class Block, class Ends, class How, std::size_t H>
  SILT_INLINE void run(Block& block, std::size_t count, const std::uint16_t* kinds,
                       const std::array<Scalar*, H>& history, const Ends& ends, Tally& tally,
                       const How& how) const {
    constexpr std::size_t W = Lanes<Arch, Scalar>::width;
    how.template loads<ContactsType, Arch>(block, pieces(count, W) * W, times, table, kinds,
                                           history, tally);
    tally.end_block();
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
    if constexpr (Fluxes::active) fluxes->add(block, count, ends);
  }
};

}  // namespace silt::detail
