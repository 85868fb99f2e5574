// silt - BSD-3-Clause, see LICENSE
#pragma once

// The hopper of D. Markauskas, A. Kaceniauskas, A. Maknickas, Information Technology and Control 40
// (2011) 287, for one process (hopper.cpp) and for many (ranks.cpp).
//
//   hopper::Scene s;
//   auto sim = hopper::make_simulation(s);
//   sim.run(s.settling_time(), silt::progress());
//   sim.remove_wall(hopper::lid);
//   sim.run(2.0, silt::vtk_series("out", silt::every(0.02)), silt::progress());

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <silt/silt.hpp>

namespace hopper {

using Law = silt::HertzMindlin;

struct Scene {
  std::size_t particles = 100000;
  double density = 2500;                     // [kg/m3]
  double width = 0.1;                        // [m] of both boxes, square
  double orifice = 0.04;                     // [m] side of the square hole
  double r_min = 0.975e-3;                   // [m] diameters 1.95 to 2.35 mm
  double r_max = 1.175e-3;                   // [m]
  double gap = 0.3e-3;                       // [m] between the spheres as they start to fall
  double time_step = 2.5e-5;                 // [s]
  double moments[4] = {0.2, 0.5, 0.7, 1.2};  // [s] of the paper's snapshots, after opening
  bool flat = false;                         // floor: flat, or a 45 degree funnel
  bool sort = true;

  double bulk_height() const {  // [m] of all particles in one box, at a solid fraction of 0.6
    const double mean_cube = (r_max + r_min) * (r_max * r_max + r_min * r_min) / 4;
    return static_cast<double>(particles) * 4.0 / 3.0 * M_PI * mean_cube / (0.6 * width * width);
  }
  double orifice_height() const { return std::max(0.05, 1.25 * bulk_height()); }  // [m]
  double funnel_top() const { return orifice_height() + (flat ? 0 : (width - orifice) / 2); }
  double room() const { return 3 * bulk_height() + 0.02; }  // [m] the spheres start loose
  /// [s] before the orifice opens: the fall from the top of the room, and two thirds of that time
  /// for the grains to come to rest.
  double settling_time() const {
    return std::ceil(100 * 5.0 / 3.0 * std::sqrt(2 * room() / 9.81)) / 100;
  }
  Law::Material material() const {
    return {.youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.4};
  }
};

/// Floor of the upper box around the orifice: four trapezoids, flat or sloping at 45 degrees.
inline std::vector<std::array<silt::Vec3d, 3>> floor_triangles(const Scene& s) {
  const double a = (s.width - s.orifice) / 2, b = s.width - a, w = s.width;
  const double low = s.orifice_height(), high = s.funnel_top();
  const silt::Vec3d outer[4] = {{0, 0, high}, {w, 0, high}, {w, w, high}, {0, w, high}};
  const silt::Vec3d inner[4] = {{a, a, low}, {b, a, low}, {b, b, low}, {a, b, low}};
  std::vector<std::array<silt::Vec3d, 3>> triangles;
  for (int k = 0; k < 4; ++k) {
    const int n = (k + 1) % 4;
    triangles.push_back({outer[k], outer[n], inner[n]});
    triangles.push_back({outer[k], inner[n], inner[k]});
  }
  return triangles;
}

/// Both boxes for pictures: their side walls as triangles from the floor to above the filling.
inline std::vector<std::array<silt::Vec3d, 3>> box_triangles(const Scene& s) {
  const double w = s.width, top = s.funnel_top() + 1.6 * s.bulk_height();
  const silt::Vec3d corner[4] = {{0, 0, 0}, {w, 0, 0}, {w, w, 0}, {0, w, 0}};
  const silt::Vec3d up{0, 0, top};
  std::vector<std::array<silt::Vec3d, 3>> triangles;
  for (int k = 0; k < 4; ++k) {
    const auto p = corner[k], q = corner[(k + 1) % 4];
    triangles.push_back({p, q, q + up});
    triangles.push_back({p, q + up, p + up});
  }
  triangles.push_back({corner[0], corner[1], corner[2]});
  triangles.push_back({corner[0], corner[2], corner[3]});
  return triangles;
}

inline constexpr std::size_t lid = 6;  // number of the wall that closes the orifice

template <class... Policies>
auto make_simulation(const Scene& s, Policies... policies) {
  silt::Particles<silt::Sphere> grains;
  grains.fill({.min = {0, 0, s.funnel_top()}, .max = {s.width, s.width, s.funnel_top() + s.room()}},
              {.radius = silt::uniform(s.r_min, s.r_max),
               .density = s.density,
               .count = s.particles,
               .gap = s.gap});
  silt::Simulation sim{std::move(grains), silt::Contacts<Law>{s.material()},
                       silt::VerletList<>{.sort = s.sort}, std::move(policies)...};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = s.time_step;
  const double w = s.width;
  const auto wall = s.material();
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, wall);
  sim.add_wall(silt::Plane{{w, 0, 0}, {-1, 0, 0}}, wall);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 1, 0}}, wall);
  sim.add_wall(silt::Plane{{0, w, 0}, {0, -1, 0}}, wall);
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, wall);
  sim.add_wall(silt::TriangleMesh(floor_triangles(s)), wall);
  sim.add_wall(silt::Plane{{0, 0, s.orifice_height()}, {0, 0, 1}}, wall);
  sim.guard.max_overlap = 0.5;  // at 1e6 Pa an impact at 1 m/s alone makes 14 % of the radius
  sim.guard.domain = silt::Box{{0, 0, 0}, {w, w, s.funnel_top() + s.room()}};
  return sim;
}

/// Mass flow through a square orifice of side L [kg/s] by Beverloo's correlation, with C = 0.58 for
/// the circle converted by the hydraulic diameter, and k = 1.4:
///   W = (4/pi) C rho_bulk (L - k d)^2 sqrt(g (L - k d))
inline double beverloo(double L, double d, double bulk_density) {
  const double free = L - 1.4 * d;
  return 4 / M_PI * 0.58 * bulk_density * free * free * std::sqrt(9.81 * free);
}

}  // namespace hopper
