// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of ConvexPairs: which pairs are apart, by tests that are cheaper than finding contacts.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <silt/engine/convex/convex_pairs.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Rows, class ContactsType, class Domain, class Arch, class Fluxes>
inline void ConvexPairs<Rows, ContactsType, Domain, Arch, Fluxes>::sort_out(
    const Scene& scene, std::size_t from, std::size_t count, ByKind& near, ByKind& open,
    Tally<ContactsType>& tally) {
  const auto difference = Row4<Arch>::of(-1, -1, -1, 1);
  const Real zero(0), step(gap_slack * scene.in.times.step);
  double* const gaps = scene.list.history(radius);
  for (std::size_t k = from; k < from + count; k += W) {
    const std::uint32_t *const a = scene.list.first() + k, *const b = scene.list.second() + k;
    const std::uint64_t lanes = valid_lanes<W>(from + count - k);
    const Real kept = load<Real>(gaps + k);
    const std::uint64_t touched = lane_bits(kept > zero) & lanes;
    std::uint64_t closed = 0;  // lanes that need no test
    if (const auto resting = kept < zero; any(resting)) {
      const Real left = kept + step * approach(scene.in, a, b);
      closed = lane_bits(left < zero) & lane_bits(resting) & lanes;
      store(gaps + k, select(resting, min(left, zero), kept));
    }
    if ((closed | ~lanes) == ~std::uint64_t{0}) continue;

    Row4<Arch> rows[W];
    SILT_UNROLL
    for (std::size_t lane = 0; lane < W; ++lane)
      rows[lane] = Row4<Arch>::load(&scene.in.positions[b[lane]].x) +
                   difference * Row4<Arch>::load(&scene.in.positions[a[lane]].x);
    Real columns[4];
    rows_to_columns<Arch>(rows, columns);
    Vec3<Real> d{columns[0], columns[1], columns[2]};
    if constexpr (Domain::periodic) d = scene.domain.shortest(d);
    const Real distance2 = dot(d, d), reach = columns[3];
    const std::uint64_t within = lane_bits(distance2 < reach * reach);
    alignas(64) double x[3][W], gap[W];
    store(x[0], d.x), store(x[1], d.y), store(x[2], d.z), store(gap, sqrt(distance2) - reach);
    for (std::uint64_t bits = lanes & ~closed; bits != 0; bits &= bits - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
      const std::uint64_t bit = bits & -bits;
      if (within & bit)
        (touched & bit ? open : near).add(scene, k + lane, x, lane);
      else
        part(scene, k + lane, gap[lane], touched & bit, tally);
    }
  }
}

template <class Rows, class ContactsType, class Domain, class Arch, class Fluxes>
template <std::size_t A, std::size_t B, Exponents E>
inline void ConvexPairs<Rows, ContactsType, Domain, Arch, Fluxes>::prove_apart(
    const Scene& scene, const Some& near, std::size_t count, Some& open,
    Tally<ContactsType>& tally) {
  for (std::size_t k = 0; k < count; k += W) {
    const std::size_t valid = std::min(W, count - k);
    alignas(64) double x[3][W], gap[W];
    const Vec3<Real> d = near.template between_at<Real>(k);
    store(x[0], d.x), store(x[1], d.y), store(x[2], d.z);
    if constexpr (Touch::template in_lanes<A, B>)
      store(gap, least_gap(Touch::template posed<A, B, E>(scene.in, near, k,
                                                          Gather::axes_pack(scene.in, near.i + k),
                                                          Gather::axes_pack(scene.in, near.j + k)),
                           Kept::memory_of(scene.list, near.place + k)));
    else
      for (std::size_t lane = 0; lane < valid; ++lane)
        Touch::template with_placed<A, B>(
            scene.in, near, k + lane, [&](const auto& i, const auto& j) {
              gap[lane] = least_gap_of(i, j, Kept::memory_at(scene.list, near.place[k + lane]));
            });
    for (std::size_t lane = 0; lane < valid; ++lane)
      if (gap[lane] > 0)
        part(scene, near.place[k + lane], gap[lane], false, tally);
      else
        open.add(near.place[k + lane], near.i[k + lane], near.j[k + lane], x, lane);
  }
}

template <class Rows, class ContactsType, class Domain, class Arch, class Fluxes>
inline void ConvexPairs<Rows, ContactsType, Domain, Arch, Fluxes>::part(
    const Scene& scene, std::size_t place, double gap, bool touched,
    [[maybe_unused]] Tally<ContactsType>& tally) {
  List& list = scene.list;
  if constexpr (keeps_events<ContactsType>)
    if (touched) {
      NotedContact note;
      note.first = list.first()[place], note.second = list.second()[place];
      const PositionRow &a = scene.in.positions[note.first], &b = scene.in.positions[note.second];
      Vec3d between = a.centre() - b.centre();
      Vec3d velocity =
          scene.in.motions[note.first].velocity() - scene.in.motions[note.second].velocity();
      if constexpr (Domain::periodic) {
        const Vec3d whole = between;
        between = scene.domain.shortest(between);
        if constexpr (deforms<Domain>) velocity -= scene.domain.carried(whole - between);
      }
      note.event.normal = between * (1 / norm(between));
      note.event.point = a.centre() - (a.r + 0.5 * gap) * note.event.normal;
      end_watched<ContactsType>(
          [&](std::size_t k) -> double& { return list.history(events + k)[place]; }, velocity,
          scene.in.times, note, tally.notes);
    }
  if constexpr (keeps_offset<ContactsType>) list.history(ContactsType::offset_from)[place] = 0;
  if (touched) list.forget_contact(place, M);
  list.history(radius)[place] = gap > 0 ? -gap : 0;
}

}  // namespace silt::detail
