// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/solid_edges.hpp>

/// Contacts of convex bodies with the rims of cylinders and cones. Used by solid_walls.hpp.

namespace silt::inline SILT_TARGET::detail {

/// Feature of a contact with a rim: this number, plus 0 at `from` or 1 at `to`.
inline constexpr std::uint32_t rim_feature = 1000;
inline bool is_rim(const SolidContact& c) { return c.feature >= rim_feature; }

/// One end of a RoundWall: the circle of all centre + radius e(phi).
struct Rim {
  const RoundWall& wall;
  Vec3d centre;    // [m]
  double radius;   // [m]
  double inwards;  // +1 at `from`, -1 at `to`: the surface extends along inwards axis
  double free;     // +1 if the free side is away from the axis, else -1

  Rim(const RoundWall& of, bool at_to, double free_side)
      : wall(of),
        centre(of.from + (at_to ? of.length : 0) * of.axis),
        radius(at_to ? of.radius - of.length * of.n_z / of.n_r : of.radius),
        inwards(at_to ? -1 : 1),
        free(free_side) {}

  Vec3d at(const Vec3d& e) const { return centre + radius * e; }
  Vec3d tangent(const Vec3d& e) const { return cross(wall.axis, e); }

  /// Sine of the angle between a contact's normal and the surface that begins at e. > 0 where the
  /// surface rises above the plane normal to n, so that the surface itself touches. Behind
  /// the surface, which has one side as for spheres: the component of n along the axis.
  double under_surface(const Vec3d& n, const Vec3d& e) const {
    const double along = inwards * dot(n, wall.axis);
    if (free * dot(n, wall.normal(e)) < 0) return along;
    return wall.n_r * along - inwards * wall.n_z * dot(n, e);
  }
  /// Whether a ball around the body's centre reaches the rim.
  bool is_near(const Vec3d& body, double bound) const {
    const double z = dot(body - centre, wall.axis), across = wall.to_centre - radius;
    return z * z + across * across < bound * bound;
  }
  /// Half the range of phi within `bound` of the body's centre, around its own phi; < 0: empty.
  double half_range(const Vec3d& body, double bound) const {
    const double z = dot(body - centre, wall.axis), rho = wall.to_centre;
    const double square = z * z + (rho - radius) * (rho - radius);
    if (!(square < bound * bound)) return -1;
    const double room = bound * bound - square, turn = 4 * rho * radius;
    return room >= turn ? std::numbers::pi : 2 * std::asin(std::sqrt(room / turn));
  }
  SolidContact contact(const Vec3d& p, const Vec3d& n, double overlap, double R_eff) const {
    SolidContact out;
    out.normal = n, out.overlap = overlap, out.R_eff = R_eff;
    out.point = p - (0.5 * overlap) * n;
    out.feature = rim_feature + (inwards > 0 ? 0 : 1);
    return out;
  }
};

/// Angle between `from` and `level` at which the slope becomes zero; it is zero at `level`.
template <class Probe>
double where_level(const Probe& probe, double from, double level) {
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (from + level);
    (probe(middle).slope == 0 ? level : from) = middle;
  }
  return level;
}

/// Calls refine(low, high) for each interval between samples in which a function of phi changes
/// from rising to falling. probe(phi) returns its `slope`, 0 if below rounding errors. If the
/// function is constant around the whole rim, refine is called once, at phi = 0.
template <class Probe, class Refine>
void for_each_peak(double half, const Probe& probe, const Refine& refine) {
  // The depth is concave along a line: a second peak needs a curved arc.
  const int parts = std::clamp(static_cast<int>(std::ceil(half / 0.05)), 6, 48) * 2;
  const auto angle = [&](int k) { return -half + 2 * half * k / parts; };
  auto low = probe(-half);
  bool level = half >= std::numbers::pi;
  for (int k = 1; k <= parts; ++k) {
    auto high = probe(angle(k));
    level &= high.slope == 0;
    if (low.slope > 0 && high.slope == 0) {  // a plateau, then a fall: its middle
      auto last = high;
      while (k < parts && high.slope == 0) last = high, high = probe(angle(++k));
      if (high.slope < 0) {
        const double from = where_level(probe, low.phi, last.phi);
        const double to = where_level(probe, high.phi, last.phi);
        const auto middle = probe(0.5 * (from + to));
        refine(middle, middle);
      }
    } else if (low.slope > 0 && high.slope < 0) {
      refine(low, high);
    }
    low = high;
  }
  if (level) refine(probe(0), probe(0));
}

/// Newton's method for a point of the rim and a direction m, normal to the rim and outward of the
/// body, such that the support point along m lies straight behind the point. With r from the point
/// of the rim to the support point, K the radii of curvature along t and w = m x t:
///   r . t = 0,  r . w = 0;  overlap = r . m.                                                  (1)
/// Both are derivatives of h(m) - m . (point - centre): the overlap is stationary, hence its
/// derivative with respect to the body's position is the normal.
template <class Form>
std::optional<SolidContact> rim_contact(const Rim& rim, const PlacedSuper<Form>& body, double phi) {
  const auto& wall = rim.wall;
  Vec3d e = wall.e(phi), t = rim.tangent(e);
  Vec3d m = way_out(body, rim.at(e), t);
  if (!(dot(m, m) > 0)) return {};
  const double first = phi;
  double psi = std::atan2(dot(m, wall.axis), dot(m, e));
  const double bound = body.form.bound;
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 40; ++k) {
    e = wall.e(phi), t = rim.tangent(e);
    const double c = std::cos(psi), s = std::sin(psi);
    m = c * e + s * wall.axis;
    const Vec3d w = c * wall.axis - s * e, p = rim.at(e);
    const auto cap = body.cap(m, t, w);
    const Vec3d r = body.position - p + cap.height * m + cap.along_s * t + cap.along_t * w;
    const double along_t = dot(r, t), along_w = dot(r, w), depth = dot(r, m);
    const double error = std::hypot(along_t, along_w);
    const bool stuck = k == 39 || (k > 12 && error >= last);
    if (stuck && error > 1e-9 * bound) break;
    if (stuck || error <= 1e-13 * (bound + rim.radius)) {
      const Vec3d n = -m;
      if (!(depth > 0)) return {};
      if (rim.under_surface(n, e) > 0) return {};
      return rim.contact(p, n, depth, contact_radius(body.form, cap));
    }
    last = error;
    // dm = c t dphi + w dpsi, dt = -e dphi, dw = -s t dphi - m dpsi, dp = radius t dphi
    const double a = cap.radii.xx * c - rim.radius - dot(r, e), b = cap.radii.xy;
    const double d = cap.radii.xy * c - s * along_t, f = cap.radii.yy - depth;
    // The right kind of stationary point: the shortest way out (f > 0), and the deepest along the
    // rim (curvature of the depth along the rim, with the best m, < 0). A flat face has a > 0.
    const double ff = std::max(f, 1e-6 * bound);
    const double reduced = std::min(a - b * d / ff, -1e-3 * bound);
    const double limit = 0.2, along = -(along_t - b * along_w / ff) / reduced,
                 turn = -(along_w + d * along) / ff;
    const double size =
        std::max(std::abs(along) * std::max(1.0, rim.radius / bound), std::abs(turn));
    const double part = size > limit ? limit / size : 1;
    phi += part * along, psi += part * turn;
  }
  // No convergence, deeper than the radii of curvature: the way out at the first phi.
  e = wall.e(first), m = way_out(body, rim.at(e), rim.tangent(e));
  const double depth = dot(m, body.support(m) - rim.at(e));
  if (!(depth > 0) || rim.under_surface(-m, e) > 0) return {};
  return rim.contact(rim.at(e), -m, depth, contact_radius_at(body, m));
}

/// Contact with the tip of a cone.
template <class Form>
std::optional<SolidContact> tip_contact(const Rim& rim, const PlacedSuper<Form>& body) {
  const auto found = point_depth(body, rim.centre);
  if (!found) return {};
  return rim.contact(rim.centre, found->normal, found->depth,
                     contact_radius_at(body, -found->normal));
}

/// Contacts of a smooth body: the search begins at the minima of its gauge along the rim.
template <class Form>
void rim_contacts(const Rim& rim, const PlacedSuper<Form>& body, double, bool,
                  DeepestContacts& deepest) {
  const double half = rim.half_range(body.position, body.form.bound);
  if (half < 0) return;
  struct Probe {
    double phi, slope;  // of minus the gauge
    bool inside;
  };
  const auto probe = [&](double phi) {
    const Vec3d e = rim.wall.e(phi);
    const auto g = gauge_slope(body.form, body.axes.to_body(rim.at(e) - body.position));
    const double slope = -dot(body.axes.to_space(g.slope), rim.tangent(e));
    return Probe{phi, std::abs(slope) > 1e-12 * norm(g.slope) ? slope : 0, g.f < 1};
  };
  for_each_peak(half, probe, [&](Probe low, Probe high) {
    const double start = high.phi - low.phi;
    for (int k = 0; k < 30 && high.phi - low.phi > 1e-3 * start; ++k) {
      const auto middle = probe(0.5 * (low.phi + high.phi));
      (middle.slope > 0 ? low : high) = middle;
      if (k == 7 && !low.inside && !high.inside && !middle.inside) break;
    }
    if (low.inside || high.inside || probe(0.5 * (low.phi + high.phi)).inside)
      if (const auto found = rim_contact(rim, body, 0.5 * (low.phi + high.phi)))
        deepest.add(*found);
  });
}

/// A point of the rim inside a polyhedron.
struct RimDepth {
  double phi, depth;  // [m] below the dilated surface
  double slope;       // [m] derivative with respect to phi
  Vec3d out;          // [-] direction of the shortest way out, in the body's frame
};

/// A body lying along the wall also lies on the rim, once its far end has passed it, up to this
/// tilt in either direction [-].
inline constexpr double most_tilt = 0.1;

/// Depth of the points of a rim in a polyhedron, as a function of phi.
class RimInPolyhedron {
 public:
  RimInPolyhedron(const Rim& rim, const PlacedPolyhedron& body, double ahead)
      : rim_(rim), body_(body), core_(*body.shape) {
    const auto& pose = body.pose;
    centre_ = pose.to_body(rim.centre);
    x_ = pose.turn.back(rim.wall.x), y_ = pose.turn.back(rim.wall.y);
    const auto& wall = rim.wall;
    inwards_ = pose.turn.back(rim.inwards * (wall.n_r * wall.axis - wall.n_z * wall.x));
    ahead_ = ahead;
  }

  RimDepth operator()(double phi) const {
    const double c = std::cos(phi), s = std::sin(phi);
    const Vec3d e = c * x_ + s * y_, t = c * y_ - s * x_, p = centre_ + rim_.radius * e;
    RimDepth out{phi, std::numeric_limits<double>::infinity(), 0, {0, 0, 0}};
    for (const auto& face : core_.faces())
      if (const double d = depth_in(face, p); d < out.depth) out.depth = d, out.out = face.normal;
    if (const double r = core_.radius(); r > 0) {
      if (out.depth < 0) {
        const auto found = sphere_contact(rim_.at(rim_.wall.e(phi)), r, body_);
        if (found.overlap > 0)
          out.depth = found.overlap - 2 * r, out.out = body_.pose.turn.back(found.normal);
      }
      out.depth += r;
    }
    out.slope = -rim_.radius * dot(out.out, t);
    if (std::abs(out.slope) <= 1e-13 * rim_.radius) out.slope = 0;
    return out;
  }

  /// Whether a point of the rim is still in the core after a translation of the body by `by`.
  bool stays_in(double phi, const Vec3d& by) const {
    const Vec3d p = centre_ + rim_.radius * (std::cos(phi) * x_ + std::sin(phi) * y_) -
                    body_.pose.turn.back(by);
    return std::all_of(core_.faces().begin(), core_.faces().end(),
                       [&](const auto& face) { return dot(face.normal, p) < face.offset; });
  }
  /// Whether a corner of the core is nearest to the contact.
  bool by_corner(const SolidContact& c) const {
    const double r = core_.radius();
    const Vec3d near = body_.pose.to_body(c.point + (r - 0.5 * c.overlap) * c.normal);
    const auto& corners = core_.vertices();
    const double tie = 1e-9 * bound_of(body_);
    return r > 0 && std::any_of(corners.begin(), corners.end(),
                                [&](const Vec3d& v) { return norm(v - near) < tie; });
  }

  /// The deepest point between one with a rising depth and one without. In a sharp body the depth
  /// is the minimum of one wave per face: the peak is where the waves of the two ends meet.
  std::optional<SolidContact> peak(RimDepth low, RimDepth high) const {
    const bool sharp = !(core_.radius() > 0);
    for (int k = 0; k < 100 && high.phi - low.phi > 1e-15; ++k) {
      const double width = high.phi - low.phi;
      const double fall = low.slope - high.slope;
      double step = 0.5 * width;
      if (k % 4 != 3 && fall > 0)
        step = sharp && low.out != high.out ? (high.depth - low.depth - high.slope * width) / fall
                                            : width * low.slope / fall;
      if (!(step > 0 && step < width)) step = 0.5 * width;
      const auto next = (*this)(low.phi + step);
      const double tiny = 1e-15 * (bound_of(body_) + rim_.radius);
      const bool met = sharp && low.out != high.out &&
                       next.depth >= std::min(low.depth + low.slope * step,
                                              high.depth - high.slope * (width - step)) -
                                         tiny &&
                       (next.out == low.out || next.out == high.out) && width < 1e-5;
      (next.slope > 0 ? low : high) = next;
      if (next.slope == 0) break;
      if (met) {
        low.phi = high.phi = next.phi, low.depth = high.depth = next.depth;
        break;
      }
    }
    return contact(low, high);
  }

 private:
  /// Depth of p below a face [m]. A face that points out over the wall's end counts as farther out
  /// by `ahead`, the depth of the corners near it: the next part of the body touches at once.
  double depth_in(const Polyhedron::Face& face, const Vec3d& p) const {
    const double d = face.offset - dot(face.normal, p);
    return ahead_ > 0 && dot(face.normal, inwards_) < -most_tilt ? d + ahead_ : d;
  }

  /// At a face the way out is its normal. Between two faces with equal depths it is the way to
  /// their common edge.
  std::optional<SolidContact> contact(const RimDepth& low, const RimDepth& high) const {
    const double fall = low.slope - high.slope;
    const bool between = high.slope != 0 && fall > 0;
    const double share = between ? -high.slope / fall : 0;  // of `low`
    const double below = between ? 0.5 * (low.depth + high.depth) : high.depth;
    if (!(below > 0)) return {};
    double phi = between ? 0.5 * (low.phi + high.phi) : high.phi;
    Vec3d out = share * low.out + (1 - share) * high.out;
    const double length = norm(out);
    if (!(length > 0.1)) return {};  // two faces with opposite normals
    out *= 1 / length;
    double depth = below / length;
    if (between && !(core_.radius() > 0)) meet_edge(low.out, high.out, below, phi, depth, out);
    return rim_.contact(rim_.at(rim_.wall.e(phi)), body_.pose.turn * -out, depth,
                        core_.equal_volume_radius());
  }

  /// The shortest way from the rim to the common edge of two faces of equal depth.
  void meet_edge(const Vec3d& one, const Vec3d& other, double below, double& phi, double& depth,
                 Vec3d& out) const {
    const Vec3d along = cross(one, other);
    const double square = dot(along, along);
    if (!(square > 1e-6)) return;
    const Vec3d b = along * (1 / std::sqrt(square));
    const auto place = [&](double at) {
      return centre_ + rim_.radius * (std::cos(at) * x_ + std::sin(at) * y_);
    };
    const Vec3d start = place(phi);
    const Vec3d on_edge = start + (below / (1 + dot(one, other))) * (one + other);
    double at = phi;
    for (int k = 0; k < 20; ++k) {
      const Vec3d e = std::cos(at) * x_ + std::sin(at) * y_,
                  t = std::cos(at) * y_ - std::sin(at) * x_;
      Vec3d r = on_edge - place(at);
      r -= dot(r, b) * b;
      const double tb = dot(t, b), change = -rim_.radius * (1 - tb * tb) - dot(r, e);
      const double step = -dot(r, t) / change;
      if (!(change < 0) || std::abs(at + step - phi) > 0.1) return;
      at += step;
      if (std::abs(step) > 1e-12) continue;
      const double distance = norm(r);
      if (!(dot(r, out) > 0)) return;
      phi = at, depth = distance, out = r * (1 / distance);
      return;
    }
  }

  const Rim& rim_;
  const PlacedPolyhedron& body_;
  const Polyhedron& core_;
  Vec3d centre_, x_, y_, inwards_;
  double ahead_;
};

/// `alone`: no point of the surface touches.
inline void rim_contacts(const Rim& rim, const PlacedPolyhedron& body, double ahead, bool alone,
                         DeepestContacts& deepest) {
  const double half = rim.half_range(body.pose.position, bound_of(body));
  if (half < 0) return;
  const RimInPolyhedron depth(rim, body, ahead);
  for_each_peak(half, depth, [&](const RimDepth& low, const RimDepth& high) {
    const auto found = depth.peak(low, high);
    if (!found) return;
    const double under = rim.under_surface(found->normal, rim.wall.e(high.phi));
    // Outside, a face or edge along the wall touches the surface, not the rim.
    double most = most_tilt;
    if (rim.free > 0 && !alone) most = -1e-9;
    if (rim.free < 0 && depth.by_corner(*found)) most = 0;
    if (under <= most) deepest.add(*found);
  });
}
inline std::optional<SolidContact> tip_contact(const Rim& rim, const PlacedPolyhedron& body) {
  const auto found = sphere_contact(rim.centre, 0, body);
  if (!(found.overlap > 0)) return {};
  return rim.contact(rim.centre, -found.normal, found.overlap, body.shape->equal_volume_radius());
}

}  // namespace silt::inline SILT_TARGET::detail
