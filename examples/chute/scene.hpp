// silt - BSD-3-Clause, see LICENSE
#pragma once

// The chute's scene: a plate, a bend and an outflow of steel as one mesh, a batch of ore that is
// fed, and the laws by which it wears the steel.
//
//   chute::Scene s;
//   auto sim = chute::make_simulation(s);
//   sim.run(s.batch / s.rate + 1, silt::vtk_series("out", silt::every(0.05)));
//   silt::write_wear<chute::Sliding>("sliding.vtp", sim, "chute");

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <silt/silt.hpp>

namespace chute {

using silt::Vec3d;
using Law = silt::HertzMindlin;
using Sliding = silt::Wear<silt::Archard>;
using Cutting = silt::Wear<silt::Finnie>;
/// A user-defined law: the friction work on each facet, in J instead of m3.
struct FrictionWork {
  double volume(const silt::WallRub& c) const { return c.tangential_force * c.slip * c.duration; }
};
using Rubbing = silt::Wear<FrictionWork>;

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

inline auto make_simulation(const Scene& s) {
  const Law::Material ore{
      .youngs_modulus = 3e7, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.5};
  const Law::Material steel{
      .youngs_modulus = 6e7, .poisson_ratio = 0.3, .restitution = 0.3, .friction = s.friction};
  // Grains of ore are not round: rolling resistance above friction makes them slide.
  silt::Contacts<Law, silt::RollingEpsd, silt::SeveralMaterials> contacts{
      {ore, steel}, {.rolling_friction = 0.5}};
  contacts.set_pair(ore, steel, {.restitution = 0.3, .friction = s.friction});
  silt::Simulation sim{silt::Particles<silt::Sphere>{},
                       contacts,
                       silt::ContactEvents{},
                       Sliding{s.archard},
                       Cutting{s.finnie},
                       Rubbing{}};
  sim.gravity = {0, 0, -s.g};
  sim.add_wall(s.mesh(), steel, {.name = "chute"});
  const double end = s.at(s.length(), 0, 0).z;
  sim.add_outlet({{-2, -2, end - 0.5}, {4, 2, end - 0.15}});
  sim.add_inlet(s.inlet(), {.radius = silt::uniform(s.r_min, s.r_max),
                            .density = s.density,
                            .velocity = {0, 0, -s.feed},
                            .total = static_cast<std::uint64_t>(s.batch / s.mean_mass()),
                            .mass_rate = s.rate});
  return sim;
}

}  // namespace chute
