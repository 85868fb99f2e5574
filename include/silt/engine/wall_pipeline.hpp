// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <span>
#include <vector>

#include <silt/engine/pair_pipeline.hpp>
#include <silt/engine/wall_contacts.hpp>

namespace silt::detail {

/// Computes the loads of all contacts with walls: geometry of each candidate, then the same law
/// over lanes as for pairs, rows out; sums what each wall bears.
template <class ContactsType, class Arch>
class WallPipeline {
  using Real = typename Lanes<Arch>::Real;
  using Law = typename ContactsType::Law;
  using Rolling = typename ContactsType::Rolling;
  using Kernel = ContactKernel<ContactsType, Real>;
  using Motion = MotionRow<ContactsType::rotates>;
  using Contacts = WallContacts<ContactsType::history>;
  static constexpr std::size_t W = Lanes<Arch>::width;
  static constexpr std::size_t block = Contacts::block;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  static constexpr bool rotates = ContactsType::rotates;

 public:
  struct Input {
    const PositionRow* positions;
    const Motion* motions;
    const std::uint16_t* materials;  // of each particle, if there are several
    double time_step;                // [s]
  };

  /// Writes one row a slot to `rows`; sets force and torque of the walls; returns the largest
  /// overlap over the sphere's radius.
  double run(const Input& in, Contacts& contacts, const CoefficientTable<ContactsType>& table,
             std::span<Wall> walls, double* rows, const Team& team) {
    loads_.assign(contacts.blocks() * walls.size(), {});
    largest_.assign(contacts.blocks(), 0);
    team.for_parts(contacts.blocks(),
                   [&](std::size_t b) { run_block(in, contacts, table, walls, rows, b); });
    for (std::size_t w = 0; w < walls.size(); ++w) {
      walls[w].force = walls[w].torque = {0, 0, 0};
      for (std::size_t b = 0; b < contacts.blocks(); ++b) {
        walls[w].force += loads_[b * walls.size() + w].force;
        walls[w].torque += loads_[b * walls.size() + w].torque;
      }
      walls[w].impulse += walls[w].force * in.time_step;
    }
    double most = 0;
    for (const double l : largest_) most = std::max(most, l);
    return most;
  }

 private:
  struct alignas(64) Scratch {
    double normal[3][block];       // [-]
    double half_change[3][block];  // [-]
    double overlap[block];         // [m]
    double arm[block];             // [-]
    double radius[block];          // [m]
    double mass[block];            // [kg]
    double velocity[3][block];     // [m/s]
    double spin[3][block];         // [m/s]
    double twist[block];           // [rad/s]
    double angular[3][block];      // [rad/s]
    std::uint16_t kind[block];     // place in the coefficient table
    Vec3d point[block];            // [m] where it touches
  };
  struct WallLoad {
    Vec3d force, torque;
  };

  void run_block(const Input& in, Contacts& contacts, const CoefficientTable<ContactsType>& table,
                 std::span<const Wall> walls, double* rows, std::size_t b) {
    Scratch s;
    const std::size_t first = b * block;
    for (std::size_t k = 0; k < block; ++k) clear(s, k);
    const auto candidates = contacts.block_candidates(b);
    for (std::size_t k = 0, next = 0; k < candidates.size(); k = next) {
      while (next < candidates.size() && candidates[next].particle == candidates[k].particle)
        ++next;
      touch(candidates.subspan(k, next - k), walls, contacts, in, table, s, first);
    }

    const Real time_step(in.time_step);
    for (std::size_t k = 0; k < block; k += W) {
      const auto law = gather_coefficients<Law::template Coefficients, Real>(table.law, s.kind + k);
      double* history[ContactsType::history + 1];
      for (std::size_t h = 0; h < ContactsType::history; ++h)
        history[h] = contacts.history(h) + first + k;
      const auto load = Kernel::load(kinematics(s, k), rolling_kinematics(s, k), time_step, law,
                                     rolling_coefficients(table, s.kind + k), history);
      write_rows<chunks>(rows + (first + k) * 4 * chunks, load);
    }
    for (const auto& c : contacts.block_candidates(b)) {
      auto& wall_load = loads_[b * walls.size() + c.wall];
      const std::size_t count = Contacts::slots_of(walls[c.wall].surfaces[c.surface]);
      for (std::size_t k = c.slot - first; k < c.slot - first + count; ++k) {
        if (!(s.overlap[k] > 0)) continue;
        const double* r = rows + (first + k) * 4 * chunks;
        const Vec3d force{-r[0], -r[1], -r[2]};
        wall_load.force += force;
        wall_load.torque += cross(s.point[k] - walls[c.wall].reference, force);
        largest_[b] = std::max(largest_[b], s.overlap[k] / s.radius[k]);
      }
    }
  }

  static void clear(Scratch& s, std::size_t k) {
    for (int d = 0; d < 3; ++d)
      s.normal[d][k] = d == 2,
      s.half_change[d][k] = s.velocity[d][k] = s.spin[d][k] = s.angular[d][k] = 0;
    s.overlap[k] = -1, s.arm[k] = s.radius[k] = s.mass[k] = 1, s.twist[k] = 0, s.kind[k] = 0;
  }

  /// A place where a sphere touches a surface.
  struct Touch {
    SurfacePoint point;     // normal in space
    std::size_t candidate;  // among those of the sphere
    bool seam;              // belongs to another contact of the sphere
  };

  /// All contacts of one sphere with the surfaces near it.
  static void touch(std::span<const WallCandidate> candidates, std::span<const Wall> walls,
                    Contacts& contacts, const Input& in,
                    const CoefficientTable<ContactsType>& table, Scratch& s, std::size_t first) {
    const PositionRow& row = in.positions[candidates[0].particle];
    std::array<Touch, block> found;  // as many as fit into a block's slots
    std::size_t count = 0;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const auto& c = candidates[k];
      visit_surface(walls[c.wall].surfaces[c.surface], [&](const auto& surface) {
        using S = std::remove_cvref_t<decltype(surface)>;
        SurfacePoint points[S::max_contacts];
        const int n = touching_points(surface, walls[c.wall], c, row, contacts, points);
        for (int p = 0; p < n; ++p) found[count++] = {points[p], k, false};
      });
    }
    if (count > 1 && candidates.size() > 1) drop_seams({found.data(), count}, 1e-6 * row.r);
    for (std::size_t k = 0, next = 0; k < candidates.size(); ++k) {
      const auto& c = candidates[k];
      const std::size_t slots = Contacts::slots_of(walls[c.wall].surfaces[c.surface]);
      bool taken[8] = {};
      for (; next < count && found[next].candidate == k; ++next) {
        if (found[next].seam) continue;
        const SurfacePoint& point = found[next].point;
        const std::size_t own = slot_for(point.normal, c.slot, contacts, taken, slots);
        const Vec3d last = contacts.slot(own).touching ? contacts.slot(own).normal : point.normal;
        contacts.slot(own) = {point.normal, true};
        describe(point, last, row, walls[c.wall], c, in, table, s, own - first);
      }
      for (std::size_t p = 0; p < slots; ++p)
        if (!taken[p]) contacts.slot(c.slot + p).touching = false;
    }
  }

  template <class S>
  static int touching_points(const S& surface, const Wall& wall, const WallCandidate& c,
                             const PositionRow& row, const Contacts& contacts,
                             SurfacePoint* points) {
    const Vec3d centre = Contacts::in_body(wall, row.centre());
    int count;
    if constexpr (requires { surface.contacts(centre, row.r, contacts.facets(c), points); })
      count = surface.contacts(centre, row.r, contacts.facets(c), points);
    else
      count = surface.contacts(centre, row.r, points);
    if (wall.moves())
      for (int p = 0; p < count; ++p) points[p].normal = wall.pose.rotate(points[p].normal);
    return count;
  }

  /// Where two surfaces join, the rim or edge of one lies in the tangent plane of the other: it is
  /// a seam there and no second contact.
  static void drop_seams(std::span<Touch> found, double tolerance) {
    for (std::size_t a = 0; a < found.size(); ++a)
      for (std::size_t b = 0; b < found.size() && !found[a].seam; ++b) {
        if (found[a].candidate == found[b].candidate || found[b].seam) continue;
        const double deeper = found[a].point.distance - found[b].point.distance;
        const bool second = deeper > tolerance || (deeper > -tolerance && b < a);
        if (second && in_tangent_plane(found[a].point, found[b].point, tolerance))
          found[a].seam = true;
      }
  }

  /// The slot whose contact had nearly this normal a step ago, else a free one: history goes on
  /// while a contact moves from facet to edge to facet.
  static std::size_t slot_for(const Vec3d& normal, std::size_t begin, Contacts& contacts,
                              bool* taken, std::size_t slots) {
    std::size_t best = slots;
    double nearest = 0.8;  // cosine of the largest turn in one step
    for (std::size_t k = 0; k < slots; ++k) {
      const auto& slot = contacts.slot(begin + k);
      if (taken[k] || !slot.touching) continue;
      if (const double cosine = dot(slot.normal, normal); cosine > nearest)
        nearest = cosine, best = k;
    }
    for (std::size_t k = 0; best == slots && k < slots; ++k)
      if (!taken[k] && !contacts.slot(begin + k).touching) best = k;
    for (std::size_t k = 0; best == slots && k < slots; ++k)
      if (!taken[k]) {
        best = k;  // an old contact that ended in this very step
        contacts.slot(begin + k).touching = false;
        for (std::size_t h = 0; h < ContactsType::history; ++h) contacts.history(h)[begin + k] = 0;
      }
    taken[best] = true;
    return begin + best;
  }

  static void describe(const SurfacePoint& point, const Vec3d& last_normal, const PositionRow& row,
                       const Wall& wall, const WallCandidate& c, const Input& in,
                       const CoefficientTable<ContactsType>& table, Scratch& s, std::size_t k) {
    const Motion& motion = in.motions[c.particle];
    if (motion.inv_m == 0) return;  // a fixed sphere feels no wall
    const Vec3d contact = row.centre() - point.distance * point.normal;
    const Vec3d half_change = 0.5 * (point.normal - last_normal);
    Vec3d wall_velocity{0, 0, 0}, wall_spin{0, 0, 0};
    if (wall.moves()) {
      // Mean velocity of the material point over the last step, like the spheres' own.
      wall_velocity =
          (contact - wall.last_pose.to_space(wall.pose.to_body(contact))) * (1 / in.time_step);
      wall_spin = angular_velocity(wall.last_pose, wall.pose, in.time_step);
      // ... of the one under the contact half a step ago, which this one was not if they slide.
      wall_velocity += cross(wall_spin, 0.5 * in.time_step * (wall_velocity - motion.velocity()) +
                                            point.distance * half_change);
    }
    const auto put = [k](double(*out)[block], const Vec3d& v) {
      out[0][k] = v.x, out[1][k] = v.y, out[2][k] = v.z;
    };
    put(s.normal, point.normal);
    put(s.half_change, half_change);
    put(s.velocity, motion.velocity() - wall_velocity);
    s.overlap[k] = row.r - point.distance;
    s.arm[k] = point.distance / row.r;
    s.radius[k] = row.r;
    s.mass[k] = 1 / motion.inv_m;
    s.twist[k] = dot(wall_spin, point.normal);
    if constexpr (rotates) {
      put(s.spin, motion.spin_velocity());
      put(s.angular, motion.spin_velocity() * motion.inv_r - wall_spin);
    }
    std::size_t material = 0;
    if constexpr (ContactsType::several_materials) material = in.materials[c.particle];
    s.kind[k] = static_cast<std::uint16_t>(material * table.materials + wall.material);
    s.point[k] = contact;
  }

  /// Mean angular velocity [rad/s] from one pose to the next.
  static Vec3d angular_velocity(const Pose& from, const Pose& to, double time_step) {
    const Quaternion d = to.rotation * conjugate(from.rotation);
    const Vec3d axis{d.x, d.y, d.z};
    const double sine = norm(axis);
    if (sine == 0) return {0, 0, 0};
    const double angle = 2 * std::atan2(d.w < 0 ? -sine : sine, std::abs(d.w));
    return axis * (angle / (sine * time_step));
  }

  static Kinematics<Real> kinematics(const Scratch& s, std::size_t k) {
    Kinematics<Real> out;
    out.normal = load3<Real>(s.normal[0] + k, s.normal[1] + k, s.normal[2] + k);
    out.half_change = load3<Real>(s.half_change[0] + k, s.half_change[1] + k, s.half_change[2] + k);
    out.overlap = load<Real>(s.overlap + k);
    out.arm = load<Real>(s.arm + k);
    out.R_eff = load<Real>(s.radius + k);
    out.m_eff = load<Real>(s.mass + k);
    out.inverse_m_eff = Real(1) / out.m_eff;
    out.velocity = load3<Real>(s.velocity[0] + k, s.velocity[1] + k, s.velocity[2] + k);
    out.spin = load3<Real>(s.spin[0] + k, s.spin[1] + k, s.spin[2] + k);
    out.twist = load<Real>(s.twist + k);
    return out;
  }

  static RollingKinematics<Real> rolling_kinematics(const Scratch& s, std::size_t k) {
    const Real r = load<Real>(s.radius + k);
    return {load3<Real>(s.angular[0] + k, s.angular[1] + k, s.angular[2] + k),
            Real(1.4) * load<Real>(s.mass + k) * r * r};
  }

  static auto rolling_coefficients(const CoefficientTable<ContactsType>& table,
                                   const std::uint16_t* kinds) {
    if constexpr (ContactsType::has_rolling)
      return gather_coefficients<Rolling::template Coefficients, Real>(table.rolling, kinds);
    else
      return typename Kernel::RollingCoefficients{};
  }

  std::vector<WallLoad> loads_;  // by block and wall
  std::vector<double> largest_;  // by block
};

}  // namespace silt::detail
