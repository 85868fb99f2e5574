// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>

#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A Contacts type with contacts that begin with an overlap, because a bond has broken or a
/// particle has broken into fragments. This overlap, the offset, is excluded from the contact. The
/// offset never grows: it is limited to the overlap in each step, so that the contact is an
/// ordinary one once the partners have separated, and it releases no energy that the partners did
/// not put in. Between fragments it also shrinks at the speed StepTimes::parting; the energy of
/// that is Tally::parted.
template <class ContactsType>
struct WithOffset : ContactsType {
  static constexpr std::size_t offset_from = ContactsType::history;
  static constexpr std::size_t history = offset_from + 1;
};
template <class ContactsType>
inline constexpr bool keeps_offset = requires {
  ContactsType::offset_from;
};

/// [m] above any overlap: the offset of a pair whose next overlap is to be excluded.
inline constexpr double whole_overlap = 1e30;

/// The overlaps of a pack of contacts minus their offsets, which are updated. Negative values are
/// not offsets and stay until the partners have separated (ImpactWatch).
template <class Real>
SILT_INLINE Real without_offset(const Real& overlap, ScalarOf<Real>* offsets) {
  const Real zero(0), kept = silt::load<Real>(offsets);
  const Real now = select(overlap > zero, min(kept, overlap), zero);
  if (any(now != kept)) silt::store(offsets, now);
  return overlap - max(now, zero);
}

/// Whether a pair of the inner list has an offset.
template <class ContactsType, class PairList>
bool any_offset([[maybe_unused]] const PairList& pairs) {
  bool any = false;
  if constexpr (keeps_offset<ContactsType>)
    pairs.for_each([&](std::size_t k) { any |= pairs.history(ContactsType::offset_from, k) != 0; });
  return any;
}

/// [m] offset of the pair at place k of the inner list.
template <class EngineType>
double offset_of_pair([[maybe_unused]] const EngineType& e, [[maybe_unused]] std::size_t k) {
  using C = typename EngineType::Contacts;
  if constexpr (keeps_offset<C>)
    return std::max(static_cast<double>(e.lists.pairs.history(C::offset_from, k)), 0.0);
  else
    return 0;
}

}  // namespace silt::detail
