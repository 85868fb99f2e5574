// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include <silt/boundary/deforming_box.hpp>
#include <silt/boundary/domain.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/contact/coefficients.hpp>
#include <silt/engine/contact/contact_fluxes.hpp>
#include <silt/engine/contact/contact_stage.hpp>
#include <silt/engine/contact/load_rows.hpp>
#include <silt/engine/contact/offset.hpp>
#include <silt/engine/lists/pair_list.hpp>
#include <silt/engine/state/rows.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Computes the loads of all pairs of the inner list and sums them: gathers the rows of both
/// particles, evaluates the law in SIMD lanes, writes load rows, adds them up. Blocks fit into the
/// first-level cache between these stages. Scalar: float or double (Precision).
template <class ContactsType, class Domain, class Arch, class Scalar, class Fluxes = NoFluxes>
class PairPipeline {
  using Real = typename Lanes<Arch, Scalar>::Real;
  using Row = Row4<Arch, Scalar>;
  using ParticleMotion = MotionRow<ContactsType::rotates, Scalar>;
  using List = PairList<ContactsType::history, Scalar>;
  static constexpr std::size_t W = Lanes<Arch, Scalar>::width;
  static constexpr std::size_t block = 128;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  static constexpr std::size_t row = 4 * chunks;  // scalars
  static constexpr bool rotates = ContactsType::rotates;
  static constexpr bool single = std::is_same_v<Scalar, float>;

 public:
  struct Input {
    const PositionRow* positions;
    const ParticleMotion* motions;
    const std::uint16_t* kinds;  // index in the coefficient table, if there are several materials
    double largest_radius, smallest_radius;  // [m]
    StepTimes times;
    bool fetch_ahead;                // the working set exceeds the caches
    const Scalar* shares = nullptr;  // of each pair's force (SharedContacts), or null
    Fluxes* fluxes = nullptr;        // of modules, if there are any
    bool offsets = true;             // some contacts may have one (WithOffset)
  };

  /// Bytes accessed in a step by `pairs` between `particles`.
  static constexpr std::size_t working_set(std::size_t particles, std::size_t pairs) {
    return particles * (sizeof(PositionRow) + sizeof(ParticleMotion) + row * sizeof(Scalar)) +
           pairs * (2 * sizeof(std::uint32_t) + 2 * ContactsType::history * sizeof(Scalar));
  }

  /// Adds the load of every pair to the sums of its particles.
  template <PairsOf Which = PairsOf::All>
  static Tally<ContactsType> run(const Input& in, List& list,
                                 const CoefficientTable<ContactsType>& table, const Domain& domain,
                                 Scalar* sums, const Team& team) {
    return sum_over_groups<Tally<ContactsType>, Which>(
        list, team, [&](std::size_t from, std::size_t to) {
          return run_group(in, list, table, domain, from, to, sums);
        });
  }

 private:
  using Block = KinematicsBlock<ContactsType, block, Scalar>;
  using Stage = ContactStage<ContactsType, Arch, Scalar, Fluxes>;
  /// The pairs of a block.
  struct Ends {
    static constexpr bool at_wall = false;
    const PositionRow* positions;
    const std::uint32_t *of_first, *of_second;
    std::size_t from;  // place of the first in the list
    std::uint32_t first(std::size_t k) const { return of_first[k]; }
    std::uint32_t second(std::size_t k) const { return of_second[k]; }
    std::uint32_t order(std::size_t k) const { return static_cast<std::uint32_t>(from + k); }
    void where(std::size_t k, NotedContact& note) const {
      const PositionRow& a = positions[of_first[k]];
      note.event.point = a.centre() - (a.r - 0.5 * note.overlap) * note.event.normal;
    }
  };

  static Tally<ContactsType> run_group(const Input& in, List& list,
                                       const CoefficientTable<ContactsType>& table,
                                       const Domain& domain, std::size_t from, std::size_t to,
                                       Scalar* sums) {
    alignas(64) Scalar rows[block * row];
    RunningTally<ContactsType, Real> tally;
    for (; from < to; from += block) {
      const std::size_t count = std::min(block, to - from);
      run_block(in, list, table, domain, from, count, tally, sums, rows);
      add_up(list.first() + from, list.second() + from, count, rows, sums);
    }
    return tally.end();
  }

  /// Computes `count` pairs, plus the padding of the last pack, into `rows`.
  __attribute__((flatten)) static void run_block(const Input& in, List& list,
                                                 const CoefficientTable<ContactsType>& table,
                                                 const Domain& domain, std::size_t from,
                                                 std::size_t count,
                                                 RunningTally<ContactsType, Real>& tally,
                                                 const Scalar* sums, Scalar* rows) {
    Block kinematics;
    const std::uint32_t *const first = list.first() + from, *const second = list.second() + from;
    const std::size_t padded = pieces(count, W) * W;
    gather(in, first, second, domain, padded, sums, kinematics);
    std::array<Scalar*, ContactsType::history + 1> history{};
    for (std::size_t h = 0; h < ContactsType::history; ++h) history[h] = list.history(h) + from;
    double& largest = tally.sum.largest;
    bool plain = true;
    if constexpr (keeps_offset<ContactsType>)
      if (in.offsets)
        plain = false,
        largest = complete<true>(in, first, second, padded, history, largest, kinematics);
    if (plain) largest = complete<false>(in, first, second, padded, history, largest, kinematics);
    const std::uint16_t* const kinds = ContactsType::several_materials ? in.kinds + from : nullptr;
    const Stage stage{in.times, table, in.fluxes};
    stage.run(kinematics, count, kinds, history, Ends{in.positions, first, second, from}, tally,
              AtOnePoint<Scalar>{in.shares != nullptr ? in.shares + from : nullptr});
    if constexpr (sums_virial<ContactsType>)
      tally.sum.virial = tally.sum.virial + virial(in, first, second, padded, kinematics);
    write_rows<ContactsType, Arch>(kinematics, padded, rows);
  }
  /// The virial of a block whose loads are known.
  static Upper3 virial(const Input& in, const std::uint32_t* first, const std::uint32_t* second,
                       std::size_t count, const Block& loads) {
    VirialLanes<Real> sums;
    for (std::size_t k = 0; k < count; k += W) {
      alignas(Real) Scalar radii[W];
      for (std::size_t lane = 0; lane < W; ++lane)
        radii[lane] =
            static_cast<Scalar>(in.positions[first[k + lane]].r + in.positions[second[k + lane]].r);
      const auto kin = loads.template get<Real>(k);
      sums.add(loads.template get_load<Real>(k).force,
               (load<Real>(radii) - kin.overlap) * kin.normal);
    }
    return sums.sum();
  }

  /// Adds the load rows of a block to the sums of its particles. Consecutive pairs often share a
  /// particle, whose sum would be stored and reloaded from one pair to the next; therefore the
  /// block is traversed in strides.
  static void add_up(const std::uint32_t* first, const std::uint32_t* second, std::size_t count,
                     const Scalar* rows, Scalar* sums) {
    constexpr std::size_t stride = 16;
    for (std::size_t from = 0; from < stride; ++from)
      for (std::size_t k = from; k < count; k += stride) {
        add_row<Arch, chunks, false>(sums + first[k] * row, rows + k * row);
        add_row<Arch, chunks, true>(sums + second[k] * row, rows + k * row);
      }
  }

  /// Motion of a pack of pairs: {v_a - v_b, 1/m_a + 1/m_b}, and sums of all other columns.
  static SILT_INLINE void motion_between(const ParticleMotion* motions, const std::uint32_t* a,
                                         const std::uint32_t* b, Real (&velocity)[4],
                                         Real (&spin)[4]) {
    read_anew(a), read_anew(b);
    if constexpr (rotates && has_row8<Arch, Scalar>) {
      using Whole = Row8<Arch, Scalar>;
      const auto sign = Whole::of(-1, 1, 1, 1);
      Whole rows[W];
      SILT_UNROLL
      for (std::size_t lane = 0; lane < W; ++lane)
        rows[lane] = Whole::load(&motions[a[lane]].vx) + sign * Whole::load(&motions[b[lane]].vx);
      rows_to_columns<Arch>(rows, velocity, spin);
    } else {
      const auto difference = Row::of(-1, -1, -1, 1), sum = Row::all(1);
      Row rows[W];
      SILT_UNROLL
      for (std::size_t lane = 0; lane < W; ++lane)
        rows[lane] = Row::load(&motions[a[lane]].vx) + difference * Row::load(&motions[b[lane]].vx);
      rows_to_columns<Arch>(rows, velocity);
      if constexpr (rotates) {
        read_anew(a), read_anew(b);
        SILT_UNROLL
        for (std::size_t lane = 0; lane < W; ++lane)
          rows[lane] = Row::load(&motions[a[lane]].wx) + sum * Row::load(&motions[b[lane]].wx);
        rows_to_columns<Arch>(rows, spin);
      }
    }
  }

  /// Relative position of the spheres of a pack of pairs.
  struct Apart {
    Vec3<Real> d;                   // [m] from the second to the first centre
    Real distance2, reach, excess;  // [m2], [m] sum of the radii, [m2] its square minus distance2
    struct None {};
    // [m/s] velocity of the second sphere's image
    [[no_unique_address]] std::conditional_t<deforms<Domain>, Vec3<Real>, None> carried{};
  };
  static SILT_INLINE Apart distances(const Input& in, const std::uint32_t* a,
                                     const std::uint32_t* b, const Domain& domain) {
    using Wide = typename Lanes<Arch>::Real;
    constexpr std::size_t V = Lanes<Arch>::width, packs = W / V;
    const auto difference = Row4<Arch>::of(-1, -1, -1, 1);
    read_anew(a), read_anew(b);
    Wide x[packs], y[packs], z[packs], squared[packs], reach[packs], excess[packs];
    [[maybe_unused]] Wide vx[packs], vy[packs], vz[packs];
    for (std::size_t p = 0; p < packs; ++p) {
      Row4<Arch> rows[V];
      SILT_UNROLL
      for (std::size_t lane = 0; lane < V; ++lane)
        rows[lane] = Row4<Arch>::load(&in.positions[a[p * V + lane]].x) +
                     difference * Row4<Arch>::load(&in.positions[b[p * V + lane]].x);
      Wide columns[4];
      rows_to_columns<Arch>(rows, columns);
      Vec3<Wide> d{columns[0], columns[1], columns[2]};
      if constexpr (deforms<Domain>) {
        const Vec3<Wide> whole = d;
        d = domain.shortest(d);
        const Vec3<Wide> v = domain.carried(whole - d);
        vx[p] = v.x, vy[p] = v.y, vz[p] = v.z;
      } else if constexpr (Domain::periodic) {
        d = domain.shortest(d);
      }
      x[p] = d.x, y[p] = d.y, z[p] = d.z, reach[p] = columns[3];
      squared[p] = max(dot(d, d), smallest<Wide>());
      if constexpr (single) excess[p] = reach[p] * reach[p] - squared[p];
    }
    Apart out;
    if constexpr (single)
      out = {{narrow<Arch>(x), narrow<Arch>(y), narrow<Arch>(z)},
             max(narrow<Arch>(squared), smallest<Real>()),
             narrow<Arch>(reach),
             narrow<Arch>(excess)};
    else
      out = {{x[0], y[0], z[0]}, squared[0], reach[0], Real(0)};
    if constexpr (deforms<Domain>) {
      if constexpr (single)
        out.carried = {narrow<Arch>(vx), narrow<Arch>(vy), narrow<Arch>(vz)};
      else
        out.carried = {vx[0], vy[0], vz[0]};
    }
    return out;
  }

  // Between the stages of a block its kinematics temporarily contain:
  //   normal: d; overlap: excess; m_eff: distance2; change.x: reach;
  //   R_eff: 1/R*, or where spheres do not rotate the radius of the second.
  // The stages are short loops, so that the processor works on several packs at a time while one
  // pack waits for its square roots and divisions.

  /// Transposes the rows of the particles of `count` pairs (whole packs) into lanes.
  static void gather(const Input& in, const std::uint32_t* first, const std::uint32_t* second,
                     const Domain& domain, std::size_t count, const Scalar* sums, Block& out) {
    for (std::size_t k = 0; k < count; k += W) {
      const std::uint32_t *const a = first + k, *const b = second + k;
      if (in.fetch_ahead) fetch(in, a + List::ahead, b + List::ahead, sums);
      Kinematics<Real> kin;
      Real velocity[4], spin[4];
      motion_between(in.motions, a, b, velocity, spin);
      kin.velocity = {velocity[0], velocity[1], velocity[2]}, kin.inverse_m_eff = velocity[3];
      if constexpr (rotates) {
        kin.spin = {spin[0], spin[1], spin[2]}, kin.R_eff = spin[3];
      } else {
        alignas(Real) Scalar radius[W];
        for (std::size_t lane = 0; lane < W; ++lane)
          radius[lane] = static_cast<Scalar>(in.positions[b[lane]].r);
        kin.R_eff = load<Real>(radius);
      }
      const Apart apart = distances(in, a, b, domain);
      if constexpr (deforms<Domain>) kin.velocity -= apart.carried;
      kin.normal = apart.d, kin.overlap = apart.excess, kin.m_eff = apart.distance2;
      kin.change.x = apart.reach;
      out.put_gathered(k, kin);
      if constexpr (ContactsType::has_rolling) gather_rolling(in, a, b, k, out);
      if constexpr (needs_radii<ContactsType>)
        for (std::size_t lane = 0; lane < W; ++lane)
          out.put(k + lane, Radii<Scalar>{static_cast<Scalar>(in.positions[a[lane]].r),
                                          static_cast<Scalar>(in.positions[b[lane]].r)});
    }
  }

  /// Completes the kinematics of `count` gathered pairs.
  template <bool Offsets>
  static double complete(
      const Input& in, const std::uint32_t* first, const std::uint32_t* second, std::size_t count,
      [[maybe_unused]] const std::array<Scalar*, ContactsType::history + 1>& history,
      double largest, Block& out) {
    const Real time_step(static_cast<Scalar>(in.times.step));
    for (std::size_t k = 0; k < count; k += W) {
      Kinematics<Real> kin = out.template get_gathered<Real>(k);
      const Vec3<Real> d = kin.normal;
      const Real distance2 = kin.m_eff, reach = kin.change.x, excess = kin.overlap;
      const Real inverse_mass = kin.inverse_m_eff, inverse_radius = kin.R_eff;
      const Real distance = sqrt(distance2);

      // One division yields all reciprocals, 1/a = b c (1/(a b c)), and depends on no square root.
      const Real lengths = distance2 * reach;
      Real inverse_reach, inverse_distance;
      if constexpr (rotates) {
        const Real masses = inverse_mass * inverse_radius, all = Real(1) / (lengths * masses);
        const Real per_lengths = all * masses, per_masses = all * lengths;
        inverse_reach = per_lengths * distance2, inverse_distance = per_lengths * reach * distance;
        kin.m_eff = per_masses * inverse_radius, kin.R_eff = per_masses * inverse_mass;
      } else {
        const Real all = Real(1) / (lengths * inverse_mass), per_lengths = all * inverse_mass;
        inverse_reach = per_lengths * distance2, inverse_distance = per_lengths * reach * distance;
        kin.m_eff = all * lengths,
        kin.R_eff = inverse_radius * (reach - inverse_radius) * inverse_reach;
      }
      kin.normal = inverse_distance * d;
      if constexpr (single)
        kin.overlap = excess / (reach + distance);  // a difference would suffer from cancellation
      else
        kin.overlap = reach - distance;
      if constexpr (keeps_offset<ContactsType> && Offsets)
        kin.overlap = without_offset(kin.overlap, history[ContactsType::offset_from] + k);
      // The change of the normal in a step due to tangential motion, to second order.
      const Vec3<Real> across = kin.velocity - dot(kin.velocity, kin.normal) * kin.normal;
      kin.change = (time_step * inverse_distance) * across;
      if constexpr (rotates) {
        kin.arm = distance * inverse_reach;
        kin.twist = dot(kin.spin, kin.normal) * inverse_reach;
      }
      out.put_completed(k, kin);
      if constexpr (ContactsType::has_rolling) {
        const auto rolling = static_cast<Scalar>(InertiaOf<ContactsType>::rolling());
        silt::store(out.inertia_eff + k, Real(rolling) / load<Real>(out.inertia_eff + k));
      }

      // Overlap over the smaller radius, min(a, b) = a b/max(a, b), with a b = R* (a + b) and an
      // upper bound for max(a, b) from the sum. Computed exactly only where this bound exceeds the
      // maximum so far.
      constexpr double rounding = 64 * std::numeric_limits<Scalar>::epsilon();
      const Real larger = min(Real(static_cast<Scalar>(in.largest_radius)),
                              reach - Real(static_cast<Scalar>(in.smallest_radius)));
      const Real known(static_cast<Scalar>(largest * (1 - rounding)));
      if (any(kin.overlap * larger > known * kin.R_eff * reach))
        largest = std::max(largest, exact_overlap(in, first + k, second + k, kin.overlap));
    }
    return largest;
  }

  /// Prefetches the rows of later pairs. Only the particle with the higher place is fetched: the
  /// list follows the order of particles, so the other one was usually used recently.
  static SILT_INLINE void fetch(const Input& in, const std::uint32_t* a, const std::uint32_t* b,
                                const Scalar* sums) {
    for (std::size_t lane = 0; lane < W; ++lane) {
      const std::size_t later = std::max(a[lane], b[lane]);
      __builtin_prefetch(in.positions + later);
      __builtin_prefetch(in.motions + later);
      __builtin_prefetch(sums + later * row, 1);
    }
  }

  static double exact_overlap(const Input& in, const std::uint32_t* a, const std::uint32_t* b,
                              const Real& overlap) {
    alignas(Real) Scalar lanes[W];
    silt::store(lanes, overlap);
    double most = 0;
    for (std::size_t lane = 0; lane < W; ++lane)
      if (lanes[lane] > 0)
        most = std::max(most,
                        lanes[lane] / std::min(in.positions[a[lane]].r, in.positions[b[lane]].r));
    return most;
  }

  /// Relative angular velocity of a pack of pairs, and the sum of 1/(m r^2) in place of the
  /// inertia.
  static SILT_INLINE void gather_rolling(const Input& in, const std::uint32_t* first,
                                         const std::uint32_t* second, std::size_t k, Block& out) {
    read_anew(first), read_anew(second);
    Row rows[W];
    for (std::size_t lane = 0; lane < W; ++lane) {
      const ParticleMotion &a = in.motions[first[lane]], &b = in.motions[second[lane]];
      rows[lane] = Row::all(a.inv_r) * Row::load(&a.wx) - Row::all(b.inv_r) * Row::load(&b.wx);
      out.inertia_eff[k + lane] = a.inv_m * a.inv_r * a.inv_r + b.inv_m * b.inv_r * b.inv_r;
    }
    Real turning[4];
    rows_to_columns<Arch>(rows, turning);
    for (int c = 0; c < 3; ++c) silt::store(out.angular_velocity[c] + k, turning[c]);
  }
};

}  // namespace silt::detail
