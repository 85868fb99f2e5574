// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <functional>
#include <string>

#include <silt/shape/narrow/solid_walls.hpp>

#include "bodies.hpp"
#include "near.hpp"

/// What the tests of contacts with walls share.
namespace solid_test {

using namespace silt;
using shape_test::pi;
using Draws = shape_test::Random;
using Super = PlacedSuper<SuperForm<double>>;
using Poly = PlacedSuper<PolyForm<double>>;

inline Super place(const SuperEllipsoid& shape, const Vec3d& at, const Quaternion& q) {
  return {form_of(shape), body_axes(q), at};
}
inline PlacedPolyhedron place(const Polyhedron& shape, const Vec3d& at, const Quaternion& q) {
  return {&shape, {at, q}};
}

inline Vec3d at_of(const Super& b) { return b.position; }
inline Vec3d at_of(const Poly& b) { return b.position; }
inline Vec3d at_of(const PlacedPolyhedron& b) { return b.pose.position; }

template <class Form>
PlacedSuper<Form> moved(PlacedSuper<Form> b, const Vec3d& by, const Quaternion& q) {
  b.position += by;
  b.axes = {rotate(q, b.axes.x), rotate(q, b.axes.y), rotate(q, b.axes.z)};
  return b;
}
inline PlacedPolyhedron moved(PlacedPolyhedron b, const Vec3d& by, const Quaternion& q) {
  b.pose.position += by;
  auto& t = b.pose.turn;
  t = {rotate(q, t.x), rotate(q, t.y), rotate(q, t.z)};
  return b;
}

inline constexpr int most = 16;
using Touches = std::vector<SolidContact>;
template <class Find>
Touches all(Find&& find) {
  Touches out(most);
  out.resize(static_cast<std::size_t>(find(out.data(), most)));
  return out;
}

/// The contact whose point is nearest to that of `c`.
inline const SolidContact* same(const Touches& all, const SolidContact& c) {
  const SolidContact* best = nullptr;
  for (const auto& o : all)
    if (!best || norm(o.point - c.point) < norm(best->point - c.point)) best = &o;
  return best;
}

/// The largest error of -gradient normal and of the torque about the body's centre, against central
/// differences of the overlap of every contact. [-] and [m]. Infinite if a contact gets lost.
template <class Body, class Find>
double potential_error(const Body& body, Find&& find, double step) {
  const Touches now = find(body);
  double worst = 0;
  for (const auto& c : now)
    for (int k = 0; k < 6; ++k) {
      Vec3d axis{0, 0, 0};
      (k % 3 == 0 ? axis.x : k % 3 == 1 ? axis.y : axis.z) = 1;
      double value[2];
      for (int side = 0; side < 2; ++side) {
        const double h = side == 0 ? -step : step;
        const Body b = k < 3 ? moved(body, h * axis, Quaternion{})
                             : moved(body, {0, 0, 0}, rotation_about(axis, h));
        const Touches then = find(b);
        const auto* o = same(then, c);
        if (!o) return std::numeric_limits<double>::infinity();
        value[side] = o->overlap;
      }
      const double rate = (value[1] - value[0]) / (2 * step);
      const Vec3d force = c.gradient * c.normal;
      const Vec3d torque = cross(c.point - at_of(body), force) + c.couple * force;
      worst = std::max(worst, std::abs(rate + dot(k < 3 ? force : torque, axis)));
    }
  return worst;
}

}  // namespace solid_test
