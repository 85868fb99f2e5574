// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/clip.hpp>
#include <silt/shape/narrow/placed_polyhedron.hpp>

/// The intersection of two bodies, or of a body and a half-space, as a graph: which planes cut
/// which body, and in which order. The result does not depend on the order; the speed does. Tests:
/// tests/shape/volume_overlap.cpp

namespace silt::inline SILT_TARGET::detail {

/// Half-spaces of a cutter in the frame of the body that is cut. Columns for lanes.
struct Cutter {
  static constexpr std::size_t most = (Polyhedron::most_faces + 7) / 8 * 8;
  alignas(64) double x[most], y[most], z[most], offset[most];
  std::size_t size = 0;

  HalfSpace half(std::size_t k) const { return {{x[k], y[k], z[k]}, offset[k]}; }
};

/// The planes of `by` in the frame of `body`: n . (D + Q x) <= offset, D and Q the place and turn
/// of `body` seen from `by`.
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

/// One bit for each plane that may cut the box around the graph, in lanes; 4 words for 250 planes.
inline void planes_that_may_cut(const ClippedBody::Graph& g, const Cutter& c,
                                std::array<std::uint64_t, 4>& words) {
  using Real = Lanes<DefaultArch>::Real;
  Box box;
  for (std::size_t v = 0; v < g.size; ++v) box.include(g.at(v));
  const Vec3d m = box.centre(), e = 0.5 * box.extent();
  for (std::size_t k = 0; k < c.size; k += Lanes<DefaultArch>::width) {
    const Real nx = load<Real>(c.x + k), ny = load<Real>(c.y + k), nz = load<Real>(c.z + k);
    const Real highest = nx * Real(m.x) + ny * Real(m.y) + nz * Real(m.z) +
                         silt::abs(nx) * Real(e.x) + silt::abs(ny) * Real(e.y) +
                         silt::abs(nz) * Real(e.z);
    words[k / 64] |= lane_bits(highest > load<Real>(c.offset + k)) << k % 64;
  }
}

/// Cuts `body` by all planes, `first` first: it should leave little to cut for the others. False if
/// nothing is left.
inline bool cut_by_all(ClippedBody& body, const Cutter& cutter, std::size_t first) {
  if (!body.cut(cutter.half(first), first_cut_face + first)) return false;
  std::array<std::uint64_t, 4> words{};
  planes_that_may_cut(body.graph(), cutter, words);
  for (std::size_t word = 0; word < words.size(); ++word)
    for (auto bits = words[word]; bits != 0; bits &= bits - 1) {
      const std::size_t k = word * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      if (k < cutter.size && k != first && !body.cut(cutter.half(k), first_cut_face + k))
        return false;
    }
  return true;
}

/// Cuts i and j and calls action(graph, body that was cut, cutter, +1 if i's planes cut) if
/// anything is left. The planes of the body with a face across the axis cut the other one: a corner
/// pressed into a face takes one cut then.
template <class Action>
void cut_pair(const PlacedPolyhedron& i, const PlacedPolyhedron& j, const Vec3d& axis,
              Action&& action) {
  const auto of_i = i.shape->face_towards(-i.pose.turn.back(axis));
  const auto of_j = j.shape->face_towards(j.pose.turn.back(axis));
  const bool i_cuts = of_i.cosine >= of_j.cosine;
  const PlacedPolyhedron &cutting = i_cuts ? i : j, &body = i_cuts ? j : i;
  Cutter cutter;
  place_planes(cutting, body, cutter);
  ClippedBody left(*body.shape);
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
  Cutter cutter;
  cutter.x[0] = n.x, cutter.y[0] = n.y, cutter.z[0] = n.z, cutter.offset[0] = offset;
  cutter.size = 1;
  ClippedBody left(*i.shape);
  if (left.cut(cutter.half(0), first_cut_face)) action(left.graph(), cutter);
}

}  // namespace silt::detail
