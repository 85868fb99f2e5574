// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/arched_polygon.hpp>
#include <silt/shape/narrow/placed.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Contact of dilated polyhedra by two nearly parallel faces.
///
/// The depth of two such faces is largest at a corner of the region Q that they share, and jumps
/// from corner to corner as they tilt through parallel. In place of this largest depth the overlap
/// takes the faces as slightly arched: with e_k the depths at the corners v_k of Q,
///
///   S = least over z of max_k (e_k + (eta S/rho^2) |v_k - z|^2)                               (1)
///
/// The arch is 0 at corners of Q. Its height is a share of S, so S and the depth vanish together,
/// and S is the depth itself where one corner is deeper than all others by more than the arch
/// (S unchanged, to the last bit). In between the contact point z moves continuously through Q:
///   z = sum_k l_k v_k,  l_k >= 0 the multipliers of (1), sum_k l_k = 1,                        (2)
///   dS = sum_k l_k (de_k + 2 (eta S/rho^2) (v_k - z) . dv_k)/N,
///   N = 1 - (eta/rho^2) sum_k l_k |v_k - z|^2
/// which is the gradient of the overlap: any law conserves energy. Faces that lie flat have
///   S = e/(1 - eta r^2/rho^2), r the radius of the smallest circle around Q.
/// With margins = r_i + r_j of the bodies, the depth is
///   e at x = margins - distance to the plane of i - distance to the plane of j, x between them,
/// which at corners of Q that are corners of a body is the distance of corner and plane.
///
/// (1) holds for faces within half of `largest_tilt` of parallel, and for Q of at least
/// `least_area` rho^2; S goes over into the depth of margin_contact() up to the whole tilt and for
/// Q = 0, by a weight W whose gradient counts too. The tilt is limited to a third of the angle
/// between a face and its neighbours: of finely faceted bodies no other face is then nearer to
/// parallel. Depths beyond some 0.03 rho leave (1) before their point has reached an edge.
///
/// Spread of the contact (friction, damping): the covariance of the largest part of Q that is
/// symmetric about z.
/// Valid:  two faces with together at most 48 corners; others keep the contact of margin_contact().
/// Source: silt's own; (1) is the smallest enclosing circle with weights (N. Megiddo, Proc. 24th
///         FOCS (1983) 1, recalled).
/// Tests:  tests/shape/face_patch.cpp.
struct FacePatch {
  static constexpr double arch = 0.2;           // [-] eta
  static constexpr double largest_tilt = 0.02;  // [rad]
  static constexpr double least_area = 0.01;    // [-] of rho^2
  static constexpr std::size_t most_corners = FlatPolygon::room / 2;
};

/// Two facing faces, seen along the normal between them.
struct FacingFaces {
  const PlacedPolyhedron &i, &j;
  Vec3d n_i, n_j;         // [-] their outward normals
  double off_i, off_j;    // [m] of their planes
  Vec3d origin, m, s, t;  // m: from j to i
  FlatPolygon q;

  FacingFaces(const PlacedPolyhedron& a, const PlacedPolyhedron& b, std::size_t face_a,
              std::size_t face_b, const Vec3d& at)
      : i(a), j(b), origin(at) {
    const auto &fa = i.shape->faces()[face_a], &fb = j.shape->faces()[face_b];
    n_i = i.pose.turn * fa.normal, n_j = j.pose.turn * fb.normal;
    off_i = fa.offset + silt::dot(n_i, i.pose.position - origin);
    off_j = fb.offset + silt::dot(n_j, j.pose.position - origin);
    m = normalised(n_j - n_i);
    tangents(m, s, t);
    if (silt::dot(silt::cross(s, t), m) < 0) std::swap(s, t);
    const auto loop_i = i.shape->loop(fa), loop_j = j.shape->loop(fb);
    const std::size_t count_i = loop_i.size(), count_j = loop_j.size();
    for (std::size_t k = 0; k < count_i; ++k)  // clockwise, seen along -m
      q.add({flat(i, loop_i[count_i - 1 - k]), {}, true});
    for (std::size_t k = 0; k < count_i; ++k) q.corner[k].way = q.after(k).at - q.corner[k].at;
    Flat at_k = flat(j, loop_j[0]);
    const Flat first = at_k;
    for (std::size_t k = 0; k < count_j && q.size > 0; ++k) {
      const Flat next = k + 1 < count_j ? flat(j, loop_j[k + 1]) : first;
      q.cut(at_k, next - at_k, false);
      at_k = next;
    }
  }

  double tilt() const { return 1 + silt::dot(n_i, n_j); }  // [-] 1 - cos
  /// The depths at the corners of q.
  std::array<double, FlatPolygon::room> depths(double margins) const {
    std::array<double, FlatPolygon::room> out;
    const Vec3d both = n_i + n_j;
    const Flat slope{silt::dot(both, s), silt::dot(both, t)};
    const double middle = margins + (off_i + off_j);
    for (std::size_t k = 0; k < q.size; ++k) out[k] = middle - dot(slope, q.corner[k].at);
    return out;
  }
  Vec3d along(const Flat& v) const { return v.x * s + v.y * t; }
  double height_i(const Vec3d& x) const { return (off_i - silt::dot(n_i, x)) / silt::dot(n_i, m); }
  double height_j(const Vec3d& x) const { return (off_j - silt::dot(n_j, x)) / silt::dot(n_j, m); }
  /// How a corner of q moves with i across m: all of w, nothing of it, or along an edge of j. This
  /// returns the transpose, applied to w.
  Vec3d taken_along(std::size_t k, const Vec3d& w) const {
    const auto &in = q.before(k), &out = q.corner[k];
    if (in.of_i == out.of_i) return in.of_i ? w : Vec3d{0, 0, 0};
    const Flat a = in.of_i ? in.way : out.way, b = in.of_i ? out.way : in.way;
    const double across = cross(a, b);
    if (!(across * across > 1e-12 * dot(a, a) * dot(b, b))) return 0.5 * w;
    const double along_b = b.x * silt::dot(w, s) + b.y * silt::dot(w, t);
    return (along_b / across) * (a.x * t - a.y * s);
  }

 private:
  Flat flat(const PlacedPolyhedron& body, std::uint32_t v) const {
    const Vec3d x = body.pose.to_space(body.shape->vertices()[v]) - origin;
    return {silt::dot(x, s), silt::dot(x, t)};
  }
};

/// dS = force . u + torque . w for a motion u, w of i about the origin.
struct PatchGradient {
  Vec3d force{0, 0, 0}, torque{0, 0, 0};

  void add(const Vec3d& f, const Vec3d& at) { force += f, torque += silt::cross(at, f); }
  void scale(double by) { force *= by, torque *= by; }
};

/// (2), without the factor in front of the bracket's inverse.
inline PatchGradient gradient_of(const FacingFaces& faces, const ArchedDepth& found) {
  PatchGradient out;
  const auto& basis = found.best;
  for (std::size_t b = 0; b < basis.size; ++b) {
    const std::size_t k = basis.corner[b];
    const Flat v = faces.q.corner[k].at, arm = v - basis.z;
    const Vec3d x = faces.along(v);
    const double h_i = faces.height_i(x), h_j = faces.height_j(x);
    const Vec3d slope = faces.n_i + faces.n_j;
    const Vec3d across =
        2 * found.bend * faces.along(arm) - slope + silt::dot(slope, faces.m) * faces.m;
    out.add(basis.share[b] * faces.n_i, x + h_j * faces.m);
    out.add(basis.share[b] * faces.taken_along(k, across), x + (0.5 * (h_i + h_j)) * faces.m);
  }
  return out;
}

/// Smooth step from 0 at x <= 0 to 1 at x >= 1, and its slope.
inline std::array<double, 2> smooth_step(double x) {
  if (x <= 0) return {0, 0};
  if (x >= 1) return {1, 0};
  return {x * x * (3 - 2 * x), 6 * x * (1 - x)};
}

/// Two faces close to parallel: their limit of the tilt as 1 - cos, or 0 if they are not.
inline double tilt_limit(const PlacedPolyhedron& i, const PlacedPolyhedron& j,
                         const Polyhedron::Facing& to_j, const Polyhedron::Facing& to_i) {
  constexpr double most = 0.5 * FacePatch::largest_tilt * FacePatch::largest_tilt;
  if (!(to_j.cosine > 1 - most) || !(to_i.cosine > 1 - most)) return 0;
  const double turn = std::min(i.shape->least_turn(to_j.face), j.shape->least_turn(to_i.face)) / 3;
  const double limit = std::min(most, 0.5 * turn * turn);
  const std::size_t corners =
      i.shape->faces()[to_j.face].corners + j.shape->faces()[to_i.face].corners;
  const bool near = to_j.cosine > 1 - limit && to_i.cosine > 1 - limit;
  return near && corners <= FacePatch::most_corners ? limit : 0;
}

/// Weight W of (1), and what its gradient needs.
struct PatchWeight {
  double limit, area;  // [-] of the tilt, [m2] from which Q counts in full
  std::array<double, 2> upright, wide;

  PatchWeight(const FacingFaces& faces, double most, double rho)
      : limit(most),
        area(FacePatch::least_area * rho * rho),
        upright(smooth_step((4 * faces.tilt() / limit - 1) / 3)),
        wide(smooth_step(faces.q.area() / area)) {}
  double value() const { return (1 - upright[0]) * wide[0]; }
  /// Adds `by` times the gradient of W.
  void add_gradient(const FacingFaces& faces, double by, PatchGradient& sum) const {
    const double by_tilt = -by * wide[0] * upright[1] * 4 / (3 * limit);
    sum.torque += by_tilt * silt::cross(faces.n_i, faces.n_j);
    if (!(wide[1] > 0)) return;
    const double by_area = by * (1 - upright[0]) * wide[1] / area;
    for (std::size_t k = 0; k < faces.q.size; ++k)
      if (faces.q.corner[k].of_i) {
        const Flat a = faces.q.corner[k].at, edge = faces.q.after(k).at - a;
        sum.add(by_area * faces.along({edge.y, -edge.x}), faces.along(a + 0.5 * edge));
      }
  }
};

/// Force, its place and the spread from the gradient of the overlap.
inline void set_contact(const FacingFaces& faces, const PatchGradient& sum, const Flat& z,
                        double rho, double weight, SolidContact& out) {
  const double size = norm(sum.force), square = size * size;
  const Vec3d middle = faces.along(z);
  const Vec3d at = (1 / square) * silt::cross(sum.force, sum.torque),
              height = middle + (0.5 * (faces.height_i(middle) + faces.height_j(middle))) * faces.m;
  out.normal = (-1 / size) * sum.force, out.gradient = size;
  out.couple = silt::dot(sum.force, sum.torque) / square;
  out.point = faces.origin + at + silt::dot(height - at, out.normal) * out.normal;
  const auto c = faces.q.about(z, 1e-9).covariance(z, 1e-6 * rho);
  out.spread = weight * tensor_along(faces.s, faces.t, faces.m, {c[0], c[1], 0, c[2], 0, 0});
}

enum class FaceState { Unknown, Corner, Smooth };

/// The contact (1) of two nearly parallel faces in `out`, which holds that of margin_contact() if
/// `is_known`. Without it only contacts of full weight whose cores are apart are found: then these
/// faces have the least distance of the bodies, as both are convex. FaceState::Corner: that of
/// margin_contact() is right.
inline FaceState touch_faces(const PlacedPolyhedron& i, const PlacedPolyhedron& j,
                             const Polyhedron::Facing& to_j, const Polyhedron::Facing& to_i,
                             bool is_known, SolidContact& out) {
  const double limit = tilt_limit(i, j, to_j, to_i);
  if (!(limit > 0)) return FaceState::Unknown;
  const Vec3d origin = is_known ? out.point : 0.5 * (i.pose.position + j.pose.position);
  const FacingFaces faces(i, j, to_j.face, to_i.face, origin);
  if (!(faces.tilt() < limit) || faces.q.size < 3) return FaceState::Unknown;
  const double rho = std::min(i.shape->bounding_radius(), j.shape->bounding_radius()),
               per_depth = FacePatch::arch / (rho * rho);
  const PatchWeight weight(faces, limit, rho);
  const double W = weight.value();
  if (is_known ? !(W > 0) : W < 1) return FaceState::Unknown;

  const double margins = i.shape->radius() + j.shape->radius();
  const auto depth = faces.depths(margins);
  ArchedDepth found{faces.q, depth, rho};
  if (found.is_corner(per_depth)) return FaceState::Corner;
  if (!(found.best.value > 0) || (!is_known && found.best.value >= margins))
    return FaceState::Unknown;
  found.solve(per_depth);

  PatchGradient sum = gradient_of(faces, found);
  sum.scale(W / (1 - per_depth * found.square()));
  if (W < 1) {
    sum.add((W - 1) * out.normal, {0, 0, 0});
    weight.add_gradient(faces, found.best.value - out.overlap, sum);
  }
  out.overlap = is_known ? out.overlap + W * (found.best.value - out.overlap) : found.best.value;
  set_contact(faces, sum, found.best.z, rho, W, out);
  return FaceState::Smooth;
}

}  // namespace silt::detail
