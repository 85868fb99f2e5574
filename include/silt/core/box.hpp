// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <limits>

#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// An axis-aligned box from `min` to `max` [m]. Default: empty, grows by `include`.
struct Box {
  Vec3d min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
            std::numeric_limits<double>::infinity()};
  Vec3d max{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
            -std::numeric_limits<double>::infinity()};

  Vec3d extent() const { return max - min; }
  Vec3d centre() const { return (min + max) * 0.5; }
  double volume() const {
    const auto e = extent();
    return e.x * e.y * e.z;
  }
  bool contains(const Vec3d& p) const {
    return p.x >= min.x && p.x <= max.x && p.y >= min.y && p.y <= max.y && p.z >= min.z &&
           p.z <= max.z;
  }
  void include(const Vec3d& p) {
    min = {std::min(min.x, p.x), std::min(min.y, p.y), std::min(min.z, p.z)};
    max = {std::max(max.x, p.x), std::max(max.y, p.y), std::max(max.z, p.z)};
  }
  void include(const Box& b) {
    min = {std::min(min.x, b.min.x), std::min(min.y, b.min.y), std::min(min.z, b.min.z)};
    max = {std::max(max.x, b.max.x), std::max(max.y, b.max.y), std::max(max.z, b.max.z)};
  }
  Box grown(double by) const { return {min - Vec3d{by, by, by}, max + Vec3d{by, by, by}}; }
};

}  // namespace silt
