// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include <silt/boundary/cone.hpp>
#include <silt/boundary/cylinder.hpp>
#include <silt/boundary/motion.hpp>
#include <silt/boundary/plane.hpp>
#include <silt/boundary/stl.hpp>
#include <silt/boundary/triangle_mesh.hpp>

namespace silt::inline SILT_TARGET {

/// One surface of a wall, in the wall's own coordinates.
using Surface = std::variant<Plane, Cylinder, Cone, std::shared_ptr<const TriangleMesh>>;

/// The surfaces that make one wall: a single one, or several as in `silt::box`.
struct Surfaces {
  Surfaces(const Plane& plane) : parts{plane.unit()} {}    // NOLINT: a plane is a wall
  Surfaces(const Cylinder& cylinder) : parts{cylinder} {}  // NOLINT
  Surfaces(const Cone& cone) : parts{cone} {}              // NOLINT
  Surfaces(TriangleMesh mesh)                              // NOLINT
      : parts{std::make_shared<const TriangleMesh>(std::move(mesh))} {}
  explicit Surfaces(std::vector<Surface> surfaces) : parts(std::move(surfaces)) {}
  std::vector<Surface> parts;
};

/// Six planes around a box, seen from inside. InputError unless min < max.
inline Surfaces box(const Vec3d& min, const Vec3d& max) {
  std::vector<Surface> parts;
  for (const auto& plane : box_planes(min, max)) parts.emplace_back(plane);
  return Surfaces(std::move(parts));
}

/// A wall from the triangles of an STL file; lengths are multiplied by `scale` (1e-3 for files in
/// mm).
inline Surfaces stl_wall(const std::string& path, double scale = 1) {
  return TriangleMesh(read_stl(path, scale));
}

/// A wall of a simulation: surfaces, a material, a prescribed motion, and the load it bears.
struct Wall {
  std::vector<Surface> surfaces;
  std::size_t material = 0;  // in the table of the contacts
  Motion motion;             // empty: at rest
  Pose pose{};               // now
  Pose last_pose{};          // one step ago
  Vec3d force{};             // [N] on the wall, by particles, at the last step
  Vec3d torque{};            // [N m] on the wall, about `reference`
  Vec3d reference{};         // [m] point that the torque is taken about
  Vec3d impulse{};           // [N s] force summed over time since the start

  bool moves() const { return static_cast<bool>(motion); }
};

namespace detail {

/// Mean velocity [m/s] over the last step, of `step` [s], of the point of a wall that is now at
/// `place`.
inline Vec3d mean_velocity(const Wall& wall, const Vec3d& place, double step) {
  if (!wall.moves()) return {0, 0, 0};
  return (place - wall.last_pose.to_space(wall.pose.to_body(place))) * (1 / step);
}

/// Calls f with the surface itself, meshes by reference.
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

}  // namespace detail
}  // namespace silt
