// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <numbers>

#include <silt/shape/narrow/solid_planes.hpp>

/// Searches over the angle phi that determines the normals of a cylinder or cone. Used by
/// solid_walls.hpp.

namespace silt::inline SILT_TARGET {

namespace detail {

/// The lateral surface of a cylinder or cone, extended without end, in a frame that points to the
/// body: all points with N(phi) . (p - from) = n_r radius for one phi. N is the normal away from
/// the axis,
///   N(phi) = n_r e(phi) + n_z axis,  N' = n_r e',  N'' = -n_r e,  e = x cos phi + y sin phi. (1)
struct RoundWall {
  Vec3d from, axis;
  Vec3d x, y;             // normal to the axis; x towards the centre of the body
  double length, radius;  // [m] of the axis; of the surface at `from`
  double n_r, n_z;        // [-]
  double to_centre;       // [m] distance of the body's centre from the axis
  double offset;          // [m] n_r radius

  RoundWall(const Vec3d& a, const Vec3d& b, double radius_a, double radius_b, const Vec3d& centre)
      : from(a), radius(radius_a) {
    length = norm(b - a);
    axis = (b - a) * (1 / length);
    const double taper = radius_b - radius_a, slant = std::sqrt(length * length + taper * taper);
    n_r = length / slant, n_z = -taper / slant, offset = n_r * radius;
    const Vec3d across = centre - a - dot(centre - a, axis) * axis;
    to_centre = norm(across);
    Vec3d any;
    tangents(axis, any, y);
    x = to_centre > 1e-14 * length ? across * (1 / to_centre) : any;
    x = normalised(x - dot(x, axis) * axis);
    y = cross(axis, x);
  }

  /// An edge: a cylinder of radius 0. `towards`: unit x; `distance`: of the body's centre.
  RoundWall(const Vec3d& start, const Vec3d& direction, double edge, const Vec3d& towards,
            double distance)
      : from(start), axis(direction), x(towards), y(cross(direction, towards)), length(edge) {
    radius = offset = n_z = 0, n_r = 1, to_centre = distance;
  }

  Vec3d e(double phi) const { return std::cos(phi) * x + std::sin(phi) * y; }
  Vec3d normal(const Vec3d& e) const { return n_r * e + n_z * axis; }
  /// Distance of a point outwards of the surface [m]; p from `from`.
  double beyond(const Vec3d& p, const Vec3d& normal) const { return dot(p, normal) - offset; }
  /// Position of the foot of p on the surface, along the slant [m]; 0 to slant(): between the ends.
  double along(const Vec3d& p, const Vec3d& e) const {
    return n_r * dot(p, axis) - n_z * (dot(p, e) - radius);
  }
  double slant() const { return length / n_r; }
  bool between_ends(const Vec3d& p, const Vec3d& e) const {
    const double u = along(p, e);
    return u >= 0 && u <= slant();
  }
  /// Whether a ball around the body's centre can touch the surface, on its inner or outer side.
  bool in_reach(const Vec3d& centre, double bound, bool inner) const {
    const double beyond_centre = beyond(centre - from, normal(x)), u = along(centre - from, x);
    return (inner ? beyond_centre > -bound : beyond_centre < bound) && u > -bound &&
           u < slant() + bound;
  }
};

/// The support point of a body along N(phi) or, outside the wall, along -N(phi).
struct RoundSupport {
  double phi;
  Vec3d e, p;       // p: from `from`
  double beyond;    // [m] outwards of the surface
  double slope;     // [m] derivative of `beyond` with respect to phi: N' . p
  double weight;    // [m] w of (2)
  double radius_t;  // [m] radius of curvature around the axis, times n_r^2
};

template <class Form>
RoundSupport support_at(const RoundWall& wall, const PlacedSuper<Form>& body, double phi,
                        double sign) {
  const Vec3d e = wall.e(phi), n = sign * wall.normal(e), s = cross(wall.axis, e), t = cross(n, s);
  const auto cap = body.cap(n, s, t);
  const Vec3d p = body.position - wall.from + cap.height * n + cap.along_s * s + cap.along_t * t;
  return {phi,
          e,
          p,
          wall.beyond(p, wall.normal(e)),
          wall.n_r * dot(p, s),
          wall.n_r * dot(p, e),
          wall.n_r * wall.n_r * cap.radii.xx};
}

/// Zero of the slope between two angles at which its signs differ. Newton's method within the
/// interval, with bisection where the slope does not decrease enough.
template <class Form>
RoundSupport turning_point(const RoundWall& wall, const PlacedSuper<Form>& body, double low,
                           double high, double start, double sign) {
  const double tolerance = 1e-12 * body.form.bound;
  auto at = support_at(wall, body, start, sign);
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 80 && std::abs(at.slope) > tolerance; ++k) {
    if (sign < 0 && at.beyond >= 0) break;  // separated
    (at.slope > 0 ? low : high) = at.phi;
    const double curve = sign * at.radius_t - at.weight;
    double next = curve < 0 ? at.phi - at.slope / curve : high + 1;
    const bool slow = std::abs(at.slope) > 0.5 * last;
    last = std::abs(at.slope);
    if (slow || !(next > low && next < high)) next = 0.5 * (low + high);
    if (next == at.phi || !(high - low > 1e-15)) break;
    at = support_at(wall, body, next, sign);
  }
  return at;
}

/// All local maxima over phi of the distance D(phi) by which a smooth body extends beyond the
/// surface: the deepest contacts inside a concave wall.
///
///   D = N . p - n_r radius,  D' = N' . p,  D'' = T - w,  w = n_r e . p                       (2)
///
/// with T the body's radius of curvature. Intervals are halved until the integral of T over one,
/// obtained from D' and w at its ends, shows that D' has no relevant rise, that D' falls or rises
/// throughout, or that D < 0. An edge or corner takes few halvings, a face parallel to the wall
/// about ten. Maxima closer to each other than 1 % of the body count as one.
template <class Form>
class InnerMaxima {
 public:
  InnerMaxima(const RoundWall& wall, const PlacedSuper<Form>& body) : wall_(wall), body_(body) {
    const double bound = body.form.bound;
    // |N . (p - from)| <= n_r to_centre cos phi + n_z z + bound must reach the offset.
    const double z = dot(body.position - wall.from, wall.axis);
    offset_ = wall.offset - wall.n_z * z;
    const double least = (offset_ - bound) / std::max(wall.n_r * wall.to_centre, 1e-300);
    const double width = least <= -1 ? std::numbers::pi : std::acos(std::min(least, 1.0));
    const int parts = std::clamp(static_cast<int>(std::ceil(width / 0.4)), 2, 8) * 2;
    auto low = support_at(wall, body, -width, 1);
    for (int k = 1; k <= parts; ++k) {
      const auto high = support_at(wall, body, -width + 2 * width * k / parts, 1);
      if (k == 1 || high.beyond > best_.beyond) best_ = high;
      search(low, high, 0);
      low = high;
    }
    // A body of revolution about the wall's axis is equally deep everywhere: one point is enough.
    if (count_ == 0 && least <= -1 && best_.beyond > 0 && std::abs(best_.slope) <= 1e-9 * bound)
      found_[count_++] = best_;
  }

  int count() const { return count_; }
  const RoundSupport& operator[](int k) const { return found_[static_cast<std::size_t>(k)]; }

 private:
  static constexpr int most = 16;

  void search(const RoundSupport& a, const RoundSupport& b, int halved) {
    const double width = b.phi - a.phi, bound = body_.form.bound;
    // N in between combines the N at both ends; the sum of weights is at most 1/cos(width/2).
    const double stretch = 1 / std::cos(0.5 * width);
    const double highest = std::max(a.beyond, b.beyond) + offset_;
    if (highest * (highest > 0 ? stretch : 1) + std::abs(wall_.n_z) * bound * (stretch - 1) <=
        offset_)
      return;
    const double w = std::max(a.weight, b.weight), mean_w = 0.5 * (a.weight + b.weight);
    // Rise of D' by curvature; the change of w follows from its slope.
    const double rise =
        std::max(0.0, b.slope - a.slope + width * (mean_w + width / 12 * (a.slope - b.slope)));
    if (a.slope <= 0 && a.slope + rise <= 0) return;
    if (b.slope > 0 && b.slope - rise >= 0) return;
    if (a.slope > 1.1 * w * width) return;
    const double mean_T = 0.5 * (a.radius_t + b.radius_t);
    const double low_T = std::min(a.radius_t, b.radius_t),
                 high_T = std::max(a.radius_t, b.radius_t);
    const bool smooth =
        high_T <= 2 * low_T && std::abs(rise - mean_T * width) <= 0.15 * mean_T * width;
    const bool rises = smooth && low_T > 1.3 * w;
    if (rises) return;
    const bool falls = smooth && 1.3 * high_T < std::min(a.weight, b.weight);
    if (falls || rise <= 0.01 * body_.form.size || halved == 12) {
      if (a.slope > 0 && b.slope <= 0) keep(a, b);
      return;
    }
    const auto middle = support_at(wall_, body_, 0.5 * (a.phi + b.phi), 1);
    search(a, middle, halved + 1);
    search(middle, b, halved + 1);
  }

  void keep(const RoundSupport& a, const RoundSupport& b) {
    const double start = a.phi + (b.phi - a.phi) * a.slope / (a.slope - b.slope);
    const auto at = turning_point(wall_, body_, a.phi, b.phi, start, 1);
    if (at.beyond > 0 && count_ < most) found_[static_cast<std::size_t>(count_++)] = at;
  }

  const RoundWall& wall_;
  const PlacedSuper<Form>& body_;
  double offset_;  // [m] n_r times the radius of the surface at the body's centre
  RoundSupport best_{};
  std::array<RoundSupport, most> found_;
  int count_ = 0;
};

/// Half the range of phi that contains the nearest point of a body outside.
inline double outer_range(const RoundWall& wall, double bound) {
  return wall.to_centre > bound ? std::asin(bound / wall.to_centre) : 0.5 * std::numbers::pi;
}

/// The angle phi at which the lowest corner of a core is highest above the surface: maximum over
/// phi of the minimum over corners of N . p. Each corner gives a wave, concave in the relevant
/// range.
class OuterAngle {
 public:
  OuterAngle(const RoundWall& wall, const PlacedPolyhedron& body)
      : wall_(wall), range_(outer_range(wall, bound_of(body))) {
    low_ = -range_, high_ = range_;
    const double rounding = 1e-14 * (bound_of(body) + wall.to_centre);
    double next = 0;
    for (int k = 0; k < 64; ++k) {
      phi_ = next;
      const Vec3d e = wall.e(phi_), N = wall.normal(e);
      const Vec3d p = body.support(-N) - wall.from;
      beyond_ = wall.beyond(p, N);
      if (beyond_ >= body.shape->radius()) return;  // this plane separates them
      if (k > 0 && dot(N, p) >= expected_ - rounding) return;
      if (dot(p, cross(wall.axis, e)) > 0)
        low_ = phi_, p_low_ = p, has_low_ = true;
      else
        high_ = phi_, p_high_ = p, has_high_ = true;
      next = dot(p, e) > 0 ? best_between() : low_;
      if (!(next > low_ && next < high_)) next = halved();
      if (!(high_ - low_ > 1e-15)) return;
    }
  }
  double phi() const { return phi_; }
  double beyond() const { return beyond_; }  // [m] of the lowest corner

 private:
  double angle_of(const Vec3d& p) const { return std::atan2(dot(p, wall_.y), dot(p, wall_.x)); }
  double height(const Vec3d& p, double phi) const { return dot(p, wall_.normal(wall_.e(phi))); }

  double halved() {
    expected_ = std::numeric_limits<double>::infinity();
    return 0.5 * (low_ + high_);
  }
  /// The best angle for the corners of the two ends; sets `expected_`, the height of the lower one.
  double best_between() {
    double phi;
    if (!has_low_ || !has_high_) {
      const Vec3d& p = has_low_ ? p_low_ : p_high_;
      phi = std::clamp(angle_of(p), has_low_ ? low_ : -range_, has_low_ ? range_ : high_);
      expected_ = height(p, phi);
      return phi;
    }
    const Vec3d d = p_high_ - p_low_;
    const double along_x = dot(d, wall_.x), along_y = dot(d, wall_.y);
    const double share =
        -wall_.n_z * dot(d, wall_.axis) / (wall_.n_r * std::hypot(along_x, along_y));
    const double middle = std::atan2(along_y, along_x),
                 half = std::acos(std::clamp(share, -1., 1.));
    // d is higher before the tie and lower after it: the tie is behind the peak of its wave.
    phi = std::remainder(middle + half, 2 * std::numbers::pi);
    const double peak_low = angle_of(p_low_), peak_high = angle_of(p_high_);
    if (peak_low < phi)
      phi = peak_low;
    else if (peak_high > phi)
      phi = peak_high;
    expected_ = std::min(height(p_low_, phi), height(p_high_, phi));
    return phi;
  }

  const RoundWall& wall_;
  double range_, low_, high_;
  Vec3d p_low_{}, p_high_{};
  bool has_low_ = false, has_high_ = false;
  double phi_ = 0, beyond_ = 0, expected_ = 0;
};

/// The range along the wall's line at the angle of e that a core touches: a point, or part of a
/// face or edge.
struct TouchingLine {
  double low = std::numeric_limits<double>::infinity();  // [m] along the slant
  double high = -std::numeric_limits<double>::infinity();
};
/// From the corners that are as low as `beyond`, within rounding: their hull's range on the line.
inline TouchingLine touching_line(const RoundWall& wall, const PlacedPolyhedron& body,
                                  const Vec3d& e, double beyond) {
  const Vec3d N = wall.normal(e), across = cross(wall.axis, e);
  const double tie = 1e-9 * bound_of(body);
  struct Tied {
    double side, along;  // [m] across, and along the slant
  };
  std::array<Tied, 32> tied;
  std::size_t count = 0;
  for (const auto& corner : body.shape->vertices()) {
    const Vec3d p = body.pose.to_space(corner) - wall.from;
    if (wall.beyond(p, N) <= beyond + tie && count < tied.size())
      tied[count++] = {dot(p, across), wall.along(p, e)};
  }
  TouchingLine line;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j) {
      const auto &a = tied[i], &b = tied[j];
      if (a.side > tie || b.side < -tie) continue;
      const double width = b.side - a.side;
      const double part = width > tie ? std::clamp(-a.side / width, 0.0, 1.0) : 0;
      const double u = a.along + part * (b.along - a.along);
      line.low = std::min(line.low, u), line.high = std::max(line.high, u);
    }
  return line;
}

}  // namespace detail

}  // namespace silt
