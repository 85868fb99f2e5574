// silt - BSD-3-Clause, see LICENSE
#pragma once

#include "bodies.hpp"
#include "random_pairs.hpp"

#include <silt/shape/narrow/solid_pairs.hpp>

/// Bodies of every kind that touch_solids() takes, of one size (0.3 to 0.5 m), and a law by which
/// two of them collide.
namespace solids {

using shape_test::Random;
using silt::NormalMemory;
using silt::PlacedBall;
using silt::PlacedPolyhedron;
using silt::PlacedSuper;
using silt::Polyhedron;
using silt::Quaternion;
using silt::SolidContact;
using silt::Vec3d;
using Super = PlacedSuper<silt::SuperForm<double>>;
using PolySuper = PlacedSuper<silt::PolyForm<double>>;

struct BallKind {
  static inline const std::string name = "ball";
  double radius;
  explicit BallKind(Random& random) : radius(random.uniform(0.3, 0.5)) {}
  PlacedBall at(const Vec3d& x, const Quaternion&) const { return {radius, x}; }
};

/// A super-ellipsoid of which the sphere of equal volume has radius 0.4; s up to `s`.
inline silt::SuperEllipsoid super_shape(Random& random, double s) {
  pairs::Source source(static_cast<unsigned>(random.uniform(0, 1e9)));
  auto shape = source.shape(s, 2);
  const double scale = 0.4 / shape.equal_volume_radius();
  shape.a *= scale, shape.b *= scale, shape.c *= scale;
  return shape;
}

struct SuperKind {
  static inline const std::string name = "super";
  silt::SuperForm<double> form;
  explicit SuperKind(Random& random, double s = 6) : form(form_of(super_shape(random, s))) {}
  Super at(const Vec3d& x, const Quaternion& q) const { return {form, body_axes(q), x}; }
};

struct PolySuperKind {
  static inline const std::string name = "poly-super";
  silt::PolyForm<double> form;
  explicit PolySuperKind(Random& random) {
    const auto side = [&] { return random.uniform(0.3, 0.5); };
    const Vec3d plus{side(), side(), side()}, minus{side(), side(), side()};
    form =
        form_of(silt::PolySuperEllipsoid{plus, minus, random.uniform(2, 4), random.uniform(2, 4)});
  }
  PolySuper at(const Vec3d& x, const Quaternion& q) const { return {form, body_axes(q), x}; }
};

struct SharpKind {
  static inline const std::string name = "polyhedron";
  Polyhedron shape;
  explicit SharpKind(Random& random) : shape(random.hull(12)) {}
  explicit SharpKind(const Polyhedron& given) : shape(given) {}
  PlacedPolyhedron at(const Vec3d& x, const Quaternion& q) const { return {&shape, {x, q}}; }
};

struct DilatedKind : SharpKind {
  static inline const std::string name = "dilated";
  explicit DilatedKind(Random& random)
      : SharpKind(Polyhedron::from_points(random.hull(12).vertices(), 0.06)) {}
};

/// The farthest point along unit n, dilation and all.
template <class Body>
Vec3d farthest(const Body& body, const Vec3d& n) {
  return body.support(n);
}
inline Vec3d farthest(const PlacedPolyhedron& body, const Vec3d& n) {
  return body.support(n) + body.shape->radius() * n;
}

/// F(m), by the support functions alone.
template <class A, class B>
double depth_along(const A& i, const B& j, const Vec3d& m) {
  return dot(m, farthest(i, m) - farthest(j, -m));
}

/// The least of F by a grid on the sphere and then ever smaller steps: an upper bound. [m]
template <class A, class B>
double least_depth(const A& i, const B& j) {
  constexpr int n = 1500;
  Vec3d best{0, 0, 1};
  double least = 1e300;
  for (int k = 0; k < n; ++k) {
    const double z = 1 - (2 * k + 1.0) / n, r = std::sqrt(1 - z * z), phi = 2.399963229728653 * k;
    const Vec3d m{r * std::cos(phi), r * std::sin(phi), z};
    if (const double d = depth_along(i, j, m); d < least) least = d, best = m;
  }
  for (double step = 0.05; step > 1e-8;) {
    Vec3d s, t, to = best;
    silt::tangents(best, s, t);
    for (int k = 0; k < 16; ++k) {
      const double phi = 0.39269908169872414 * k;
      const Vec3d m =
          silt::normalised(best + s * (step * std::cos(phi)) + t * (step * std::sin(phi)));
      if (const double d = depth_along(i, j, m); d < least) least = d, to = m;
    }
    if (to == best)
      step *= 0.5;
    else
      best = to;
  }
  return least;
}

/// Calls use(KindA, KindB) for the ordered pairs of kinds.
template <class Use>
void for_each_pair(Use&& use, Random& random) {
  const auto with = [&](const auto& i) {
    use(i, BallKind(random)), use(i, SuperKind(random)), use(i, PolySuperKind(random));
    use(i, SharpKind(random)), use(i, DilatedKind(random));
  };
  with(BallKind(random)), with(SuperKind(random)), with(PolySuperKind(random));
  with(SharpKind(random)), with(DilatedKind(random));
}

/// A free body with mass 1 and any moments of inertia, its centre where its shape is placed.
/// Leapfrog, the rotation by NO_SQUISH (T. F. Miller et al., J. Chem. Phys. 116 (2002) 8649).
struct Free {
  Vec3d x{0, 0, 0}, v{0, 0, 0}, spin{0, 0, 0};  // spin: angular momentum in body axes
  Quaternion q;
  static constexpr double I[3]{0.05, 0.06, 0.08};

  double energy() const {
    return 0.5 * dot(v, v) +
           0.5 * (spin.x * spin.x / I[0] + spin.y * spin.y / I[1] + spin.z * spin.z / I[2]);
  }
  Vec3d angular() const { return cross(x, v) + rotate(q, spin); }
  void turn_about(int k, double h) {
    const Vec3d axis{k == 0 ? 1. : 0., k == 1 ? 1. : 0., k == 2 ? 1. : 0.};
    const double angle = h * dot(axis, spin) / I[k];
    q = q * silt::rotation_about(axis, angle);
    spin = rotate(silt::rotation_about(axis, -angle), spin);
  }
  void drift(double h) {
    x += h * v;
    turn_about(2, h / 2), turn_about(1, h / 2), turn_about(0, h);
    turn_about(1, h / 2), turn_about(2, h / 2);
  }
  void kick(const Vec3d& force, const Vec3d& torque, double h) {
    v += h * force, spin += h * rotate(conjugate(q), torque);
  }
};

struct Collision {
  double swing = 0, end = 0, momentum = 0;  // energy errors over energy; changes
  double jump = 0;                          // [m] of the point from one step to the next
  bool touched = false, parted = false;
};

/// Two bodies fly at each other, off centre and turning, and part; Hertz' law without damping.
template <class KindI, class KindJ>
Collision collide(const KindI& kind_i, const KindJ& kind_j, unsigned seed, double h) {
  Random random(seed);
  Free i, j;
  const Vec3d ray = random.direction();
  i.q = random.turn(), j.q = random.turn();
  i.x = 0.65 * ray + 0.1 * random.direction(), j.x = -0.65 * ray;
  i.v = -0.5 * ray, j.v = 0.5 * ray;
  i.spin = 0.01 * random.direction(), j.spin = 0.01 * random.direction();
  const double before = i.energy() + j.energy(), k = 2e4;
  const Vec3d P = i.v + j.v, S = i.angular() + j.angular();
  NormalMemory<double> memory;
  Collision out;
  Vec3d last{0, 0, 0};
  bool pressed = false;
  for (double t = 0; t < 1.8; t += h) {
    i.drift(h / 2), j.drift(h / 2);
    const auto c = touch_solids(kind_i.at(i.x, i.q), kind_j.at(j.x, j.q), memory);
    if (c.overlap > 0) {
      if (pressed) out.jump = std::max(out.jump, norm(c.point - last));
      last = c.point;
      const double law = k * std::sqrt(c.R_eff * c.overlap);
      const double stored = 0.4 * law * c.overlap * c.overlap;
      const Vec3d force = (law * c.overlap * c.gradient) * c.normal, turn = c.couple * force;
      // Half kicks on either side of the place at which the stored energy is taken.
      const auto kick = [&] {
        i.kick(force, cross(c.point - i.x, force) + turn, h / 2);
        j.kick(-force, -(cross(c.point - j.x, force) + turn), h / 2);
      };
      kick();
      out.swing = std::max(out.swing, std::abs(i.energy() + j.energy() + stored - before) / before);
      kick();
    }
    pressed = c.overlap > 0;
    out.touched |= pressed, out.parted = out.touched && !pressed;
    i.drift(h / 2), j.drift(h / 2);
  }
  out.end = std::abs(i.energy() + j.energy() - before) / before;
  out.momentum = std::max(norm(i.v + j.v - P), norm(i.angular() + j.angular() - S));
  return out;
}

}  // namespace solids
