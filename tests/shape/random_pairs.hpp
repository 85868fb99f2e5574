// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include <silt/shape/narrow/super_ellipsoids.hpp>

/// Random and near-degenerate pairs of super-ellipsoids, for tests and for the long run in
/// benchmarks/shape.
namespace pairs {

using Form = silt::SuperForm<double>;
using Pair = silt::PosedPair<Form, Form>;

struct Source {
  explicit Source(unsigned seed) : engine(seed) {}
  std::mt19937_64 engine;

  double uniform(double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(engine);
  }
  double normal() { return std::normal_distribution<double>()(engine); }
  double log_uniform(double a, double b) { return std::exp(uniform(std::log(a), std::log(b))); }
  silt::Vec3d direction() { return silt::normalised({normal(), normal(), normal()}); }
  silt::Quaternion turn(double angle) { return silt::rotation_about(direction(), angle); }
  silt::Quaternion turn() {
    const double w = normal(), x = normal(), y = normal(), z = normal();
    const double n = 1 / std::sqrt(w * w + x * x + y * y + z * z);
    return {w * n, x * n, y * n, z * n};
  }
  /// Exponents up to s, 2 and equal ones often among them; aspect ratio up to `aspect`.
  silt::SuperEllipsoid shape(double s, double aspect) {
    const auto exponent = [&] {
      return uniform(0, 1) < 0.2 ? 2.0 : uniform(0, 1) < 0.5 ? s : log_uniform(2, s);
    };
    const auto axis = [&] { return log_uniform(1, aspect); };
    silt::SuperEllipsoid out{axis(), axis(), axis(), exponent(), exponent()};
    if (uniform(0, 1) < 0.3) out.s2 = out.s1;
    return out;
  }
};

/// Sets the distance so that the bodies overlap by `depth` of the touching distance along `ray`.
inline void set_depth(Pair& pair, const silt::Vec3d& ray, double depth) {
  pair.between = ray;
  const auto out = silt::find_ray_normal(pair, false);
  const auto D = silt::depth_along(pair, out.direction);
  const double distance = (D.i.height + D.j.height) / dot(out.direction, ray);
  pair.between = ray * (distance * (1 - depth));
}

struct Posed {
  silt::SuperEllipsoid i, j;
  silt::Quaternion turn_i, turn_j;
  Pair pair;
};

/// A pair in general position.
inline Posed general(Source& from, double s, double aspect, double depth) {
  Posed p{from.shape(s, aspect), from.shape(s, aspect), from.turn(), from.turn(), {}};
  p.pair = {form_of(p.i), form_of(p.j), body_axes(p.turn_i), body_axes(p.turn_j), {}};
  set_depth(p.pair, from.direction(), depth);
  return p;
}

/// Faces, edges or corners of i and j upon each other up to a tilt of `tilt` rad.
inline Posed aligned(Source& from, double s, double aspect, double tilt, double depth) {
  Posed p{from.shape(s, aspect), from.shape(s, aspect), from.turn(), {}, {}};
  const auto quarter = [&](const silt::Vec3d& axis) {
    const double part = from.uniform(0, 1) < 0.3 ? 0.5 : 1;
    return silt::rotation_about(axis, part * 1.5707963267948966 * std::floor(from.uniform(0, 4)));
  };
  p.turn_j =
      p.turn_i * quarter({1, 0, 0}) * quarter({0, 1, 0}) * quarter({0, 0, 1}) * from.turn(tilt);
  p.pair = {form_of(p.i), form_of(p.j), body_axes(p.turn_i), body_axes(p.turn_j), {}};
  // Along an axis of i, or where a face of j stands out over one of i.
  const double off = from.uniform(0, 1) < 0.5 ? 0 : 0.8;
  const silt::Vec3d ray{from.uniform(-off, off) * p.i.a, from.uniform(-off, off) * p.i.b, p.i.c};
  set_depth(p.pair, silt::normalised(p.pair.turn_i.to_space(ray)), depth);
  return p;
}

/// The pair a moment later: j has moved by `step` smaller sizes and turned by `step` rad.
inline void move(Source& from, Posed& p, double step) {
  p.turn_j = from.turn(step) * p.turn_j;
  p.pair.turn_j = body_axes(p.turn_j);
  p.pair.between += from.direction() * (step * std::min(p.pair.i.size, p.pair.j.size));
}

}  // namespace pairs
