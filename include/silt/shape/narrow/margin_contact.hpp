// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/penetration.hpp>

namespace silt::inline SILT_TARGET {

/// Contact of two cores, each dilated by a margin r: rounded polyhedra, spheres (a point and r),
/// capsules (a segment and r), super-ellipsoids, triangles of walls, in any pair.
struct MarginContact {
  Vec3d normal{0, 0, 0};       // [-] unit, from b to a
  double overlap = 0;          // [m] r_a + r_b - distance of the cores; <= 0: gap of at least that
  Vec3d point{0, 0, 0};        // [m] midway between the two surfaces
  bool cores_overlap = false;  // deeper than the margins: normal and point may jump from here on
  double uncertainty = 0;      // [m] of overlap, for smooth cores that overlap
};

/// Memory of a pair (12 bytes): the last normal, start of the search. Initially zero.
struct AxisMemory {
  float x = 0, y = 0, z = 0;

  Vec3d axis() const { return {x, y, z}; }
  void set(const Vec3d& n) {
    x = static_cast<float>(n.x), y = static_cast<float>(n.y), z = static_cast<float>(n.z);
  }
};

/// overlap = r_a + r_b - d with the distance d of the cores (GJK). For d > 0 the gradient of the
/// overlap is the normal (length 1, at any point of the line between the nearest points); hence any
/// law U(overlap) conserves energy, and the normal rotates continuously. Where features of the
/// cores are parallel the nearest points are not unique and the point may jump along them; faces
/// of two polyhedra: narrow/face_patch.hpp.
///   d = 0: overlap = r_a + r_b + penetration of the cores.
/// Returns overlap 0 as soon as the dilated bodies are proved apart.
///
/// Source: G. van den Bergen 2001 (margins).
/// Tests:  tests/shape/gjk.cpp
template <ConvexSet A, ConvexSet B>
MarginContact margin_contact(const A& a, double r_a, const B& b, double r_b, AxisMemory& memory) {
  MarginContact out;
  const auto gjk = gjk_distance(a, b, memory.axis(), r_a + r_b);
  if (gjk.overlapping) {
    const auto deep = penetration(a, b, gjk);
    out.normal = deep.normal, out.cores_overlap = true;
    out.overlap = r_a + r_b + deep.depth, out.uncertainty = deep.depth - deep.lower_bound;
    out.point = 0.5 * (deep.on_a + deep.on_b) + (0.5 * (r_b - r_a)) * deep.normal;
  } else {
    out.normal = gjk.normal;
    if (!gjk.beyond_reach) out.overlap = std::max(r_a + r_b - gjk.distance, 0.0);
    out.point = 0.5 * (gjk.on_a + gjk.on_b) + (0.5 * (r_b - r_a)) * gjk.normal;
  }
  memory.set(out.normal);
  return out;
}

/// Two bodies with their own radii of dilation.
inline MarginContact margin_contact(const PlacedPolyhedron& a, const PlacedPolyhedron& b,
                                    AxisMemory& memory) {
  return margin_contact(a, a.shape->radius(), b, b.shape->radius(), memory);
}

}  // namespace silt
