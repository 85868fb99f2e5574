// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/contact_kernel.hpp>
#include <silt/engine/load_rows.hpp>
#include <silt/engine/pair_list.hpp>
#include <silt/engine/rows.hpp>

namespace silt::detail {

/// The coefficients of every pair of materials, ready for the kernels.
template <class ContactsType>
struct CoefficientTable {
  std::size_t materials = 1;
  std::vector<typename ContactsType::LawCoefficients> law;          // materials x materials
  std::vector<typename ContactsType::RollingCoefficients> rolling;  // materials x materials
};

/// Gathers, for one pack of contacts, the coefficients of each lane's pair of materials.
template <template <class> class Aggregate, class Real>
inline Aggregate<Real> gather_coefficients(const std::vector<Aggregate<double>>& table,
                                           const std::uint16_t* kinds) {
  if constexpr (!is_batch<Real>) {
    return table[kinds[0]];
  } else {
    constexpr std::size_t n = sizeof(Aggregate<double>) / sizeof(double), W = Real::size;
    alignas(Real) double lanes[n][W];
    for (std::size_t lane = 0; lane < W; ++lane) {
      const auto values = std::bit_cast<std::array<double, n>>(table[kinds[lane]]);
      for (std::size_t k = 0; k < n; ++k) lanes[k][lane] = values[k];
    }
    std::array<Real, n> reals;
    for (std::size_t k = 0; k < n; ++k) reals[k] = Real::load_aligned(lanes[k]);
    return std::bit_cast<Aggregate<Real>>(reals);
  }
}

/// Computes the loads of all pairs of the inner list and adds them up: gather rows of both
/// particles, law over lanes, rows out, sums. Blocks are small enough to stay in the first-level
/// cache between the stages.
template <class ContactsType, class Domain, class Arch>
class PairPipeline {
  using Real = typename Lanes<Arch>::Real;
  using Law = typename ContactsType::Law;
  using Rolling = typename ContactsType::Rolling;
  using Kernel = ContactKernel<ContactsType, Real>;
  using Motion = MotionRow<ContactsType::rotates>;
  static constexpr std::size_t W = Lanes<Arch>::width;
  static constexpr std::size_t block = 128;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  static constexpr bool rotates = ContactsType::rotates;

 public:
  struct Input {
    const PositionRow* positions;
    const Motion* motions;
    const std::uint16_t* kinds;  // place in the coefficient table, if there are several materials
    double time_step;            // [s]
  };

  struct Output {
    double* sums;  // row of each particle
    double* rows;  // row 0 zero, then those of pairs that lie in two shares
  };

  /// Adds the load of every pair to `out`; returns the largest overlap over the smaller radius.
  static double run(const Input& in, PairList<ContactsType::history>& list,
                    const CoefficientTable<ContactsType>& table, const Domain& domain,
                    std::span<const PairShare> shares, const Output& out, const Team& team) {
    std::vector<double> largest(shares.size() + 1, 0.0);
    team.for_parts(shares.size(), [&](std::size_t p) {
      const PairShare& share = shares[p];
      double* own_row = out.rows + share.first_row * 4 * chunks;
      double most = 0;
      for (std::size_t from = share.from; from < share.to; from += block) {
        alignas(64) double rows[block * 4 * chunks];
        const std::size_t count = std::min(block, share.to - from);
        most = std::max(most, run_block(in, list, table, domain, from, count, rows));
        own_row =
            add_up(list, share, from, std::min(count, list.size() - from), rows, out.sums, own_row);
      }
      largest[p] = most;
    });
    return *std::max_element(largest.begin(), largest.end());
  }

 private:
  /// One block of pairs, component by component.
  struct alignas(64) Scratch {
    double position[4][block];  // [m] x, y, z differences; sum of radii
    double motion[4][block];    // [m/s] velocity differences; [1/kg] 1/m*
    double spin[4][block];      // [m/s] sums of spin velocities; [1/m] 1/R*
    double inv_small[block];    // [1/m] one over the smaller radius
    double radius_b[block];     // [m] only where motion rows have no radius
    double rolling[4][block];   // [rad/s] w_a - w_b; [1/(kg m2)] 1/I_r
  };

  static double run_block(const Input& in, PairList<ContactsType::history>& list,
                          const CoefficientTable<ContactsType>& table, const Domain& domain,
                          std::size_t from, std::size_t count, double* rows) {
    Scratch s;
    prefetch(in, list, from + block);
    gather(in, list.first() + from, list.second() + from, count, s);

    const Real time_step(in.time_step);
    auto law = broadcast<Law::template Coefficients, Real>(table.law[0]);
    auto rolling = uniform_rolling(table);
    Real largest(0);
    for (std::size_t k = 0; k < count; k += W) {
      if constexpr (ContactsType::several_materials) {
        law = gather_coefficients<Law::template Coefficients, Real>(table.law, in.kinds + from + k);
        if constexpr (ContactsType::has_rolling)
          rolling = gather_coefficients<Rolling::template Coefficients, Real>(table.rolling,
                                                                              in.kinds + from + k);
      }
      double* history[ContactsType::history + 1];
      for (std::size_t h = 0; h < ContactsType::history; ++h)
        history[h] = list.history(h) + from + k;
      const auto kinematics = pair_kinematics(s, k, domain, time_step);
      const auto load =
          Kernel::load(kinematics, rolling_kinematics(s, k), time_step, law, rolling, history);
      write_rows<chunks>(rows + k * 4 * chunks, load);
      largest = max(largest, kinematics.overlap * smaller_radius_inverse(s, k));
    }
    return largest_lane(largest);
  }

  /// Adds the rows of a block to the sums of its particles; rows of pairs with a particle outside
  /// the share are kept from `own_row` on. Returns the place for the next of these.
  static double* add_up(const PairList<ContactsType::history>& list, const PairShare& share,
                        std::size_t from, std::size_t count, const double* rows, double* sums,
                        double* own_row) {
    using Pack = RowPack<Arch>;
    constexpr std::size_t n = 4 * chunks;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t a = list.first()[from + k], b = list.second()[from + k];
      const bool own_a = share.owns(list.first()[from + k]);
      const bool own_b = share.owns(list.second()[from + k]);
      if (own_a) add_row<Pack, chunks, false>(sums + a * n, rows + k * n);
      if (own_b) add_row<Pack, chunks, true>(sums + b * n, rows + k * n);
      if (own_a && own_b) continue;
      std::copy_n(rows + k * n, n, own_row);
      own_row += n;
    }
    return own_row;
  }

  /// Asks for the rows of the block that comes next: partners lie too far apart for the hardware.
  static void prefetch(const Input& in, const PairList<ContactsType::history>& list,
                       std::size_t from) {
    const std::size_t end = std::min(list.padded_size(), from + block);
    for (std::size_t k = from; k < end; ++k) {
      __builtin_prefetch(&in.positions[list.second()[k]]);
      __builtin_prefetch(&in.motions[list.second()[k]]);
    }
  }

  static auto uniform_rolling(const CoefficientTable<ContactsType>& table) {
    if constexpr (ContactsType::has_rolling)
      return broadcast<Rolling::template Coefficients, Real>(table.rolling[0]);
    else
      return typename Kernel::RollingCoefficients{};
  }

  static SILT_INLINE Kinematics<Real> pair_kinematics(const Scratch& s, std::size_t k,
                                                      const Domain& domain, const Real& time_step) {
    Vec3<Real> d = load3<Real>(s.position[0] + k, s.position[1] + k, s.position[2] + k);
    if constexpr (Domain::periodic) d = domain.shortest(d);
    const Real reach = load<Real>(s.position[3] + k);
    const Real distance = sqrt(max(dot(d, d), Real(std::numeric_limits<double>::min())));
    const Vec3<Real> velocity = load3<Real>(s.motion[0] + k, s.motion[1] + k, s.motion[2] + k);
    const Real inverse_mass = load<Real>(s.motion[3] + k);

    // One division serves all reciprocals: 1/a = b c (1/(a b c)).
    Kinematics<Real> out;
    Real inverse_distance, inverse_reach;
    if constexpr (rotates) {
      const Real inverse_radius = load<Real>(s.spin[3] + k);
      const Real lengths = distance * reach, masses = inverse_mass * inverse_radius;
      const Real all = Real(1) / (lengths * masses);
      const Real per_lengths = all * masses, per_masses = all * lengths;
      inverse_distance = per_lengths * reach, inverse_reach = per_lengths * distance;
      out.m_eff = per_masses * inverse_radius, out.R_eff = per_masses * inverse_mass;
    } else {
      const Real b = load<Real>(s.radius_b + k);
      const Real lengths = distance * reach;
      const Real all = Real(1) / (lengths * inverse_mass);
      inverse_distance = all * inverse_mass * reach;
      inverse_reach = all * inverse_mass * distance;
      out.m_eff = all * lengths, out.R_eff = (reach - b) * b * inverse_reach;
    }
    out.normal = d * inverse_distance;
    out.overlap = reach - distance;
    out.inverse_m_eff = inverse_mass;
    out.velocity = velocity;
    // The normal half a step ago, to second order: turned back by the crosswise motion.
    const Vec3<Real> across = velocity - dot(velocity, out.normal) * out.normal;
    out.half_change = (Real(0.5) * time_step * inverse_distance) * across;
    if constexpr (rotates) {
      out.spin = load3<Real>(s.spin[0] + k, s.spin[1] + k, s.spin[2] + k);
      out.arm = distance * inverse_reach;
      out.twist = dot(out.spin, out.normal) * inverse_reach;
    }
    return out;
  }

  static RollingKinematics<Real> rolling_kinematics(const Scratch& s, std::size_t k) {
    if constexpr (ContactsType::has_rolling)
      return {load3<Real>(s.rolling[0] + k, s.rolling[1] + k, s.rolling[2] + k),
              Real(1) / load<Real>(s.rolling[3] + k)};
    else
      return {};
  }

  static Real smaller_radius_inverse(const Scratch& s, std::size_t k) {
    return load<Real>(s.inv_small + k);
  }

  static void gather(const Input& in, const std::uint32_t* first, const std::uint32_t* second,
                     std::size_t count, Scratch& s) {
    if constexpr (W == 1) {
      for (std::size_t k = 0; k < count; ++k) gather_one(in, first[k], second[k], k, s);
    } else {
      // Rows are four or eight doubles: packs of at most four lanes turn them.
      constexpr std::size_t G = W < 4 ? W : 4;
      for (std::size_t k = 0; k < count; k += G) gather_pack<G>(in, first + k, second + k, k, s);
    }
    for (std::size_t k = 0; k < count; ++k) gather_rest(in, first[k], second[k], k, s);
  }

  static void gather_one(const Input& in, std::uint32_t a, std::uint32_t b, std::size_t k,
                         Scratch& s) {
    const PositionRow &pa = in.positions[a], &pb = in.positions[b];
    s.position[0][k] = pa.x - pb.x, s.position[1][k] = pa.y - pb.y;
    s.position[2][k] = pa.z - pb.z, s.position[3][k] = pa.r + pb.r;
    const Motion &ma = in.motions[a], &mb = in.motions[b];
    s.motion[0][k] = ma.vx - mb.vx, s.motion[1][k] = ma.vy - mb.vy;
    s.motion[2][k] = ma.vz - mb.vz, s.motion[3][k] = ma.inv_m + mb.inv_m;
    if constexpr (rotates) {
      s.spin[0][k] = ma.wx + mb.wx, s.spin[1][k] = ma.wy + mb.wy;
      s.spin[2][k] = ma.wz + mb.wz, s.spin[3][k] = ma.inv_r + mb.inv_r;
    }
  }

  /// G pairs at once: signed row sums, then a transpose from rows to components.
  template <std::size_t G>
  static void gather_pack(const Input& in, const std::uint32_t* a, const std::uint32_t* b,
                          std::size_t k, Scratch& s) {
    using Pack = typename PackOf<G>::type;
    alignas(64) static constexpr double difference[4] = {-1, -1, -1, 1}, sum[4] = {1, 1, 1, 1};
    const auto turn = [&](auto row_of, const double* signs, double(*out)[block]) {
      for (std::size_t c = 0; c < 4; c += G) {
        const Pack sign = Pack::load_aligned(signs + c);
        Pack v[G];
        for (std::size_t lane = 0; lane < G; ++lane)
          v[lane] = Pack::load_aligned(row_of(a[lane]) + c) +
                    sign * Pack::load_aligned(row_of(b[lane]) + c);
        transpose(v);
        for (std::size_t lane = 0; lane < G; ++lane) v[lane].store_aligned(out[c + lane] + k);
      }
    };
    turn([&](std::uint32_t p) { return &in.positions[p].x; }, difference, s.position);
    turn([&](std::uint32_t p) { return &in.motions[p].vx; }, difference, s.motion);
    if constexpr (rotates) turn([&](std::uint32_t p) { return &in.motions[p].wx; }, sum, s.spin);
  }

  /// What is neither a sum nor a difference of rows.
  static void gather_rest(const Input& in, std::uint32_t a, std::uint32_t b, std::size_t k,
                          Scratch& s) {
    if constexpr (rotates) {
      s.inv_small[k] = std::max(in.motions[a].inv_r, in.motions[b].inv_r);
    } else {
      s.radius_b[k] = in.positions[b].r;
      s.inv_small[k] = 1 / std::min(in.positions[a].r, in.positions[b].r);
    }
    if constexpr (ContactsType::has_rolling) {
      const Motion &ma = in.motions[a], &mb = in.motions[b];
      s.rolling[0][k] = ma.wx * ma.inv_r - mb.wx * mb.inv_r;
      s.rolling[1][k] = ma.wy * ma.inv_r - mb.wy * mb.inv_r;
      s.rolling[2][k] = ma.wz * ma.inv_r - mb.wz * mb.inv_r;
      // 1/(I + m r^2) of a solid sphere: 1/(1.4 m r^2).
      s.rolling[3][k] = (ma.inv_m * ma.inv_r * ma.inv_r + mb.inv_m * mb.inv_r * mb.inv_r) / 1.4;
    }
  }
};

}  // namespace silt::detail
