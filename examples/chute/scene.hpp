// silt - BSD-3-Clause, see LICENSE
#pragma once

// The chute's scene, its mesh, and the closed forms for its wear.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <silt/silt.hpp>

namespace chute {

using silt::Vec3d;

struct Scene {
  double rate = 4, batch = 20;                       // [kg/s], [kg]
  double steep = 55, flat = 25;                      // [degrees] of the plate and of the outflow
  double width = 0.15, side = 0.08;                  // [m]
  double upper = 0.5, radius = 0.3, lower = 0.25;    // [m] along the plate, of the bend, after it
  double friction = 0.35;                            // [-] ore on steel
  double r_min = 4e-3, r_max = 6e-3;                 // [m]
  double facet = 5e-3;                               // [m] of the mesh
  static constexpr double g = 9.81;                  // [m/s2]
  static constexpr double density = 2700, feed = 2;  // [kg/m3], [m/s] into the chute
  static constexpr silt::Archard archard{.coefficient = 2e-3, .hardness = 1.5e9};
  static constexpr silt::Finnie finnie{.flow_stress = 1.5e9, .share_cutting = 0.02};

  static double radians(double degrees) { return degrees * std::numbers::pi / 180; }
  double bend() const { return radius * radians(steep - flat); }               // [m] along it
  double length() const { return upper + bend() + lower; }                     // [m]
  int rows() const { return static_cast<int>(std::round(length() / facet)); }  // of facets
  double cell() const { return length() / rows(); }                            // [m] of a row
  double middle(std::size_t row) const { return (static_cast<double>(row) + 0.5) * cell(); }  // [m]
  double archard_factor() const { return archard.coefficient / archard.hardness; }  // [1/Pa]
  silt::Box inlet() const { return {{0.05, 0.02, 0.2}, {0.13, width - 0.02, 0.3}}; }
  double mean_mass() const {  // [kg] of radii that are uniform
    return density * std::numbers::pi / 3 * (std::pow(r_max, 4) - std::pow(r_min, 4)) /
           (r_max - r_min);
  }
  double landing() const {  // [m] where the middle of what falls meets the plate
    return 0.5 * (inlet().min.x + inlet().max.x) / std::cos(radians(steep));
  }
  /// Slope [rad] at the distance s [m] along the chute from the upper end.
  double slope(double s) const {
    return radians(steep) - std::clamp((s - upper) / radius, 0.0, radians(steep - flat));
  }
  /// The point at s, y, and the height h above the floor.
  Vec3d at(double s, double y, double h) const {
    const double top = radians(steep), t = slope(s), l = std::max(s - upper - bend(), 0.0);
    const double u = std::min(s, upper), r = radius;
    return {
        u * std::cos(top) + r * (std::sin(top) - std::sin(t)) + l * std::cos(t) + h * std::sin(t),
        y,
        -u * std::sin(top) + r * (std::cos(top) - std::cos(t)) - l * std::sin(t) + h * std::cos(t)};
  }
  /// The distance s of a point on or above the chute.
  double place(const Vec3d& p) const {
    const double top = radians(steep), end = radians(flat);
    const double s = p.x * std::cos(top) - p.z * std::sin(top);
    if (s < upper) return std::max(s, 0.0);
    const Vec3d middle = at(upper, 0, radius), d = p - middle;
    const double t = std::atan2(-d.x, -d.z);
    if (t > end) return upper + radius * (top - t);
    return upper + bend() + d.x * std::cos(end) - d.z * std::sin(end);
  }
  silt::TriangleMesh mesh() const {
    const int up = static_cast<int>(side / facet), across = static_cast<int>(width / facet);
    const auto corner = [&](int row, int k) {  // k: down one side, across the floor, up the other
      const int above = std::max({up - k, k - up - across, 0});
      return at(cell() * row, width * std::clamp(k - up, 0, across) / across, side * above / up);
    };
    std::vector<std::array<Vec3d, 3>> all;
    for (int i = 0; i < rows(); ++i)
      for (int k = 0; k < across + 2 * up; ++k) {
        const Vec3d a = corner(i, k), b = corner(i + 1, k), c = corner(i + 1, k + 1);
        all.push_back({a, b, c}), all.push_back({a, c, corner(i, k + 1)});
      }
    return silt::TriangleMesh(all);
  }
};

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
inline std::vector<double> block(const Scene& s) {
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

}  // namespace chute
