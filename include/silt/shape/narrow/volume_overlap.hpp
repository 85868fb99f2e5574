// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/cut_pair.hpp>

/// Contact of polyhedra by the volume V of their intersection. Any contact law with a potential
/// becomes an energy-conserving one.
///
/// **Geometry.** Let body i move by dx(p) = du + dw x p relative to j. Only the part of its surface
/// inside j sweeps volume, hence
///   dV = S . du + G . dw,   S = int n_i dA,   G = int p x n_i dA   over (surface of i) in j. (1)
/// A potential W(V) hence acts on i with the force -W' S and the torque -W' G about the origin: a
/// wrench whose axis has the direction of S, passes through x_c = (S x G)/|S|^2, and carries the
/// couple -W' (S . G)/|S|^2 S. Here G is taken about the middle of the intersection, and x_c is the
/// point of the axis nearest to it. The opposite acts on j, as its own surface has -S and -G.
///
/// **The overlap.** A contact law is a function U(delta) of a length. Let delta = g(V), then
///   dU = U'(delta) g'(V) dV : force on i = U'(delta) |grad delta| n, n = -S/|S|,
///   |grad delta| = g'(V) |S|,   torque about x_c = that force times the couple (S . G)/|S|^2, (2)
/// conserve energy for ANY law and any g. For continuous forces,
///   delta = L (V/L^3)^p,   g' = p delta/V, (3)
/// L a length of the pair, p the exponent. A law U ~ delta^q then is W ~ V^(p q). As a function of
/// the depth d of touching features (face V ~ d, edge ~ d^2, corner ~ d^3) the force is
///   face d^(pq - 1),   edge d^(2pq - 1),   corner d^(3pq - 1). (4)
/// p q > 1 is needed, otherwise the force jumps at the first touch of two faces (p q = 1: Feng's
/// linear energy, F = k |S|). With the default p = 2/3 the linear law (q = 2) has V^(4/3), Hertz (q
/// = 5/2) has V^(5/3). The smooth V^(3/2) is between them; p = 3/(2 q) gives it exactly (F = k
/// sqrt(V) |S|). p q = 2 makes a face a linear spring, k (A/L^2)^2, with very soft corners (d^5).
/// Along the axis, the stiffness is dF/dd = U'' |grad delta|^2 + U' d|grad delta|/dd; for a face of
/// fixed area (|S| = A, V = A d) it is U'' g'^2 A^2 + U' g'' A^2. At a fixed load it grows as 1/d
/// if p q < 2: a light face contact is stiff, but its force is bounded by (4).
///
/// The mean depth delta = V/|S| is not used: its force must include the change of |S|, and when a
/// block tilts through full face contact d|S| jumps, and with it the force (by a factor 2 at the
/// edge); without that term energy is not conserved. The volume has no such jump. It has a kink
/// where a face of i and one of j are coplanar with the same outward direction, as when aligned
/// blocks slide past full cover: there a side force W' (depth times width) changes sign.
///
/// **Rates.** d delta/dt = -|grad delta| (n . v + couple n . w), v, w of i relative to j at the
/// point: a dashpot on d delta/dt through (2) never adds energy. The mass of the coordinate delta
/// is m*/|grad delta|^2 (without rotation).
///
/// **Limitation.** The pressure W' is uniform over the contact. A block that rests on a full face
/// therefore tilts freely up to about 2 d/L (d its depth there), where an edge lifts and the force
/// moves to the other side; rocking within that range is not damped either.
///
/// Source: Y. T. Feng, K. Han, D. R. J. Owen, Comput. Methods Appl. Mech. Eng. 373 (2021) 113454
///         (the energy-conserving volume model; S and x_c); (3), (4) and the couple are silt's.
/// Valid:  convex bodies of up to 4000 faces; concave ones as sums over parts. If i is completely
///         inside j then S = 0: no force; `gradient` is 0 and `buried` is set, a guard must stop.
///         Dilated bodies touch by their cores here; for their radius see
///         narrow/margin_contact.hpp.
/// Cost:   no allocation; benchmarks/shape/bench_polyhedra.cpp.
/// Tests:  tests/shape/volume_overlap.cpp (Monte Carlo, finite differences of V, energy of
///         collisions, continuity of face contacts, a cube at rest)

namespace silt::inline SILT_TARGET {

/// Intersection of i with j, or with a half-space.
struct VolumeOverlap {
  double volume = 0;     // [m3], 0: apart
  Vec3d area{0, 0, 0};   // [m2] S of (1): vector area of i's surface inside j
  Vec3d point{0, 0, 0};  // [m] x_c on the axis of the wrench
  double couple = 0;     // [m] S . G/|S|^2: pitch of the wrench
};

/// Conversion of volume to overlap, (3).
struct VolumeScale {
  double length;              // [m] L
  double exponent = 2.0 / 3;  // [-] p
};

/// L for a pair: the smaller cube root of the two volumes [m3]; faces of equal cubes then have |S|
/// = L^2. Walls count as infinitely large.
inline double volume_scale_length(double volume_i, double volume_j) {
  return std::cbrt(std::min(volume_i, volume_j));
}

/// Input of a contact law. Force on i: F = U'(overlap) gradient normal at `point`; torque on i
/// about `point`: couple F; the opposite on j.
struct VolumeContact {
  Vec3d normal{0, 0, 0};  // [-] unit, from j to i
  double overlap = 0;     // [m] delta; 0: not touching
  double gradient = 0;    // [-] |grad delta|
  Vec3d point{0, 0, 0};   // [m]
  double couple = 0;      // [m]
  double area = 0;        // [m2] |S|
  double volume = 0;      // [m3]
  bool buried = false;    // one body completely inside the other: no direction, no force
  Symmetric3 spread;      // [m2] covariance of the intersection across the normal; by thickness
};

/// Memory of a pair (12 bytes): a direction from j to i, along which the bodies were apart or
/// pressed, and whether they touched. It affects only the speed. Initially zero.
struct OverlapMemory {
  float x = 0, y = 0, z = 0;

  Vec3d axis() const { return {x, y, z}; }
  bool touched() const { return x * x + y * y + z * z > 2; }
  /// Length 1: were apart; length 2: touched.
  void set(const Vec3d& unit, bool touching) {
    const double scale = touching ? 2 : 1;
    x = static_cast<float>(scale * unit.x), y = static_cast<float>(scale * unit.y),
    z = static_cast<float>(scale * unit.z);
  }
};

namespace detail {

/// Volume, S, G (about `middle`) of the intersection, S and G of the cutter's faces.
struct CutIntegrals {
  double volume = 0;
  Vec3d area{0, 0, 0}, moment{0, 0, 0}, middle{0, 0, 0};
};

/// Uses only directed edges: each edge p -> q of a face with normal n spans, with the foot of the
/// origin on its plane, the part w = n . (p x q)/2 of its area. Then
class CutIntegrator {
 public:
  CutIntegrator(const ClippedBody::Graph& g, const Polyhedron& body, const Cutter& cutter)
      : body_(body.plane_columns()), cutter_(cutter) {
    Vec3d middle{0, 0, 0};
    for (std::size_t v = 0; v < g.size; ++v) middle += g.at(v);
    out_.middle = middle * (1 / static_cast<double>(g.size));
    for (std::size_t v = 0; v < g.size; ++v) {
      const Vec3d p = g.at(v) - out_.middle;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t other = g.neighbour[v][k];
        if (other < v) continue;  // both directions at once
        const Vec3d q = g.at(other) - out_.middle, pq = cross(p, q);
        add(g.face[v][k], pq, p + q);
        add(g.face[v][k == 2 ? 0 : k + 1], -pq, p + q);
      }
    }
    out_.volume *= 1.0 / 6;
    out_.area *= 0.5;
    out_.moment *= 1.0 / 6;
  }
  const CutIntegrals& result() const { return out_; }

 private:
  /// Both kinds of faces in one stream: branches would be unpredictable.
  SILT_INLINE void add(std::size_t f, const Vec3d& pq, const Vec3d& sum) {
    const bool own = f < first_cut_face;
    const std::size_t at = own ? f : f - first_cut_face;
    const Vec3d n{*((own ? body_.x.data() : cutter_.x) + at),
                  *((own ? body_.y.data() : cutter_.y) + at),
                  *((own ? body_.z.data() : cutter_.z) + at)};
    const double offset = *((own ? body_.w.data() : cutter_.offset) + at);
    const double twice = dot(n, pq), of_cut = own ? 0 : twice;
    out_.volume += twice * (offset - dot(n, out_.middle));
    out_.area += of_cut * n;
    out_.moment += cross(of_cut * sum, n);
  }

  const Polyhedron::Columns& body_;
  const Cutter& cutter_;
  CutIntegrals out_;
};

/// To space, for i: `sign` +1 if i's planes cut j, -1 if i was cut.
inline VolumeOverlap finish(const CutIntegrals& cut, const RigidPose& body, double sign) {
  VolumeOverlap out;
  if (!(cut.volume > 0)) return out;
  const double square = dot(cut.area, cut.area);
  const double scale = square > 0 ? 1 / square : 0;
  out.volume = cut.volume;
  out.area = body.turn * (sign * cut.area);
  out.point = body.to_space(cut.middle + scale * cross(cut.area, cut.moment));
  out.couple = scale * dot(cut.area, cut.moment);
  return out;
}

}  // namespace detail

/// Cores of i and j. `axis`: roughly from j to i, not zero; it determines the order of the cuts,
/// for speed.
inline VolumeOverlap volume_overlap(const PlacedPolyhedron& i, const PlacedPolyhedron& j,
                                    const Vec3d& axis) {
  VolumeOverlap out;
  detail::cut_pair(
      i, j, axis, [&](const auto& graph, const auto& body, const auto& cutter, double sign) {
        out = detail::finish(detail::CutIntegrator(graph, *body.shape, cutter).result(), body.pose,
                             sign);
      });
  return out;
}

/// The core of i with the half-space of all points p with normal . (p - at) < 0; normal a unit
/// vector.
inline VolumeOverlap volume_overlap(const PlacedPolyhedron& i, const Vec3d& at,
                                    const Vec3d& normal) {
  VolumeOverlap out;
  detail::cut_half_space(i, at, normal, [&](const auto& graph, const auto& cutter) {
    out = detail::finish(detail::CutIntegrator(graph, *i.shape, cutter).result(), i.pose, -1);
  });
  return out;
}

/// The core of i with the prism behind a triangle of a mesh wall (counter-clockwise seen from the
/// free side): behind its plane, between the planes through its sides. Prisms of a flat wall fill
/// the space behind it for any triangulation; the sum is then that of the half-space. At an edge
/// between flat parts the error is the volume behind both or neither, of second order in the depth.
inline VolumeOverlap volume_overlap(const PlacedPolyhedron& i,
                                    const std::array<Vec3d, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3d up = normalised(cross(b - a, c - a));
  detail::Cutter& cutter = detail::Cutter::empty();
  const auto add = [&](const Vec3d& at, const Vec3d& normal) {
    const Vec3d n = i.pose.turn.back(normal);
    const std::size_t k = cutter.size++;
    cutter.x[k] = n.x, cutter.y[k] = n.y, cutter.z[k] = n.z;
    cutter.offset[k] = dot(normal, at - i.pose.position);
  };
  add(a, up);
  for (std::size_t k = 0; k < 3; ++k)
    add(triangle[k], normalised(cross(triangle[(k + 1) % 3] - triangle[k], up)));
  detail::ClippedBody& left = detail::ClippedBody::whole(*i.shape);
  if (!detail::cut_by_all(left, cutter, 0)) return {};
  return detail::finish(detail::CutIntegrator(left.graph(), *i.shape, cutter).result(), i.pose, -1);
}

/// (2) and (3). `towards_i`: any direction from j to i, for a buried body, which has none.
inline VolumeContact contact_of(const VolumeOverlap& o, const VolumeScale& scale,
                                const Vec3d& towards_i) {
  VolumeContact out;
  if (!(o.volume > 0)) return out;
  const double length = scale.length, area = norm(o.area);
  out.volume = o.volume, out.area = area, out.point = o.point;
  out.overlap = length * std::pow(o.volume / (length * length * length), scale.exponent);
  if (area * area * area > 1e-30 * o.volume * o.volume) {
    out.normal = o.area * (-1 / area), out.couple = o.couple;
    out.gradient = scale.exponent * out.overlap / o.volume * area;
  } else {
    out.buried = true;
    out.normal = dot(towards_i, towards_i) > 0 ? normalised(towards_i) : Vec3d{0, 0, 1};
  }
  return out;
}

namespace detail {
/// overlap_along(axis) is called unless the remembered axis shows the bodies apart; a search for a
/// new axis (GJK) is rare.
template <class Overlap>
VolumeContact remembered_contact(const PlacedPolyhedron& i, const PlacedPolyhedron& j,
                                 OverlapMemory& memory, Overlap&& overlap_along) {
  const Vec3d between = i.pose.position - j.pose.position;
  Vec3d axis = memory.axis();
  const bool known = dot(axis, axis) > 0;
  if (!known) axis = dot(between, between) > 0 ? between : Vec3d{0, 0, 1};
  if (!memory.touched() && gap_along(i, j, axis) >= 0) {
    if (!known) memory.set(normalised(axis), false);
    return {};
  }
  const VolumeContact contact = overlap_along(axis);
  if (contact.overlap > 0) {
    memory.set(contact.normal, true);
  } else {
    const auto apart = gjk_distance(i, j, axis);
    memory.set(apart.overlapping ? normalised(axis) : apart.normal, false);
  }
  return contact;
}
}  // namespace detail

/// Contact of two bodies. The caller excludes pairs with separate bounding spheres.
inline VolumeContact volume_contact(const PlacedPolyhedron& i, const PlacedPolyhedron& j,
                                    const VolumeScale& scale, OverlapMemory& memory) {
  return detail::remembered_contact(i, j, memory, [&](const Vec3d& axis) {
    return contact_of(volume_overlap(i, j, axis), scale, i.pose.position - j.pose.position);
  });
}

}  // namespace silt
