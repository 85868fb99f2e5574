// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <variant>

#include <silt/boundary/wall.hpp>
#include <silt/core/box.hpp>
#include <silt/core/error.hpp>

/// Walls in a periodic box. A particle touches an image of a wall where it would touch the wall
/// itself after being moved by whole box lengths. So walls stay in place, and particles are tested
/// at several shifted positions.
///
///   planes                       do not repeat: they are half spaces
///   Cylinder, Cone, Side::Inside repeat along their axis only: one beside it would fill the drum
///   everything else              repeats in all periodic directions
///
/// In a direction in which a surface spans the box, the surface, and all that particles there
/// reach, acts without images: it is meant to be endless there. If a motion has moved it away, the
/// one image that spans the box acts.
///
/// Units: SI. Errors: InputError for a wall more than a million box lengths away.
/// Tests: tests/engine/wall_images.cpp

namespace silt::inline SILT_TARGET::detail {

/// The shifts of a particle along x, y and z, in box lengths, packed into one number. Sums and
/// order of these numbers are those of the three shifts. 0: no shift.
using WallImage = std::int64_t;
inline constexpr std::int64_t image_base = std::int64_t{1} << 21;

inline constexpr WallImage image_limit = std::int64_t{1} << 62;  // no image is that far away

inline WallImage wall_image(const std::array<std::int64_t, 3>& lengths) {
  return (lengths[0] * image_base + lengths[1]) * image_base + lengths[2];
}
inline std::array<std::int64_t, 3> lengths_of(WallImage image) {
  std::array<std::int64_t, 3> n{};
  for (std::size_t d = 3; d-- > 1;) {
    n[d] = ((image + image_base / 2) & (image_base - 1)) - image_base / 2;
    image = (image - n[d]) / image_base;
  }
  n[0] = image;
  return n;
}
/// The displacement [m] of particles for an image; `period` [m]: lengths of the box.
inline Vec3d way_of(WallImage image, const Vec3d& period) {
  const auto n = lengths_of(image);
  return {static_cast<double>(n[0]) * period.x, static_cast<double>(n[1]) * period.y,
          static_cast<double>(n[2]) * period.z};
}

/// Whether a number read from a file is a valid image in a box of these lengths [m] (0 where it is
/// not periodic).
inline bool is_wall_image(WallImage image, const Vec3d& period) {
  if (!(-image_limit < image && image < image_limit)) return false;
  const auto n = lengths_of(image);
  return (n[0] == 0 || period.x > 0) && (n[1] == 0 || period.y > 0) && (n[2] == 0 || period.z > 0);
}

/// Lengths [m] of a box; 0 where it is not periodic.
template <class Domain>
Vec3d period_of(const Domain& domain) {
  return {domain.length(0), domain.length(1), domain.length(2)};
}

/// The range of images at which particles are tested against a surface.
struct ImageRange {
  std::array<std::int64_t, 3> low{0, 0, 0}, high{0, 0, 0};

  bool is_plain() const { return low == high && low == std::array<std::int64_t, 3>{0, 0, 0}; }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z) visit(wall_image({x, y, z}));
  }
};

inline std::array<double, 3> numbers_of(const Vec3d& v) { return {v.x, v.y, v.z}; }

/// A surface's bounds [m] at the present pose of its wall. A rotated infinite surface has none.
inline Box bounds_in_space(const Wall& wall, const Surface& surface) {
  const Box b = visit_surface(surface, [](const auto& s) { return s.bounds(); });
  if (!wall.moves()) return b;
  const Pose& pose = wall.pose;
  if (pose.rotation == Quaternion{}) return {b.min + pose.translation, b.max + pose.translation};
  Box turned;
  if (is_finite(b.min) && is_finite(b.max))
    for (int corner = 0; corner < 8; ++corner)
      turned.include(pose.to_space({corner & 1 ? b.max.x : b.min.x, corner & 2 ? b.max.y : b.min.y,
                                    corner & 4 ? b.max.z : b.min.z}));
  return turned;
}

/// Whether a surface has images along an axis of space.
inline bool repeats_along(const Wall& wall, const Surface& surface, std::size_t direction) {
  if (std::holds_alternative<Plane>(surface)) return false;
  const auto along_axis = [&](const auto& round) {
    if (round.side == Side::Outside) return true;
    const Vec3d axis = normalised(round.to - round.from);
    const auto n = numbers_of(wall.moves() ? wall.pose.rotate(axis) : axis);
    return std::abs(n[direction]) > 1 - 1e-12;
  };
  if (const auto* c = std::get_if<Cylinder>(&surface)) return along_axis(*c);
  if (const auto* c = std::get_if<Cone>(&surface)) return along_axis(*c);
  return true;
}

/// The images of a surface that may be touched in `region` [m], which contains the particles with
/// their reaches.
template <class Domain>
ImageRange images_of(const Wall& wall, const Surface& surface, const Domain& domain,
                     const Box& region) {
  ImageRange all;
  if (std::holds_alternative<Plane>(surface)) return all;
  const Box bounds = bounds_in_space(wall, surface);
  const auto from = numbers_of(bounds.min), to = numbers_of(bounds.max);
  const auto low = numbers_of(region.min), high = numbers_of(region.max);
  const auto begin = numbers_of(domain.box().min), end = numbers_of(domain.box().max);
  for (std::size_t d = 0; d < 3; ++d) {
    const int axis = static_cast<int>(d);
    if (!domain.repeats(axis) || !repeats_along(wall, surface, d)) continue;
    const double length = domain.length(axis);
    require(std::max(std::abs(from[d]), std::abs(to[d])) < 1e6 * length, Domain::policy_name,
            ": a wall", wall.name.empty() ? "" : " '", wall.name, wall.name.empty() ? "" : "'",
            " is at ", bounds.min, " to ", bounds.max,
            " m, more than a million lengths of the box away; give it a motion that comes back");
    const auto whole = [](double x) { return static_cast<std::int64_t>(x); };
    // A surface that spans the box.
    const double least = std::ceil((from[d] - std::min(low[d], begin[d])) / length);
    const double most = std::floor((to[d] - std::max(high[d], end[d])) / length);
    if (least <= most) {
      all.low[d] = all.high[d] = whole(std::clamp(0.0, least, most));
      continue;
    }
    all.low[d] = whole(std::ceil((from[d] - high[d]) / length));
    all.high[d] = whole(std::floor((to[d] - low[d]) / length));
  }
  return all;
}

/// `region` [m], extended in periodic directions by the whole wall where images of it may lie in
/// the region: the displacement of those points of a moving wall counts too.
inline Box region_with_images(const Box& region, const Wall& wall, const Vec3d& period) {
  if (period == Vec3d{0, 0, 0}) return region;
  Box all = region;
  for (const Surface& surface : wall.surfaces) {
    if (std::holds_alternative<Plane>(surface)) continue;
    const Box b = bounds_in_space(wall, surface);
    const auto widen = [](double length, double from, double to, double& low, double& high) {
      if (!(length > 0) || (to <= low + length && from >= high - length)) return;
      low = std::min(low, from), high = std::max(high, to);
    };
    Box one = region;
    widen(period.x, b.min.x, b.max.x, one.min.x, one.max.x);
    widen(period.y, b.min.y, b.max.y, one.min.y, one.max.y);
    widen(period.z, b.min.z, b.max.z, one.min.z, one.max.z);
    all.include(one);
  }
  return all;
}

/// The position at which a particle is tested: its own, or shifted by an image [m].
struct SeenHere {
  static constexpr WallImage image = 0;
  const Vec3d& operator()(const Vec3d& point) const { return point; }
  bool may_reach(const Vec3d&, double) const { return true; }
};
struct SeenElsewhere {
  WallImage image;
  Vec3d way;
  Box bounds;  // [m] of the surface in space

  Vec3d operator()(const Vec3d& point) const { return point + way; }
  bool may_reach(const Vec3d& seen, double within) const {
    return bounds.grown(within).contains(seen);
  }
};

/// Whether two candidates (WallCandidate) have the same sphere and surface: images share slots.
template <class Candidate>
bool same_surface(const Candidate& a, const Candidate& b) {
  return a.particle == b.particle && a.wall == b.wall && a.surface == b.surface;
}
/// The end of the candidates at the same surface as the one at `first`.
template <class Candidate>
std::size_t end_of_images(std::span<const Candidate> all, std::size_t first) {
  std::size_t end = first + 1;
  while (end < all.size() && same_surface(all[first], all[end])) ++end;
  return end;
}

}  // namespace silt::detail
