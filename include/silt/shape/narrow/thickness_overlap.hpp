// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/volume_overlap.hpp>

/// Contact of polyhedra by the thickness of their intersection: an overlap that is the depth itself
/// for faces, grows in proportion to it for edges and corners, and conserves energy under any law.
///
/// **The overlap.** Let C be the covariance of the points of the intersection, C = int (p - m)(p -
/// m)^T dV/V, m its middle. A slab of thickness d has d^2/12 across; the overlap takes this
/// direction from all by the harmonic mean, which nothing makes jump:
///   delta = sqrt(12/T),  T = tr C^-1. (1) two faces     d (1 - d^2/L^2 ...) for a slab of
///   thickness d and width L: the depth; edge, corner  proportional to the depth, as the
///   intersection grows without change of shape
///                 (a cube's corner on a plane 0.548 d, its edge 0.707 d).
/// So a contact law has at a face the stiffness that its user gave it, whatever the area, and
/// corners are softer by no more than the squares of these factors.
///
/// **Force.** C depends on the shape of the intersection alone, not on where it is, so that only
/// the motion of i's surface in j counts, as for the volume. With q(p) = (p - m)^T C^-2 (p - m),
///   d delta = delta/(2 T V) int (q - T) (du + dw x p) . n_i dA  over (surface of i) in j, (2)
/// which gives the two vectors S and G of a wrench (volume_overlap.hpp (1), with the weight of (2)
/// under the integrals): force on i = -U' S, torque -U' G, for any U(delta). j has the negatives.
/// The pressure is (q - T), largest where the intersection is thickest: a block that tilts is
/// turned back, as on an elastic bed, unlike under the volume law, whose pressure is uniform.
///
/// Source: silt's own. (2) is the transport theorem for C; the wrench as for Feng et al. 2021.
/// Valid:  while the intersection is thinner than wide. A needle that stands deep in a body is held
///         by its width: delta tends to a constant, the force to 0 (a guard on the overlap stops
///         that). `buried` as for the volume. |grad delta| is 1 for faces, less for edges and
///         corners.
/// Accuracy: C is taken in a frame along the normal, so that thin slabs do not drown in rounding.
/// Cost:   benchmarks/shape/bench_polyhedra.cpp. No allocation. Memory of a pair: OverlapMemory.
/// Tests:  tests/shape/volume_overlap.cpp, overlap_laws.cpp

namespace silt::inline SILT_TARGET {

namespace detail {

/// Axes with z along `n`, any unit vector (T. Duff et al., J. Comput. Graph. Tech. 6 (2017) 1).
inline RotationMatrix frame_along(const Vec3d& n) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

inline Vec3d times(const Symmetric3& s, const Vec3d& v) {
  return {s.xx * v.x + s.xy * v.y + s.zx * v.z, s.xy * v.x + s.yy * v.y + s.yz * v.z,
          s.zx * v.x + s.yz * v.y + s.zz * v.z};
}
inline Symmetric3 inverse(const Symmetric3& s) {
  const double xx = s.yy * s.zz - s.yz * s.yz, xy = s.zx * s.yz - s.xy * s.zz,
               zx = s.xy * s.yz - s.zx * s.yy;
  const double scale = 1 / (s.xx * xx + s.xy * xy + s.zx * zx);
  return scale * Symmetric3{xx, s.xx * s.zz - s.zx * s.zx, s.xx * s.yy - s.xy * s.xy,
                            xy, s.xy * s.zx - s.xx * s.yz, zx};
}

/// (1) and (2) of what is left of a body, about its middle and along its normal.
class ThicknessIntegrals {
 public:
  /// `cut`: volume, vector area and middle of the same graph.
  ThicknessIntegrals(const ClippedBody::Graph& g, const Polyhedron& body, const Cutter& cutter,
                     const CutIntegrals& cut)
      : body_(body),
        cutter_(cutter),
        middle_(cut.middle),
        frame_(frame_along(normalised(cut.area))) {
    add_moments(g);
    const double scale = 1 / moments_.volume;
    mean_ = scale * moments_.first;
    Symmetric3 c = scale * moments_.second;
    c += -1.0 * outer(mean_);
    inverse_ = inverse(c);
    trace_ = inverse_.trace();
    thickness = std::sqrt(12 / trace_);
    add_pressure(g);
    const double weight = thickness / (2 * trace_ * moments_.volume);
    area = frame_ * (weight * area), moment = frame_ * (weight * moment);
  }

  double thickness = 0;                  // [m] delta
  Vec3d area{0, 0, 0}, moment{0, 0, 0};  // S, G of (2), G about the middle; frame of the body

 private:
  Vec3d local(const ClippedBody::Graph& g, std::size_t v) const {
    return frame_.back(g.at(v) - middle_);
  }
  HalfSpace plane(std::size_t f) const {
    if (f >= first_cut_face) return cutter_.half(f - first_cut_face);
    return {body_.faces()[f].normal, body_.faces()[f].offset};
  }

  /// Each way p -> q around a face spans a triangle with the foot of the middle on the face's
  /// plane, and a tetrahedron with the middle.
  void add_moments(const ClippedBody::Graph& g) {
    for (std::size_t v = 0; v < g.size; ++v) {
      const Vec3d p = local(g, v);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d q = local(g, g.neighbour[v][k]);
        const auto half = plane(g.face[v][k]);
        const Vec3d n = frame_.back(half.normal);
        const double height = half.offset - dot(half.normal, middle_);
        const double part = dot(n, cross(p, q)) * height / 6;
        const Vec3d foot = height * n, sum = foot + p + q;
        moments_.volume += part;
        moments_.first += (part / 4) * sum;
        for (const Vec3d& x : {sum, foot, p, q}) moments_.second += (part / 20) * outer(x);
      }
    }
  }

  /// The same triangles on the cutter's faces, by four points: exact for third powers (P. C.
  /// Hammer, A. H. Stroud, Math. Tables Aids Comput. 10 (1956) 137).
  void add_pressure(const ClippedBody::Graph& g) {
    for (std::size_t v = 0; v < g.size; ++v)
      for (std::size_t k = 0; k < 3; ++k) {
        if (g.face[v][k] < first_cut_face) continue;
        const auto half = plane(g.face[v][k]);
        const Vec3d p = local(g, v), q = local(g, g.neighbour[v][k]), n = frame_.back(half.normal);
        const Vec3d foot = (half.offset - dot(half.normal, middle_)) * n, sum = foot + p + q;
        const double w = 0.5 * dot(n, cross(p, q));
        const auto add = [&](const Vec3d& at, double weight) {
          const Vec3d slope = times(inverse_, at - mean_);
          const Vec3d push = weight * w * (dot(slope, slope) - trace_) * n;
          area += push, moment += cross(at, push);
        };
        add((1.0 / 3) * sum, -27.0 / 48);
        for (const Vec3d& corner : {foot, p, q}) add(0.2 * sum + 0.4 * corner, 25.0 / 48);
      }
  }

  const Polyhedron& body_;
  const Cutter& cutter_;
  Vec3d middle_;
  RotationMatrix frame_;  // of the integrals, in the frame of the body
  Moments moments_;
  Vec3d mean_{0, 0, 0};
  Symmetric3 inverse_;  // C^-1
  double trace_ = 0;    // T
};

/// `sign` +1 if i's planes cut the body, -1 if i was cut.
inline VolumeContact thickness_of(const ClippedBody::Graph& g, const PlacedPolyhedron& body,
                                  const Cutter& cutter, double sign, const Vec3d& towards_i) {
  VolumeContact out;
  const auto cut = CutIntegrator(g, *body.shape, cutter).result();
  if (!(cut.volume > 0)) return out;
  out.volume = cut.volume, out.area = norm(cut.area);
  if (!(out.area * out.area * out.area > 1e-30 * cut.volume * cut.volume)) {
    out.buried = true, out.overlap = std::cbrt(cut.volume);
    out.point = body.pose.to_space(cut.middle);
    out.normal = dot(towards_i, towards_i) > 0 ? normalised(towards_i) : Vec3d{0, 0, 1};
    return out;
  }
  const ThicknessIntegrals t(g, *body.shape, cutter, cut);
  const double square = dot(t.area, t.area);
  if (!(t.thickness > 0 && square > 0)) return {};  // too thin for numbers
  out.overlap = t.thickness, out.gradient = std::sqrt(square);
  out.normal = body.pose.turn * ((-sign / out.gradient) * t.area);
  out.point = body.pose.to_space(cut.middle + (1 / square) * cross(t.area, t.moment));
  out.couple = dot(t.area, t.moment) / square;
  return out;
}

}  // namespace detail

/// Cores of i and j, as volume_overlap.
inline VolumeContact thickness_overlap(const PlacedPolyhedron& i, const PlacedPolyhedron& j,
                                       const Vec3d& axis) {
  VolumeContact out;
  detail::cut_pair(
      i, j, axis, [&](const auto& graph, const auto& body, const auto& cutter, double sign) {
        out = detail::thickness_of(graph, body, cutter, sign, i.pose.position - j.pose.position);
      });
  return out;
}

/// The core of i with the half-space of all points p with normal . (p - at) < 0; normal a unit
/// vector.
inline VolumeContact thickness_overlap(const PlacedPolyhedron& i, const Vec3d& at,
                                       const Vec3d& normal) {
  VolumeContact out;
  detail::cut_half_space(i, at, normal, [&](const auto& graph, const auto& cutter) {
    out = detail::thickness_of(graph, i, cutter, -1, normal);
  });
  return out;
}

/// As volume_contact, by the thickness.
inline VolumeContact thickness_contact(const PlacedPolyhedron& i, const PlacedPolyhedron& j,
                                       OverlapMemory& memory) {
  return detail::remembered_contact(
      i, j, memory, [&](const Vec3d& axis) { return thickness_overlap(i, j, axis); });
}

}  // namespace silt
