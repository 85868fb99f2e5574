// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/dyn_array.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Deformation of a DeformingBox since the last search and the last pruning.
///
/// Let F be the deformation since then, an affine map of space and of all images alike, and s <= 1
/// a lower bound of how it scales distances: |F u| >= s |u|. Sphere i is at F y_i, and y_i has
/// moved by no more than U_i, the sum over the steps of |c_i| dt/s, with c_i its velocity relative
/// to the flow. Two spheres whose centres were at least R_i + q_i + R_j + q_j apart (R: the radius
/// plus half the law's range) are then at least s (R_i + q_i - U_i + R_j + q_j - U_j) apart, which
/// is R_i + R_j or more if for each of them
///   U_i/q_i + (1/s - 1) R_i/q_i <= 1. (2')
/// This is condition (2) of ListUpkeep, and holds for images too. Likewise the inner reaches are at
/// most
///   q_i <= s (s_i - D_i) - (1 - s) R_i,   D_i the displacement of y_i since the search, (1')
/// in place of (1). Each step scales distances by no less than 1 + dt d, where d < 0 is the
/// smallest principal value of the strain rate, because |(I + dt L) u| >= u (I + dt L) u for unit
/// vectors u.
/// Tests: tests/engine/deforming_box.cpp (against brute force at every step).
struct FlowSince {
  Upper3 map = Upper3::identity();  // F since the search
  double searched = 1, pruned = 1;  // [-] s since then
  double tightest = 0;              // [-] largest R_i/q_i at the pruning

  void search() { map = Upper3::identity(), searched = pruned = 1; }
  void prune(double largest) { pruned = 1, tightest = largest; }
  /// Call after a step that has deformed all by `step` and scaled distances by no less than `s`.
  void follow(const Upper3& step, double s) { map = step * map, searched *= s, pruned *= s; }
  /// The share of the inner reaches that the deformation alone has used up [-].
  double used() const { return (1 / pruned - 1) * tightest; }
  /// The used part [m] of the outer reach of a sphere that was at `from` and is at `now`.
  double spent(double outer, double R, const Vec3d& from, const Vec3d& now,
               const Vec3d& centre) const {
    const Vec3d y = centre + map.inverse() * (now - centre);
    return outer - (searched * (outer - norm(y - from)) - (1 - searched) * R);
  }

  static constexpr std::size_t state_size = 9;
  void put_state(DynArray<double>& out) const {
    for (const double v : map.values()) out.push_back(v);
    out.insert(out.end(), {searched, pruned, tightest});
  }
  void restore(const double* s) {
    map = Upper3::of({s[0], s[1], s[2], s[3], s[4], s[5]});
    searched = s[6], pruned = s[7], tightest = s[8];
  }
};
struct NoFlow {};

}  // namespace silt::detail
