// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include <silt/engine/convex_gather.hpp>
#include <silt/engine/load_rows.hpp>
#include <silt/engine/pair_list.hpp>
#include <silt/shape/narrow/solid_pairs.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Computes the loads of all pairs of convex parts, block by block. The lists are of bounding
/// spheres; of a block's pairs, each stage takes only those on that the one before could not prove
/// apart, again in whole packs, pairs of the same two kinds together:
///   the gap that was found last, less what speeds and spins may have closed since; bounding
///   spheres; separation along the last normal (least_gap()); contact (touch()); law; loads.
/// Of two kinds the first in KindList is i, else the particle with the lower id. What a pair keeps
/// behind the law's history: NormalMemory, whose last number, R_eff while the bodies touch, is
/// minus a lower bound of the gap while they do not.
template <class Rows, class ContactsType, class Domain, class Arch>
class ConvexPairs {
  using Real = typename Lanes<Arch>::Real;
  using List = PairList<ContactsType::history, double>;
  using Gather = ConvexGather<Rows, List, ContactsType::memory_from, Arch>;
  using Memory = typename Gather::Memory;
  template <std::size_t K, Exponents E>
  using FormOf = typename Gather::template FormOf<K, E>;
  using Kinds = typename Rows::Kinds;
  static constexpr std::size_t W = Lanes<Arch>::width;
  static constexpr std::size_t kind_count = Kinds::count,
                               pair_kinds = kind_count * (kind_count + 1) / 2;
  static constexpr std::size_t block = kind_count > 1 ? 256 : 128, chunks = 2, row = 4 * chunks;
  static constexpr std::size_t H = ContactsType::history, M = ContactsType::memory_from,
                               radius = ContactsType::memory_radius;
  static_assert(load_chunks<ContactsType> == chunks,
                "rolling resistance is of spheres and of bodies made of spheres: the shape of "
                "others resists rolling itself");
  static_assert(!ActsAtDistance<typename ContactsType::Law>,
                "laws that act at a distance are for spheres and bodies made of spheres");
  template <std::size_t K>
  using KernelAt = KernelOf<typename Rows::template KindAt<K>>;
  template <std::size_t A, std::size_t B>
  static constexpr bool in_lanes = KernelAt<A>::in_lanes&& KernelAt<B>::in_lanes;
  /// Overlaps of polyhedra are no depths: see SolidContact.
  template <std::size_t A, std::size_t B>
  static constexpr bool has_gradient =
      std::is_same_v<typename Rows::template KindAt<A>, Polyhedron>&& A == B;

 public:
  using Input = ConvexInput<Rows>;

  /// Adds the load of every pair to the sums of its bodies: force, and torque about the centre.
  static Tally<ContactsType> run(const Input& in, List& list,
                                 const CoefficientTable<ContactsType>& table, const Domain& domain,
                                 double* sums, const Team& team) {
    return sum_over_groups<Tally<ContactsType>>(list, team, [&](std::size_t from, std::size_t to) {
      return run_group({in, list, table, domain, sums}, from, to);
    });
  }

 private:
  struct Scene {
    const Input& in;
    List& list;
    const CoefficientTable<ContactsType>& table;
    const Domain& domain;
    double* sums;
  };

  /// Some pairs of a block.
  struct Some {
    std::size_t count = 0;
    std::uint32_t place[block + W];            // in the list
    std::uint32_t i[block + W], j[block + W];  // rows
    alignas(64) double between[3][block + W];  // [m] from the centre of i to that of j
    void add(std::uint32_t k, std::uint32_t a, std::uint32_t b, const double (&x)[3][W],
             std::size_t lane, double sign = 1) {
      place[count] = k, i[count] = a, j[count] = b;
      for (int c = 0; c < 3; ++c) between[c][count] = sign * x[c][lane];
      ++count;
    }
    /// Fills the last pack with its last pair.
    void pad() {
      for (std::size_t k = count; k % W != 0; ++k) {
        place[k] = place[count - 1], i[k] = i[count - 1], j[k] = j[count - 1];
        for (auto& c : between) c[k] = c[count - 1];
      }
    }
    SILT_INLINE Vec3<Real> between_at(std::size_t k) const {
      return load3<Real>(between[0] + k, between[1] + k, between[2] + k);
    }
  };
  /// By the kinds of i and j.
  struct ByKind {
    Some of[pair_kinds];
    void clear() {
      for (Some& some : of) some.count = 0;
    }
    static constexpr std::size_t at(std::size_t a, std::size_t b) {  // a <= b
      return a * kind_count - a * (a + 1) / 2 + b;
    }
    void add(const Scene& scene, std::size_t k, const double (&x)[3][W], std::size_t lane) {
      const std::uint32_t a = scene.list.first()[k], b = scene.list.second()[k];
      const std::size_t p = scene.in.rows->kind_of(a), q = scene.in.rows->kind_of(b);
      if (p <= q)
        of[at(p, q)].add(static_cast<std::uint32_t>(k), a, b, x, lane);
      else
        of[at(q, p)].add(static_cast<std::uint32_t>(k), b, a, x, lane, -1);
    }
  };

  static Tally<ContactsType> run_group(const Scene& scene, std::size_t from, std::size_t to) {
    RunningTally<ContactsType, Real> tally;
    ByKind near, open;
    for (; from < to; from += block) {
      near.clear(), open.clear();
      sort_out(scene, from, std::min(block, to - from), near, open);
      for_all_kinds<0, 0>([&]<std::size_t A, std::size_t B>() {
        run_kinds<A, B>(scene, near.of[ByKind::at(A, B)], open.of[ByKind::at(A, B)], tally);
      });
    }
    return tally.end();
  }
  template <std::size_t A, std::size_t B, class Run>
  static void for_all_kinds(const Run& run) {
    run.template operator()<A, B>();
    if constexpr (B + 1 < kind_count)
      for_all_kinds<A, B + 1>(run);
    else if constexpr (A + 1 < kind_count)
      for_all_kinds<A + 1, A + 1>(run);
  }
  template <std::size_t A, std::size_t B>
  static void run_kinds(const Scene& scene, Some& near, Some& open,
                        RunningTally<ContactsType, Real>& tally) {
    if (near.count + open.count == 0) return;
    const auto run = [&](auto e) {
      constexpr Exponents E = decltype(e)::value;
      near.pad();
      prove_apart<A, B, E>(scene, near, open);
      open.pad();
      if (open.count > 0) run_contacts<A, B, E>(scene, open, tally);
    };
    if constexpr (kind_count == 1 && in_lanes<A, B>)
      with_exponents(scene.in.rows->exponents, run);
    else  // not each kernel for each pair of kinds: that would be long to compile
      run(std::integral_constant<Exponents, Exponents::Any>{});
  }

  /// Sorts pairs: those that touched are open; of the others those whose gap is used up and whose
  /// bounding spheres overlap are near.
  static void sort_out(const Scene& scene, std::size_t from, std::size_t count, ByKind& near,
                       ByKind& open) {
    const auto difference = Row4<Arch>::of(-1, -1, -1, 1);
    const Real zero(0), step(gap_slack * scene.in.times.step);
    double* const gaps = scene.list.history(radius);
    for (std::size_t k = from; k < from + count; k += W) {
      const std::uint32_t *const a = scene.list.first() + k, *const b = scene.list.second() + k;
      const std::uint64_t lanes = valid_lanes(from + count - k);
      const Real kept = load<Real>(gaps + k);
      const std::uint64_t touched = lane_bits(kept > zero) & lanes;
      std::uint64_t closed = 0;  // lanes that need no look
      if (const auto resting = kept < zero; any(resting)) {
        const Real left = kept + step * approach(scene.in, a, b);
        closed = lane_bits(left < zero) & lane_bits(resting) & lanes;
        store(gaps + k, select(resting, min(left, zero), kept));
      }
      if ((closed | ~lanes) == ~std::uint64_t{0}) continue;

      Row4<Arch> rows[W];
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
          part(scene.list, k + lane, gap[lane], touched & bit);
      }
    }
  }

  /// Of the near pairs those that the last normal does not prove to be apart.
  template <std::size_t A, std::size_t B, Exponents E>
  static void prove_apart(const Scene& scene, const Some& near, Some& open) {
    for (std::size_t k = 0; k < near.count; k += W) {
      const std::size_t valid = std::min(W, near.count - k);
      alignas(64) double x[3][W], gap[W];
      const Vec3<Real> d = near.between_at(k);
      store(x[0], d.x), store(x[1], d.y), store(x[2], d.z);
      if constexpr (in_lanes<A, B>)
        store(gap, least_gap(posed<A, B, E>(scene, near, k),
                             Gather::memory_of(scene.list, near.place + k)));
      else
        for (std::size_t lane = 0; lane < valid; ++lane)
          with_placed<A, B>(scene, near, k + lane, [&](const auto& i, const auto& j) {
            gap[lane] = least_gap_of(i, j, Gather::memory_at(scene.list, near.place[k + lane]));
          });
      for (std::size_t lane = 0; lane < valid; ++lane)
        if (gap[lane] > 0)
          part(scene.list, near.place[k + lane], gap[lane], false);
        else
          open.add(near.place[k + lane], near.i[k + lane], near.j[k + lane], x, lane);
    }
  }

  /// Notes the gap [m] of a pair that does not touch; one that did loses its history.
  static void part(List& list, std::size_t place, double gap, bool touched) {
    if (touched)
      for (std::size_t h = 0; h < M; ++h) list.history(h)[place] = 0;
    list.history(radius)[place] = gap > 0 ? -gap : 0;
  }

  /// How fast [m/s] the gap of each pair may shrink: bodies turn about their centres within their
  /// bounding spheres, whose radius is in the spin velocity.
  static SILT_INLINE Real approach(const Input& in, const std::uint32_t* a,
                                   const std::uint32_t* b) {
    const double* at[W];
    Real i[8], j[8];
    for (std::size_t lane = 0; lane < W; ++lane) at[lane] = &in.motions[a[lane]].vx;
    gather_columns<Arch, 2>(at, i);
    for (std::size_t lane = 0; lane < W; ++lane) at[lane] = &in.motions[b[lane]].vx;
    gather_columns<Arch, 2>(at, j);
    const auto length = [](const Real& x, const Real& y, const Real& z) {
      return sqrt(x * x + y * y + z * z);
    };
    return length(i[0] - j[0], i[1] - j[1], i[2] - j[2]) + length(i[4], i[5], i[6]) +
           length(j[4], j[5], j[6]);
  }
  static std::uint64_t valid_lanes(std::size_t left) {
    return left >= W ? (std::uint64_t{1} << W) - 1 : (std::uint64_t{1} << left) - 1;
  }
  /// The angular velocity is that at the end of a step, in which that of a free body may have been
  /// a little greater.
  static constexpr double gap_slack = 1.1;

  /// Contacts of a block: kinematics and arms, side by side.
  struct Contacts {
    KinematicsBlock<ContactsType, block, double> kinematics;
    alignas(64) double history[H + 1][block];
    alignas(64) double arm_i[3][block], arm_j[3][block];  // [m] from the centres
    alignas(64) double gradient[block], couple[block];    // of SolidContact
    std::uint16_t kind[block];
  };

  template <std::size_t A, std::size_t B, Exponents E>
  static void run_contacts(const Scene& scene, const Some& open,
                           RunningTally<ContactsType, Real>& tally) {
    Contacts c;
    const std::size_t padded = pieces(open.count, W) * W;
    for (std::size_t k = 0; k < padded; k += W) touch_pack<A, B, E>(scene, open, k, c, tally);
    for (std::size_t h = 0; h < M; ++h) {
      const double* const from = scene.list.history(h);
      for (std::size_t k = 0; k < open.count; ++k) c.history[h][k] = from[open.place[k]];
      for (std::size_t k = open.count; k < padded; ++k) c.history[h][k] = 0;
    }
    for (std::size_t k = open.count; k < padded; ++k) c.kinematics.overlap[k] = -1;  // no contacts
    if constexpr (ContactsType::several_materials)
      for (std::size_t k = 0; k < padded; ++k) c.kind[k] = scene.in.kinds[open.place[k]];
    std::array<double*, H + 1> history{};
    for (std::size_t h = 0; h < H; ++h) history[h] = c.history[h];
    loads_of<ContactsType, Arch>(c.kinematics, padded, scene.in.times, scene.table,
                                 ContactsType::several_materials ? c.kind : nullptr, history,
                                 tally);
    tally.end_block();
    for (std::size_t h = 0; h < M; ++h) {
      Gather::scatter(c.history[h], open.place, open.count, scene.list.history(h));
    }
    add_loads<has_gradient<A, B>>(scene, open, padded, c);
  }

  /// What a narrow phase has found.
  struct Found {
    BodyContact<Real> contact;
    Real gradient = Real(1), couple = Real(0);
  };
  template <std::size_t A, std::size_t B, Exponents E>
  static SILT_INLINE Found find(const Scene& scene, const Some& open, std::size_t k,
                                Memory& memory) {
    if constexpr (in_lanes<A, B>) {
      return {touch(posed<A, B, E>(scene, open, k), memory)};
    } else {
      alignas(64) double of[10][W];
      const std::size_t valid = std::min(W, open.count - k);
      for (std::size_t lane = 0; lane < valid; ++lane) {
        auto kept = one_lane<NormalMemory<double>>(memory, lane);
        SolidContact one;
        with_placed<A, B>(scene, open, k + lane,
                          [&](const auto& i, const auto& j) { one = touch_solids(i, j, kept); });
        set_lane(memory, kept, lane);
        const double values[] = {one.normal.x, one.normal.y, one.normal.z, one.point.x,
                                 one.point.y,  one.point.z,  one.overlap,  one.R_eff,
                                 one.gradient, one.couple};
        for (std::size_t v = 0; v < 10; ++v) of[v][lane] = values[v];
      }
      for (auto& v : of)
        for (std::size_t lane = valid; lane < W; ++lane) v[lane] = v[0];
      Found found;
      found.contact.normal = load3<Real>(of[0], of[1], of[2]);
      found.contact.point = load3<Real>(of[3], of[4], of[5]);
      found.contact.overlap = load<Real>(of[6]), found.contact.R_eff = load<Real>(of[7]);
      found.contact.touches = found.contact.overlap > Real(0);
      found.gradient = load<Real>(of[8]), found.couple = load<Real>(of[9]);
      return found;
    }
  }

  template <std::size_t A, std::size_t B, Exponents E>
  static void touch_pack(const Scene& scene, const Some& open, std::size_t k, Contacts& c,
                         RunningTally<ContactsType, Real>& tally) {
    const auto& in = scene.in;
    Memory memory = Gather::memory_of(scene.list, open.place + k);
    memory.R_eff = max(memory.R_eff, Real(0));  // else a gap
    const auto touched = memory.R_eff > Real(0), with_i = memory.follows > Real(0);
    const BodyAxes<Real> turn_i = Gather::axes_pack(in, open.i + k),
                         turn_j = Gather::axes_pack(in, open.j + k);
    const BodyAxes<Real> turn{select(with_i, turn_i.x, turn_j.x),
                              select(with_i, turn_i.y, turn_j.y),
                              select(with_i, turn_i.z, turn_j.z)};
    const Vec3<Real> last = turn.to_space(memory.direction), between = open.between_at(k);
    const Found of = find<A, B, E>(scene, open, k, memory);
    const BodyContact<Real>& found = of.contact;
    const std::size_t valid = std::min(W, open.count - k);
    memory.R_eff = select(found.touches, memory.R_eff, min(found.overlap, Real(0)));
    Gather::keep_memory(scene.list, open.place + k, valid, memory);

    BodyAtContact<Real> i, j;
    Real thin_i, thin_j;
    Gather::body_pack(in, open.i + k, i, thin_i), Gather::body_pack(in, open.j + k, j, thin_j);
    if constexpr (!Rows::has_levers) i.axes = turn_i, j.axes = turn_j;
    const Real zero(0), step(in.times.step);
    const Vec3<Real> n = found.normal, arm_i = found.point, arm_j = found.point - between;
    Kinematics<Real> kin;
    kin.normal = n;
    kin.velocity = i.velocity_at(arm_i) - j.velocity_at(arm_j);
    // The direction of a step ago: it is kept in the axes of one body, which have turned.
    const Vec3<Real> turned = step * cross(select(with_i, i.spin, j.spin), last);
    kin.change = select(touched, n + last - turned, {zero, zero, zero});
    kin.overlap = select(found.touches, found.overlap, Real(-1));
    kin.inverse_m_eff = i.inverse_mass(arm_i, n, of.couple) + j.inverse_mass(arm_j, n, of.couple);
    if constexpr (has_gradient<A, B>) {
      // All that moves the overlap's rate counts `gradient` times, and so does all force.
      kin.velocity += (of.couple * dot(i.spin - j.spin, n)) * n;
      kin.velocity = of.gradient * kin.velocity;
      kin.inverse_m_eff = max(of.gradient * of.gradient * kin.inverse_m_eff, smallest<Real>());
      store(c.gradient + k, of.gradient), store(c.couple + k, of.couple);
    }
    kin.m_eff = Real(1) / kin.inverse_m_eff;
    kin.R_eff = found.R_eff;
    kin.arm = zero, kin.spin = {zero, zero, zero};
    kin.twist = Real(0.5) * dot(i.spin + j.spin, n);
    c.kinematics.put(k, kin);
    c.kinematics.put(k, Radii<Real>{Real(2) * kin.R_eff, Real(2) * kin.R_eff});
    store(c.arm_i[0] + k, arm_i.x), store(c.arm_i[1] + k, arm_i.y), store(c.arm_i[2] + k, arm_i.z);
    store(c.arm_j[0] + k, arm_j.x), store(c.arm_j[1] + k, arm_j.y), store(c.arm_j[2] + k, arm_j.z);

    const Real share = select(found.touches, found.overlap, zero) / min(thin_i, thin_j);
    if (any(share > Real(tally.sum.largest))) {
      alignas(64) double each[W];
      store(each, share);
      tally.sum.largest = std::max(tally.sum.largest, *std::max_element(each, each + W));
    }
  }

  /// Force and torques of the contacts, onto the sums of both bodies.
  template <bool HasGradient>
  static void add_loads(const Scene& scene, const Some& open, std::size_t padded,
                        const Contacts& c) {
    alignas(64) double on_i[block * row], on_j[block * row];
    for (std::size_t k = 0; k < padded; k += W) {
      Vec3<Real> force = c.kinematics.template get_load<Real>(k).force, couple{};
      if constexpr (HasGradient) {
        const Vec3<Real> n = c.kinematics.template get<Real>(k).normal;
        force = load<Real>(c.gradient + k) * force;
        couple = (load<Real>(c.couple + k) * dot(force, n)) * n;
      }
      const auto turning = [&](const double(&a)[3][block]) {
        const Vec3<Real> torque = cross(load3<Real>(a[0] + k, a[1] + k, a[2] + k), force);
        return HasGradient ? torque + couple : torque;
      };
      const PairLoad<Real> i{force, turning(c.arm_i), {}};
      const PairLoad<Real> j{-force, -turning(c.arm_j), {}};
      write_rows<chunks, Arch, Real>(on_i + k * row, i);
      write_rows<chunks, Arch, Real>(on_j + k * row, j);
    }
    for (std::size_t k = 0; k < open.count; ++k) {
      add_row<Arch, chunks, false>(scene.sums + open.i[k] * row, on_i + k * row);
      add_row<Arch, chunks, false>(scene.sums + open.j[k] * row, on_j + k * row);
    }
  }

  template <std::size_t A, std::size_t B, Exponents E>
  static SILT_INLINE PosedPair<FormOf<A, E>, FormOf<B, E>> posed(const Scene& scene,
                                                                 const Some& some, std::size_t k) {
    PosedPair<FormOf<A, E>, FormOf<B, E>> pair;
    pair.i = Gather::template form_pack<A, E>(scene.in, some.i + k),
    pair.j = Gather::template form_pack<B, E>(scene.in, some.j + k);
    pair.turn_i = Gather::axes_pack(scene.in, some.i + k),
    pair.turn_j = Gather::axes_pack(scene.in, some.j + k);
    pair.between = some.between_at(k);
    return pair;
  }
  /// Calls visit(i, j) with one pair, i's centre being the origin.
  template <std::size_t A, std::size_t B, class Visit>
  static void with_placed(const Scene& scene, const Some& some, std::size_t k, const Visit& visit) {
    const auto& rows = *scene.in.rows;
    visit(rows.template placed<A>(some.i[k], {0, 0, 0}),
          rows.template placed<B>(some.j[k],
                                  {some.between[0][k], some.between[1][k], some.between[2][k]}));
  }
};

}  // namespace silt::detail
