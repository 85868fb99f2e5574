// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>

#include <silt/boundary/motion.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/sph/driven_walls.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A wall for its particles: surfaces, pose and motion.
struct WallPart {
  DynArray<Surface> surfaces;
  std::string name;
  Motion motion;  // of its own
  SurfaceVelocity belt;
  const Wall* of;  // wall of a Simulation; null: the Sph's own
  DrivenMotion driven{};
  Pose pose{}, last{}, next{}, first{}, listed{};
  double span = 1;
  bool is_belt = true;

  bool is_driven() const { return of != nullptr && of->is_driven(); }
  bool moves() const {
    return of != nullptr ? static_cast<bool>(of->motion) || is_driven() : static_cast<bool>(motion);
  }
  template <class S>
  static constexpr bool is_mesh = std::is_same_v<std::remove_cvref_t<S>, TriangleMesh>;
  /// Only closed meshes have an inside.
  void check(std::size_t number) const {
    for (const Surface& one : surfaces)
      visit_surface(one, [&](const auto& s) {
        if constexpr (is_mesh<decltype(s)>)
          require(s.is_closed(), "Sph: the mesh of wall ", called(number),
                  " is not closed and has no inside; close it, or use planes, "
                  "cylinders and cones");
      });
  }
  /// "'lid'", or its number.
  std::string called(std::size_t number) const {
    return name.empty() ? text(number) : in_quotes(name);
  }
  /// A pose that is no rotation would stretch the wall.
  Pose checked(const Pose& at_time, double t, std::size_t number) const {
    const Quaternion& q = at_time.rotation;
    const double length2 = q.w * q.w + dot(q.vector(), q.vector());
    require(is_finite(at_time.translation) && std::abs(length2 - 1) <= 1e-6,
            "Sph: the motion of wall ", called(number), " gives at t = ", t, " s the translation ",
            at_time.translation, " m and a quaternion of length ", std::sqrt(length2),
            "; it must be finite, and the quaternion of length 1: mend the function that was given "
            "to add_wall (silt::rotation_about(axis, angle) returns a unit quaternion)");
    return at_time;
  }
  /// Moves to `time` [s]; velocities are the means since `before` [s].
  void move_to(double time, double before, std::size_t number) {
    if (!moves()) return;
    const auto at = [&](double t) {
      if (of == nullptr) return checked(motion(t), t, number);
      return of->is_driven() ? driven.at(t) : of->pose_at(t);
    };
    const double from = std::max(time - before, 0.0);  // motions need not be defined before 0
    pose = at(time), last = at(from), next = at(from + before), span = before;
  }
  /// [m/s] at a point in its own coordinates.
  Vec3d velocity(const Vec3d& own) const {
    if (!moves()) return {0, 0, 0};
    return (1 / span) * (next.to_space(own) - last.to_space(own));
  }
  std::size_t nearest_surface(const Vec3d& x) const {
    std::size_t which = 0;
    nearest(x, &which);
    return which;
  }
  /// Nearest surface to a point in space: distance, normal and index.
  SurfacePoint nearest(const Vec3d& x, std::size_t* which = nullptr) const {
    constexpr double far = std::numeric_limits<double>::infinity();
    SurfacePoint least{{0, 0, 0}, far, 0};
    const Vec3d own = pose.to_body(x);
    const auto take = [&](const SurfacePoint& p, std::size_t k) {
      if (!(p.distance < least.distance)) return;
      least = p;
      if (which != nullptr) *which = k;
    };
    for (std::size_t k = 0; k < surfaces.size(); ++k)
      visit_surface(surfaces[k], [&](const auto& s) {
        SurfacePoint p;
        if constexpr (!is_mesh<decltype(s)>)
          if (s.contacts(own, 1e300, &p) != 0) take(p, k);
      });
    // Meshes last: their search ends at the distance found so far.
    for (std::size_t k = 0; k < surfaces.size(); ++k)
      visit_surface(surfaces[k], [&](const auto& s) {
        if constexpr (is_mesh<decltype(s)>) {
          // The free side is that of the triangles' normals.
          if (s.contains(own) == (s.volume() > 0)) {
            SurfacePoint p = s.nearest_point(own);
            p.distance *= -1, p.normal = -1.0 * p.normal;
            take(p, k);
          } else if (least.distance == far) {
            take(s.nearest_point(own), k);
          } else if (least.distance > 0) {
            if (const auto p = s.nearest_point(own, least.distance)) take(*p, k);
          }
        }
      });
    least.normal = pose.rotate(least.normal);
    return least;
  }
};

}  // namespace silt::detail
