// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <silt/boundary/finite_walls.hpp>
#include <silt/boundary/wall.hpp>

namespace ball_mill {

inline constexpr int lifter_count = 8;
inline constexpr double lifter_size = 5e-3;  // [m] height, and width, which the paper does not give

/// The lifters: bars along the axis. Their height above the shell equals their width; they extend
/// as far behind the shell, to leave no open seam, and beyond both ends of the drum.
inline silt::TriangleMesh lifters(double radius, double length) {
  const double h = lifter_size;
  const auto bar =
      silt::box_mesh({radius - h, -length, -0.5 * h}, {radius + h, 2 * length, 0.5 * h});
  std::vector<std::array<silt::Vec3d, 3>> all;
  for (int k = 0; k < lifter_count; ++k) {
    const double turn = 2 * std::numbers::pi * (k + 0.5) / lifter_count;
    const double c = std::cos(turn), s = std::sin(turn);
    for (const auto& triangle : bar.triangles()) {
      std::array<silt::Vec3d, 3> corners;
      for (std::size_t m = 0; m < 3; ++m) {
        const silt::Vec3d at = bar.vertices()[triangle[m]];
        corners[m] = {c * at.x - s * at.z, at.y, s * at.x + c * at.z};
      }
      all.push_back(corners);
    }
  }
  return silt::TriangleMesh(all);
}

/// Shell, lifters and end walls are one rotating wall: its torque is the drum's.
inline silt::Surfaces drum_surfaces(double radius, double length, bool ends) {
  std::vector<silt::Surface> parts = silt::Surfaces(lifters(radius, length)).parts;
  parts.emplace_back(
      silt::Cylinder{{0, -length, 0}, {0, 2 * length, 0}, radius, silt::Side::Inside});
  if (ends) {
    parts.emplace_back(silt::Plane{{0, 0, 0}, {0, 1, 0}});
    parts.emplace_back(silt::Plane{{0, length, 0}, {0, -1, 0}});
  }
  return silt::Surfaces(std::move(parts));
}

}  // namespace ball_mill
