// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured: wear by place, from the modules and by other routes; closed forms for the wear.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "chute/scene.hpp"

namespace chute {

/// Volumes [m3] of the floor by position, and of the whole chute.
struct Worn {
  std::vector<double> floor;
  double all = 0;
  explicit Worn(const Scene& s) : floor(static_cast<std::size_t>(s.rows()), 0.0) {}
  void add(const Scene& s, const Vec3d& point, const Vec3d& normal, double volume) {
    all += volume;
    const auto k = static_cast<std::size_t>(s.place(point) / s.cell());
    if (std::abs(normal.y) < 0.5) floor[std::min(k, floor.size() - 1)] += volume;
  }
};

/// Finnie's law in its textbook form, of speed [m/s] and angle [rad].
inline double cut(const silt::Finnie& law, double mass, double speed, double angle) {
  const double K = law.force_ratio;
  const double f = std::tan(angle) <= K / 6
                       ? std::sin(2 * angle) - 6 / K * std::pow(std::sin(angle), 2)
                       : K / 6 * std::pow(std::cos(angle), 2);
  return law.share_cutting * mass * speed * speed * f / (law.flow_stress * law.depth_ratio * K);
}

/// Depth [m/kg] by Archard's law of a block that falls onto the plate and slides down with the
/// whole flow: k/(H b) (g cos(slope) + v^2/r), independent of the flow's thickness. 0 before it
/// lands.
inline std::vector<double> block_depth(const Scene& s) {
  const double top = Scene::radians(s.steep), start = s.landing();
  const double fall = 0.5 * (s.inlet().min.z + s.inlet().max.z) + start * std::sin(top) - s.r_max;
  // The normal velocity is lost, and friction removes its share of that impulse.
  double v =
      std::sqrt(s.feed * s.feed + 2 * s.g * fall) * (std::sin(top) - s.friction * std::cos(top));
  std::vector<double> depth(Worn(s).floor.size(), 0.0);
  for (std::size_t k = 0; k < depth.size(); ++k) {
    const double at = s.middle(k), t = s.slope(at);
    if (at < start) continue;
    const bool bends = at > s.upper && at < s.upper + s.bend();
    const double pressed = s.g * std::cos(t) + (bends ? v * v / s.radius : 0);  // [m/s2]
    depth[k] = s.archard_factor() / s.width * pressed;
    v = std::sqrt(std::max(v * v + 2 * s.cell() * (s.g * std::sin(t) - s.friction * pressed), 0.0));
  }
  return depth;
}

/// By a module M.
template <class M, class Sim>
Worn worn_by(const Sim& sim, const Scene& s) {
  Worn worn(s);
  const silt::TriangleMesh mesh = s.mesh();
  const auto volumes = silt::worn_volumes<M>(sim, "chute");
  for (std::size_t t = 0; t < volumes.size(); ++t) {
    const auto& [p, q, r] = mesh.triangles()[t];
    const auto& x = mesh.vertices();
    worn.add(s, 1.0 / 3 * (x[p] + x[q] + x[r]), mesh.normals()[t], volumes[t]);
  }
  return worn;
}

/// Wear computed without the modules: from contacts sampled at intervals, and from impacts.
struct Seen {
  static constexpr double sample = 0.5e-3;  // [s]
  Worn sliding, impacts;
  std::array<double, 18> angles{};  // [m3] cut by impacts at 0 to 5 degrees, 5 to 10, ...

  template <class Sim>
  void read_contacts(const Sim& now, const Scene& s) {
    now.for_each_contact([&](const silt::ContactSeen& c) {
      if (c.wall == silt::no_wall) return;
      const std::size_t k = c.place_a;
      const Vec3d v = now.velocity(k) + cross(now.angular_velocity(k), c.point - now.position(k));
      const double way = norm(v - dot(v, c.normal) * c.normal) * sample;
      sliding.add(s, c.point, c.normal, s.archard_factor() * c.normal_force * way);
    });
  }
  void note(const silt::ContactEvent& c, double mass, const Scene& s) {
    const double angle = std::atan2(c.normal_speed, c.tangential_speed);
    const double V = cut(s.finnie, mass, std::hypot(c.normal_speed, c.tangential_speed), angle);
    impacts.add(s, c.point, c.normal, V);
    angles[static_cast<std::size_t>(std::min(angle / Scene::radians(5), 17.0))] += V;
  }
};

}  // namespace chute
