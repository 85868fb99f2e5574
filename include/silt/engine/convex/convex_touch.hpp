// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include <silt/engine/convex/contact_area.hpp>
#include <silt/engine/convex/convex_gather.hpp>
#include <silt/shape/narrow/solid_pairs.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A batch of pairs of convex parts.
template <std::size_t Room, std::size_t W>
struct SomePairs {
  static constexpr std::size_t room = Room + W;
  std::size_t count = 0;
  std::uint32_t place[room];            // in the list
  std::uint32_t i[room], j[room];       // rows
  alignas(64) double between[3][room];  // [m] from the centre of i to that of j

  template <std::size_t N>
  void add(std::uint32_t k, std::uint32_t a, std::uint32_t b, const double (&x)[3][N],
           std::size_t lane, double sign = 1) {
    place[count] = k, i[count] = a, j[count] = b;
    for (int c = 0; c < 3; ++c) between[c][count] = sign * x[c][lane];
    ++count;
  }
  /// Pads the last pack with copies of its last pair.
  void pad() {
    for (std::size_t k = count; k % W != 0; ++k) {
      place[k] = place[count - 1], i[k] = i[count - 1], j[k] = j[count - 1];
      for (auto& c : between) c[k] = c[count - 1];
    }
  }
  /// Removes the first `done` pairs.
  void drop(std::size_t done) {
    if (done == 0) return;
    const auto shift = [&](auto& of) { std::copy(of + done, of + count, of); };
    shift(place), shift(i), shift(j);
    for (auto& c : between) shift(c);
    count -= done;
  }
  template <class Real>
  SILT_INLINE Vec3<Real> between_at(std::size_t k) const {
    return load3<Real>(between[0] + k, between[1] + k, between[2] + k);
  }
};

/// N contacts: the results of the narrow phase, then kinematics and loads.
template <class ContactsType, std::size_t N>
struct ConvexSlice {
  KinematicsBlock<ContactsType, N, double> kinematics;
  alignas(64) double history[ContactsType::history + 1][N];
  alignas(64) double arm_i[3][N];             // [m] of the contact point from the centre of i
  alignas(64) double last[3][N];              // direction in the last step, as stored
  alignas(64) double followed[N];             // the body it follows; 0: no contact in the last step
  alignas(64) double gradient[N], couple[N];  // of SolidContact
  std::uint16_t kind[N];
  static constexpr bool has_area = ContactsType::points > 1;
  AreaBlock<has_area ? N : 1> area;
};

/// The narrow phase of pairs of convex parts: kernels in lanes, or pair by pair. In lanes all pairs
/// get one Newton step; the few that do not converge are then processed together in packs of their
/// own.
template <class Rows, class ContactsType, class List, std::size_t N, class Arch>
struct ConvexTouch {
  using Real = typename Lanes<Arch>::Real;
  using Gather = ConvexGather<Rows, Arch>;
  using Kept = KeptGather<List, ContactsType, Arch>;
  using Memory = typename Kept::Memory;
  using Slice = ConvexSlice<ContactsType, N>;
  using Input = ConvexInput<Rows>;
  template <std::size_t K, Exponents E>
  using FormOf = typename Gather::template FormOf<K, E>;
  template <std::size_t K>
  using KernelAt = KernelOf<typename Rows::template KindAt<K>>;
  template <std::size_t A, std::size_t B>
  static constexpr bool in_lanes = KernelAt<A>::in_lanes&& KernelAt<B>::in_lanes;
  static constexpr std::size_t W = Lanes<Arch>::width, M = ContactsType::memory_from,
                               radius = ContactsType::memory_radius;

  /// Whether the contacts of two kinds have an area. Ellipsoids touch at points, as balls do.
  template <std::size_t A, std::size_t B, Exponents E>
  static constexpr bool has_area =
      has_flats<typename Rows::template KindAt<A>>&& has_flats<typename Rows::template KindAt<B>> &&
      (!in_lanes<A, B> || E > Exponents::Two);

  /// Contacts of the `count` pairs from `from` on, whose last pack is padded. Writes into the
  /// slice: normal, overlap, R_eff, arm_i, last, followed, gradient, couple, history and memory.
  template <std::size_t A, std::size_t B, Exponents E, class Some>
  static void run(const Input& in, List& list, const Some& some, std::size_t from,
                  std::size_t count, Slice& out) {
    if constexpr (in_lanes<A, B>) {
      std::uint16_t open[N + W];
      std::size_t left = 0;
      for (std::size_t k = 0; k < count; k += W) {
        const BodyAxes<Real> turn_i = Gather::axes_pack(in, some.i + from + k),
                             turn_j = Gather::axes_pack(in, some.j + from + k);
        Memory memory =
            recall<has_area<A, B, E>>(list, some.place + from + k, turn_i, turn_j, k, out);
        const auto pair = posed<A, B, E>(in, some, from + k, turn_i, turn_j);
        const auto found = first_step(
            pair, load3<Real>(out.last[0] + k, out.last[1] + k, out.last[2] + k), memory);
        put<has_area<A, B, E>>(pair, found, memory, k,
                               in.times.renew_areas || any_is_new<has_area<A, B, E>>(out, k), out);
        std::uint64_t bits = ~lane_bits(found.solved);
        bits &= (std::uint64_t{1} << std::min(W, count - k)) - 1;
        for (; bits != 0; bits &= bits - 1)
          open[left++] = static_cast<std::uint16_t>(k + std::countr_zero(bits));
      }
      for (std::size_t k = left; k % W != 0; ++k) open[k] = open[left - 1];
      for (std::size_t k = 0; k < left; k += W)
        go_on<A, B, E>(in, some, from, open + k, std::min(W, left - k), out);
    } else {
      for (std::size_t k = 0; k < count; k += W)
        recall<has_area<A, B, E>>(list, some.place + from + k,
                                  Gather::axes_pack(in, some.i + from + k),
                                  Gather::axes_pack(in, some.j + from + k), k, out);
      for (std::size_t k = 0; k < count; ++k)
        with_placed<A, B>(in, some, from + k, [&](const auto& i, const auto& j) {
          auto memory = memory_at(out, k);
          const SolidContact c = touch_solids(i, j, memory);
          put(c, memory, k, out);
          // The last pair pads the last pack: inactive lanes must compute finite values.
          if (k + 1 == count)
            for (std::size_t more = count; more % W != 0; ++more) put(c, memory, more, out);
        });
    }
  }

  template <std::size_t A, std::size_t B, Exponents E, class Some>
  static SILT_INLINE PosedPair<FormOf<A, E>, FormOf<B, E>> posed(const Input& in, const Some& some,
                                                                 std::size_t k,
                                                                 const BodyAxes<Real>& turn_i,
                                                                 const BodyAxes<Real>& turn_j) {
    return {Gather::template form_pack<A, E>(in, some.i + k),
            Gather::template form_pack<B, E>(in, some.j + k), turn_i, turn_j,
            some.template between_at<Real>(k)};
  }
  /// Calls visit(i, j) for one pair, with the centre of i as origin.
  template <std::size_t A, std::size_t B, class Some, class Visit>
  static void with_placed(const Input& in, const Some& some, std::size_t k, const Visit& visit) {
    const auto& rows = *in.rows;
    visit(rows.template placed<A>(some.i[k], {0, 0, 0}),
          rows.template placed<B>(some.j[k],
                                  {some.between[0][k], some.between[1][k], some.between[2][k]}));
  }

 private:
  /// Copies the history of a pack of pairs into the slice.
  template <bool HasArea>
  static SILT_INLINE Memory recall(List& list, const std::uint32_t* place,
                                   const BodyAxes<Real>& turn_i, const BodyAxes<Real>& turn_j,
                                   std::size_t k, Slice& out) {
    Real numbers[4 * Kept::chunks];
    Memory memory;
    Kept::kept_of(list, place, numbers, memory);
    memory.R_eff = max(memory.R_eff, Real(0));  // negative: a gap
    for (std::size_t h = 0; h < M; ++h) store(out.history[h] + k, numbers[h]);
    if constexpr (HasArea) {
      Real more[4 * Kept::more_chunks];
      Kept::more_of(list, place, more);
      for (std::size_t h = Kept::first; h < radius; ++h)
        store(out.history[h] + k, more[h - Kept::first]);
    }
    keep(memory, k, out);
    const auto with_i = memory.follows > Real(0);
    const BodyAxes<Real> turn{select(with_i, turn_i.x, turn_j.x),
                              select(with_i, turn_i.y, turn_j.y),
                              select(with_i, turn_i.z, turn_j.z)};
    const Vec3<Real> last = turn.to_space(memory.direction);
    store(out.last[0] + k, last.x), store(out.last[1] + k, last.y), store(out.last[2] + k, last.z);
    store(out.followed + k, select(memory.R_eff > Real(0), memory.follows, Real(0)));
    return memory;
  }
  /// Whether any of a pack's contacts has no area points yet.
  template <bool HasArea>
  static SILT_INLINE bool any_is_new([[maybe_unused]] const Slice& slice,
                                     [[maybe_unused]] std::size_t k) {
    if constexpr (HasArea) {
      const auto* const way = slice.history + ContactsType::frame_from;
      const Vec3<Real> t = load3<Real>(way[0] + k, way[1] + k, way[2] + k);
      return any(!(dot(t, t) > Real(0.5)));
    }
    return false;
  }
  template <std::size_t Slots>
  static SILT_INLINE void keep(const Memory& memory, std::size_t k,
                               ConvexSlice<ContactsType, Slots>& out) {
    store(out.history[M] + k, memory.direction.x),
        store(out.history[M + 1] + k, memory.direction.y);
    store(out.history[M + 2] + k, memory.direction.z),
        store(out.history[M + 3] + k, memory.follows);
    store(out.history[radius] + k, memory.R_eff);
  }
  static NormalMemory<double> memory_at(const Slice& slice, std::size_t k) {
    const auto& h = slice.history;
    return {{h[M][k], h[M + 1][k], h[M + 2][k]}, h[M + 3][k], h[radius][k]};
  }

  template <class FormI, class FormJ>
  static SILT_INLINE BodyContact<Real> first_step(const PosedPair<FormI, FormJ>& pair,
                                                  const Vec3<Real>& last, Memory& memory) {
    if constexpr (are_balls<FormI, FormJ>)
      return touch(pair, memory);
    else
      return touch_from<ContactRadius::AtFirstTouch, false>(pair, last, memory);
  }

  /// Copies the results of the lanes into the slice, with the stored values: R_eff, or minus the
  /// gap where they do not touch.
  template <bool HasArea, class Pair, std::size_t Slots>
  static SILT_INLINE void put([[maybe_unused]] const Pair& pair, const BodyContact<Real>& found,
                              Memory& memory, std::size_t k, [[maybe_unused]] bool renew_area,
                              ConvexSlice<ContactsType, Slots>& out) {
    if constexpr (HasArea)
      if (renew_area) out.area.put_spread(k, spread_of(pair, found));
    const Real gap = min(found.overlap, Real(0));
    memory.R_eff = select(found.solved, select(found.touches, memory.R_eff, gap), memory.R_eff);
    auto& kin = out.kinematics;
    const auto put3 = [&](double(*to)[Slots], const Vec3<Real>& v) {
      store(to[0] + k, v.x), store(to[1] + k, v.y), store(to[2] + k, v.z);
    };
    put3(kin.normal, found.normal), put3(out.arm_i, found.point);
    store(kin.overlap + k, found.overlap), store(kin.R_eff + k, found.R_eff);
    store(out.gradient + k, Real(1)), store(out.couple + k, Real(0));
    keep(memory, k, out);
  }
  static void put(const SolidContact& found, const NormalMemory<double>& memory, std::size_t k,
                  Slice& out) {
    auto& kin = out.kinematics;
    const auto put3 = [&](double(*to)[N], const Vec3d& v) {
      to[0][k] = v.x, to[1][k] = v.y, to[2][k] = v.z;
    };
    put3(kin.normal, found.normal), put3(out.arm_i, found.point);
    kin.overlap[k] = found.overlap, kin.R_eff[k] = found.R_eff;
    out.gradient[k] = found.gradient, out.couple[k] = found.couple;
    if constexpr (Slice::has_area) out.area.put_spread(k, found.spread);
    auto& h = out.history;
    h[M][k] = memory.direction.x, h[M + 1][k] = memory.direction.y;
    h[M + 2][k] = memory.direction.z, h[M + 3][k] = memory.follows;
    h[radius][k] = found.overlap > 0 ? memory.R_eff : std::min(found.overlap, 0.0);
  }

  /// Continues the iteration for up to one pack of a slice's contacts (`which`) from their present
  /// directions.
  template <std::size_t A, std::size_t B, Exponents E, class Some>
  static void go_on(const Input& in, const Some& some, std::size_t from, const std::uint16_t* which,
                    std::size_t valid, Slice& slice) {
    SomePairs<W, 0> few;
    alignas(64) double normal[3][W], kept[5][W];  // NormalMemory
    for (std::size_t lane = 0; lane < W; ++lane) {
      const std::size_t k = which[lane];
      few.add(0, some.i[from + k], some.j[from + k], some.between, from + k);
      for (int c = 0; c < 3; ++c) normal[c][lane] = slice.kinematics.normal[c][k];
      for (int h = 0; h < 4; ++h) kept[h][lane] = slice.history[M + h][k];
      kept[4][lane] = slice.history[radius][k];
    }
    Memory memory{load3<Real>(kept[0], kept[1], kept[2]), load<Real>(kept[3]), load<Real>(kept[4])};
    const auto pair =
        posed<A, B, E>(in, few, 0, Gather::axes_pack(in, few.i), Gather::axes_pack(in, few.j));
    ConvexSlice<ContactsType, W> one;
    if constexpr (are_balls<FormOf<A, E>, FormOf<B, E>>)
      put<has_area<A, B, E>>(pair, touch(pair, memory), memory, 0, true, one);
    else
      put<has_area<A, B, E>>(pair,
                             touch_from<ContactRadius::AtFirstTouch, true>(
                                 pair, -load3<Real>(normal[0], normal[1], normal[2]), memory),
                             memory, 0, true, one);
    for (std::size_t lane = 0; lane < valid; ++lane) {
      const std::size_t k = which[lane];
      auto& from_k = one.kinematics;
      auto& to = slice.kinematics;
      for (int c = 0; c < 3; ++c) {
        to.normal[c][k] = from_k.normal[c][lane];
        slice.arm_i[c][k] = one.arm_i[c][lane];
      }
      to.overlap[k] = from_k.overlap[lane], to.R_eff[k] = from_k.R_eff[lane];
      for (std::size_t h = M; h < ContactsType::memory_to; ++h)
        slice.history[h][k] = one.history[h][lane];
      slice.history[radius][k] = one.history[radius][lane];
      if constexpr (has_area<A, B, E>)
        for (std::size_t c = 0; c < 6; ++c) slice.area.spread[c][k] = one.area.spread[c][lane];
    }
  }
};

}  // namespace silt::detail
