// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/volume_overlap.hpp>

/// Contact of polyhedra by the thickness of their intersection: an overlap that equals the depth
/// for faces, is proportional to it for edges and corners, and conserves energy for any law.
///
/// **The overlap.** Let C be the covariance of the points of the intersection, C = int (p - m)(p -
/// m)^T dV/V, m its middle. A slab of thickness d has d^2/12 across; the overlap selects this
/// direction by the harmonic mean, which is continuous:
///   delta = sqrt(12/T),  T = tr C^-1.                                                        (1)
///   two faces     d (1 - d^2/L^2 ...) for a slab of thickness d and width L: the depth
///   edge, corner  proportional to the depth, as the intersection grows without change of shape
///                 (a cube's corner on a plane 0.548 d, its edge 0.707 d).
/// At a face a contact law has thus the stiffness given by the user, for any area, and corners are
/// softer by no more than the squares of these factors.
///
/// **Force.** C depends only on the shape of the intersection, not on its position; only the motion
/// of i's surface in j counts, as for the volume. With q(p) = (p - m)^T C^-2 (p - m),
///   d delta = delta/(2 T V) int (q - T) (du + dw x p) . n_i dA  over (surface of i) in j, (2)
/// which gives the two vectors S and G of a wrench (volume_overlap.hpp (1), with the weight of (2)
/// under the integrals): force on i = -U' S, torque -U' G, for any U(delta). The opposite acts on
/// j. The pressure is (q - T), largest where the intersection is thickest: a tilted block is
/// rotated back, as on an elastic bed. Under the volume law the pressure is uniform.
///
/// Source: silt's own. (2) is the transport theorem for C; the wrench as for Feng et al. 2021.
/// Valid:  while the intersection is thinner than wide. A needle deep in a body is held by its
///         width: delta tends to a constant, the force to 0 (a guard on the overlap stops this).
///         `buried` as for the volume. |grad delta| is 1 for faces, less for edges and corners.
/// Accuracy: C is computed in a frame along the normal and the longest side, which avoids rounding
/// errors for thin slabs and for slivers along an edge.
/// Cost:   benchmarks/shape/bench_polyhedra.cpp. No allocation. Memory of a pair: OverlapMemory.
/// Tests:  tests/shape/volume_overlap.cpp, overlap_laws.cpp

namespace silt::inline SILT_TARGET {

namespace detail {

/// frame_along(n) with x along the part of `way` across n: an intersection along an edge is some
/// 1e-6 as wide as it is long, and an inverse of C in oblique axes would be lost in rounding.
inline RotationMatrix frame_along(const Vec3d& n, const Vec3d& way) {
  const Vec3d x = way - dot(way, n) * n;
  const double length2 = dot(x, x);
  if (!(length2 > 1e-12 * dot(way, way))) return frame_along(n);
  const Vec3d unit = (1 / std::sqrt(length2)) * x;
  return {unit, cross(n, unit), n};
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

/// Edge p -> q of a face with normal n at height h, one per lane: it spans a triangle with a point
/// of the face's plane, and a tetrahedron with the middle. That point is the foot h n of the
/// middle. In slabs as thin as `thin_slab` it is on the slab's middle plane z = 0, where that meets
/// the face's plane within `reach`: the foot on an inclined side would be as far above the slab as
/// the slab is wide, and its square would be lost in rounding.
template <class Real>
struct WayAround {
  Vec3<Real> p, q, n;
  Real h;

  template <bool Thin>
  SILT_INLINE Vec3<Real> foot(const Real& reach) const {
    const Vec3<Real> under = h * n;
    if constexpr (!Thin) return under;
    const Real slant = n.x * n.x + n.y * n.y, zero(0);
    const auto on_middle = h * h < slant * reach * reach;
    const Real scale = h / select(on_middle, slant, Real(1));
    return {select(on_middle, scale * n.x, under.x), select(on_middle, scale * n.y, under.y),
            select(on_middle, zero, under.z)};
  }
  /// [m2] twice the area of its triangle with that point.
  template <bool Thin>
  SILT_INLINE Real twice_area(const Vec3<Real>& foot) const {
    if constexpr (Thin) return dot(n, cross(p - foot, q - foot));
    return dot(n, cross(p, q));
  }
};
/// [-] thickness over width. A covariance by feet errs by 1e-16 of the square of the width: here by
/// 1e-6 of that of the thickness.
inline constexpr double thin_slab = 1e-5;

template <class Real>
double sum_of_lanes(const Real& x) {
  alignas(64) double lanes[Lanes<DefaultArch>::width];
  store(lanes, x);
  double sum = 0;
  for (const double lane : lanes) sum += lane;
  return sum;
}
template <class Real>
Vec3d sum_of_lanes(const Vec3<Real>& v) {
  return {sum_of_lanes(v.x), sum_of_lanes(v.y), sum_of_lanes(v.z)};
}

/// From the middle of the intersection to its farthest corner.
inline Vec3d longest_way(const ClippedBody::Graph& g, const Vec3d& middle) {
  Vec3d longest{0, 0, 0};
  for (std::size_t v = 0; v < g.size; ++v)
    if (const Vec3d way = g.at(v) - middle; dot(way, way) > dot(longest, longest)) longest = way;
  return longest;
}

/// (1) and (2) of the intersection, about its middle and along its normal.
class ThicknessIntegrals {
 public:
  /// `cut`: volume, vector area and middle of the same graph; `longest`: its longest_way().
  ThicknessIntegrals(const ClippedBody::Graph& g, const Polyhedron& body, const Cutter& cutter,
                     const CutIntegrals& cut, const Vec3d& longest)
      : g_(g),
        body_(body),
        cutter_(cutter),
        middle_(cut.middle),
        frame_(frame_along(normalised(cut.area), longest)) {
    const double wide = norm(longest);
    if (cut.volume > thin_slab * wide * norm(cut.area))
      integrate<false>(0);
    else
      integrate<true>(2 * wide);
  }

  double thickness = 0;                  // [m] delta
  Vec3d area{0, 0, 0}, moment{0, 0, 0};  // S, G of (2), G about the middle; frame of the body
  Symmetric3 spread;                     // [m2] C, in `frame`
  const RotationMatrix& frame() const { return frame_; }

 private:
  using Real = Lanes<DefaultArch>::Real;
  static constexpr std::size_t width = Lanes<DefaultArch>::width;

  /// Calls use(WayAround) for all edges of faces of the cutter, or of both bodies, as many at a
  /// time as there are lanes. Unused lanes are zero, and add zero.
  template <bool OfCutterOnly, class Use>
  SILT_INLINE void for_each_way(Use&& use) const {
    alignas(64) double lane[10][width];
    std::size_t filled = 0;
    const auto put = [&](const Vec3d& v, std::size_t row) {
      lane[row][filled] = v.x, lane[row + 1][filled] = v.y, lane[row + 2][filled] = v.z;
    };
    for (std::size_t v = 0; v < g_.size; ++v)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t f = g_.face[v][k];
        if (OfCutterOnly && f < first_cut_face) continue;
        const Vec3d n =
            f < first_cut_face ? body_.faces()[f].normal : cutter_.half(f - first_cut_face).normal;
        put(g_.at(v), 0), put(g_.at(g_.neighbour[v][k]), 3), put(n, 6);
        lane[9][filled] =
            f < first_cut_face ? body_.faces()[f].offset : cutter_.offset[f - first_cut_face];
        if (++filled == width) use(in_frame(lane)), filled = 0;
      }
    if (filled == 0) return;
    for (auto& row : lane)
      for (std::size_t k = filled; k < width; ++k) row[k] = 0;
    use(in_frame(lane));
  }

  SILT_INLINE WayAround<Real> in_frame(const double (&lane)[10][width]) const {
    const auto vector = [&](std::size_t row) {
      return load3<Real>(lane[row], lane[row + 1], lane[row + 2]);
    };
    const auto all = [](const Vec3d& v) { return Vec3<Real>{Real(v.x), Real(v.y), Real(v.z)}; };
    const Vec3<Real> x = all(frame_.x), y = all(frame_.y), z = all(frame_.z), o = all(middle_);
    const auto turned = [&](const Vec3<Real>& v) {
      return Vec3<Real>{dot(x, v), dot(y, v), dot(z, v)};
    };
    const Vec3<Real> n = vector(6);
    return {turned(vector(0) - o), turned(vector(3) - o), turned(n),
            load<Real>(lane[9]) - dot(n, o)};
  }

  template <bool Thin>
  void integrate(double reach) {
    const Moments m = moments<Thin>(Real(reach));
    const double scale = 1 / m.volume;
    mean_ = scale * m.first;
    Symmetric3 c = scale * m.second;
    c += -1.0 * outer(mean_);
    inverse_ = inverse(c);
    spread = c;
    trace_ = inverse_.trace();
    thickness = std::sqrt(12 / trace_);
    add_pressure<Thin>(Real(reach));
    const double weight = thickness / (2 * trace_ * m.volume);
    area = frame_ * (weight * area), moment = frame_ * (weight * moment);
  }

  template <bool Thin>
  Moments moments(const Real& reach) const {
    const Real zero(0);
    Real volume = zero, xx = zero, yy = zero, zz = zero, xy = zero, yz = zero, zx = zero;
    Vec3<Real> first{zero, zero, zero};
    for_each_way<false>([&](const WayAround<Real>& e) {
      const Vec3<Real> foot = e.template foot<Thin>(reach), sum = foot + e.p + e.q;
      const Real part = e.template twice_area<Thin>(foot) * e.h;
      volume += part, first += part * sum;
      for (const Vec3<Real>& v : {sum, foot, e.p, e.q}) {
        const Vec3<Real> w = part * v;
        xx += w.x * v.x, yy += w.y * v.y, zz += w.z * v.z;
        xy += w.x * v.y, yz += w.y * v.z, zx += w.z * v.x;
      }
    });
    Moments m{sum_of_lanes(volume) / 6, (1.0 / 24) * sum_of_lanes(first), {}};
    m.second = (1.0 / 120) * Symmetric3{sum_of_lanes(xx), sum_of_lanes(yy), sum_of_lanes(zz),
                                        sum_of_lanes(xy), sum_of_lanes(yz), sum_of_lanes(zx)};
    return m;
  }

  /// Over the triangles on the cutter's faces, by four points: exact for third powers (P. C.
  /// Hammer, A. H. Stroud, Math. Tables Aids Comput. 10 (1956) 137).
  template <bool Thin>
  void add_pressure(const Real& reach) {
    const Real zero(0), kxx(inverse_.xx), kyy(inverse_.yy), kzz(inverse_.zz), kxy(inverse_.xy),
        kyz(inverse_.yz), kzx(inverse_.zx), mx(mean_.x), my(mean_.y), mz(mean_.z), trace(trace_);
    Vec3<Real> push{zero, zero, zero}, turn{zero, zero, zero};
    for_each_way<true>([&](const WayAround<Real>& e) {
      const Vec3<Real> foot = e.template foot<Thin>(reach), sum = foot + e.p + e.q;
      const Real twice = e.template twice_area<Thin>(foot);
      Real pressure = zero;
      Vec3<Real> at{zero, zero, zero};  // pressure times place
      const auto add = [&](const Vec3<Real>& x, double weight) {
        const Vec3<Real> r{x.x - mx, x.y - my, x.z - mz};
        const Vec3<Real> slope{kxx * r.x + kxy * r.y + kzx * r.z, kxy * r.x + kyy * r.y + kyz * r.z,
                               kzx * r.x + kyz * r.y + kzz * r.z};
        const Real here = Real(weight) * twice * (dot(slope, slope) - trace);
        pressure += here, at += here * x;
      };
      add(Real(1.0 / 3) * sum, -27.0 / 96);
      for (const Vec3<Real>& corner : {foot, e.p, e.q})
        add(Real(0.2) * sum + Real(0.4) * corner, 25.0 / 96);
      push += pressure * e.n, turn += cross(at, e.n);
    });
    area = sum_of_lanes(push), moment = sum_of_lanes(turn);
  }

  const ClippedBody::Graph& g_;
  const Polyhedron& body_;
  const Cutter& cutter_;
  Vec3d middle_;
  RotationMatrix frame_;  // of the integrals, in the frame of the body
  Vec3d mean_{0, 0, 0};
  Symmetric3 inverse_;  // C^-1
  double trace_ = 0;    // T
};

/// Thinner intersections [-, of the body's bounding radius] are ignored.
inline constexpr double thinnest = 1e-12;

/// `sign` +1 if i's planes cut the body, -1 if i was cut.
inline VolumeContact thickness_of(const ClippedBody::Graph& g, const PlacedPolyhedron& body,
                                  const Cutter& cutter, double sign, const Vec3d& towards_i) {
  VolumeContact out;
  const auto cut = CutIntegrator(g, *body.shape, cutter).result();
  if (!(cut.volume > 0)) return out;
  out.volume = cut.volume, out.area = norm(cut.area);
  // Volume over area is a thickness as well, half of (1) or more. For bodies that touch without
  // overlap, as pieces of one body, it is rounding, and so is their C.
  const double least = 0.3 * thinnest * body.shape->bounding_radius();  // [m]
  if (!(cut.volume > least * out.area)) return {};
  const Vec3d longest = longest_way(g, cut.middle);
  const double wide = norm(longest);
  if (!(out.area * out.area * out.area > 1e-30 * cut.volume * cut.volume)) {
    if (!(cut.volume > thinnest * wide * wide * wide)) return {};
    out.buried = true, out.overlap = std::cbrt(cut.volume);
    out.point = body.pose.to_space(cut.middle);
    out.normal = dot(towards_i, towards_i) > 0 ? normalised(towards_i) : Vec3d{0, 0, 1};
    return out;
  }
  // For bodies that share only an edge or a corner, area and volume are both rounding.
  if (!(out.area > least * wide)) return {};
  const ThicknessIntegrals t(g, *body.shape, cutter, cut, longest);
  const double square = dot(t.area, t.area);
  // Below the accuracy of corners, some 1e-16 of the body.
  if (!(t.thickness > thinnest * body.shape->bounding_radius() && square > 0)) return {};
  out.overlap = t.thickness, out.gradient = std::sqrt(square);
  out.normal = body.pose.turn * ((-sign / out.gradient) * t.area);
  out.point = body.pose.to_space(cut.middle + (1 / square) * cross(t.area, t.moment));
  out.couple = dot(t.area, t.moment) / square;
  const auto &turn = body.pose.turn, &frame = t.frame();
  out.spread = tensor_along(turn * frame.x, turn * frame.y, turn * frame.z, t.spread);
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
