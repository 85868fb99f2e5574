// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/clip.hpp>
#include <silt/shape/narrow/placed_polyhedron.hpp>

/// Intersection of two bodies, or of a body and a half-space, as a graph: the planes that cut a
/// body, and their order. The result does not depend on the order; the speed does.
/// Tests:   tests/shape/volume_overlap.cpp

namespace silt::inline SILT_TARGET::detail {

/// Half-spaces of a cutter in the frame of the body to be cut. Columns for lanes.
struct Cutter {
  static constexpr std::size_t most = (Polyhedron::most_faces + 7) / 8 * 8;
  alignas(64) double x[most], y[most], z[most], offset[most];
  std::size_t size;

  /// The object of this thread, emptied.
  static SILT_INLINE Cutter& empty() {
    Cutter& all = room_of_thread<Cutter>();
    all.size = 0;
    return all;
  }
  HalfSpace half(std::size_t k) const { return {{x[k], y[k], z[k]}, offset[k]}; }
};

/// Planes of `by` in the frame of `body`: n . (D + Q x) <= offset, D and Q position and rotation of
/// `body` relative to `by`.
inline void place_planes(const PlacedPolyhedron& by, const PlacedPolyhedron& body, Cutter& out) {
  using Real = Lanes<DefaultArch>::Real;
  const Vec3d d = by.pose.to_body(body.pose.position);
  const auto &a = by.pose.turn, &b = body.pose.turn;
  const Vec3d qx = a.back(b.x), qy = a.back(b.y), qz = a.back(b.z);
  const auto& c = by.shape->plane_columns();
  out.size = by.shape->faces().size();
  for (std::size_t k = 0; k < c.padded; k += Lanes<DefaultArch>::width) {
    const Real nx = load_any<Real>(&c.x[k]), ny = load_any<Real>(&c.y[k]),
               nz = load_any<Real>(&c.z[k]);
    store(out.x + k, nx * Real(qx.x) + ny * Real(qx.y) + nz * Real(qx.z));
    store(out.y + k, nx * Real(qy.x) + ny * Real(qy.y) + nz * Real(qy.z));
    store(out.z + k, nx * Real(qz.x) + ny * Real(qz.y) + nz * Real(qz.z));
    store(out.offset + k,
          load_any<Real>(&c.w[k]) - nx * Real(d.x) - ny * Real(d.y) - nz * Real(d.z));
  }
}

/// One bit for each plane of a cutter.
using PlaneBits = std::array<std::uint64_t, (Cutter::most + 63) / 64>;
/// Limit: order and tight boxes cost more than they save.
inline constexpr std::size_t few_planes = 64;

/// Calls use(plane) for all marked planes until it is false, and returns whether it never was.
template <class Use>
SILT_INLINE bool for_each_plane(const Cutter& cutter, const PlaneBits& words, const Use& use) {
  for (std::size_t word = 0; word * 64 < cutter.size; ++word)
    for (auto bits = words[word]; bits != 0; bits &= bits - 1) {
      const std::size_t k = word * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      if (k < cutter.size && !use(k)) return false;
    }
  return true;
}

/// Axes with z along `n`, any unit vector (T. Duff et al., J. Comput. Graph. Tech. 6 (2017) 1).
inline RotationMatrix frame_along(const Vec3d& n) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

/// Marks the planes lower than highest_along(normal), in lanes.
template <class Highest>
SILT_INLINE void mark_planes(const Cutter& c, PlaneBits& words, const Highest& highest_along) {
  using Real = Lanes<DefaultArch>::Real;
  for (std::size_t from = 0; from < c.size; from += 64) {
    std::uint64_t bits = 0;
    for (std::size_t k = from; k < std::min(c.size, from + 64); k += Lanes<DefaultArch>::width) {
      const Real highest =
          highest_along(load<Real>(c.x + k), load<Real>(c.y + k), load<Real>(c.z + k));
      bits |= lane_bits(highest > load<Real>(c.offset + k)) << (k - from);
    }
    words[from / 64] = bits;
  }
}

/// Marks the planes that may cut the box around the graph, in lanes. Fills as many words as there
/// are planes. The rest of a round body after a cut is a flat cap: with many planes a box along the
/// axes of the body would include ten times as many as one along `flat`, a unit vector.
inline void planes_that_may_cut(const ClippedBody::Graph& g, const Cutter& c, const Vec3d& flat,
                                PlaneBits& words) {
  if (c.size <= few_planes) {
    Box box;
    for (std::size_t v = 0; v < g.size; ++v) box.include(g.at(v));
    const Vec3d m = box.centre(), e = 0.5 * box.extent();
    return mark_planes(c, words, [&](auto nx, auto ny, auto nz) {
      using Real = decltype(nx);
      return nx * Real(m.x) + ny * Real(m.y) + nz * Real(m.z) + silt::abs(nx) * Real(e.x) +
             silt::abs(ny) * Real(e.y) + silt::abs(nz) * Real(e.z);
    });
  }
  const RotationMatrix axes = frame_along(flat);
  const Vec3d origin = g.at(0);
  Box box;
  for (std::size_t v = 0; v < g.size; ++v) box.include(axes.back(g.at(v) - origin));
  const Vec3d m = origin + axes * box.centre(), e = 0.5 * box.extent();
  mark_planes(c, words, [&](auto nx, auto ny, auto nz) {
    using Real = decltype(nx);
    const auto along = [&](const Vec3d& v) {
      return nx * Real(v.x) + ny * Real(v.y) + nz * Real(v.z);
    };
    return along(m) + silt::abs(along(axes.x)) * Real(e.x) + silt::abs(along(axes.y)) * Real(e.y) +
           silt::abs(along(axes.z)) * Real(e.z);
  });
}

/// Cuts by the marked planes, those closest to `flat` first: a lens is cut from the middle
/// outwards, and most planes beyond its rim then have nothing left to cut.
inline bool cut_from_middle(ClippedBody& body, const Cutter& cutter, const PlaneBits& words,
                            const Vec3d& flat) {
  constexpr std::size_t rings = 16;
  std::uint16_t count[rings + 1] = {}, in_turn[Cutter::most];
  const auto tilt = [&](std::size_t k) { return 1 - dot(cutter.half(k).normal, flat); };
  double most = 0;
  for_each_plane(cutter, words,
                 [&](std::size_t k) { return most = std::max(most, tilt(k)), true; });
  const double scale = most > 0 ? (rings - 1e-6) / most : 0;
  const auto ring = [&](std::size_t k) {
    return static_cast<std::size_t>(std::max(scale * tilt(k), 0.0));
  };
  for_each_plane(cutter, words, [&](std::size_t k) { return ++count[ring(k) + 1], true; });
  for (std::size_t r = 0; r < rings; ++r)
    count[r + 1] = static_cast<std::uint16_t>(count[r + 1] + count[r]);
  const std::size_t all = count[rings];
  for_each_plane(cutter, words, [&](std::size_t k) {
    return in_turn[count[ring(k)]++] = static_cast<std::uint16_t>(k), true;
  });
  for (std::size_t k = 0; k < all; ++k)
    if (!body.cut(cutter.half(in_turn[k]), first_cut_face + in_turn[k])) return false;
  return true;
}

/// Cuts `body` by all planes, `first` first: it should leave little for the others. False if
/// nothing is left.
inline bool cut_by_all(ClippedBody& body, const Cutter& cutter, std::size_t first) {
  const HalfSpace half = cutter.half(first);
  if (!body.cut(half, first_cut_face + first)) return false;
  PlaneBits words;
  planes_that_may_cut(body.graph(), cutter, half.normal, words);
  words[first / 64] &= ~(std::uint64_t{1} << first % 64);
  if (cutter.size > few_planes) return cut_from_middle(body, cutter, words, half.normal);
  return for_each_plane(
      cutter, words, [&](std::size_t k) { return body.cut(cutter.half(k), first_cut_face + k); });
}

/// Cuts i and j and calls action(graph, body that was cut, cutter, +1 if i's planes cut) if
/// anything is left. The planes of the body with a face across the axis cut the other one: a corner
/// pressed into a face then needs one cut.
template <class Action>
void cut_pair(const PlacedPolyhedron& i, const PlacedPolyhedron& j, const Vec3d& axis,
              Action&& action) {
  const auto of_i = i.shape->face_towards(-i.pose.turn.back(axis));
  const auto of_j = j.shape->face_towards(j.pose.turn.back(axis));
  const bool i_cuts = of_i.cosine >= of_j.cosine;
  const PlacedPolyhedron &cutting = i_cuts ? i : j, &body = i_cuts ? j : i;
  Cutter& cutter = Cutter::empty();
  place_planes(cutting, body, cutter);
  ClippedBody& left = ClippedBody::whole(*body.shape);
  if (cut_by_all(left, cutter, i_cuts ? of_i.face : of_j.face))
    action(left.graph(), body, cutter, i_cuts ? 1.0 : -1.0);
}

/// The same with the half-space of all points p with normal . (p - at) < 0: action(graph, cutter).
template <class Action>
void cut_half_space(const PlacedPolyhedron& i, const Vec3d& at, const Vec3d& normal,
                    Action&& action) {
  const Vec3d n = i.pose.turn.back(normal);
  const double offset = dot(normal, at - i.pose.position);
  if (-i.shape->reach(-n) >= offset) return;
  Cutter& cutter = Cutter::empty();
  cutter.x[0] = n.x, cutter.y[0] = n.y, cutter.z[0] = n.z, cutter.offset[0] = offset;
  cutter.size = 1;
  ClippedBody& left = ClippedBody::whole(*i.shape);
  if (left.cut(cutter.half(0), first_cut_face)) action(left.graph(), cutter);
}

}  // namespace silt::detail
