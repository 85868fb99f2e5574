// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <silt/boundary/cone.hpp>
#include <silt/boundary/cylinder.hpp>
#include <silt/boundary/plane.hpp>
#include <silt/boundary/triangle_mesh.hpp>
#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Triangles to display a surface.
struct Outline {
  DynArray<Vec3d> points;  // [m]
  DynArray<std::array<std::uint32_t, 3>> triangles;
};

/// Part of a plane inside the box `seen`.
[[gnu::cold]] inline Outline outline(const Plane& plane, const Box& seen) {
  const Vec3d e = seen.extent();
  const Box box = seen.grown(1e-6 * norm(e));
  const Vec3d n = normalised(plane.normal);
  Outline out;
  const auto height = [&](const Vec3d& p) { return dot(p - plane.point, n); };
  for (int edge = 0; edge < 12; ++edge) {
    const int d = edge / 4, a = edge & 1, b = (edge >> 1) & 1;
    const double low[3] = {box.min.x, box.min.y, box.min.z},
                 high[3] = {box.max.x, box.max.y, box.max.z};
    double from[3], to[3];
    from[d] = low[d], to[d] = high[d];
    from[(d + 1) % 3] = to[(d + 1) % 3] = a ? high[(d + 1) % 3] : low[(d + 1) % 3];
    from[(d + 2) % 3] = to[(d + 2) % 3] = b ? high[(d + 2) % 3] : low[(d + 2) % 3];
    const Vec3d p{from[0], from[1], from[2]}, q{to[0], to[1], to[2]};
    const double hp = height(p), hq = height(q);
    if ((hp < 0) != (hq < 0)) out.points.push_back(p + (hp / (hp - hq)) * (q - p));
  }
  if (out.points.size() < 3) return {};
  Vec3d middle{0, 0, 0};
  for (const auto& p : out.points) middle += p * (1.0 / static_cast<double>(out.points.size()));
  const auto axes = across(n);
  const auto angle = [&](const Vec3d& p) {
    return std::atan2(dot(p - middle, axes[1]), dot(p - middle, axes[0]));
  };
  std::sort(out.points.begin(), out.points.end(),
            [&](const Vec3d& p, const Vec3d& q) { return angle(p) < angle(q); });
  for (std::uint32_t k = 1; k + 1 < out.points.size(); ++k) out.triangles.push_back({0, k, k + 1});
  return out;
}

/// Lateral surface between two circles.
[[gnu::cold]] inline Outline lateral_outline(const Vec3d& from, const Vec3d& to, double r_from,
                                             double r_to) {
  constexpr std::uint32_t segments = 64;
  const auto [u, v] = across(normalised(to - from));
  Outline out;
  for (std::uint32_t k = 0; k < segments; ++k) {
    const double angle = 2 * std::numbers::pi * k / segments;
    const Vec3d radial = std::cos(angle) * u + std::sin(angle) * v;
    out.points.push_back(from + r_from * radial);
    out.points.push_back(to + r_to * radial);
    const std::uint32_t a = 2 * k, b = 2 * ((k + 1) % segments);
    out.triangles.push_back({a, b, a + 1});
    out.triangles.push_back({b, b + 1, a + 1});
  }
  return out;
}
/// The circle where a plane crosses the axis of a cylinder at a right angle.
[[gnu::cold]] inline Outline circular_outline(const Plane& plane, const Cylinder& c) {
  const Vec3d axis = normalised(c.to - c.from);
  const Vec3d centre = c.from + dot(plane.point - c.from, axis) * axis;
  const Outline lateral = lateral_outline(centre, centre + axis, c.radius, c.radius);
  Outline out;
  for (std::uint32_t k = 0; k < lateral.points.size(); k += 2)
    out.points.push_back(lateral.points[k]);
  for (std::uint32_t k = 1; k + 1 < out.points.size(); ++k) out.triangles.push_back({0, k, k + 1});
  return out;
}
[[gnu::cold]] inline Outline outline(const Cylinder& c, const Box&) {
  return lateral_outline(c.from, c.to, c.radius, c.radius);
}
[[gnu::cold]] inline Outline outline(const Cone& c, const Box&) {
  return lateral_outline(c.from, c.to, c.radius_from, c.radius_to);
}

[[gnu::cold]] inline Outline outline(const TriangleMesh& mesh, const Box&) {
  Outline out{mesh.vertices(), {}};
  for (const auto& t : mesh.triangles()) out.triangles.push_back({t[0], t[1], t[2]});
  return out;
}

}  // namespace silt::detail
