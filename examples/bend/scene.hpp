// silt - BSD-3-Clause, see LICENSE
#pragma once

// The bend's scene: a pipe of 50 mm as a mesh, which is the wall of particles and gas, the air in
// it, and spheres that come in with it. It starts along x, bends about z and continues along y.
//
//   bend::Scene s;
//   auto sim = bend::make_simulation(s, silt::MomentumModel::A);
//   sim.run(s.duration, silt::vtk_series("out", silt::every(0.01)));

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <silt/fluid.hpp>

namespace bend {

using silt::Vec3d;
constexpr double pi = std::numbers::pi;

struct Scene {
  std::string kind = "hv", closure = "mixing-length";
  std::size_t cells = 8;  // [-] a diameter
  double inlet = 0.2;     // [m] of pipe before the bend
  double outlet = 0.55;   // [m] behind it
  double duration = 0.6;  // [s]
  bool full = false;      // as published: 0.5 m, 1 m, 3 s, 12 cells

  static constexpr double D = 0.05, bend = 0.05;               // [m] pipe, centre line of its bend
  static constexpr double density = 1123, particle_speed = 7;  // [kg/m3], [m/s]
  static constexpr silt::FluidProperties air{1.225, 1.8e-5};

  double radius() const { return kind == "hv" ? 1.4e-3 : 1.5e-3; }                  // [m]
  double flux() const { return kind == "hv" ? 31.1 : kind == "vh" ? 40.8 : 35.7; }  // [kg/m2s]
  double gas() const { return kind == "hv" ? 11.9 : 16; }                           // [m/s]
  Vec3d gravity() const {
    const double g = 9.81;
    return kind == "hv" ? Vec3d{0, -g, 0} : kind == "vh" ? Vec3d{-g, 0, 0} : Vec3d{0, 0, -g};
  }
  double area() const { return pi / 4 * D * D; }
  double rate() const { return flux() * area() / (density * silt::Sphere::volume(radius())); }
  double cell() const { return D / static_cast<double>(cells); }
  double from() const { return 0.4 * duration; }  // [s] when it is measured
  silt::HertzMindlin::Material material() const {
    const double shear_modulus = 1e7, poisson = 0.3;
    return {.youngs_modulus = 2 * (1 + poisson) * shear_modulus,
            .poisson_ratio = poisson,
            .restitution = 0.4,
            .friction = 0.3};
  }
};

/// The pipe from three cells before the flow's box to three behind it, normals outwards.
inline silt::TriangleMesh pipe(const Scene& s) {
  struct Ring {
    Vec3d middle, across;  // [m], [-] towards the outer side
  };
  std::vector<Ring> rings;
  const double more = 4 * s.cell();
  const auto add = [&](const Vec3d& middle, double angle) {
    rings.push_back({middle, {std::sin(angle), -std::cos(angle), 0}});
  };
  const int pieces = 24, sides = 48, legs = 8;
  for (int k = 0; k < legs; ++k) add({-(s.inlet + more) * (legs - k) / legs, 0, 0}, 0);
  for (int k = 0; k <= pieces; ++k) {
    const double angle = 0.5 * pi * k / pieces;
    add({s.bend * std::sin(angle), s.bend * (1 - std::cos(angle)), 0}, angle);
  }
  for (int k = 1; k <= legs; ++k) add({s.bend, s.bend + (s.outlet + more) * k / legs, 0}, pi / 2);
  // A polygon with the circle's area.
  const double step = 2 * pi / sides, R = s.D / 2 * std::sqrt(step / std::sin(step));
  std::vector<std::array<Vec3d, 3>> soup;
  const auto corner = [&](const Ring& ring, int k) {
    const double angle = step * (k % sides);
    return ring.middle + R * std::cos(angle) * ring.across + Vec3d{0, 0, R * std::sin(angle)};
  };
  for (std::size_t r = 0; r + 1 < rings.size(); ++r)
    for (int k = 0; k < sides; ++k) {
      const Vec3d a = corner(rings[r], k), b = corner(rings[r], k + 1), c = corner(rings[r + 1], k),
                  d = corner(rings[r + 1], k + 1);
      soup.push_back({a, c, b}), soup.push_back({b, c, d});
    }
  return silt::TriangleMesh(soup);
}

/// Turbulent air flow through the pipe, with a fully developed profile at the inlet.
inline silt::FlowSolver air(const Scene& s, const silt::TriangleMesh& wall,
                            silt::MomentumModel model) {
  const double h = s.cell(), side = s.D / 2 + h;
  const auto cells = [&](double length) { return static_cast<int>(std::ceil(length / h - 1e-9)); };
  const int nx = cells(s.inlet + s.bend + side), ny = cells(side + s.bend + s.outlet),
            nz = cells(2 * side);
  // Whole cells: the pipe's centre in the middle of the box in z; the remainder goes to the far
  // sides.
  const Vec3d low{-s.inlet, -side, -0.5 * nz * h};
  const double end = s.bend + s.outlet;
  silt::FlowSolver flow(
      silt::Grid({{low.x, end - ny * h, low.z}, {low.x + nx * h, end, low.z + nz * h}},
                 {nx, ny, nz}),
      s.air, {.model = model, .tolerance = 1e-5});
  flow.set_boundary(silt::boundary_of(wall));
  if (s.closure == "k-epsilon")
    flow.set_turbulence(silt::KEpsilon{.width = s.D});
  else
    flow.set_turbulence(silt::MixingLength{.half_width = s.D / 2});
  flow.set_side(1, 1, silt::Outflow{});
  // The open cell faces cover slightly more or less than the pipe: the inflow is scaled to the
  // exact rate.
  double share = 1;
  for (int k = 0; k < 2; ++k) {
    const auto seventh = [s, share](const Vec3d& x) {
      const double y = 1 - std::min(1.0, std::hypot(x.y, x.z) / (s.D / 2));
      return Vec3d{share * s.gas() * 60 / 49 * std::pow(y, 1.0 / 7), 0, 0};
    };
    flow.set_side(0, 0, silt::Inflow{.profile = seventh});
    flow.start();
    share *= s.gas() * s.area() / flow.flow_rate(0, 0);
  }
  return flow;
}

/// Air and particles in the pipe, which is empty at the start.
inline auto make_simulation(const Scene& s, silt::MomentumModel model) {
  const auto wall = pipe(s);
  silt::CoupledFlow gas{silt::FreeStream{}, silt::Kernel{}, air(s, wall, model)};
  gas.diameter = 2 * s.radius();
  silt::Simulation sim{silt::Particles<silt::Sphere>{},
                       silt::Contacts<silt::HertzMindlin, silt::RollingDirectional>{
                           s.material(), {.rolling_friction = 0.005}},
                       gas};
  sim.add_wall(wall, s.material());
  sim.gravity = s.gravity();
  sim.time_step = 5e-6;
  // They enter without touching the wall.
  const double first = -s.inlet + s.radius(), room = 0.95 * s.D / 2;
  sim.add_inlet(silt::CylinderRegion{{first, 0, 0}, {first + 0.03, 0, 0}, room},
                {.radius = silt::uniform(s.radius(), s.radius()),
                 .density = s.density,
                 .rate = s.rate(),
                 .velocity = {s.particle_speed, 0, 0}});
  const double end = s.bend + s.outlet, far = 1;
  sim.add_outlet({{-far, end, -far}, {far, end + far, far}});
  return sim;
}

}  // namespace bend
