// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/contact_spread.hpp>
#include <silt/shape/narrow/corner_normal.hpp>
#include <silt/shape/narrow/face_patch.hpp>
#include <silt/shape/narrow/margin_contact.hpp>
#include <silt/shape/narrow/sphere_polyhedron.hpp>
#include <silt/shape/narrow/thickness_overlap.hpp>

/// Contact of any two bodies among PlacedBall, PlacedSuper and PlacedPolyhedron:
///
///   touch_solids(i, j, memory)    SolidContact, for every ordered pair of kinds
///   least_gap_of(i, j, memory)    cheap lower bound of the gap; <= 0 proves nothing
///
///   ball, ball                    closed form
///   ball or super, super          smallest depth over all normals (super_ellipsoids.hpp)
///   ball, polyhedron              nearest point of the polyhedron (sphere_polyhedron.hpp)
///   super, polyhedron             smallest depth over all normals (corner_normal.hpp)
///   two sharp polyhedra           thickness of the intersection (thickness_overlap.hpp)
///   polyhedra, at least one       distance of the cores (margin_contact.hpp)
///   dilated                       nearly parallel faces: face_patch.hpp
///
/// (super: super-ellipsoid or poly-super-ellipsoid; a dilated polyhedron includes its radius.) In
/// all of them the overlap is a potential of position and orientation (placed.hpp (1)), with the
/// R_eff of the first touch, which is kept in memory. They are continuous except for the normal
/// where two ways out are equally short: a ball's centre inside a polyhedron and equally far from
/// two of its faces; a super's overlap beyond its own radius of curvature, where its minimum may
/// end (super_ellipsoids.hpp); dilated polyhedra with overlapping cores. The point jumps where
/// parallel edges leave it undetermined (dilated polyhedra; super on polyhedron only if the super
/// is flat there), faces of dilated polyhedra excepted.
///
/// Memory: direction = -normal, in the axes of the body that is flatter at the contact; for a ball
///         in space. A pair without one (follows = 0: new, or its bounding spheres were apart) is
///         searched globally; otherwise a touching pair follows its minimum.
///
/// Tests:  tests/shape/solid_pairs.cpp. Cost: benchmarks/shape/bench_solid_pairs.cpp.

namespace silt::inline SILT_TARGET {

namespace detail {

inline const Vec3d& place_of(const PlacedBall& b) { return b.position; }
template <class Form>
const Vec3d& place_of(const PlacedSuper<Form>& b) {
  return b.position;
}
inline const Vec3d& place_of(const PlacedPolyhedron& b) { return b.pose.position; }

inline BodyAxes<double> axes_of(const PlacedBall&) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }
template <class Form>
BodyAxes<double> axes_of(const PlacedSuper<Form>& b) {
  return b.axes;
}
inline BodyAxes<double> axes_of(const PlacedPolyhedron& b) {
  return {b.pose.turn.x, b.pose.turn.y, b.pose.turn.z};
}

/// Upper bound of the height over the origin along unit n.
inline double height_bound(const PlacedBall& b, const Vec3d&) { return b.radius; }
template <class Form>
double height_bound(const PlacedSuper<Form>& b, const Vec3d& n) {
  return rough_height(b.form, b.axes.to_body(n)) + 1e-5 * b.form.bound;
}
inline double height_bound(const PlacedPolyhedron& b, const Vec3d& n) {
  return b.shape->reach(b.pose.turn.back(n)) + b.shape->radius();
}

/// Last direction from i to j, in space; zero if there is none.
template <class A, class B>
Vec3d last_direction_of(const A& i, const B& j, const NormalMemory<double>& memory) {
  if (memory.follows == 0) return {0, 0, 0};
  return (memory.follows > 0 ? axes_of(i) : axes_of(j)).to_space(memory.direction);
}

template <class A, class B>
void keep_direction_of(const A& i, const B& j, const Vec3d& m, bool with_i,
                       NormalMemory<double>& memory) {
  memory.direction = (with_i ? axes_of(i) : axes_of(j)).to_body(m);
  memory.follows = with_i ? 1 : -1;
}

/// A touching pair of dilated polyhedra whose faces are nearly parallel (face_patch.hpp): follows
/// is 2 or -2.
inline void keep_faces(NormalMemory<double>& memory) { memory.follows *= 2; }
inline bool were_faces(const NormalMemory<double>& memory) {
  return std::abs(memory.follows) > 1.5 && memory.R_eff > 0;
}

/// For a touching pair: R_eff of the first touch. m = -normal.
template <class A, class B>
double keep_radius(const A& i, const B& j, const Vec3d& m, NormalMemory<double>& memory) {
  if (!(memory.R_eff > 0)) {
    const double a = contact_radius_at(i, m), b = contact_radius_at(j, -m);
    memory.R_eff = a * b / (a + b);
  }
  return memory.R_eff;
}

/// Apart by at least `gap`, or not known to touch (gap <= 0).
inline SolidContact apart_by(double gap, NormalMemory<double>& memory) {
  SolidContact out;
  memory.R_eff = 0;
  out.overlap = -std::max(gap, 0.0);
  return out;
}

/// By the bounding spheres; a pair that is apart by these is new when it returns.
template <class A, class B>
double gap_of_spheres(const A& i, const B& j) {
  return norm(place_of(j) - place_of(i)) - (bound_of(i) + bound_of(j));
}

/// By the last direction m, unit.
template <class A, class B>
double gap_towards(const A& i, const B& j, const Vec3d& m) {
  return dot(m, place_of(j) - place_of(i)) - height_bound(i, m) - height_bound(j, -m);
}

/// For i and j in the other order: minus the direction, which follows the same body.
inline NormalMemory<double> mirrored(const NormalMemory<double>& m) {
  return {-m.direction, -m.follows, m.R_eff};
}
inline SolidContact mirrored(SolidContact c) {
  c.normal = -c.normal;
  return c;
}

inline SphereForm<double> form_of_placed(const PlacedBall& b) { return sphere_form(b.radius); }
template <class Form>
const Form& form_of_placed(const PlacedSuper<Form>& b) {
  return b.form;
}

template <class A, class B>
auto posed_pair(const A& i, const B& j) {
  return PosedPair{form_of_placed(i), form_of_placed(j), axes_of(i), axes_of(j),
                   place_of(j) - place_of(i)};
}

/// Two smooth bodies, not both balls.
template <class A, class B>
SolidContact touch_smooth(const A& i, const B& j, NormalMemory<double>& memory) {
  const auto pair = posed_pair(i, j);
  if (memory.follows != 0 && memory.R_eff == 0) {
    const double gap = least_gap(pair, memory);
    if (gap > 0 && gap_of_spheres(i, j) <= 0) return apart_by(gap, memory);
  }
  const auto c = touch(pair, memory);
  SolidContact out;
  out.overlap = c.touches ? c.overlap : std::min(c.overlap, 0.0);
  if (!c.touches) return out;
  out.normal = c.normal, out.point = place_of(i) + c.point, out.R_eff = c.R_eff;
  return out;
}

/// Point and overlap of the smallest depth of a super-ellipsoid and a polyhedron.
template <class Form>
SolidContact touch_corners(const PlacedSuper<Form>& i, const PlacedPolyhedron& j,
                           NormalMemory<double>& memory) {
  if (const double gap = gap_of_spheres(i, j); gap > 0) {
    memory.follows = 0;
    return apart_by(gap, memory);
  }
  const Vec3d last = last_direction_of(i, j, memory);
  if (memory.follows != 0 && memory.R_eff == 0)
    if (const double gap = gap_towards(i, j, last); gap > 0) return apart_by(gap, memory);
  const auto& turn = j.pose.turn;
  const auto found = find_corner_normal(i, j, turn.back(last), memory.R_eff > 0);
  const Vec3d m = turn * found.direction;
  // At a corner the normal belongs to the smooth body, whose rotation it follows.
  if (found.held == 1)
    keep_direction_of(i, j, m, true, memory);
  else
    memory.direction = found.direction, memory.follows = -1;
  if (!(found.depth > 0)) return apart_by(-found.depth, memory);
  SolidContact out;
  out.normal = -m, out.overlap = found.depth;
  out.point = j.pose.to_space(found.corner) + (0.5 * found.depth - j.shape->radius()) * m;
  if (found.held == 3)  // on a face
    out.spread =
        symmetric(spread_of(i.form, i.axes, out.normal, out.point - i.position, out.overlap));
  if (!(memory.R_eff > 0)) {
    const double a = found.contact_radius, b = contact_radius_at(j, -m);
    memory.R_eff = a * b / (a + b);
  }
  out.R_eff = memory.R_eff;
  return out;
}

inline SolidContact touch_ball(const PlacedBall& i, const PlacedPolyhedron& j,
                               NormalMemory<double>& memory) {
  const Vec3d last = last_direction_of(i, j, memory);
  if (memory.follows != 0 && memory.R_eff == 0)
    if (const double gap = gap_towards(i, j, last); gap > 0) return apart_by(gap, memory);
  const auto c = sphere_contact(i.position, i.radius, j);
  if (!(c.overlap > 0)) {
    const auto gjk = gjk_distance(PointSet{i.position}, j, -last);
    if (!gjk.overlapping) keep_direction_of(i, j, -gjk.normal, false, memory);
    return apart_by(gjk.lower_bound - i.radius - j.shape->radius(), memory);
  }
  keep_direction_of(i, j, -c.normal, false, memory);
  SolidContact out;
  out.normal = c.normal, out.point = c.point, out.overlap = c.overlap;
  out.R_eff = keep_radius(i, j, -c.normal, memory);
  return out;
}

/// Both sharp.
inline SolidContact touch_sharp(const PlacedPolyhedron& i, const PlacedPolyhedron& j,
                                const Vec3d& axis, NormalMemory<double>& memory) {
  const auto c = thickness_overlap(i, j, axis);
  if (!(c.overlap > 0)) {
    const auto gjk = gjk_distance(i, j, axis);
    if (!gjk.overlapping) keep_direction_of(i, j, -gjk.normal, false, memory);
    return apart_by(gjk.lower_bound, memory);
  }
  SolidContact out;
  out.normal = c.normal, out.point = c.point, out.overlap = c.overlap;
  out.gradient = c.buried ? 0 : c.gradient, out.couple = c.couple;
  out.spread = c.spread;
  return out;
}

/// One or both dilated.
inline SolidContact touch_dilated(const PlacedPolyhedron& i, const PlacedPolyhedron& j,
                                  const Vec3d& axis, NormalMemory<double>& memory) {
  AxisMemory start;
  start.set(axis);
  const auto c = margin_contact(i, j, start);
  if (!(c.overlap > 0)) {
    if (dot(c.normal, c.normal) > 0) keep_direction_of(i, j, -c.normal, false, memory);
    const double gap = gap_along(i, j, c.normal) - i.shape->radius() - j.shape->radius();
    return apart_by(gap, memory);
  }
  SolidContact out;
  out.normal = c.normal, out.point = c.point, out.overlap = c.overlap;
  return out;
}

}  // namespace detail

/// Lower bound [m] of the gap between i and j by their bounding spheres and along the last
/// direction; <= 0 proves nothing.
template <class A, class B>
double least_gap_of(const A& i, const B& j, const NormalMemory<double>& memory) {
  const double by_spheres = detail::gap_of_spheres(i, j);
  if (by_spheres > 0 || memory.follows == 0) return by_spheres;
  const Vec3d m = detail::last_direction_of(i, j, memory);
  return std::max(by_spheres, detail::gap_towards(i, j, m));
}

/// Contact of two convex parts of any two kinds; `memory` is the last direction.
inline SolidContact touch_solids(const PlacedBall& i, const PlacedBall& j,
                                 NormalMemory<double>& memory) {
  const Vec3d between = j.position - i.position;
  const double distance = norm(between), overlap = i.radius + j.radius - distance;
  const Vec3d m = distance > 0 ? between * (1 / distance) : Vec3d{0, 0, 1};
  memory.direction = m, memory.follows = 1;
  if (!(overlap > 0)) return detail::apart_by(-overlap, memory);
  SolidContact out;
  out.normal = -m, out.overlap = overlap;
  out.point = i.position + (i.radius - 0.5 * overlap) * m;
  out.R_eff = memory.R_eff = i.radius * j.radius / (i.radius + j.radius);
  return out;
}

template <class FormI, class FormJ>
SolidContact touch_solids(const PlacedSuper<FormI>& i, const PlacedSuper<FormJ>& j,
                          NormalMemory<double>& memory) {
  return detail::touch_smooth(i, j, memory);
}
template <class Form>
SolidContact touch_solids(const PlacedSuper<Form>& i, const PlacedBall& j,
                          NormalMemory<double>& memory) {
  return detail::touch_smooth(i, j, memory);
}
template <class Form>
SolidContact touch_solids(const PlacedSuper<Form>& i, const PlacedPolyhedron& j,
                          NormalMemory<double>& memory) {
  return detail::touch_corners(i, j, memory);
}
inline SolidContact touch_solids(const PlacedBall& i, const PlacedPolyhedron& j,
                                 NormalMemory<double>& memory) {
  if (const double gap = detail::gap_of_spheres(i, j); gap > 0) {
    memory.follows = 0;
    return detail::apart_by(gap, memory);
  }
  return detail::touch_ball(i, j, memory);
}

inline SolidContact touch_solids(const PlacedPolyhedron& i, const PlacedPolyhedron& j,
                                 NormalMemory<double>& memory) {
  if (const double gap = detail::gap_of_spheres(i, j); gap > 0) {
    memory.follows = 0;
    return detail::apart_by(gap, memory);
  }
  const double margins = i.shape->radius() + j.shape->radius();
  const Vec3d between = i.pose.position - j.pose.position;
  Vec3d axis = -detail::last_direction_of(i, j, memory);
  if (memory.follows == 0) axis = dot(between, between) > 0 ? normalised(between) : Vec3d{0, 0, 1};
  if (const double gap = gap_along(i, j, axis) - margins; gap > 0) {
    if (memory.follows == 0) detail::keep_direction_of(i, j, -axis, false, memory);
    return detail::apart_by(gap, memory);
  }
  auto faces = detail::FaceState::Unknown;
  if (detail::were_faces(memory)) {  // if they still are, the distance is theirs
    SolidContact out;
    const auto to_j = i.shape->face_towards(-i.pose.turn.back(axis)),
               to_i = j.shape->face_towards(j.pose.turn.back(axis));
    faces = detail::touch_faces(i, j, to_j, to_i, false, out);
    if (faces == detail::FaceState::Smooth) {
      detail::keep_direction_of(i, j, -out.normal, to_j.cosine > to_i.cosine, memory);
      detail::keep_faces(memory);
      out.R_eff = memory.R_eff;
      return out;
    }
  }
  auto out = margins > 0 ? detail::touch_dilated(i, j, axis, memory)
                         : detail::touch_sharp(i, j, axis, memory);
  if (!(out.overlap > 0)) return out;
  const auto to_j = i.shape->face_towards(-i.pose.turn.back(out.normal)),
             to_i = j.shape->face_towards(j.pose.turn.back(out.normal));
  if (margins > 0 && faces == detail::FaceState::Unknown)
    faces = detail::touch_faces(i, j, to_j, to_i, true, out);
  detail::keep_direction_of(i, j, -out.normal, to_j.cosine > to_i.cosine, memory);
  if (faces == detail::FaceState::Smooth) detail::keep_faces(memory);
  out.R_eff = detail::keep_radius(i, j, -out.normal, memory);
  return out;
}

// ---- other orders -------------------------------------------------------------------------------

namespace detail {
template <class A, class B>
SolidContact touch_swapped(const A& i, const B& j, NormalMemory<double>& memory) {
  auto other = mirrored(memory);
  const auto out = mirrored(touch_solids(j, i, other));
  memory = mirrored(other);
  return out;
}
}  // namespace detail

template <class Form>
SolidContact touch_solids(const PlacedBall& i, const PlacedSuper<Form>& j,
                          NormalMemory<double>& memory) {
  return detail::touch_swapped(i, j, memory);
}
template <class Form>
SolidContact touch_solids(const PlacedPolyhedron& i, const PlacedSuper<Form>& j,
                          NormalMemory<double>& memory) {
  return detail::touch_swapped(i, j, memory);
}
inline SolidContact touch_solids(const PlacedPolyhedron& i, const PlacedBall& j,
                                 NormalMemory<double>& memory) {
  return detail::touch_swapped(i, j, memory);
}

}  // namespace silt
