// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/shape/narrow/solid_planes.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Triangles with a function e that is linear on each, and the integrals of its powers.
///
/// Exact: over a triangle the integral of e^m is 2 area m!/(m + 2)! h_m(e0, e1, e2), h the sum of
/// all products of m factors. Its derivative by e_i is m times the integral of e^(m-1) and the
/// share of corner i, and that of h_m is h_(m-1) of all three and of e_i once more.
template <int Power>
class PowerIntegrals {
 public:
  static constexpr std::size_t lanes = 8;
  static constexpr int m = Power;

  bool is_full() const { return count_ == lanes; }
  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c, const std::array<double, 3>& e,
           std::uint32_t face) {
    const std::size_t k = count_++;
    corner_[0][k] = a, corner_[1][k] = b, corner_[2][k] = c;
    for (std::size_t n = 0; n < 3; ++n) e_[n][k] = e[n];
    twice_area_[k] = norm(cross(b - a, c - a));
    face_[k] = face;
  }
  /// Integrals of e^(m-2) and its products with the position.
  struct Spread {
    double weight = 0;
    Vec3d first{0, 0, 0};
    Symmetric3 second;
    void add(const Spread& more) {
      weight += more.weight, first += more.first, second += more.second;
    }
    /// Covariance of the position.
    Symmetric3 covariance() const {
      const double over = 1 / weight;
      Symmetric3 c = over * second;
      c += -1.0 * outer(over * first);
      return c;
    }
  };
  /// Calls use(face, integral of e^m, of e^(m-1), of e^(m-1) x, Spread) for each face and clears
  /// them.
  template <class Use>
  void end(const Use& use) {
    double h[m + 1][lanes], slope[lanes];
    for (std::size_t k = count_; k < lanes; ++k) e_[0][k] = e_[1][k] = e_[2][k] = 0;
    for (std::size_t k = 0; k < lanes; ++k) h[0][k] = 1;
    for (int p = 1; p <= m; ++p)
      for (std::size_t k = 0; k < lanes; ++k) h[p][k] = e_[0][k] * h[p - 1][k];
    for (int n = 1; n < 3; ++n)
      for (int p = 1; p <= m; ++p)
        for (std::size_t k = 0; k < lanes; ++k) h[p][k] += e_[n][k] * h[p - 1][k];
    double part[3][lanes], bend[3][3][lanes];
    for (int n = 0; n < 3; ++n) {
      for (std::size_t k = 0; k < lanes; ++k) slope[k] = 1;
      for (int q = n; q < 3; ++q)
        for (std::size_t k = 0; k < lanes; ++k) bend[n][q][k] = 1;
      for (int p = 1; p < m; ++p) {
        for (std::size_t k = 0; k < lanes; ++k) slope[k] = h[p][k] + e_[n][k] * slope[k];
        for (int q = n; q < 3 && p < m - 1; ++q)
          for (std::size_t k = 0; k < lanes; ++k)
            bend[n][q][k] = slope[k] + e_[q][k] * bend[n][q][k];
      }
      for (std::size_t k = 0; k < lanes; ++k) part[n][k] = slope[k];
    }
    for (std::size_t k = 0; k < count_; ++k) {
      const double share = twice_area_[k] / (m * (m + 1) * (m + 2));
      const double less = share * (part[0][k] + part[1][k] + part[2][k]);
      Spread spread;
      const double flat = share / (m - 1);
      for (int n = 0; n < 3; ++n) {
        Vec3d row = (2 * flat * bend[n][n][k]) * corner_[n][k];
        double weight = 2 * flat * bend[n][n][k];
        for (int q = 0; q < 3; ++q) {
          if (q == n) continue;
          const double both = flat * bend[std::min(n, q)][std::max(n, q)][k];
          row += both * corner_[q][k], weight += both;
        }
        const Vec3d& x = corner_[n][k];
        spread.weight += weight, spread.first += weight * x;
        spread.second +=
            {x.x * row.x, x.y * row.y, x.z * row.z, x.x * row.y, x.y * row.z, x.z * row.x};
      }
      use(face_[k], twice_area_[k] / ((m + 1) * (m + 2)) * h[m][k], less,
          share * (part[0][k] * corner_[0][k] + part[1][k] * corner_[1][k] +
                   part[2][k] * corner_[2][k]),
          spread);
    }
    count_ = 0;
  }

 private:
  alignas(64) double e_[3][lanes];
  double twice_area_[lanes];
  Vec3d corner_[3][lanes];
  std::uint32_t face_[lanes];
  std::size_t count_ = 0;
};

/// Effect of a mesh surface in a sharp polyhedron, patch by patch; see surface_contacts().
class SurfaceDepth {
 public:
  static constexpr int power = 16;

  SurfaceDepth(const PlacedPolyhedron& body, const TriangleMesh& mesh)
      : body_(body), mesh_(mesh), unit_(body.shape->bounding_radius()), work_(memory()) {}

  /// `way` [m]: displacement of the body for this triangle.
  void add(std::uint32_t t, const Vec3d& way = {0, 0, 0}) {
    const double over = 1 / unit_;
    auto& [polygon, cell, next, faces, low] = work_;
    polygon.clear();
    for (const auto v : mesh_.triangles()[t])
      polygon.push_back(over * body_.pose.to_body(mesh_.vertices()[v] - way));
    if (!cut_by_bound() || !cut_by_body()) return;
    find_nearest_faces();
    Patch* const patch = patch_of(mesh_.patches()[t]);
    if (patch == nullptr) return;
    const auto use = [&](std::uint32_t f, double full, double less, const Vec3d& place,
                         const Sums::Spread& spread) {
      patch->spread.add(spread);
      const Vec3d& n = body_.shape->faces()[f].normal;
      patch->full += full, patch->less += less;
      patch->place += place;
      patch->push += less * n;
      patch->torque += cross(place, n);
    };
    const auto& all = body_.shape->faces();
    for (const auto f : faces) {
      cell = polygon;
      for (const auto g : faces) {
        if (g == f) continue;  // where it is nearer than the other
        cut(cell, all[g].normal - all[f].normal, (all[g].offset - all[f].offset) / unit_);
        if (cell.size() < 3) break;
      }
      for (std::size_t k = 2; k < cell.size(); ++k) {
        sums_.add(cell[0], cell[k - 1], cell[k],
                  {std::max(depth(f, cell[0]), 0.0), std::max(depth(f, cell[k - 1]), 0.0),
                   std::max(depth(f, cell[k]), 0.0)},
                  f);
        if (sums_.is_full()) sums_.end(use);
      }
    }
    sums_.end(use);
  }

  void write(DeepestContacts& deepest) const {
    for (std::size_t k = 0; k < count_; ++k) deepest.add(contact(patch_[k]));
  }

 private:
  static constexpr std::size_t most = 16;
  static constexpr std::uint32_t few = 16;  // faces that are tested one by one

  // All in units of the bounding radius, in the body's axes.
  using Sums = PowerIntegrals<power>;
  struct Patch {
    std::uint32_t number;
    double full;   // integral of the depth to `power`
    double less;   // ... to one less
    Vec3d place;   // of that, times the position
    Vec3d push;    // of that, times the normal of the nearest face
    Vec3d torque;  // of that, times place x normal
    Sums::Spread spread;
  };
  struct Memory {
    DynArray<Vec3d> polygon, cell, next;
    DynArray<std::uint32_t> faces;
    DynArray<double> numbers;
  };
  static Memory& memory() {
    thread_local Memory work;
    return work;
  }

  double depth(std::uint32_t f, const Vec3d& x) const {
    const auto& face = body_.shape->faces()[f];
    return face.offset / unit_ - dot(face.normal, x);
  }
  /// Keeps the part of a polygon with normal . x <= offset.
  void cut(DynArray<Vec3d>& polygon, const Vec3d& normal, double offset) {
    auto& [unused, cell, next, faces, inside] = work_;
    inside.clear();
    bool none = true, all = true;
    for (const Vec3d& x : polygon) {
      const double by = offset - dot(normal, x);
      inside.push_back(by);
      none &= by < 0, all &= !(by < 0);
    }
    if (all) return;
    next.clear();
    if (!none) {
      std::size_t last = polygon.size() - 1;
      for (std::size_t k = 0; k < polygon.size(); last = k++) {
        const double before = inside[last], now = inside[k];
        if ((before < 0) != (now < 0))
          next.push_back(polygon[last] + (before / (before - now)) * (polygon[k] - polygon[last]));
        if (!(now < 0)) next.push_back(polygon[k]);
      }
    }
    polygon.swap(next);
  }
  /// A ball around a polygon.
  struct Ball {
    Vec3d centre;
    double radius;
  };
  static Ball ball_about(const DynArray<Vec3d>& polygon) {
    Vec3d sum{0, 0, 0};
    for (const Vec3d& x : polygon) sum += x;
    const Vec3d centre = (1 / static_cast<double>(polygon.size())) * sum;
    double square = 0;
    for (const Vec3d& x : polygon) square = std::max(square, dot(x - centre, x - centre));
    return {centre, std::sqrt(square)};
  }

  /// Reduces a large triangle to a square around the section of the bounding sphere with its plane.
  bool cut_by_bound() {
    auto& polygon = work_.polygon;
    const Vec3d across = cross(polygon[1] - polygon[0], polygon[2] - polygon[0]);
    const Vec3d n = (1 / norm(across)) * across;
    const double height = dot(n, polygon[0]), square = 1 - height * height;
    if (!(square > 0)) return false;
    if (dot(across, across) < 1) return true;  // no larger than the body
    const double r = std::sqrt(square);
    Vec3d s, t;
    tangents(n, s, t);
    for (const Vec3d& way : {s, -s, t, -t}) {
      cut(polygon, way, r);
      if (polygon.size() < 3) return false;
    }
    return true;
  }
  bool cut_by_body() {
    const auto& plane = body_.shape->plane_columns();
    const auto count = static_cast<std::uint32_t>(body_.shape->faces().size());
    auto& [polygon, cell, next, crossed, low] = work_;
    crossed.clear();
    if (count <= few) {
      for (std::uint32_t f = 0; f < count; ++f) {
        double least = 4, most_depth = -4;
        for (const Vec3d& x : polygon) {
          const double e = depth(f, x);
          least = std::min(least, e), most_depth = std::max(most_depth, e);
        }
        if (!(most_depth > 0)) return false;
        if (least < 0) crossed.push_back(f);
      }
    } else {
      const Ball ball = ball_about(polygon);
      for (std::uint32_t f = 0; f < count; ++f) {
        const double e =
            plane.w[f] / unit_ - dot(Vec3d{plane.x[f], plane.y[f], plane.z[f]}, ball.centre);
        if (e <= -ball.radius) return false;
        if (e < ball.radius) crossed.push_back(f);
      }
    }
    for (const auto f : crossed) {
      cut(polygon, body_.shape->faces()[f].normal, body_.shape->faces()[f].offset / unit_);
      if (polygon.size() < 3) return false;
    }
    return true;
  }
  /// Faces that can be the nearest somewhere on the polygon.
  void find_nearest_faces() {
    const auto& plane = body_.shape->plane_columns();
    const auto count = static_cast<std::uint32_t>(body_.shape->faces().size());
    auto& [polygon, cell, next, faces, low] = work_;
    const Ball ball = ball_about(polygon);
    faces.clear();
    double least = 4;  // no point is deeper than that
    for (std::uint32_t f = 0; f < count; ++f) {
      const double e =
          plane.w[f] / unit_ - dot(Vec3d{plane.x[f], plane.y[f], plane.z[f]}, ball.centre);
      if (e > least + 2 * ball.radius) continue;
      faces.push_back(f), least = std::min(least, e);
    }
    double bound = 4;
    low.clear();
    for (const auto f : faces) {
      double least_depth = 4, most_depth = -4;
      for (const Vec3d& x : polygon) {
        const double e = depth(f, x);
        least_depth = std::min(least_depth, e), most_depth = std::max(most_depth, e);
      }
      low.push_back(least_depth), bound = std::min(bound, most_depth);
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < faces.size(); ++k)
      if (low[k] <= bound) faces[kept++] = faces[k];
    faces.resize(kept);
  }
  Patch* patch_of(std::uint32_t number) {
    for (std::size_t k = 0; k < count_; ++k)
      if (patch_[k].number == number) return &patch_[k];
    if (count_ == most) return nullptr;
    patch_[count_] = {number, 0, 0, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {}};
    return &patch_[count_++];
  }
  SolidContact contact(const Patch& p) const {
    SolidContact out;
    out.feature = static_cast<std::uint32_t>(Polyhedron::most_vertices) + p.number;
    const double pushed = norm(p.push);
    if (!(p.full > 1e-280) || !(pushed > 1e-6 * p.less)) return out;  // none, or uniform pressure
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
    out.spread = (unit_ * unit_) * turned(body_.pose.turn, p.spread.covariance());
    return out;
  }

  const PlacedPolyhedron& body_;
  const TriangleMesh& mesh_;
  double unit_;  // [m]
  Memory& work_;
  std::array<Patch, most> patch_;
  std::size_t count_ = 0;
  Sums sums_;
};

}  // namespace detail

/// Contacts of a sharp polyhedron with a mesh: one with each patch (TriangleMesh::patches()). With
/// e(x) the depth of a point of the surface in the body, the distance to the nearest of its faces'
/// planes, and S a sixth of the body's area,
///
///   overlap = (1/S integral of e^16 over the part of the patch in the body)^(1/16)           (1)
///
/// It is the depth, except for 0.24 depth/edge of it, if a cube lies on a plane; 0.46 of the depth
/// for an edge with a depth of 1 % of the size, 0.25 for such a corner. As (1) and its gradient are
/// continuous in position and orientation, energy is conserved for any law; more surface in the
/// body, or a larger depth, never reduces the overlap. The result does not depend on the
/// triangulation, on the size of triangles, or on which of their sides is solid: the body is pushed
/// out through its nearest faces.
///
/// Valid:   less than half of the body through the surface. A body compressed uniformly from all
///          sides by a patch has no direction, and no contact. Up to 16 patches.
/// Source:  silt's own; the idea of a depth within the body whose integral is the potential is that
///          of pressure fields (Elandt, Drumwright, Sherman and Ruina, IROS 2019).
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
