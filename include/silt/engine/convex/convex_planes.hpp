// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <variant>

#include <silt/engine/convex/contact_area.hpp>
#include <silt/engine/convex/convex_gather.hpp>
#include <silt/engine/lists/wall_contacts.hpp>
#include <silt/shape/narrow/super_ellipsoid_plane.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Contacts of convex parts with walls in one block: those with planes first, in lanes and whole
/// packs. Inactive lanes have an overlap of -1 and no history.
template <class ContactsType, class Candidate, std::size_t Slots, std::size_t W>
struct ConvexWallBlock {
  static constexpr std::size_t room = Slots + 16;  // one pack more
  static constexpr std::uint32_t no_slot = std::numeric_limits<std::uint32_t>::max();
  static_assert(W <= 16);

  KinematicsBlock<ContactsType, room, double> kinematics;
  alignas(64) double history[ContactsType::history + 1][room];
  std::uint16_t kind[room];
  const Candidate* of[room];
  std::uint32_t slot[room];                         // no_slot: padding
  alignas(64) double arm[3][room], place[3][room];  // [m] from the centre; in space
  double gradient[room], couple[room];              // of SolidContact
  static constexpr bool has_area = ContactsType::points > 1;
  AreaBlock<has_area ? room : 1> area;
  std::size_t count = 0;
  double largest = 0;  // [-] overlap over inscribed radius
  // Of ended contacts, which are not in this block.
  [[no_unique_address]] NotesOf<ContactsType> ended;
  [[no_unique_address]] EnergyOf<ContactsType, double> last_work =
      start_energy<ContactsType, double>();
};

/// Contacts of super-ellipsoids of one kind with planes at rest.
template <class Rows, class ContactsType, class Contacts, class Arch>
class ConvexPlanes {
  using Real = typename Lanes<Arch>::Real;
  using Gather = ConvexGather<Rows, Arch>;
  static constexpr std::size_t W = Lanes<Arch>::width, radius = ContactsType::memory_radius,
                               more = radius + 1;  // further history values
  using Candidate = typename Contacts::Candidate;
  template <std::size_t K>
  using KindAt = typename Rows::template KindAt<K>;

 public:
  static constexpr bool in_lanes =
      Rows::Kinds::count == 1 && KernelOf<KindAt<0>>::in_lanes && !std::is_same_v<KindAt<0>, Ball>;
  using Block = ConvexWallBlock<ContactsType, Candidate, Contacts::block, W>;

  static bool takes(const Wall& wall, const Candidate& c) {
    return in_lanes && !wall.moves() && std::holds_alternative<Plane>(wall.surfaces[c.surface]);
  }

  /// Candidates whose bounding sphere overlaps a plane, with the data that differ between lanes.
  class Near {
   public:
    /// Returns false if the plane, which is at rest, is not reached by the candidate.
    bool take(const ConvexInput<Rows>& in, const Wall& wall, const Candidate& c) {
      using Row = typename KernelOf<KindAt<0>>::Row;
      const Plane plane = std::get<Plane>(wall.surfaces[c.surface]).unit();
      const PositionRow& p = in.positions[c.particle];
      const double d = dot(p.centre() - plane.point, plane.normal);
      if (!(d < in.rows->form_row(c.particle).template get<Row>().bound)) return false;
      row[count] = c.particle, of[count] = &c, distance[count] = d;
      const Vec3d& n = plane.normal;
      normal[0][count] = n.x, normal[1][count] = n.y, normal[2][count] = n.z;
      centre[0][count] = p.x, centre[1][count] = p.y, centre[2][count] = p.z;
      ++count;
      return true;
    }

    std::size_t count = 0;
    std::uint32_t row[Block::room];
    const Candidate* of[Block::room];
    alignas(64) double normal[3][Block::room], centre[3][Block::room], distance[Block::room];
  };

  /// Adds their contacts, pack by pack.
  static void touch(const ConvexInput<Rows>& in, Near& near, Contacts& contacts,
                    const CoefficientTable<ContactsType>& table, std::span<const Wall> walls,
                    Block& block) {
    const auto last = near.count;
    for (std::size_t k = last; last > 0 && k % W != 0; ++k) {
      near.row[k] = near.row[last - 1], near.of[k] = near.of[last - 1];
      near.distance[k] = near.distance[last - 1];
      for (auto& n : near.normal) n[k] = n[last - 1];
      for (auto& x : near.centre) x[k] = x[last - 1];
    }
    with_exponents(in.rows->exponents, [&](auto e) {
      for (std::size_t k = 0; k < last; k += W)
        pack<decltype(e)::value>(in, near, k, contacts, table, walls, block);
    });
    block.count = pieces(last, W) * W;
  }

 private:
  template <Exponents E>
  static void pack(const ConvexInput<Rows>& in, const Near& near, std::size_t k, Contacts& contacts,
                   const CoefficientTable<ContactsType>& table, std::span<const Wall> walls,
                   Block& to) {
    const std::size_t valid = std::min(W, near.count - k);
    alignas(64) double radii[W], last_normal[3][W];
    recall(near, k, valid, ContactsType::history_kept(E > Exponents::Two), contacts, to, radii,
           last_normal);
    const auto at = [&](const auto& columns, std::size_t from) {
      return load3<Real>(columns[0] + from, columns[1] + from, columns[2] + from);
    };
    const Real zero(0), one(1);
    Real R_eff = load<Real>(radii);
    const auto touched = R_eff > zero;
    const Vec3<Real> n = at(near.normal, k);
    const BodyAxes<Real> axes = Gather::axes_pack(in, near.row + k);
    const auto found = touch_plane(Gather::template form_pack<0, E>(in, near.row + k), axes, n,
                                   load<Real>(near.distance + k), R_eff);
    const Vec3<Real> arm = found.point + (Real(0.5) * found.overlap) * n;  // to the plane

    BodyAtContact<Real> body;
    Real thin;
    Gather::body_pack(in, near.row + k, body, thin);
    if constexpr (!Rows::has_levers) body.axes = axes;
    Kinematics<Real> kin;
    kin.normal = n;
    kin.change = select(touched, n - at(last_normal, 0), {zero, zero, zero});
    kin.velocity = body.velocity_at(arm);
    kin.overlap = select(found.touches, found.overlap, -one);
    kin.inverse_m_eff = max(body.inverse_mass(arm, n), Real(1e-300));
    kin.m_eff = one / kin.inverse_m_eff;
    kin.R_eff = found.R_eff;
    kin.arm = zero, kin.spin = {zero, zero, zero};
    kin.twist = zero;
    to.kinematics.put(k, kin);
    to.kinematics.put(k, Radii<Real>{kin.R_eff, zero});
    const Vec3<Real> place = at(near.centre, k) + arm;
    store(to.arm[0] + k, arm.x), store(to.arm[1] + k, arm.y), store(to.arm[2] + k, arm.z);
    store(to.place[0] + k, place.x), store(to.place[1] + k, place.y);
    store(to.place[2] + k, place.z);
    store(to.gradient + k, one), store(to.couple + k, zero);
    if constexpr (E > Exponents::Two) {
      // A contact that touched has no points yet if until now there were ellipsoids alone.
      const auto* const way = to.history + ContactsType::frame_from;
      const Vec3<Real> t = load3<Real>(way[0] + k, way[1] + k, way[2] + k);
      if (in.times.renew_areas || any(!touched || !(dot(t, t) > Real(0.5)))) {
        const auto form = Gather::template form_pack<0, E>(in, near.row + k);
        to.area.put_spread(k, spread_of(form, axes, n, found.point, found.overlap));
      }
      to.area.put_spin(k, body.spin);
    }
    alignas(64) double touches[W], share[W];
    store(touches, R_eff);
    store(share, select(found.touches, found.overlap, zero) / thin);
    name_partners(in, near, k, table, walls, to);
    for (std::size_t lane = 0; lane < valid; ++lane) to.largest = std::max(to.largest, share[lane]);
    keep(near, k, valid, touches, contacts, to);
  }
  /// The candidates and materials of a pack's contacts.
  static SILT_INLINE void name_partners([[maybe_unused]] const ConvexInput<Rows>& in,
                                        const Near& near, std::size_t k,
                                        const CoefficientTable<ContactsType>& table,
                                        std::span<const Wall> walls, Block& to) {
    for (std::size_t lane = 0; lane < W; ++lane) {
      const Candidate& c = *near.of[k + lane];
      to.of[k + lane] = &c;
      std::size_t material = 0;
      if constexpr (ContactsType::several_materials) material = in.materials[c.particle];
      to.kind[k + lane] =
          static_cast<std::uint16_t>(material * table.materials + walls[c.wall].material);
    }
  }
  /// Loads the history of a pack's contacts: `numbers` values and those of events, R_eff [m], and
  /// the last normals.
  static void recall(const Near& near, std::size_t k, std::size_t valid, std::size_t numbers,
                     Contacts& contacts, Block& to, double (&radii)[W],
                     double (&last_normal)[3][W]) {
    for (std::size_t lane = 0; lane < W; ++lane) {
      const std::size_t slot = near.of[k + lane]->slot;
      radii[lane] = contacts.history(radius)[slot];
      const Vec3d& n = contacts.slot(slot).normal;
      last_normal[0][lane] = n.x, last_normal[1][lane] = n.y, last_normal[2][lane] = n.z;
      const auto recall_one = [&](std::size_t h) {
        to.history[h][k + lane] = lane < valid ? contacts.history(h)[slot] : 0;
      };
      for (std::size_t h = 0; h < numbers; ++h) recall_one(h);
      for (std::size_t h = more; h < ContactsType::history; ++h) recall_one(h);
    }
  }
  /// Stores in their slots which planes of a pack are touched, and moves padding lanes out of
  /// reach.
  static void keep(const Near& near, std::size_t k, std::size_t valid, const double (&touches)[W],
                   Contacts& contacts, Block& to) {
    for (std::size_t lane = 0; lane < W; ++lane) {
      const Candidate& c = *near.of[k + lane];
      to.slot[k + lane] = lane < valid ? c.slot : Block::no_slot;
      if (lane >= valid) {
        to.kinematics.overlap[k + lane] = -1;
        continue;
      }
      contacts.history(radius)[c.slot] = touches[lane];
      contacts.slot(c.slot) = {
          {near.normal[0][k + lane], near.normal[1][k + lane], near.normal[2][k + lane]},
          touches[lane] > 0,
          0};
    }
  }
};

}  // namespace silt::detail
