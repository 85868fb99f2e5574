// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The particles that stand for spheres in the liquid: shells below their surface, half a spacing
/// down and then one apart, as deep as the kernel reaches, each with its mirror image above the
/// surface. What acts on them acts on the sphere.
class BodyPoints {
 public:
  struct Body {
    Vec3d centre{0, 0, 0}, velocity{0, 0, 0}, spin{0, 0, 0};  // [m], [m/s], [rad/s]
    double radius = 0;                                        // [m]
    Vec3d force{0, 0, 0}, torque{0, 0, 0};
  };
  std::vector<Body> bodies;

  std::size_t size() const { return points_.size(); }
  bool empty() const { return points_.empty(); }
  std::size_t body_of(std::size_t k) const { return points_[k].body; }
  Vec3d place(std::size_t k) const { return bodies[points_[k].body].centre + points_[k].at; }
  Vec3d ghost(std::size_t k) const {
    const Point& p = points_[k];
    return bodies[p.body].centre + p.up * p.at;
  }
  /// [m/s] of the sphere's surface half way between a point and its mirror image.
  Vec3d velocity(std::size_t k) const {
    const Point& p = points_[k];
    const Body& b = bodies[p.body];
    return b.velocity + cross(b.spin, (0.5 * (1 + p.up)) * p.at);
  }
  void move(double dt) {
    for (Body& b : bodies) b.centre += dt * b.velocity;
  }

  /// Takes what is in the liquid now; true if there are others than before.
  bool set(std::span<const Vec3d> centre, std::span<const double> radius,
           std::span<const Vec3d> velocity, std::span<const Vec3d> spin, const SphSetup& setup) {
    bool other = centre.size() != bodies.size();
    bodies.resize(centre.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      other = other || bodies[b].radius != radius[b];
      bodies[b] = {centre[b], velocity[b], spin.empty() ? Vec3d{0, 0, 0} : spin[b], radius[b]};
    }
    if (other) make(setup);
    return other;
  }

  /// Those of a state; set() gives the rest.
  void restore(std::span<const double> radii, const SphSetup& setup) {
    bodies.assign(radii.size(), {});
    for (std::size_t b = 0; b < radii.size(); ++b) bodies[b].radius = radii[b];
    make(setup);
  }

 private:
  struct Point {
    Vec3d at;   // [m] from the centre
    double up;  // [-] of the mirror image's distance over this one's
    std::uint32_t body;
  };
  void make(const SphSetup& setup) {
    points_.clear();
    const double s = setup.spacing;
    for (std::uint32_t b = 0; b < bodies.size(); ++b) {
      const double R = bodies[b].radius;
      require(R >= 1.5 * s, "Sph: a sphere of radius ", R, " m is too small for a spacing of ", s,
              " m; it must be at least 1.5 spacings: take a spacing of at most ", R / 1.5, " m");
      for (double r = R - 0.5 * s; r > 0.25 * s && r > R - 2 * setup.h(); r -= s)
        add_shell(b, r, (2 * R - r) / r, setup);
    }
  }
  void add_shell(std::uint32_t body, double r, double up, const SphSetup& setup) {
    const double s = setup.spacing, pi = std::numbers::pi;
    if (setup.dimensions == 2) {  // a cylinder's ring
      const int n = std::max(3, static_cast<int>(std::lround(2 * pi * r / s)));
      for (int k = 0; k < n; ++k) {
        const double angle = 2 * pi * (k + 0.5) / n;
        points_.push_back({{r * std::cos(angle), 0, r * std::sin(angle)}, up, body});
      }
      return;
    }
    // Along a spiral of golden angles each point has the same area.
    const int n = std::max(4, static_cast<int>(std::lround(4 * pi * r * r / (s * s))));
    const double golden = pi * (3 - std::sqrt(5.0));
    for (int k = 0; k < n; ++k) {
      const double z = 1 - (2 * k + 1.0) / n, across = std::sqrt(1 - z * z), angle = golden * k;
      points_.push_back(
          {{r * across * std::cos(angle), r * across * std::sin(angle), r * z}, up, body});
    }
  }

  std::vector<Point> points_;
};

}  // namespace silt::detail
