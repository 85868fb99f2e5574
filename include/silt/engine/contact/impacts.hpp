// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <silt/core/dyn_array.hpp>
#include <silt/core/lanes.hpp>
#include <silt/engine/contact/kinematics.hpp>
#include <silt/engine/contact/step_times.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A Contacts type whose contacts report the impacts that may break particles. For breakage by
/// impact speed, the offset (WithOffset) is -1 during contact. For breakage by the largest force
/// one more value is stored: that force [N], negated once its peak has been reported.
template <class ContactsType, bool ByForce>
struct WithImpacts : ContactsType {
  static constexpr bool impacts_by_force = false;
};
template <class ContactsType>
struct WithImpacts<ContactsType, true> : ContactsType {
  static constexpr std::size_t impact_from = ContactsType::history;
  static constexpr std::size_t history = impact_from + 1;
  static constexpr bool impacts_by_force = true;
};
template <class ContactsType>
inline constexpr bool keeps_impacts = requires {
  ContactsType::impacts_by_force;
};

/// An impact that may break a particle.
struct NotedImpact {
  static constexpr std::uint32_t no_row = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t first, second = no_row;  // rows
  std::uint32_t wall = no_row;           // if the partner is a wall
  std::uint32_t kind;                    // index in the coefficient table
  double speed;                          // [m/s] of approach
  double force;                          // [N] for breakage by force; else 0
  double m_eff, R_eff;                   // [kg], [m]
  Vec3d normal;                          // [-] towards the first
  bool is_peak;                          // for breakage by force: the maximum has passed
};

struct NoImpacts {
  template <class Other>
  void add(const Other&) {}
};
/// Impacts of one stage, in the order of its lists.
struct ImpactNotes {
  DynArray<NotedImpact> all;
  void add(const ImpactNotes& more) { all.insert(all.end(), more.all.begin(), more.all.end()); }
};
template <class ContactsType>
using ImpactsOf = std::conditional_t<keeps_impacts<ContactsType>, ImpactNotes, NoImpacts>;

/// Finds the impacts among the contacts of a block.
template <class ContactsType, class Real, class Block>
class ImpactWatch {
  using Scalar = ScalarOf<Real>;
  static constexpr std::size_t W = sizeof(Real) / sizeof(Scalar);

 public:
  /// By impact speed, before loads overwrite the velocities: contacts that begin. `kept`: offsets,
  /// those of ended contacts already reset to 0 (without_offset()).
  template <class Ends>
  static SILT_INLINE void look(const Block& block, std::size_t count, const std::uint16_t* kinds,
                               Scalar* kept, const Ends& ends, ImpactNotes& notes) {
    const Real zero(0), touching(-1);
    for (std::size_t k = 0; k < count; k += W) {
      const Real before = load<Real>(kept + k);
      const auto begins = load<Real>(block.overlap + k) > zero && before == zero;
      if (!any(begins)) [[likely]]
        continue;
      silt::store(kept + k, select(begins, touching, before));
      for (std::uint64_t began = lane_bits(begins); began != 0; began &= began - 1)
        note(block, k + static_cast<std::size_t>(std::countr_zero(began)), kinds, ends, 0, false,
             notes);
    }
  }
  /// By force, after the law: contacts whose force is the largest so far and above `floor` [N], and
  /// those whose force has fallen to half of it.
  template <class Ends>
  static SILT_INLINE void weigh(const Block& block, std::size_t count, const std::uint16_t* kinds,
                                Scalar* kept, double floor, const Ends& ends, ImpactNotes& notes) {
    const Real zero(0), least(static_cast<Scalar>(floor));
    for (std::size_t k = 0; k < count; k += W) {
      const Real last = load<Real>(kept + k), overlap = load<Real>(block.overlap + k);
      const auto touching = overlap > zero;
      if (!any(touching || abs(last) > zero)) continue;
      const Vec3<Real> normal =
          load3<Real>(block.normal[0] + k, block.normal[1] + k, block.normal[2] + k);
      const Real force =
          select(touching, max(dot(block.template get_load<Real>(k).force, normal), zero), zero);
      const Real largest = abs(last);
      const auto rises = force > largest, falls = last > zero && force < Real(Scalar(0.5)) * last;
      silt::store(kept + k,
                  select(touching, select(rises, force, select(falls, -last, last)), zero));
      for (std::uint64_t bits = lane_bits(rises && force > least); bits != 0; bits &= bits - 1)
        note_force(block, k, bits, force, kinds, ends, false, notes);
      for (std::uint64_t bits = lane_bits(falls && largest > zero); bits != 0; bits &= bits - 1)
        note_force(block, k, bits, largest, kinds, ends, true, notes);
    }
  }

 private:
  template <class Ends>
  static void note_force(const Block& block, std::size_t k, std::uint64_t bits, const Real& force,
                         const std::uint16_t* kinds, const Ends& ends, bool is_peak,
                         ImpactNotes& notes) {
    alignas(64) Scalar forces[W];
    silt::store(forces, force);
    const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
    note(block, k + lane, kinds, ends, static_cast<double>(forces[lane]), is_peak, notes);
  }
  template <class Ends>
  __attribute__((noinline)) static void note(const Block& block, std::size_t k,
                                             const std::uint16_t* kinds, const Ends& ends,
                                             double force, bool is_peak, ImpactNotes& notes) {
    const auto at = [k](const auto& columns) {
      return Vec3d{static_cast<double>(columns[0][k]), static_cast<double>(columns[1][k]),
                   static_cast<double>(columns[2][k])};
    };
    NotedImpact one{};
    one.normal = at(block.normal);
    one.speed = force > 0 ? 0 : std::max(-dot(at(block.velocity), one.normal), 0.0);
    one.m_eff = static_cast<double>(block.m_eff[k]);
    one.R_eff = static_cast<double>(block.R_eff[k]);
    one.kind = kinds != nullptr ? kinds[k] : 0, one.force = force, one.is_peak = is_peak;
    one.first = ends.first(k);
    if constexpr (Ends::at_wall)
      one.wall = static_cast<std::uint32_t>(ends.wall(k));
    else
      one.second = ends.second(k);
    notes.all.push_back(one);
  }
};

}  // namespace silt::detail
