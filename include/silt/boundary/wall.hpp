// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <silt/boundary/cone.hpp>
#include <silt/boundary/cylinder.hpp>
#include <silt/boundary/mesh_file.hpp>
#include <silt/boundary/motion.hpp>
#include <silt/boundary/plane.hpp>
#include <silt/boundary/triangle_mesh.hpp>
#include <silt/boundary/wall_drive.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/names.hpp>

namespace silt::inline SILT_TARGET {

/// One surface of a wall, in the wall's own coordinates.
using Surface = std::variant<Plane, Cylinder, Cone, std::shared_ptr<const TriangleMesh>>;

/// Surfaces that form one wall: a single one, or several as in `silt::box`.
struct Surfaces {
  Surfaces(const Plane& plane) : parts{plane.unit()} {}    // NOLINT: a plane is a wall
  Surfaces(const Cylinder& cylinder) : parts{cylinder} {}  // NOLINT
  Surfaces(const Cone& cone) : parts{cone} {}              // NOLINT
  Surfaces(TriangleMesh mesh)                              // NOLINT
      : parts{std::make_shared<const TriangleMesh>(std::move(mesh))} {}
  explicit Surfaces(DynArray<Surface> surfaces) : parts(std::move(surfaces)) {}
  DynArray<Surface> parts;
};

/// Six planes around a box, facing inwards. InputError unless min < max.
inline Surfaces box(const Vec3d& min, const Vec3d& max) {
  DynArray<Surface> parts;
  for (const auto& plane : box_planes(min, max)) parts.emplace_back(plane);
  return Surfaces(std::move(parts));
}

/// Wall from the triangles of an STL file; lengths are multiplied by `scale` (1e-3 for mm).
inline Surfaces stl_wall(const std::string& path, double scale = 1) {
  return TriangleMesh(read_stl(path, scale));
}

/// Wall from an STL, OBJ, PLY or VTP file; the format is recognised by the content or the name.
inline Surfaces mesh_wall(const std::string& path, double scale = 1) {
  return TriangleMesh(read_mesh(path, scale));
}

/// Surface velocity of a wall that does not move itself, such as a conveyor belt: `velocity` +
/// `rate` x (p - centre) at the point p in space. Only its component in the tangent plane of a
/// contact acts. Resistance to twisting and rolling acts against the rotation relative to `rate`.
struct SurfaceVelocity {
  Vec3d velocity{0, 0, 0};  // [m/s]
  Vec3d rate{0, 0, 0};      // [rad/s]
  Vec3d centre{0, 0, 0};    // [m]

  void check() const {
    require(is_finite(velocity) && is_finite(rate) && is_finite(centre),
            "SurfaceVelocity: velocity = ", velocity, " [m/s], rate = ", rate,
            " [rad/s] and centre = ", centre, " [m] must be finite");
  }
  bool is_zero() const { return velocity == Vec3d{0, 0, 0} && rate == Vec3d{0, 0, 0}; }
  /// [m/s] at a contact with this normal.
  Vec3d at(const Vec3d& point, const Vec3d& normal) const {
    const Vec3d v = velocity + cross(rate, point - centre);
    return v - dot(v, normal) * normal;
  }
};

/// Options of add_wall:
///   sim.add_wall(lid, steel, {.name = "lid", .drive = silt::ServoForce{...}});
struct WallSetup {
  std::string name = {};  // unique; used in messages about the wall
  Motion motion = {};     // prescribed; or
  WallDrive drive = {};   // ... by its loads: ServoForce, ServoTorque, Slide, Hinge, FreeBody
  SurfaceVelocity surface_velocity = {};
  std::string material = {};  // material name, if several have equal values; empty: the first
};

/// Wall of a simulation: surfaces, material, motion or drive, and load.
struct Wall {
  DynArray<Surface> surfaces;
  std::size_t material = 0;  // index in the table of the contacts
  Motion motion;             // prescribed; empty: none
  Pose pose{};               // now
  Pose last_pose{};          // one step ago
  Vec3d force{};             // [N] on the wall, from particles, at the last step
  Vec3d torque{};            // [N m] on the wall, about `reference`
  Vec3d reference{};         // [m] reference point of the torque
  Vec3d impulse{};           // [N s] time integral of the force since the start
  Vec3d angular_impulse{};   // [N m s] torque, likewise
  Vec3d turned{};            // [rad] about each axis, whole turns included, since the start
  std::string name;          // empty: none
  WallDrive drive;           // what moves it, if not `motion`
  WallState state;           // of the drive, or of a motion that was changed
  SurfaceVelocity belt;
  double added = 0;       // [s] time of add_wall
  double belt_power = 0;  // [W] of the surface velocity on particles, at the last step
  /// After set_mesh replaced surface `deformed` by a mesh of the same topology: displacement [m] of
  /// each vertex in one step, in the wall's coordinates. `deforming` 2: in the next step, 1: in
  /// this one.
  DynArray<Vec3d> vertex_steps;
  std::size_t deformed = 0;
  int deforming = 0;
  /// [m3] worn volume of each facet of its meshes, mesh after mesh, for each module that computes
  /// wear; empty: none yet.
  DynArray<double> worn;
  Box extent;  // [m] of the surfaces, in the wall's coordinates; may be infinite
  /// For a driven wall in a liquid (Sph), in addition to `force` and `torque`: load [N], [N m]
  /// about the drive's centre, and the coefficients of a servo's speed (sph/driven_walls.hpp).
  Vec3d liquid_force{}, liquid_torque{};
  double liquid_stiffness = 0,
         liquid_damping = 0;  // [N/m], [N s/m]; of a torque times arms squared

  /// remove_wall() took its surfaces.
  bool is_removed() const { return surfaces.empty(); }
  bool is_driven() const { return drive.index() != 0; }
  bool has_belt() const { return !belt.is_zero(); }
  /// Whether its surfaces move relative to the wall (belt, deforming mesh).
  bool is_in_itself_moving() const { return has_belt() || deforming == 1; }
  /// Whether it moves, or its surfaces do.
  bool moves() const { return static_cast<bool>(motion) || is_driven() || has_belt(); }
  /// Pose at `time` [s] by its motion; the present pose if it has none.
  Pose pose_at(double time) const {
    if (!motion) return pose;
    if (state.changed == 0) return motion(time);
    // The motion since that time, starting at the pose of that time.
    const Pose from = motion(state.since), to = motion(time), &held = state.start;
    const Quaternion turn = to.rotation * conjugate(from.rotation);
    return {turn * held.rotation,
            to.translation + rotate(turn, held.translation - from.translation)};
  }
  /// Velocity [m/s] at the point `place` of a driven wall, at the last half step.
  Vec3d driven_velocity(const Vec3d& place) const;
  /// [rad/s] of a driven wall in space, at the present step.
  Vec3d angular_velocity() const;
};

/// A wall, by number or name.
using WhichWall = NumberOrName;

inline Vec3d Wall::driven_velocity(const Vec3d& place) const {
  if (const auto* d = std::get_if<ServoForce>(&drive)) return state.rate * normalised(d->direction);
  if (const auto* d = std::get_if<Slide>(&drive)) return state.rate * normalised(d->direction);
  if (const auto* d = std::get_if<ServoTorque>(&drive))
    return cross(state.rate * normalised(d->axis), place - d->centre);
  if (const auto* d = std::get_if<Hinge>(&drive))
    return cross(state.rate * normalised(d->axis), place - d->centre);
  if (std::holds_alternative<FreeBody>(drive)) {
    const Vec3d &l = state.momentum, &I = state.principal;
    const Vec3d w = rotate(state.turn, {l.x / I.x, l.y / I.y, l.z / I.z});
    return state.velocity + cross(w, place - state.centre);
  }
  return {0, 0, 0};
}

inline Vec3d Wall::angular_velocity() const {
  if (const auto* d = std::get_if<ServoTorque>(&drive)) return state.rate_now * normalised(d->axis);
  if (const auto* d = std::get_if<Hinge>(&drive)) return state.rate_now * normalised(d->axis);
  if (!std::holds_alternative<FreeBody>(drive)) return {0, 0, 0};
  const Vec3d &l = state.momentum_now, &I = state.principal;
  return rotate(state.turn, {l.x / I.x, l.y / I.y, l.z / I.z});
}

namespace detail {

/// Largest distance [m] of a point of a finite wall from its centre or axis; 0 for infinite walls.
inline double reach_of(const Wall& wall) {
  const Box& b = wall.extent;
  double most = 0;
  if (!is_finite(b.min) || !is_finite(b.max)) return most;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d p =
        wall.pose.to_space({corner & 1 ? b.max.x : b.min.x, corner & 2 ? b.max.y : b.min.y,
                            corner & 4 ? b.max.z : b.min.z});
    if (const auto* d = std::get_if<Hinge>(&wall.drive))
      most = std::max(most, norm(cross(normalised(d->axis), p - d->centre)));
    else if (std::holds_alternative<FreeBody>(wall.drive))
      most = std::max(most, norm(p - wall.state.centre));
  }
  return most;
}

inline auto names_of_walls(std::span<const Wall> walls) {
  return Names{"wall", walls.size(),
               [walls](std::size_t w) -> const std::string& { return walls[w].name; },
               "add_wall(surfaces, material, {.name = ...})"};
}
/// "wall 2", or "wall 2 'lid'" if it has a name.
[[gnu::cold]] inline std::string name_of_wall(std::span<const Wall> walls, std::size_t w) {
  return names_of_walls(walls).words(w);
}
/// A name means the wall that is there; of removed walls, the one that had it last.
[[gnu::cold]] inline std::size_t number_of(std::span<const Wall> walls, const WhichWall& which) {
  std::size_t removed = walls.size();
  for (std::size_t w = 0; w < walls.size() && which.by_name(); ++w) {
    if (walls[w].name.empty() || walls[w].name != which.name()) continue;
    if (!walls[w].is_removed()) return w;
    removed = w;
  }
  return removed < walls.size() ? removed : names_of_walls(walls).number_of(which);
}
/// Names of removed walls are free.
[[gnu::cold]] inline void check_wall_name(std::span<const Wall> walls, std::string_view name,
                                          std::size_t own) {
  auto names = names_of_walls(walls);
  const std::string none;
  const auto of_those_there = [&](std::size_t w) -> const std::string& {
    return walls[w].is_removed() ? none : walls[w].name;
  };
  Names{names.what, names.count, of_those_there, names.given_by}.check(name, own);
}

/// Bounds of all surfaces in the wall's coordinates.
inline Box extent_of(const DynArray<Surface>& surfaces) {
  Box all;
  for (const auto& surface : surfaces)
    all.include(std::visit(
        [](const auto& s) {
          if constexpr (requires { *s; })
            return s->bounds();
          else
            return s.bounds();
        },
        surface));
  return all;
}

/// Mean velocity [m/s] over the last step, of length `step` [s], of the wall's point that is now at
/// `place`.
inline Vec3d mean_velocity(const Wall& wall, const Vec3d& place, double step) {
  if (!wall.moves()) return {0, 0, 0};
  return (place - wall.last_pose.to_space(wall.pose.to_body(place))) * (1 / step);
}

/// Deforming mesh: displacement [m] in this step, in space, of the point `place` [m] on one of the
/// triangles `facets`.
inline Vec3d deformation_at(const Wall& wall, std::span<const std::uint32_t> facets,
                            const Vec3d& place) {
  const auto& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(wall.surfaces[wall.deformed]);
  const Vec3d p = wall.pose.to_body(place);
  double least = std::numeric_limits<double>::infinity();
  Vec3d moved{0, 0, 0};
  for (const std::uint32_t t : facets) {
    const double distance = mesh.distance_to(t, p);
    if (!(distance < least)) continue;
    least = distance;
    const auto [i, j, k] = mesh.triangles()[t];
    const Vec3d &a = mesh.vertices()[i], &b = mesh.vertices()[j], &c = mesh.vertices()[k];
    const Vec3d& n = mesh.normals()[t];
    const double at_a = std::max(dot(cross(c - b, p - b), n), 0.0),
                 at_b = std::max(dot(cross(a - c, p - c), n), 0.0),
                 at_c = std::max(dot(cross(b - a, p - a), n), 0.0);
    moved =
        (1 / (at_a + at_b + at_c)) *
        (at_a * wall.vertex_steps[i] + at_b * wall.vertex_steps[j] + at_c * wall.vertex_steps[k]);
  }
  return wall.pose.rotate(moved);
}

/// Velocity [m/s] of a wall's surface relative to the wall at a contact: of a belt, and of a
/// deforming mesh.
inline Vec3d velocity_in_itself(const Wall& wall, std::size_t surface,
                                std::span<const std::uint32_t> facets, const Vec3d& place,
                                const Vec3d& normal, double step) {
  Vec3d v{0, 0, 0};
  if (wall.has_belt()) v = wall.belt.at(place, normal);
  if (wall.deforming == 1 && wall.deformed == surface)
    v += (1 / step) * deformation_at(wall, facets, place);
  return v;
}
/// Largest displacement [m] of a vertex in this step.
inline double deformation_of(const Wall& wall) {
  double most = 0;
  if (wall.deforming == 1)
    for (const Vec3d& v : wall.vertex_steps) most = std::max(most, norm(v));
  return most;
}

/// Calls f with the surface; meshes by reference.
template <class F>
decltype(auto) visit_surface(const Surface& surface, F&& f) {
  return std::visit(
      [&](const auto& s) -> decltype(auto) {
        if constexpr (requires { *s; })
          return f(*s);
        else
          return f(s);
      },
      surface);
}

inline bool is_mesh(const Surface& surface) {
  return std::holds_alternative<std::shared_ptr<const TriangleMesh>>(surface);
}
/// Number of facets of the meshes among the first `surfaces` of a wall.
inline std::size_t facets_before(const Wall& wall, std::size_t surfaces) {
  std::size_t sum = 0;
  for (std::size_t s = 0; s < surfaces; ++s)
    if (const auto* const mesh =
            std::get_if<std::shared_ptr<const TriangleMesh>>(&wall.surfaces[s]))
      sum += (*mesh)->triangles().size();
  return sum;
}
inline std::size_t facets_of(const Wall& wall) { return facets_before(wall, wall.surfaces.size()); }

}  // namespace detail
}  // namespace silt
