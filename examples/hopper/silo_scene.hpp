// silt - BSD-3-Clause, see LICENSE
#pragma once

// The silo's scene: a round silo over a cone, filled with grains over a lid.
//
//   silo::Scene s;
//   auto sim = silo::make_simulation(s);
//   sim.run(s.settling());
//   sim.remove_wall("lid");
//   sim.run(s.emptying, silt::vtk_series("out", silt::every(0.01)));

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <silt/silt.hpp>

namespace silo {

using silt::Vec3d;
using Law = silt::HertzMindlin;
constexpr double g = 9.81;  // [m/s2]

struct Scene {
  double wide = 16, outlet = 9;  // [grains] diameters of silo and outlet
  double high = 4;               // [silo's diameters] of the bed over the cone, about
  double emptying = 0.3;         // [s] of which the last two thirds are measured
  double wall_friction = 0.3;    // [-]
  static constexpr double grain = 2e-3, density = 2500;  // [m], [kg/m3]
  static constexpr double slope = 60;                    // [degrees] of the cone
  static constexpr int per_diameter = 4;                 // rings

  double diameter() const { return wide * grain; }                                // [m]
  double area() const { return std::numbers::pi / 4 * std::pow(diameter(), 2); }  // [m2]
  double cone() const {                                                           // [m] its height
    return 0.5 * (wide - outlet) * grain * std::tan(slope * std::numbers::pi / 180);
  }
  /// Rows of facets.
  std::size_t rows() const { return static_cast<std::size_t>(cone() / (1.5 * grain)); }
  double bed() const { return high * diameter(); }  // [m] over the cone
  std::size_t rings() const { return static_cast<std::size_t>(std::ceil(3 * high * per_diameter)); }
  double ring() const { return diameter() / per_diameter; }                      // [m] height
  double top() const { return cone() + static_cast<double>(rings()) * ring(); }  // [m] of the wall
  std::size_t grains() const {
    const double o = outlet / wide, in_cone = area() * cone() * (1 + o + o * o) / 3;
    return static_cast<std::size_t>(0.6 * (area() * bed() + in_cone) /
                                    silt::Sphere::volume(grain / 2));
  }
  double settling() const {  // [s]
    return 0.1 + 1.6 * std::sqrt(2 * (top() - cone() - bed()) / g);
  }
  /// Soft, for a long time step: at a few hundred Pa overlaps are 0.5 % of the diameter.
  Law::Material material(double mu) const {
    return {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = mu};
  }
  /// The cone in rows of facets.
  std::vector<std::array<Vec3d, 3>> facets() const {
    constexpr int around = 36;
    const auto at = [&](std::size_t row, int k) {
      const double up = static_cast<double>(row) / static_cast<double>(rows()),
                   turn = 2 * std::numbers::pi * k / around;
      const double r = 0.5 * grain * std::lerp(outlet, wide, up);
      return Vec3d{r * std::cos(turn), r * std::sin(turn), up * cone()};
    };
    std::vector<std::array<Vec3d, 3>> all;
    for (std::size_t i = 0; i < rows(); ++i)
      for (int k = 0; k < around; ++k) {
        all.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
        all.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
      }
    return all;
  }
};

inline auto make_simulation(const Scene& s) {
  silt::Particles<silt::Sphere> grains;
  grains.fill(silt::CylinderRegion{{0, 0, s.cone()}, {0, 0, s.top()}, s.diameter() / 2},
              {.radius = silt::uniform(0.9 * s.grain / 2, 1.1 * s.grain / 2),
               .density = s.density,
               .count = s.grains()});
  const auto wall = s.material(s.wall_friction);
  silt::Contacts<Law, silt::SeveralMaterials> contacts{{s.material(0.5), wall}};
  contacts.set_pair(s.material(0.5), wall, {.restitution = 0.3, .friction = s.wall_friction});
  silt::Simulation sim{std::move(grains), contacts};
  sim.gravity = {0, 0, -g};
  sim.add_wall(
      silt::Cylinder{{0, 0, s.cone()}, {0, 0, s.top()}, s.diameter() / 2, silt::Side::Inside}, wall,
      {.name = "mantle"});
  sim.add_wall(silt::TriangleMesh(s.facets()), wall, {.name = "cone"});
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, wall, {.name = "lid"});
  const double d = s.diameter();
  sim.add_outlet({{-d, -d, -0.2}, {d, d, -0.01}});
  return sim;
}

}  // namespace silo
