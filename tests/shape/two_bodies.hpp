// silt - BSD-3-Clause, see LICENSE
#pragma once

#include "random_pairs.hpp"

/// Two free super-ellipsoids that collide without damping: leapfrog with NO_SQUISH (T. F. Miller et
/// al., J. Chem. Phys. 116 (2002) 8649), force 4/3 E sqrt(R_eff) overlap^(3/2) along the normal.
namespace two_bodies {

using silt::Vec3d;

enum class Overlap { Common, Local, Midway };

struct Body {
  silt::SuperEllipsoid shape;
  silt::SuperForm<double> form;
  double mass;
  Vec3d inertia, x, v, L;  // L: angular momentum in body axes
  silt::Quaternion q;

  double energy() const {
    return 0.5 * mass * dot(v, v) +
           0.5 * (L.x * L.x / inertia.x + L.y * L.y / inertia.y + L.z * L.z / inertia.z);
  }
  Vec3d spin() const { return cross(x, v * mass) + rotate(q, L); }  // about the origin
};

inline Body body(const silt::SuperEllipsoid& shape) {
  return {shape, form_of(shape), shape.volume(), shape.inertia(), {}, {}, {}, {}};
}

/// Turns by the angle that the angular momentum about axis k makes in time h.
inline void turn_about(Body& b, int k, double h) {
  const double L[3]{b.L.x, b.L.y, b.L.z}, I[3]{b.inertia.x, b.inertia.y, b.inertia.z};
  const double angle = h * L[k] / I[k];
  const Vec3d axis{k == 0 ? 1. : 0., k == 1 ? 1. : 0., k == 2 ? 1. : 0.};
  b.q = b.q * silt::rotation_about(axis, angle);
  b.L = rotate(silt::rotation_about(axis, -angle), b.L);
}

inline void drift(Body& b, double h) {
  b.x += b.v * h;
  turn_about(b, 2, h / 2), turn_about(b, 1, h / 2), turn_about(b, 0, h);
  turn_about(b, 1, h / 2), turn_about(b, 2, h / 2);
}

inline void kick(Body& b, const Vec3d& force, const Vec3d& point, double h) {
  b.v += force * (h / b.mass);
  b.L += rotate(conjugate(b.q), cross(point - b.x, force)) * h;
}

/// Contact by the direction of the midway point.
inline silt::BodyContact<double> midway(const pairs::Pair& pair,
                                        silt::NormalMemory<double>& memory) {
  const auto ray = silt::find_ray_normal(pair);
  silt::BodyContact<double> c{};
  if (ray.depth < 0) return memory.R_eff = 0, c;
  const auto D = silt::depth_along(pair, ray.direction);
  const double scale = dot(ray.direction, pair.between) / (D.i.height + D.j.height);
  const Vec3d pi = ray.direction * D.i.height + D.s * D.i.along_s + D.t * D.i.along_t;
  if (memory.R_eff == 0) memory.R_eff = silt::detail::effective_radius_at(pair, D);
  c.touches = true, c.normal = -ray.direction, c.overlap = D.F, c.R_eff = memory.R_eff;
  c.point = pi * scale;
  return c;
}

struct End {
  double energy, momentum, angular_momentum;  // changes over energy, |m v|, |m v| size
  bool touched, parted;
};

/// One collision, the contact resolved by about `steps` steps; `seed` draws shapes and directions.
inline End collide(double s, Overlap how, int steps, unsigned seed) {
  pairs::Source from(seed);
  Body i = body({from.uniform(1, 1.5), from.uniform(1, 1.5), from.uniform(1, 1.5), s, s});
  Body j = body({from.uniform(1, 1.5), from.uniform(1, 1.5), from.uniform(1, 1.5), s, s});
  i.q = from.turn(), j.q = from.turn();
  const Vec3d ray = from.direction();
  pairs::Pair pair{i.form, j.form, body_axes(i.q), body_axes(j.q), {}};
  pairs::set_depth(pair, ray, -2e-3);
  i.x = {0, 0, 0}, j.x = pair.between;
  const double speed = 1, E = 2e4 * i.mass;  // overlaps of some 1 % of the size
  i.v = ray * (0.5 * speed), j.v = -ray * (0.5 * speed) + from.direction() * (0.2 * speed);
  i.L = from.direction() * (0.1 * speed * i.mass), j.L = from.direction() * (0.1 * speed * j.mass);
  const double contact_time = 2.87 * std::pow(0.25 * i.mass * i.mass / (E * E * 0.5), 0.2);
  const double h = contact_time / steps, before = i.energy() + j.energy();
  const Vec3d P = i.v * i.mass + j.v * j.mass, S = i.spin() + j.spin();
  silt::NormalMemory<double> memory;
  End end{0, 0, 0, false, false};
  int apart = 0;
  for (int k = 0; k < 40 * steps && !end.parted; ++k) {
    drift(i, h / 2), drift(j, h / 2);
    pair.turn_i = body_axes(i.q), pair.turn_j = body_axes(j.q), pair.between = j.x - i.x;
    const auto c = how == Overlap::Common  ? silt::touch(pair, memory)
                   : how == Overlap::Local ? silt::touch<silt::ContactRadius::Local>(pair, memory)
                                           : midway(pair, memory);
    if (c.touches) {
      const double F = 4.0 / 3.0 * E * std::sqrt(c.R_eff * c.overlap) * c.overlap;
      kick(i, c.normal * F, i.x + c.point, h), kick(j, -c.normal * F, i.x + c.point, h);
      end.touched = true, apart = 0;
    }
    drift(i, h / 2), drift(j, h / 2);
    end.parted = end.touched && ++apart > 5;
  }
  const double mv = i.mass * speed;
  end.energy = (i.energy() + j.energy() - before) / before;
  end.momentum = norm(i.v * i.mass + j.v * j.mass - P) / mv;
  end.angular_momentum = norm(i.spin() + j.spin() - S) / mv;
  return end;
}

}  // namespace two_bodies
