// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <array>
#include <cstdint>

#include <silt/core/row8.hpp>
#include <silt/engine/contact/coefficients.hpp>
#include <silt/engine/contact/contact_kernel.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What a step must know of time.
struct StepTimes {
  double step;           // [s]
  double worked;         // of it, that forces have been at work since the last step: 0 at the first
  bool ask;              // contacts what they store (ledger_asks_every)
  double lag = 0.5;      // [steps] by which velocities are older than positions
  double now = 0;        // [s]
  bool watched = false;  // somebody wants to know which contacts begin and end
  // Of contacts that are watched and began before this time [s] force and work are looked at in
  // some steps only, and whether this is one.
  double at_rest_from = -1;
  bool look_at_rest = true;
  static constexpr int at_rest_after = 2000, look_at_rest_every = 8;  // steps
  bool renew_areas = true;  // contacts of smooth bodies find their points anew (contact_area.hpp)
  static constexpr int areas_every = 8;  // steps
};

/// Chunks of four scalars in the row of one contact: force; with rotation torque over radius; with
/// rolling resistance the couple.
template <class ContactsType>
inline constexpr std::size_t load_chunks = 1 + ContactsType::rotates + ContactsType::has_rolling;

/// Writes the loads of a pack of contacts as consecutive rows of 4 * chunks scalars.
template <std::size_t Chunks, class Arch, class Pack>
SILT_INLINE void write_rows(ScalarOf<Pack>* rows, const PairLoad<Pack>& load) {
  constexpr std::size_t W = Lanes<Arch, ScalarOf<Pack>>::width;
  if constexpr (Chunks == 2 && has_row8<Arch, ScalarOf<Pack>> && sizeof(ScalarOf<Pack>) == 4) {
    const Pack force[4] = {load.force.x, load.force.y, load.force.z, Pack(0)};
    const Pack twirl[4] = {load.twirl.x, load.twirl.y, load.twirl.z, Pack(0)};
    Row8<Arch, ScalarOf<Pack>> row[W];
    columns_to_rows<Arch, ScalarOf<Pack>>(force, twirl, row);
    for (std::size_t lane = 0; lane < W; ++lane) row[lane].store(rows + lane * 8);
    return;
  }
  const Vec3<Pack> parts[3] = {load.force, load.twirl, load.couple};
  for (std::size_t c = 0; c < Chunks; ++c) {
    const Pack columns[4] = {parts[c].x, parts[c].y, parts[c].z, Pack(0)};
    Row4<Arch, ScalarOf<Pack>> row[W];
    columns_to_rows<Arch, ScalarOf<Pack>>(columns, row);
    for (std::size_t lane = 0; lane < W; ++lane) row[lane].store(rows + (lane * Chunks + c) * 4);
  }
}

struct NoPacks {};
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
template <class ContactsType, class Real>
class WatchedPacks<ContactsType, Real, NoPacks> {};

/// Law and rolling model on the first `count` contacts (whole packs) of a block, whose kinematics
/// are complete; their loads take the places of the kinematics. `kinds`: the place of each contact
/// in the table, or null if it is the first for all. `history`: one pointer a component. Their
/// energy is added to the tally. `shares`: of each contact's force, or null for all of it.
template <class ContactsType, class Arch, class Block, class Scalar, std::size_t H>
SILT_INLINE void loads_of(Block& block, std::size_t count, const StepTimes& times,
                          const CoefficientTable<ContactsType>& table, const std::uint16_t* kinds,
                          const std::array<Scalar*, H>& history,
                          RunningTally<ContactsType, typename Lanes<Arch, Scalar>::Real>& tally,
                          const Scalar* shares = nullptr) {
  using Real = typename Lanes<Arch, Scalar>::Real;
  using Kernel = ContactKernel<ContactsType, Real>;
  constexpr std::size_t W = Lanes<Arch, Scalar>::width;
  const Real step(static_cast<Scalar>(times.step)), lag(static_cast<Scalar>(times.lag));
  ContactCoefficients<ContactsType, Real> coefficients(table);
  [[maybe_unused]] WatchedPacks<ContactsType, Real,
                                std::conditional_t<keeps_events<ContactsType>, Block, NoPacks>>
      packs;
  if constexpr (keeps_events<ContactsType>)
    packs.look(block, count, times, coefficients, kinds, history);
  for (std::size_t k = 0; k < count; k += W) {
    if (kinds != nullptr) coefficients.choose(kinds + k);
    std::array<Scalar*, H> at{};
    for (std::size_t h = 0; h < ContactsType::history; ++h) at[h] = history[h] + k;
    block.put_load(
        k, Kernel::load(block.template get<Real>(k), block.template get_rolling<Real>(k),
                        block.template get_radii<Real>(k), step, lag, times.ask, coefficients.law(),
                        coefficients.rolling(), at.data(), tally,
                        shares_contacts<ContactsType> && shares != nullptr ? load<Real>(shares + k)
                                                                           : Real(1)));
  }
  if constexpr (keeps_events<ContactsType>)
    packs.watch(block, times, coefficients, kinds, history, tally.sum.notes);
}

/// The loads of a block as consecutive rows.
template <class ContactsType, class Arch, class Block, class Scalar>
SILT_INLINE void write_rows(const Block& block, std::size_t count, Scalar* rows) {
  using Real = typename Lanes<Arch, Scalar>::Real;
  constexpr std::size_t W = Lanes<Arch, Scalar>::width, chunks = load_chunks<ContactsType>;
  for (std::size_t k = 0; k < count; k += W)
    write_rows<chunks, Arch, Real>(rows + k * 4 * chunks, block.template get_load<Real>(k));
}

/// sum += row for the first partner of a contact, or what acts on the second: force and couple with
/// the opposite sign, the twirl (chunk 1) with the same.
template <class Arch, std::size_t Chunks, bool Second, class Scalar>
SILT_INLINE void add_row(Scalar* sum, const Scalar* row) {
  if constexpr (Chunks == 2 && has_row8<Arch, Scalar> && sizeof(Scalar) == 4) {
    using Row = Row8<Arch, Scalar>;
    const auto s = Row::load(sum), r = Row::load(row);
    (Second ? s + Row::of(-1, -1, 1, 1) * r : s + r).store(sum);
  } else {
    using Row = Row4<Arch, Scalar>;
    for (std::size_t c = 0; c < Chunks; ++c) {
      const auto s = Row::load(sum + 4 * c), r = Row::load(row + 4 * c);
      (Second && c != 1 ? s - r : s + r).store(sum + 4 * c);
    }
  }
}

}  // namespace silt::detail
