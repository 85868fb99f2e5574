// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>

#include <silt/core/dyn_array.hpp>
#include <silt/io/checkpoint_checks.hpp>

/// Consistency of a checkpoint's walls with those of the scene; as checkpoint_checks.hpp.

namespace silt::inline SILT_TARGET::detail {

/// `forgotten`: the lists will be rebuilt before use, except the contacts in them. Returns whether
/// candidates are laid out as for these walls; `other_motions`: they need not be.
template <class Engine, class Contacts>
bool check_wall_contacts(const CheckpointLoader& a, const typename Contacts::State& s,
                         const Contacts& contacts, std::span<const Wall> walls, std::size_t listed,
                         bool forgotten, bool other_motions) {
  const auto check = [&](const char* name, const DynArray<typename Contacts::Candidate>& all,
                         const DynArray<std::uint32_t>& facets) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto& c = all[k];
      a.need(c.particle < listed && c.wall < walls.size(), name, "[", k, "] is of row ", c.particle,
             " of ", listed, " and wall ", c.wall, " of ", walls.size());
      const auto& surfaces = walls[c.wall].surfaces;
      a.need(c.surface < surfaces.size() || (surfaces.empty() && forgotten), name, "[", k,
             "] is at surface ", c.surface, " of ", surfaces.size(), " of wall ", c.wall);
      a.need(c.facet_count <= facets.size() && c.facets <= facets.size() - c.facet_count, name, "[",
             k, "] has its facets at ", c.facets, " to ", std::uint64_t{c.facets} + c.facet_count,
             " of ", facets.size());
      const WallImage image = image_of(c);
      a.need(is_wall_image(image, contacts.period), name, "_images[", k, "] = ", image,
             ", which is not an image of a wall in this box");
      if (surfaces.empty() || forgotten) continue;
      a.need(image == 0 || !std::holds_alternative<Plane>(surfaces[c.surface]), name, "_images[", k,
             "] = ", image, ", but planes do not repeat");
      const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&surfaces[c.surface]);
      a.need(mesh != nullptr ? c.facet_count > 0 : c.facet_count == 0, name, "[", k, "] has ",
             c.facet_count, " facets");
      for (std::size_t f = 0; f < c.facet_count; ++f)
        a.need(facets[c.facets + f] < (*mesh)->triangles().size() &&
                   (f == 0 || facets[c.facets + f - 1] < facets[c.facets + f]),
               name, "[", k, "] has the facet ", facets[c.facets + f], " of ",
               (*mesh)->triangles().size(), ", which must ascend");
    }
  };
  check("walls.outer", s.outer, s.outer_facets), check("walls.inner", s.inner, s.inner_facets);
  for (std::size_t k = 1; k < s.outer.size(); ++k)
    a.need(s.outer[k - 1].key() < s.outer[k].key(), "walls.outer[", k, "] is not in order");
  DynArray<bool> seen(s.outer.size(), false);
  for (std::size_t k = 0; k < s.inner.size(); ++k) {
    const auto& c = s.inner[k];
    a.need(c.origin < s.outer.size() && !seen[c.origin] && s.outer[c.origin].key() == c.key(),
           "walls.inner[", k, "] is not in the outer list");
    seen[c.origin] = true;
  }
  a.need(Contacts::has_slots(s), "walls.inner has slots that contacts cannot have");
  const bool all_there = std::none_of(s.inner.begin(), s.inner.end(), [&](const auto& c) {
    return walls[c.wall].surfaces.empty();
  });
  const bool laid_out = !all_there || contacts.is_laid_out(s, walls);
  a.need(laid_out || other_motions || forgotten, "walls.inner is not laid out as contacts are");
  for (std::size_t k = 0; k < s.slots.size(); ++k)
    a.need(std::abs(norm(s.slots[k].normal) - 1) < 1e-3, "walls.slots[", 4 * k,
           "]: the normal is not a unit vector");
  check_memory<Engine>(a, "walls.", s.history);
  return laid_out;
}

/// All numbers are finite; rotations and moments of inertia are valid.
inline void check_wall_state(const CheckpointLoader& a, const std::string& name,
                             const WallState& s) {
  check_finite_rows(a, text("walls.state of ", name), std::span<const WallState>(&s, 1));
  a.need(is_unit(s.start.rotation) && is_unit(s.axes) && is_unit(s.turn) &&
             std::min({s.principal.x, s.principal.y, s.principal.z}) > 0 &&
             (s.changed == 0 || s.changed == 1),
         name,
         ": walls.state has rotations that are not unit quaternions, or moments of inertia that "
         "are not greater than 0");
}

inline void check_walls(const CheckpointLoader& a, const WallsState& s, std::span<const Wall> walls,
                        const ClockState& c, bool forgotten, const AcceptedChanges& accepted) {
  const auto near = [](const Pose& p, const Pose& q) {
    const double far = norm(p.translation) + norm(q.translation);
    const double cosine = p.rotation.w * q.rotation.w + p.rotation.x * q.rotation.x +
                          p.rotation.y * q.rotation.y + p.rotation.z * q.rotation.z;
    return norm(p.translation - q.translation) <= 1e-9 * far + 1e-12 && std::abs(cosine) > 1 - 1e-9;
  };
  std::size_t all_vertices = 0;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    a.need(is_finite(s.pose[w]) && is_unit(s.pose[w].rotation) && is_finite(s.last_pose[w]) &&
               is_unit(s.last_pose[w].rotation),
           name_of_wall(walls, w), ": its pose must be finite, with a unit quaternion");
    a.need(silt::is_finite(s.force[w]) && silt::is_finite(s.torque[w]) &&
               silt::is_finite(s.impulse[w]),
           name_of_wall(walls, w), ": force ", s.force[w], " N, torque ", s.torque[w],
           " N m and impulse ", s.impulse[w], " N s must be finite");
    a.need(silt::is_finite(s.reference[w]) && silt::is_finite(s.angular_impulse[w]) &&
               silt::is_finite(s.turned[w]),
           name_of_wall(walls, w), ": reference, angular impulse and angle must be finite");
    a.need(s.drive[w] < std::variant_size_v<WallDrive> && s.moves[w] <= 1, name_of_wall(walls, w),
           ": its drive is number ", s.drive[w], " of ", std::variant_size_v<WallDrive>);
    check_wall_state(a, name_of_wall(walls, w), s.state[w]);
    const auto* const mesh =
        s.deformed[w] < walls[w].surfaces.size()
            ? std::get_if<std::shared_ptr<const TriangleMesh>>(&walls[w].surfaces[s.deformed[w]])
            : nullptr;
    a.need(
        s.deforming[w] <= 2 &&
            (s.vertices[w] == 0 ? s.deforming[w] == 0
                                : mesh != nullptr && s.vertices[w] == (*mesh)->vertices().size()),
        name_of_wall(walls, w), ": walls.vertices = ", s.vertices[w], " does not match its mesh");
    all_vertices += s.vertices[w];
    if (walls[w].is_driven() || s.drive[w] != 0) continue;  // its pose follows from its loads
    Wall then = walls[w];
    then.state = s.state[w];
    const Pose scene = then.motion ? then.pose_at(c.time) : Pose{};
    require(accepted.motions || near(s.pose[w], scene),
            "a checkpoint of another scene: ", name_of_wall(walls, w), " was at ",
            s.pose[w].translation, " m, quaternion w = ", s.pose[w].rotation.w, ", at t = ", c.time,
            " s; its motion in the scene puts it at ", scene.translation,
            " m, w = ", scene.rotation.w,
            "; build the scene that wrote it, or accept other motions: "
            "load_checkpoint(sim, path, {.motions = true})");
  }
  a.need(all_vertices == s.vertex_steps.size(), "walls.vertex_steps has ", s.vertex_steps.size(),
         " rows, not ", all_vertices);
  check_finite_rows(a, "walls.vertex_steps", s.vertex_steps);
  for (const auto& marks : s.marks) {
    a.need(forgotten ? marks.size() <= walls.size() : marks.size() == walls.size(),
           "the lists have poses of ", marks.size(), " walls of ", walls.size());
    for (const Pose& p : marks)
      a.need(is_finite(p) && is_unit(p.rotation),
             "walls.searched and walls.pruned: poses must be "
             "finite, with unit quaternions");
  }
  for (const Box& b : s.regions)
    for (const Vec3d& v : {b.min, b.max})
      a.need(!std::isnan(v.x) && !std::isnan(v.y) && !std::isnan(v.z),
             "walls.regions must be numbers");
}

}  // namespace silt::detail
