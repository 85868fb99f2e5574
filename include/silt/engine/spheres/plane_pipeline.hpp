// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include <silt/core/row8.hpp>
#include <silt/engine/contact/coefficients.hpp>
#include <silt/engine/contact/contact_fluxes.hpp>
#include <silt/engine/contact/contact_stage.hpp>
#include <silt/engine/contact/load_rows.hpp>
#include <silt/engine/contact/offset.hpp>
#include <silt/engine/contact/wall_loads.hpp>
#include <silt/engine/lists/wall_contacts.hpp>
#include <silt/engine/state/rows.hpp>

namespace silt::inline SILT_TARGET::detail {

template <class Scalar>
class SharedContacts;

/// Input of the computation of wall contacts.
template <bool Rotates, class Scalar, class Fluxes>
struct WallInput {
  const PositionRow* positions;
  const MotionRow<Rotates>* motions;
  const MotionRow<Rotates, Scalar>* pair_motions;  // the same as the pairs use them
  const std::uint16_t* materials;                  // of each particle, if there are several
  StepTimes times;
  // For bodies whose parts share their contacts; else null.
  const PartRow* parts = nullptr;
  const SharedContacts<Scalar>* sharing = nullptr;
  Fluxes* fluxes = nullptr;  // of modules, if there are any
};

/// Computes the loads of spheres near one plane at rest, entirely in lanes, as for pairs. Distances
/// are computed in double, all else in Scalar.
template <class ContactsType, class Arch, class Scalar, class Fluxes, bool Repeats = false>
class PlanePipeline {
  using Real = typename Lanes<Arch, Scalar>::Real;
  using Wide = typename Lanes<Arch>::Real;
  static constexpr std::size_t W = Lanes<Arch, Scalar>::width, V = Lanes<Arch>::width;
  static constexpr std::size_t block = 128;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  static constexpr std::size_t row = 4 * chunks;  // scalars
  static constexpr bool rotates = ContactsType::rotates;
  static constexpr bool single = std::is_same_v<Scalar, float>;

 public:
  using Input = WallInput<rotates, Scalar, Fluxes>;
  using Contacts = WallContacts<ContactsType::history, Scalar, 0, 0, Repeats>;

  /// Adds the loads of one run to the sums of its particles and to the load of the wall.
  static Tally<ContactsType> run(const Input& in, const PlaneRun& plane, const Wall& wall,
                                 Contacts& contacts, const CoefficientTable<ContactsType>& table,
                                 Scalar* sums, WallLoad& load) {
    RunningTally<ContactsType, Real> tally;
    for (std::size_t from = plane.from; from < plane.to; from += block) {
      const std::size_t count = std::min(block, plane.to - from);
      std::array<Scalar*, ContactsType::history + 1> history{};
      for (std::size_t h = 0; h < ContactsType::history; ++h)
        history[h] = contacts.history(h) + from;
      run_block(in, plane, wall, contacts.at_planes(from), from, count, history, table, sums, load,
                tally);
    }
    return tally.end();
  }

 private:
  using Stage = ContactStage<ContactsType, Arch, Scalar, Fluxes>;
  /// The contacts of a block.
  struct Ends {
    static constexpr bool at_wall = true;
    const PositionRow* positions;
    const std::uint32_t* particle;
    const PlaneRun& plane;
    std::size_t from;  // slot of the first
    std::uint32_t first(std::size_t k) const { return particle[k]; }
    std::size_t wall(std::size_t) const { return plane.wall; }
    std::uint16_t surface(std::size_t) const { return plane.surface; }
    std::uint32_t order(std::size_t k) const { return static_cast<std::uint32_t>(from + k); }
    void where(std::size_t k, NotedContact& note) const {
      const PositionRow& p = positions[particle[k]];
      note.event.point = p.centre() - (p.r - note.overlap) * note.event.normal;
    }
  };
  /// One block in its stages.
  struct Block {
    KinematicsBlock<ContactsType, block, Scalar> kinematics;
    alignas(64) Scalar point[3][block];  // [m] contact point, from the wall's reference
    alignas(64) Scalar rows[block * row];
    std::uint16_t kinds[block];
  };

  __attribute__((flatten)) static void run_block(
      const Input& in, const PlaneRun& plane, const Wall& wall, const std::uint32_t* particle,
      std::size_t from, std::size_t count,
      const std::array<Scalar*, ContactsType::history + 1>& history,
      const CoefficientTable<ContactsType>& table, Scalar* sums, WallLoad& load,
      RunningTally<ContactsType, Real>& tally) {
    Block b;
    const std::size_t padded = pieces(count, W) * W;
    // Spheres at walls are scattered in memory: prefetch all of them first.
    for (std::size_t k = 0; k < count; ++k) {
      __builtin_prefetch(in.positions + particle[k]);
      __builtin_prefetch(in.pair_motions + particle[k]);
      __builtin_prefetch(sums + particle[k] * row, 1);
    }
    tally.sum.largest = std::max(tally.sum.largest,
                                 gather(in, plane, wall.reference, particle, padded, history, b));
    const bool several = table.law.size() > 1;
    for (std::size_t k = 0; k < padded && several; ++k) {
      std::size_t material = 0;
      if constexpr (ContactsType::several_materials)
        material = in.materials[particle[std::min(k, count - 1)]];
      b.kinds[k] = static_cast<std::uint16_t>(material * table.materials + wall.material);
    }
    const Stage stage{in.times, table, in.fluxes};
    stage.run(b.kinematics, count, several ? b.kinds : nullptr, history,
              Ends{in.positions, particle, plane, from}, tally, AtOnePoint<Scalar>{});
    write_rows<ContactsType, Arch>(b.kinematics, padded, b.rows);
    for (std::size_t k = 0; k < count; ++k)
      add_row<Arch, chunks, false>(sums + particle[k] * row, b.rows + k * row);
    add_up(b, padded, load);
  }

  static double gather(
      const Input& in, const PlaneRun& plane, const Vec3d& reference, const std::uint32_t* particle,
      std::size_t count,
      [[maybe_unused]] const std::array<Scalar*, ContactsType::history + 1>& history, Block& out) {
    const Real zero(0);
    const Vec3<Real> normal{Real(static_cast<Scalar>(plane.normal.x)),
                            Real(static_cast<Scalar>(plane.normal.y)),
                            Real(static_cast<Scalar>(plane.normal.z))};
    Real largest(0);
    [[maybe_unused]] const Real rolling(static_cast<Scalar>(InertiaOf<ContactsType>::rolling()));
    for (std::size_t k = 0; k < count; k += W) {
      Real velocity[4], spin[4];
      motion_of(in.pair_motions, particle + k, velocity, spin);
      const auto [from_reference, distance, overlap, r] =
          place_of(in.positions, particle + k, plane, reference);
      const Real& inv_m = velocity[3];
      // Fixed spheres get no wall force; removed spheres and padding are inactive.
      const auto there = r * inv_m > zero;
      Kinematics<Real> kin;
      kin.normal = normal, kin.change = {zero, zero, zero};
      kin.velocity = {velocity[0], velocity[1], velocity[2]};
      kin.overlap = select(there, overlap, Real(Scalar(-1e30)));
      if constexpr (keeps_offset<ContactsType>)
        kin.overlap = without_offset(kin.overlap, history[ContactsType::offset_from] + k);
      kin.R_eff = r, kin.inverse_m_eff = inv_m, kin.m_eff = Real(1) / max(inv_m, smallest<Real>());
      if constexpr (rotates) {
        kin.spin = {spin[0], spin[1], spin[2]};
        kin.arm = select(there, distance * spin[3], zero), kin.twist = zero;
        if constexpr (ContactsType::has_rolling)
          out.kinematics.put(
              k, RollingKinematics<Real>{spin[3] * kin.spin, rolling * r * r * kin.m_eff});
      }
      out.kinematics.put(k, kin);
      out.kinematics.put(k, Radii<Real>{r, zero});
      const Vec3<Real> none{zero, zero, zero},
          point = select(there, from_reference - distance * normal, none);
      silt::store(out.point[0] + k, point.x), silt::store(out.point[1] + k, point.y);
      silt::store(out.point[2] + k, point.z);
      largest = max(largest, kin.overlap / max(r, smallest<Real>()));
    }
    alignas(Real) Scalar lanes[W];
    silt::store(lanes, largest);
    return *std::max_element(lanes, lanes + W);
  }

  /// Rows of motion of a pack of spheres.
  static SILT_INLINE void motion_of(const MotionRow<rotates, Scalar>* motions,
                                    const std::uint32_t* particle, Real (&velocity)[4],
                                    Real (&spin)[4]) {
    if constexpr (rotates && has_row8<Arch, Scalar>) {
      using Row = Row8<Arch, Scalar>;
      Row rows[W];
      SILT_UNROLL
      for (std::size_t lane = 0; lane < W; ++lane)
        rows[lane] = Row::load(&motions[particle[lane]].vx);
      rows_to_columns<Arch>(rows, velocity, spin);
    } else {
      using Row = Row4<Arch, Scalar>;
      Row rows[W];
      SILT_UNROLL
      for (std::size_t lane = 0; lane < W; ++lane)
        rows[lane] = Row::load(&motions[particle[lane]].vx);
      rows_to_columns<Arch>(rows, velocity);
      if constexpr (rotates) {
        SILT_UNROLL
        for (std::size_t lane = 0; lane < W; ++lane)
          rows[lane] = Row::load(&motions[particle[lane]].wx);
        rows_to_columns<Arch>(rows, spin);
      }
    }
  }

  struct Place {
    Vec3<Real> from_reference;       // [m] of the centre
    Real distance, overlap, radius;  // [m] from the plane
  };
  static SILT_INLINE Place place_of(const PositionRow* positions, const std::uint32_t* particle,
                                    const PlaneRun& plane, const Vec3d& reference) {
    constexpr std::size_t packs = W / V;
    Wide x[packs], y[packs], z[packs], distance[packs], overlap[packs], radius[packs];
    for (std::size_t p = 0; p < packs; ++p) {
      Row4<Arch> rows[V];
      SILT_UNROLL
      for (std::size_t lane = 0; lane < V; ++lane)
        rows[lane] = Row4<Arch>::load(&positions[particle[p * V + lane]].x);
      Wide c[4];
      rows_to_columns<Arch>(rows, c);
      const Vec3d& n = plane.normal;
      distance[p] = c[0] * n.x + c[1] * n.y + c[2] * n.z - plane.offset;
      overlap[p] = c[3] - distance[p], radius[p] = c[3];
      x[p] = c[0] - reference.x, y[p] = c[1] - reference.y, z[p] = c[2] - reference.z;
    }
    if constexpr (single)
      return {{narrow<Arch>(x), narrow<Arch>(y), narrow<Arch>(z)},
              narrow<Arch>(distance),
              narrow<Arch>(overlap),
              narrow<Arch>(radius)};
    else
      return {{x[0], y[0], z[0]}, distance[0], overlap[0], radius[0]};
  }

  /// Adds the load of the block to that of the wall, lane by lane.
  static void add_up(const Block& b, std::size_t count, WallLoad& load) {
    Vec3<Real> force{Real(0), Real(0), Real(0)}, torque = force;
    for (std::size_t k = 0; k < count; k += W) {
      const PairLoad<Real> loads = b.kinematics.template get_load<Real>(k);
      const Vec3<Real> f = loads.force;
      force -= f;
      if constexpr (ContactsType::has_rolling) torque -= loads.couple;
      torque -= cross(load3<Real>(b.point[0] + k, b.point[1] + k, b.point[2] + k), f);
    }
    const Real all[6] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
    double sum[6] = {};
    for (int c = 0; c < 6; ++c) {
      alignas(Real) Scalar lanes[W];
      silt::store(lanes, all[c]);
      for (const Scalar value : lanes) sum[c] += static_cast<double>(value);
    }
    load.force += {sum[0], sum[1], sum[2]}, load.torque += {sum[3], sum[4], sum[5]};
  }
};

}  // namespace silt::detail
