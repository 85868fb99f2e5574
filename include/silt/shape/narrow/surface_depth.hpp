// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/shape/narrow/solid_planes.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Integrals over a flat polygon of powers of a function e that is linear on it.
template <int Power>
struct PowerIntegrals {
  double full = 0;       // of e^Power
  double less = 0;       // of e^(Power - 1)
  Vec3d place{0, 0, 0};  // of e^(Power - 1) x

  /// Adds a triangle, of corners p where e is given. Exact: over a triangle the integral of e^m is
  /// 2 area m!/(m + 2)! h_m(e0, e1, e2), h the sum of all products of m factors, and its slope by
  /// e_i is m times that of e^(m-1) and the share of corner i.
  void add(const std::array<Vec3d, 3>& p, const std::array<double, 3>& e) {
    constexpr int m = Power;
    const double twice_area = norm(cross(p[1] - p[0], p[2] - p[0]));
    std::array<double, m + 1> h;
    h[0] = 1;
    for (int k = 1; k <= m; ++k) h[k] = e[0] * h[k - 1];
    for (int n = 1; n < 3; ++n)
      for (int k = 1; k <= m; ++k) h[k] += e[n] * h[k - 1];
    full += twice_area / ((m + 1) * (m + 2)) * h[m];
    constexpr double share = 1.0 / (m * (m + 1) * (m + 2));
    for (int n = 0; n < 3; ++n) {
      double slope = 1;  // h_(m-1) of all three and of e_n once more
      for (int k = 1; k < m; ++k) slope = h[k] + e[n] * slope;
      const double part = share * twice_area * slope;
      less += part;
      place += part * p[n];
    }
  }
};

/// What the surface of a mesh in a sharp polyhedron amounts to, patch by patch; see
/// surface_contacts().
class SurfaceDepth {
 public:
  static constexpr int power = 16;

  SurfaceDepth(const PlacedPolyhedron& body, const TriangleMesh& mesh)
      : body_(body), mesh_(mesh), unit_(body.shape->bounding_radius()), work_(memory()) {}

  void add(std::uint32_t t) {
    const double over = 1 / unit_;
    auto& [polygon, cell, next, faces] = work_;
    polygon.clear();
    for (const auto v : mesh_.triangles()[t])
      polygon.push_back(over * body_.pose.to_body(mesh_.vertices()[v]));
    if (!cut_by_body(polygon, next)) return;
    find_nearest_faces(polygon, faces);
    Patch* const patch = patch_of(mesh_.patches()[t]);
    if (patch == nullptr) return;
    for (const auto f : faces) {
      cell = polygon;
      for (const auto g : faces)
        if (g != f && cell.size() > 2)
          cut(cell, next, [&](const Vec3d& x) { return depth(g, x) - depth(f, x); });
      if (cell.size() > 2) add_cell(*patch, f, cell);
    }
  }

  void write(DeepestContacts& deepest) const {
    for (std::size_t k = 0; k < count_; ++k) deepest.add(contact(patch_[k]));
  }

 private:
  static constexpr std::size_t most = 16;

  // All in units of the bounding radius, in the body's axes.
  struct Patch {
    std::uint32_t number;
    double full;   // integral of the depth to `power`
    double less;   // ... to one less
    Vec3d place;   // of that, times the place
    Vec3d push;    // of that, times the normal of the nearest face
    Vec3d torque;  // of that, times place x normal
  };
  struct Memory {
    std::vector<Vec3d> polygon, cell, next;
    std::vector<std::uint32_t> faces;
  };
  static Memory& memory() {
    thread_local Memory work;
    return work;
  }

  double depth(std::uint32_t f, const Vec3d& x) const {
    const auto& face = body_.shape->faces()[f];
    return face.offset / unit_ - dot(face.normal, x);
  }
  /// Keeps of a polygon where `inside` is not below 0.
  template <class Inside>
  static void cut(std::vector<Vec3d>& polygon, std::vector<Vec3d>& next, const Inside& inside) {
    next.clear();
    Vec3d last = polygon.back();
    double before = inside(last);
    for (const Vec3d& p : polygon) {
      const double now = inside(p);
      if ((before < 0) != (now < 0)) next.push_back(last + (before / (before - now)) * (p - last));
      if (!(now < 0)) next.push_back(p);
      last = p, before = now;
    }
    polygon.swap(next);
  }
  bool cut_by_body(std::vector<Vec3d>& polygon, std::vector<Vec3d>& next) const {
    const auto& plane = body_.shape->plane_columns();
    const auto count = static_cast<std::uint32_t>(body_.shape->faces().size());
    const std::array<Vec3d, 3> p{polygon[0], polygon[1], polygon[2]};
    const double over = 1 / unit_;
    auto& crossed = work_.faces;
    crossed.clear();
    for (std::uint32_t f = 0; f < count; ++f) {
      const Vec3d n{plane.x[f], plane.y[f], plane.z[f]};
      const double w = over * plane.w[f];
      const double a = w - dot(n, p[0]), b = w - dot(n, p[1]), c = w - dot(n, p[2]);
      if (!(std::max({a, b, c}) > 0)) return false;
      if (std::min({a, b, c}) < 0) crossed.push_back(f);
    }
    for (const auto f : crossed) {
      cut(polygon, next, [&](const Vec3d& x) { return depth(f, x); });
      if (polygon.size() < 3) return false;
    }
    return true;
  }
  /// Those that can be the nearest somewhere on the polygon.
  void find_nearest_faces(const std::vector<Vec3d>& polygon,
                          std::vector<std::uint32_t>& faces) const {
    const auto count = static_cast<std::uint32_t>(body_.shape->faces().size());
    faces.clear();
    double bound = 4;  // no point is deeper than that in its nearest face
    const auto range = [&](std::uint32_t f) {
      double low = 4, high = -4;
      for (const Vec3d& x : polygon) {
        const double e = depth(f, x);
        low = std::min(low, e), high = std::max(high, e);
      }
      return std::array{low, high};
    };
    for (std::uint32_t f = 0; f < count; ++f)
      if (const auto [low, high] = range(f); low <= bound)
        faces.push_back(f), bound = std::min(bound, high);
    std::erase_if(faces, [&](std::uint32_t f) { return range(f)[0] > bound; });
  }
  Patch* patch_of(std::uint32_t number) {
    for (std::size_t k = 0; k < count_; ++k)
      if (patch_[k].number == number) return &patch_[k];
    if (count_ == most) return nullptr;
    patch_[count_] = {number, 0, 0, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    return &patch_[count_++];
  }
  void add_cell(Patch& patch, std::uint32_t f, const std::vector<Vec3d>& cell) const {
    const Vec3d& n = body_.shape->faces()[f].normal;
    const auto depth_at = [&](const Vec3d& x) { return std::max(depth(f, x), 0.0); };
    PowerIntegrals<power> sums;
    for (std::size_t k = 2; k < cell.size(); ++k)
      sums.add({cell[0], cell[k - 1], cell[k]},
               {depth_at(cell[0]), depth_at(cell[k - 1]), depth_at(cell[k])});
    patch.full += sums.full, patch.less += sums.less;
    patch.place += sums.place;
    patch.push += sums.less * n;
    patch.torque += cross(sums.place, n);
  }

  SolidContact contact(const Patch& p) const {
    SolidContact out;
    out.feature = static_cast<std::uint32_t>(Polyhedron::most_vertices) + p.number;
    const double pushed = norm(p.push);
    if (!(p.full > 1e-280) || !(pushed > 1e-6 * p.less)) return out;  // none, or squeezed evenly
    const double area = body_.shape->core_area() / (6 * unit_ * unit_);
    const double depth = std::pow(p.full / area, 1.0 / power);
    const Vec3d n = (-1 / pushed) * p.push;
    // The torque about the centre, as a force along its axis and a couple about that.
    const Vec3d turn = (-1 / pushed) * p.torque;
    const double couple = dot(turn, n);
    const Vec3d on_axis = cross(n, turn), middle = (1 / p.less) * p.place;
    const Vec3d at = on_axis + dot(middle - on_axis, n) * n;
    out.normal = body_.pose.turn * n;
    out.overlap = unit_ * depth;
    out.gradient = depth * pushed / p.full;
    out.couple = unit_ * couple;
    out.point = body_.pose.to_space(unit_ * at);
    out.R_eff = body_.shape->equal_volume_radius();
    return out;
  }

  const PlacedPolyhedron& body_;
  const TriangleMesh& mesh_;
  double unit_;  // [m]
  Memory& work_;
  std::array<Patch, most> patch_;
  std::size_t count_ = 0;
};

}  // namespace detail

/// Contacts of a sharp polyhedron with a mesh: one with each patch of it (TriangleMesh::patches()).
/// With e(x) the depth of a point of the surface in the body, the distance to the nearest of its
/// faces' planes, and S a sixth of the body's area,
///
///   overlap = (1/S integral of e^16 over what of the patch is in the body)^(1/16)            (1)
///
/// which is the depth, but for 0.24 depth/edge of it, where a cube lies on a plane; 0.46 of it
/// where an edge does that is 1 % of the size deep, 0.25 where a corner does. As (1) is continuous
/// in place and turn, and so is its gradient, energy is conserved under any law of it; more surface
/// in the body, or deeper, is never less overlap. Nothing depends on how the surface is cut into
/// triangles, on how large they are, or on which side of them is the solid: the body is pushed out
/// through its nearest faces.
///
/// Valid:   less than half of the body through the surface. One that is squeezed evenly from all
///          sides by a patch has no direction, and no contact. Up to 16 patches.
/// Source:  ours; the idea of a depth within the body whose integral is the potential is that of
///          pressure fields (Elandt, Drumwright, Sherman and Ruina, IROS 2019).
/// Tests:   tests/shape/surface_depth.cpp
inline int surface_contacts(const PlacedPolyhedron& body, const TriangleMesh& mesh,
                            std::span<const std::uint32_t> candidates, SolidContact* out,
                            int most) {
  detail::DeepestContacts deepest{out, most};
  detail::SurfaceDepth depth(body, mesh);
  for (const auto t : candidates) depth.add(t);
  depth.write(deepest);
  return deepest.count;
}

}  // namespace silt
