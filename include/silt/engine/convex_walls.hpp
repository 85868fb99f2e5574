// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <silt/engine/convex_rows.hpp>
#include <silt/engine/wall_pipeline.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A convex body at a plane of a wall, all in space.
struct BodyAtPlane {
  BodyContact<double> contact;  // normal from the plane to the body, point from its centre
  Vec3d place;                  // [m] the contact's point
};

/// The contact of a row with a plane, its point in the plane as that of spheres; `first_R_eff`: see
/// touch_plane().
template <Exponents E = Exponents::Any, class Rows>
BodyAtPlane body_at_plane(const Rows& rows, std::size_t row, const Vec3d& centre, const Wall& wall,
                          const Plane& given, double& first_R_eff) {
  const Plane plane = given.unit();
  const double distance =
      dot((wall.moves() ? wall.pose.to_body(centre) : centre) - plane.point, plane.normal);
  const Vec3d normal = wall.moves() ? wall.pose.rotate(plane.normal) : plane.normal;
  BodyAtPlane at;
  at.contact = touch_plane(rows.template form_at<E>(row), body_axes(rows.pose[row].q), normal,
                           distance, first_R_eff);
  at.contact.point += (0.5 * at.contact.overlap) * normal;
  at.place = centre + at.contact.point;
  return at;
}

/// Computes the loads of all contacts of convex bodies with walls, which are planes, fixed or
/// moving: exact contact of each candidate, then the same law over lanes as for pairs; sums what
/// each wall bears.
template <class ShapeType, class ContactsType, class Arch>
class ConvexWalls {
  using Real = typename Lanes<Arch>::Real;
  using Rows = ConvexRows<ShapeType>;
  static constexpr std::size_t W = Lanes<Arch>::width;
  static constexpr std::size_t H = ContactsType::history, radius = ContactsType::memory_radius;
  static constexpr std::size_t chunks = load_chunks<ContactsType>, row = 4 * chunks;

 public:
  using Contacts = WallContacts<H, double>;
  static constexpr std::size_t block = Contacts::block;
  struct Input {
    const PositionRow* positions;
    const MotionRow<true>* motions;
    const Rows* rows;
    const std::uint16_t* materials;
    StepTimes times;
  };

  /// Adds the loads to the sums of the bodies; sets force and torque of the walls.
  Tally<ContactsType> run(const Input& in, Contacts& contacts,
                          const CoefficientTable<ContactsType>& table, std::span<Wall> walls,
                          double* sums, const Team& team) {
    const std::size_t blocks = contacts.blocks();
    loads_.assign(blocks * walls.size(), {});
    tallies_.assign(blocks, {});
    with_exponents(in.rows->exponents, [&](auto e) {
      team.for_parts(blocks, [&](std::size_t b) {
        this->run_block<decltype(e)::value>(in, contacts, table, walls, sums, b);
      });
    });
    sum_wall_loads(walls, loads_, blocks, in.times.step);
    Tally<ContactsType> all;
    for (const auto& tally : tallies_) all.add(tally);
    return all;
  }

 private:
  struct Scratch {
    KinematicsBlock<ContactsType, block, double> kinematics;
    alignas(64) double history[H + 1][block];
    std::uint16_t kind[block];
    WallCandidate of[block];
    Vec3d arm[block], place[block];  // [m] from the centre; in space
    std::size_t count = 0;
  };

  template <Exponents E>
  void run_block(const Input& in, Contacts& contacts, const CoefficientTable<ContactsType>& table,
                 std::span<const Wall> walls, double* sums, std::size_t b) {
    Scratch s;
    double largest = 0;
    for (const WallCandidate& c : contacts.block_candidates(b))
      if (in.motions[c.particle].inv_m != 0)
        largest = std::max(largest, describe<E>(in, contacts, table, walls[c.wall], c, s));
    pad(s);
    std::array<double*, H + 1> history{};
    for (std::size_t h = 0; h < H; ++h) history[h] = s.history[h];
    RunningTally<ContactsType, Real> running;
    loads_of<ContactsType, Arch>(s.kinematics, pieces(s.count, W) * W, in.times, table, s.kind,
                                 history, running);
    tallies_[b] = running.end();
    tallies_[b].largest = largest;
    for (std::size_t k = 0; k < s.count; ++k) {
      const WallCandidate& c = s.of[k];
      // The memory behind the law's history has been kept by describe().
      for (std::size_t h = 0; h < ContactsType::memory_from; ++h)
        contacts.history(h)[c.slot] = s.history[h][k];
      const Vec3d force = s.kinematics.template get_load<double>(k).force;
      const Vec3d torque = cross(s.arm[k], force);
      double* const sum = sums + c.particle * row;
      sum[0] += force.x, sum[1] += force.y, sum[2] += force.z;
      sum[4] += torque.x, sum[5] += torque.y, sum[6] += torque.z;
      WallLoad& load = loads_[b * walls.size() + c.wall];
      load.force -= force;
      load.torque -= cross(s.place[k] - walls[c.wall].reference, force);
    }
  }

  /// Adds a candidate's contact, if it touches; returns overlap over least radius [-].
  template <Exponents E>
  static double describe(const Input& in, Contacts& contacts,
                         const CoefficientTable<ContactsType>& table, const Wall& wall,
                         const WallCandidate& c, Scratch& s) {
    auto& slot = contacts.slot(c.slot);
    double& first_R_eff = contacts.history(radius)[c.slot];
    const PositionRow& position = in.positions[c.particle];
    const auto [contact, place] =
        body_at_plane<E>(*in.rows, c.particle, position.centre(), wall,
                         *std::get_if<Plane>(&wall.surfaces[c.surface]), first_R_eff);
    if (!contact.touches) {
      if (slot.touching)
        for (std::size_t h = 0; h < H; ++h) contacts.history(h)[c.slot] = 0;
      slot.touching = false;
      return 0;
    }
    const Vec3d change = slot.touching ? contact.normal - slot.normal : Vec3d{0, 0, 0};
    slot = {contact.normal, true};
    const PoseRow& pose = in.rows->pose[c.particle];
    const auto body = body_at_contact(in.motions[c.particle], pose);
    Vec3d wall_velocity{0, 0, 0}, wall_spin{0, 0, 0};
    if (wall.moves()) {
      wall_velocity =
          (place - wall.last_pose.to_space(wall.pose.to_body(place))) * (1 / in.times.step);
      wall_spin = mean_angular_velocity(wall.last_pose, wall.pose, in.times.step);
    }
    const std::size_t k = s.count++;
    Kinematics<double> kin;
    kin.normal = contact.normal, kin.change = change;
    kin.velocity = body.velocity_at(contact.point) - wall_velocity;
    kin.overlap = contact.overlap, kin.R_eff = contact.R_eff;
    kin.inverse_m_eff = body.inverse_mass(contact.point, contact.normal);
    kin.m_eff = 1 / kin.inverse_m_eff;
    kin.arm = 0, kin.spin = {0, 0, 0};
    kin.twist = dot(wall_spin, contact.normal);
    s.kinematics.put(k, kin);
    s.kinematics.put(k, Radii<double>{contact.R_eff, 0});
    std::size_t material = 0;
    if constexpr (ContactsType::several_materials) material = in.materials[c.particle];
    s.kind[k] = static_cast<std::uint16_t>(material * table.materials + wall.material);
    s.of[k] = c, s.arm[k] = contact.point, s.place[k] = place;
    for (std::size_t h = 0; h < H; ++h) s.history[h][k] = contacts.history(h)[c.slot];
    return contact.overlap / pose.least_radius;
  }

  /// Fills the last pack with its first contact, moved out of reach.
  static void pad(Scratch& s) {
    for (std::size_t k = s.count; k % W != 0; ++k) {
      const std::size_t from = s.count / W * W;
      auto kinematics = s.kinematics.template get<double>(from);
      kinematics.overlap = -1;
      s.kinematics.put(k, kinematics);
      s.kinematics.put(k, s.kinematics.template get_radii<double>(from));
      for (auto& h : s.history) h[k] = 0;
      s.kind[k] = s.kind[from];
    }
  }

  std::vector<WallLoad> loads_;               // by block and wall
  std::vector<Tally<ContactsType>> tallies_;  // by block
};

}  // namespace silt::detail
