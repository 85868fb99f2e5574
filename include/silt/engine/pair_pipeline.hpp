// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/coefficients.hpp>
#include <silt/engine/contact_kernel.hpp>
#include <silt/engine/load_rows.hpp>
#include <silt/engine/pair_list.hpp>
#include <silt/engine/rows.hpp>

namespace silt::detail {

/// Computes the loads of all pairs of the inner list and adds them up: gather rows of both
/// particles, law over lanes, rows out, sums. Blocks are small enough to stay in the first-level
/// cache between the stages.
template <class ContactsType, class Domain, class Arch>
class PairPipeline {
  using Real = typename Lanes<Arch>::Real;
  using Row = Row4<Arch>;
  using Kernel = ContactKernel<ContactsType, Real>;
  using Motion = MotionRow<ContactsType::rotates>;
  using List = PairList<ContactsType::history>;
  static constexpr std::size_t W = Lanes<Arch>::width;
  static constexpr std::size_t block = 128;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  static constexpr std::size_t row = 4 * chunks;  // doubles
  static constexpr bool rotates = ContactsType::rotates;

 public:
  struct Input {
    const PositionRow* positions;
    const Motion* motions;
    const std::uint16_t* kinds;  // place in the coefficient table, if there are several materials
    double largest_radius, smallest_radius;  // [m]
    double time_step;                        // [s]
    bool fetch_ahead;                        // the working set is beyond the caches
  };

  /// Bytes that a step of `pairs` between `particles` goes through.
  static constexpr std::size_t working_set(std::size_t particles, std::size_t pairs) {
    return particles * (sizeof(PositionRow) + sizeof(Motion) + row * sizeof(double)) +
           pairs * (2 * sizeof(std::uint32_t) + 2 * ContactsType::history * sizeof(double));
  }

  /// Adds the load of every pair to the sums of its particles. Returns the largest overlap over the
  /// smaller radius.
  static double run(const Input& in, List& list, const CoefficientTable<ContactsType>& table,
                    const Domain& domain, double* sums, const Team& team) {
    const PairGroups& groups = list.groups();
    std::vector<double> largest(groups.count(), 0.0);
    for (std::size_t p = 0; p < groups.phases(); ++p) {
      const auto [from, to] = list.busy(groups.phase(p));
      team.for_parts(to - from, [&, first = from](std::size_t k) {
        const auto group = list.group(first + k);
        largest[first + k] = run_group(in, list, table, domain, group.from, group.to, sums);
      });
    }
    return *std::max_element(largest.begin(), largest.end());
  }

 private:
  using Block = KinematicsBlock<rotates, ContactsType::has_rolling, block>;

  static double run_group(const Input& in, List& list, const CoefficientTable<ContactsType>& table,
                          const Domain& domain, std::size_t from, std::size_t to, double* sums) {
    alignas(64) double rows[block * row];
    double most = 0;
    for (; from < to; from += block) {
      const std::size_t count = std::min(block, to - from);
      most = run_block(in, list, table, domain, from, count, most, sums, rows);
      add_up(list.first() + from, list.second() + from, count, rows, sums);
    }
    return most;
  }

  /// Computes `count` pairs, and those that fill up the last pack, into `rows`. Returns the largest
  /// overlap over the smaller radius if it is more than `largest`, else this.
  __attribute__((flatten)) static double run_block(const Input& in, List& list,
                                                   const CoefficientTable<ContactsType>& table,
                                                   const Domain& domain, std::size_t from,
                                                   std::size_t count, double largest,
                                                   const double* sums, double* rows) {
    Block kinematics;
    largest = gather(in, list.first() + from, list.second() + from, domain, pieces(count, W) * W,
                     largest, sums, kinematics);
    const Real time_step(in.time_step);
    ContactCoefficients<ContactsType, Real> coefficients(table);
    for (std::size_t k = 0; k < count; k += W) {
      if constexpr (ContactsType::several_materials) coefficients.choose(in.kinds + from + k);
      double* history[ContactsType::history + 1];
      for (std::size_t h = 0; h < ContactsType::history; ++h)
        history[h] = list.history(h) + from + k;
      const auto load =
          Kernel::load(kinematics.template get<Real>(k), kinematics.template get_rolling<Real>(k),
                       time_step, coefficients.law(), coefficients.rolling(), history);
      write_rows<chunks, Arch>(rows + k * row, load);
    }
    return largest;
  }

  /// Adds the rows of a block to the sums of its particles. Consecutive pairs often share a
  /// particle, whose sum would have to travel through memory from one to the next: the order goes
  /// through the block in strides.
  static void add_up(const std::uint32_t* first, const std::uint32_t* second, std::size_t count,
                     const double* rows, double* sums) {
    constexpr std::size_t stride = 16;
    for (std::size_t from = 0; from < stride; ++from)
      for (std::size_t k = from; k < count; k += stride) {
        add_row<Arch, chunks, false>(sums + first[k] * row, rows + k * row);
        add_row<Arch, chunks, true>(sums + second[k] * row, rows + k * row);
      }
  }

  /// Kinematics of `count` pairs (whole packs) from the rows of their particles.
  static double gather(const Input& in, const std::uint32_t* first, const std::uint32_t* second,
                       const Domain& domain, std::size_t count, double largest, const double* sums,
                       Block& out) {
    const Row difference = Row::of(-1, -1, -1, 1), sum = Row::all(1);
    const Real half_step(0.5 * in.time_step);
    for (std::size_t k = 0; k < count; k += W) {
      const std::uint32_t *const a = first + k, *const b = second + k;
      if (in.fetch_ahead) fetch(in, a + List::ahead, b + List::ahead, sums);
      const auto turn = [&](const auto& row_of, const Row& sign, Real(&columns)[4]) {
        Row rows[W];
        for (std::size_t lane = 0; lane < W; ++lane)
          rows[lane] = Row::load(row_of(a[lane])) + sign * Row::load(row_of(b[lane]));
        rows_to_columns<Arch>(rows, columns);
      };
      Real position[4], velocity[4], spin[4];
      turn([&](std::uint32_t p) { return &in.positions[p].x; }, difference, position);
      turn([&](std::uint32_t p) { return &in.motions[p].vx; }, difference, velocity);
      if constexpr (rotates) turn([&](std::uint32_t p) { return &in.motions[p].wx; }, sum, spin);

      Vec3<Real> d{position[0], position[1], position[2]};
      if constexpr (Domain::periodic) d = domain.shortest(d);
      const Real distance2 = max(dot(d, d), Real(std::numeric_limits<double>::min()));
      const Real distance = sqrt(distance2);
      const Real reach = position[3], inverse_mass = velocity[3];
      Real inverse_radius, product;  // 1/R*; of the radii
      if constexpr (rotates) {
        inverse_radius = spin[3];
      } else {
        alignas(Real) double radius[W];
        for (std::size_t lane = 0; lane < W; ++lane) radius[lane] = in.positions[b[lane]].r;
        const Real r = load<Real>(radius);
        product = r * (reach - r);
      }

      // One division serves all reciprocals, 1/a = b c (1/(a b c)), and waits for no square root.
      Kinematics<Real> kin;
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
        kin.m_eff = all * lengths, kin.R_eff = product * inverse_reach;
      }
      kin.normal = inverse_distance * d;
      kin.overlap = reach - distance;
      kin.inverse_m_eff = inverse_mass;
      kin.velocity = {velocity[0], velocity[1], velocity[2]};
      // The normal half a step ago, to second order: turned back by the crosswise motion.
      const Vec3<Real> across = kin.velocity - dot(kin.velocity, kin.normal) * kin.normal;
      kin.half_change = (half_step * inverse_distance) * across;
      if constexpr (rotates) {
        kin.spin = {spin[0], spin[1], spin[2]};
        kin.arm = distance * inverse_reach;
        kin.twist = dot(kin.spin, kin.normal) * inverse_reach;
      }
      out.put(k, kin);
      if constexpr (ContactsType::has_rolling) gather_rolling(in, a, b, k, out);

      // Overlap over the smaller radius, min(a, b) = a b/max(a, b): here a b = R* (a + b), and the
      // larger one is at most what the sum leaves. Exactly only where this bound exceeds.
      const Real larger = min(Real(in.largest_radius), reach - Real(in.smallest_radius));
      if (any(kin.overlap * larger > Real(largest * (1 - 1e-14)) * kin.R_eff * reach))
        largest = std::max(largest, exact_overlap(in, a, b, kin.overlap));
    }
    return largest;
  }

  /// Asks for the rows of pairs that come later, so that they need not wait for memory then. Of
  /// each pair only those of the particle with the higher place: the list follows the order of
  /// particles, so the other one was mostly used a moment ago.
  static SILT_INLINE void fetch(const Input& in, const std::uint32_t* a, const std::uint32_t* b,
                                const double* sums) {
    for (std::size_t lane = 0; lane < W; ++lane) {
      const std::size_t later = std::max(a[lane], b[lane]);
      __builtin_prefetch(in.positions + later);
      __builtin_prefetch(in.motions + later);
      __builtin_prefetch(sums + later * row, 1);
    }
  }

  static double exact_overlap(const Input& in, const std::uint32_t* a, const std::uint32_t* b,
                              const Real& overlap) {
    alignas(Real) double lanes[W];
    silt::store(lanes, overlap);
    double most = 0;
    for (std::size_t lane = 0; lane < W; ++lane)
      if (lanes[lane] > 0)
        most = std::max(most,
                        lanes[lane] / std::min(in.positions[a[lane]].r, in.positions[b[lane]].r));
    return most;
  }

  static void gather_rolling(const Input& in, const std::uint32_t* first,
                             const std::uint32_t* second, std::size_t k, Block& out) {
    for (std::size_t lane = 0; lane < W; ++lane) {
      const Motion &a = in.motions[first[lane]], &b = in.motions[second[lane]];
      // 1/(I + m r^2) of a solid sphere: 1/(1.4 m r^2).
      out.put(k + lane, RollingKinematics<double>{
                            a.inv_r * a.spin_velocity() - b.inv_r * b.spin_velocity(),
                            1.4 / (a.inv_m * a.inv_r * a.inv_r + b.inv_m * b.inv_r * b.inv_r)});
    }
  }
};

}  // namespace silt::detail
