// silt - BSD-3-Clause, see LICENSE
#pragma once

// Scene of the crater: a bed that settles once, and the changes for each continuation; position of
// its surface; fits of the depth and force laws.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <silt/silt.hpp>

namespace crater {

using silt::Vec3d;
using Law = silt::HertzMindlin;
constexpr double g = 9.81;  // [m/s2]

struct Scene {
  double grain = 2e-3;                        // [m] mean diameter, of 0.8 to 1.2 of it
  double diameter = 8;                        // [grains] of the body
  double wide = 6, deep = 2.2;                // [bodies] diameter of the pot, depth of the bed
  std::vector<double> heights{0.5, 1.6, 5};   // [bodies] of free fall
  std::vector<double> densities{2700, 7800};  // [kg/m3] aluminium, steel
  std::size_t seed = 1;                       // of the bed: another one, another packing
  double friction = 0.5;                      // [-] between grains
  double tilt = 30;                           // [degrees] of gravity, for the angle of repose
  double longest = 0.5;                       // [s] of any run
  static constexpr double density = 2500, spread = 0.2;  // [kg/m3], [-]

  double body() const { return diameter * grain; }    // [m] diameter of the sphere
  double pot() const { return 0.5 * wide * body(); }  // [m] radius
  double bed() const { return deep * body(); }        // [m]
  double mean_volume() const {                        // [m3] of a grain
    return silt::Sphere::volume(grain / 2) * (1 + spread * spread);
  }
  std::size_t grains() const {
    const double solid = 0.585 * std::numbers::pi * pot() * pot() * bed();
    return static_cast<std::size_t>(solid / mean_volume());
  }
  /// While settling, grains lose nearly all energy at each impact; afterwards they have the
  /// properties of glass.
  Law::Material glass(bool settles) const {
    return {.youngs_modulus = 1e7,
            .poisson_ratio = 0.25,
            .restitution = settles ? 0.1 : 0.7,
            .friction = friction};
  }
  Law::Material metal() const {
    return {.youngs_modulus = 2e7, .poisson_ratio = 0.3, .restitution = 0.7, .friction = 0.3};
  }
  /// The body: a mesh of 320 facets, with the volume of a sphere of its diameter.
  silt::TriangleMesh mesh(const Vec3d& centre) const {
    const double r = body() / 2, ball = silt::Sphere::volume(r);
    return silt::sphere_mesh(centre, r * std::cbrt(ball / silt::sphere_mesh({}, r).volume()));
  }
};

/// The dropped ball, its height, and the level [m] onto which it falls.
struct Drop {
  double density, height, level;                              // [kg/m3], [m] of free fall, [m]
  double speed() const { return std::sqrt(2 * g * height); }  // [m/s] at the level
};

/// The pot with its bed; in a drop also the body, just above the bed with its impact speed, and
/// other grain properties than in settling, unless it `settles`.
inline auto make_simulation(const Scene& s, bool settles, const std::optional<Drop>& drop = {}) {
  silt::Contacts<Law, silt::SeveralMaterials> contacts{s.glass(settles)};
  if (drop) {
    contacts.add(s.metal(), "metal");
    contacts.set_pair(s.glass(settles), s.metal(), {.restitution = 0.7, .friction = 0.3});
  }
  silt::Particles<silt::Sphere> grains;
  if (settles)
    grains.fill(silt::CylinderRegion{{0, 0, 0}, {0, 0, 2.5 * s.bed()}, s.pot()},
                {.radius = silt::uniform(0.5 * (1 - Scene::spread) * s.grain,
                                         0.5 * (1 + Scene::spread) * s.grain),
                 .density = Scene::density,
                 .count = s.grains(),
                 .seed = s.seed});
  silt::Simulation sim{std::move(grains), contacts, silt::EnergyLedger{}};
  sim.gravity = {0, 0, -g};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, s.glass(settles), {.name = "floor"});
  sim.add_wall(
      silt::Cylinder{{0, 0, -s.body()}, {0, 0, 30 * s.body()}, s.pot(), silt::Side::Inside},
      s.glass(settles), {.name = "pot"});
  if (drop) {
    const double above = std::min(1.5 * s.grain, 0.5 * drop->height);  // [m]
    const auto mesh = s.mesh({0, 0, drop->level + above + s.body() / 2});
    silt::FreeBody body = silt::free_body(mesh, drop->density);
    body.velocity = {0, 0, -std::sqrt(2 * g * (drop->height - above))};
    sim.add_wall(mesh, s.metal(), {.name = "body", .drive = body});
  }
  return sim;
}

/// Depth [balls] at which a ball comes to rest that is `over` times as dense as the bed and has
/// fallen by `fall` [balls], its depth included: 0.14/mu over^(1/2) fall^(1/3), mu the tangent of
/// the angle of repose. J. S. Uehara, M. A. Ambroso, R. P. Ojha, D. J. Durian, Phys. Rev. Lett. 90
/// (2003) 194301; the exponents as in their abstract, the factor recalled.
inline double law_depth(double mu, double over, double fall) {
  return 0.14 / mu * std::sqrt(over) * std::cbrt(fall);
}

/// Height of the bed's surface: the solid volume above a height, packed as below it.
class Surface {
 public:
  template <class Sim>
  Surface(const Scene& s, const Sim& sim) : scene_(s) {
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) grains_.push_back({sim.position(k), sim.radius(k)});
    const double radius = 0.8 * s.pot(), area = std::numbers::pi * radius * radius;  // [m], [m2]
    const auto inside = [&](const Vec3d& p) { return std::hypot(p.x, p.y) < radius; };
    const double low = 0.2 * s.bed(), high = 0.7 * s.bed();
    const double over = solid_over(low, inside);
    fraction_ = (over - solid_over(high, inside)) / (area * (high - low));
    level_ = low + over / (fraction_ * area);
  }
  double level() const { return level_; }        // [m]
  double fraction() const { return fraction_; }  // [-] of solid
  /// Slope [degrees] towards +x of the middle of the surface, from strips across x.
  double slope() const {
    const double width = 2 * scene_.grain, half = 0.3 * scene_.pot(), low = 0.2 * scene_.bed();
    double n = 0, x = 0, z = 0, xx = 0, xz = 0;
    for (double at = -0.7 * scene_.pot(); at < 0.7 * scene_.pot(); at += width) {
      const double over = solid_over(low, [&](const Vec3d& p) {
        return std::abs(p.y) < half && p.x >= at && p.x < at + width;
      });
      const double middle = at + width / 2, height = over / (fraction_ * 2 * half * width);
      n += 1, x += middle, z += height, xx += middle * middle, xz += middle * height;
    }
    return std::atan((n * xz - x * z) / (n * xx - x * x)) * 180 / std::numbers::pi;
  }

 private:
  struct Grain {
    Vec3d at;
    double radius;
  };
  /// [m3] above a height, of grains whose centres are inside.
  template <class Inside>
  double solid_over(double height, const Inside& inside) const {
    double sum = 0;
    for (const Grain& p : grains_) {
      const double t = std::clamp(0.5 + 0.5 * (p.at.z - height) / p.radius, 0.0, 1.0);
      if (t > 0 && inside(p.at)) sum += silt::Sphere::volume(p.radius) * t * t * (3 - 2 * t);
    }
    return sum;
  }

  const Scene& scene_;
  std::vector<Grain> grains_;
  double level_ = 0, fraction_ = 0;
};

}  // namespace crater
