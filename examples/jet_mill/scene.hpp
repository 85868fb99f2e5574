// silt - BSD-3-Clause, see LICENSE
#pragma once

// The jet mill's scene: a flat round chamber with four jets, a tube in the centre of its roof as
// the outlet, and breaking grains of a synthetic material. `./run study comminution` uses it too.
//
//   jet_mill::Scene s;
//   auto sim = jet_mill::make_simulation(s);
//   sim.run(s.duration, silt::breakage_table("breakage.csv", silt::every(1e-3)));

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <silt/coupling/drag/di_felice.hpp>
#include <silt/fluid.hpp>

namespace jet_mill {

using silt::Vec3d;
using Law = silt::Softened<silt::HertzMindlin>;

/// Lengths of the chamber are whole numbers of fluid cells. Strengths are synthetic.
struct Scene {
  double cell = 1e-3;                         // [m] of the flow
  double radius = 12e-3, height = 4e-3;       // [m] of the chamber
  double outlet = 4e-3, tube = 5e-3;          // [m] radius of the tube, its length above the roof
  double post = 2e-3;                         // [m] radius of a post in the middle of both
  double nozzle = 1e-3;                       // [m] half the width of the slots of the jets
  double offset = 7e-3;                       // [m] of their lines from the axis
  double jets = 100;                          // [m/s] of the gas in the slots
  double feed = 0.3e-3;                       // [m] diameter of the feed, +- 10 %
  double rate = 5e-4;                         // [kg/s] of it
  double strength = 0.4;                      // [N] median of grains of this size
  double exponent = 1.2;                      // [-] strength goes with this power of the diameter
  double dust = 40e-6;                        // [m] fragments below it are dust
  double full_radius = 60e-6;                 // [m] smaller grains are softened; 0: none
  double restitution = 0.7, duration = 0.02;  // [-], [s]
  std::size_t most_fragments = 100, seed = 1;

  static constexpr double density = 2165;  // [kg/m3]
  static constexpr silt::FluidProperties air{.density = 1.2, .viscosity = 1.8e-5};

  double gas_rate() const { return 16 * nozzle * nozzle * jets; }  // [m3/s]
  template <class L = Law>
  typename L::Material salt() const {
    return {.solid = {.youngs_modulus = 20e9,
                      .poisson_ratio = 0.25,
                      .restitution = restitution,
                      .friction = 0.4},
            .full_radius = full_radius};
  }
  template <class L = Law>
  typename L::Material steel() const {
    return {.solid = {.youngs_modulus = 210e9,
                      .poisson_ratio = 0.3,
                      .restitution = restitution,
                      .friction = 0.4}};
  }
};

/// The gas volume: chamber, tube and nozzles, in the flow's box [m].
inline double room(const Scene& s, const Vec3d& x) {
  const double r = std::hypot(x.x, x.y);
  double inside = std::min({s.radius - r, x.z, s.height - x.z});
  inside = std::max(inside, std::min(s.outlet - r, x.z - 0.5 * s.height));
  const auto nozzle = [&](double along, double across) {  // comes along +, on the line across = 0
    inside = std::max(
        inside,
        std::min(s.nozzle - std::max(std::abs(across), std::abs(x.z - 0.5 * s.height)), -along));
  };
  nozzle(x.x, x.y + s.offset), nozzle(-x.x, x.y - s.offset);
  nozzle(x.y, x.x - s.offset), nozzle(-x.y, x.x + s.offset);
  return std::min(inside, r - s.post);
}

/// Incompressible and turbulent.
inline silt::FlowSolver air(const Scene& s) {
  const double h = s.cell, half = s.radius + 2 * h;
  const auto cells = [h](double length) { return static_cast<int>(std::lround(length / h)); };
  silt::FlowSolver flow(silt::Grid({{-half, -half, 0}, {half, half, s.height + s.tube}},
                                   {cells(2 * half), cells(2 * half), cells(s.height + s.tube)}),
                        s.air);
  flow.set_boundary({.distance = [s](const Vec3d& x) { return room(s, x); }});
  flow.set_turbulence(silt::KEpsilon{.width = 2 * s.nozzle, .intensity = 0.05});
  for (int side = 0; side < 4; ++side) {
    const int d = side / 2, end = side % 2;
    Vec3d v{0, 0, 0};
    (d == 0 ? v.x : v.y) = (end == 0 ? 1 : -1) * s.jets;
    // Seen from the centre, each jet enters at the right of its side.
    const double at = (d == 0 ? -1 : 1) * (end == 0 ? 1 : -1) * s.offset;
    const auto outline = [s, d, at](const Vec3d& x) {
      return s.nozzle -
             std::max(std::abs((d == 0 ? x.y : x.x) - at), std::abs(x.z - 0.5 * s.height));
    };
    flow.set_side(d, end, silt::Inflow{.velocity = v, .outline = outline});
  }
  flow.set_side(2, 1, silt::Outflow{});
  return flow;
}

/// The roof: a ring.
inline silt::TriangleMesh roof(const Scene& s) {
  std::vector<std::array<Vec3d, 3>> all;
  const int parts = 96;
  const auto at = [&](double r, int k) {
    const double angle = 2 * std::numbers::pi * (k % parts) / parts;
    return Vec3d{r * std::cos(angle), r * std::sin(angle), s.height};
  };
  for (int k = 0; k < parts; ++k) {
    const Vec3d a = at(s.outlet, k), b = at(s.outlet, k + 1), c = at(1.02 * s.radius, k),
                d = at(1.02 * s.radius, k + 1);
    all.push_back({a, c, d}), all.push_back({a, d, b});
  }
  return silt::TriangleMesh(all);
}

/// Walls, feed and outlet.
template <class L = Law, class Sim>
void furnish(Sim& sim, const Scene& s) {
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, s.steel<L>(), {.name = "floor"});
  sim.add_wall(
      silt::Cylinder{{0, 0, -s.height}, {0, 0, 2 * s.height}, s.radius, silt::Side::Inside},
      s.steel<L>(), {.name = "ring"});
  sim.add_wall(silt::Surfaces({roof(s)}), s.steel<L>(), {.name = "roof"});
  sim.add_wall(
      silt::Cylinder{{0, 0, s.height}, {0, 0, s.height + 2 * s.tube}, s.outlet, silt::Side::Inside},
      s.steel<L>(), {.name = "tube"});
  sim.add_wall(
      silt::Cylinder{{0, 0, -s.height}, {0, 0, s.height + 2 * s.tube}, s.post, silt::Side::Outside},
      s.steel<L>(), {.name = "post"});
  const double far = 1;
  sim.add_outlet({{-far, -far, s.height + 0.5 * s.tube}, {far, far, far}});
  const double r = 0.75 * s.radius, c = std::numbers::sqrt2 / 2;
  sim.add_inlet(
      silt::CylinderRegion{
          {r * c, r * c, 0.2 * s.height}, {r * c, r * c, 0.8 * s.height}, 0.1 * s.radius},
      {.radius = silt::uniform(0.45 * s.feed, 0.55 * s.feed),
       .density = s.density,
       .velocity = {-5 * c, 5 * c, 0},
       .seed = s.seed,
       .mass_rate = s.rate});
}

template <class L = Law>
auto contacts(const Scene& s) {
  silt::Contacts<L, silt::SeveralMaterials> both{{s.salt<L>(), s.steel<L>()}};
  both.name_material(0, "salt"), both.name_material(1, "steel");
  both.set_pair(s.salt<L>(), s.steel<L>(), {.restitution = s.restitution, .friction = 0.4});
  return both;
}

inline auto breakage(const Scene& s) {
  return silt::Breakage{
      silt::LogLogisticStrength{
          .median = s.strength, .at_diameter = 0.3e-3, .exponent = s.exponent, .spread = 3},
      silt::HertzEquivalence{},
      silt::GaudinSchuhmann{.exponent = 0.8, .coarsest = 0.8, .refining = 0.3},
      silt::PowerFatigue{.kappa = 0.1, .psi = 3},
      {.dust_below = s.dust, .most_fragments = s.most_fragments, .seed = s.seed}};
}

/// The chamber in its gas, empty at the start.
inline auto make_simulation(const Scene& s) {
  silt::CoupledFlow gas{silt::DiFelice{}, silt::Kernel{}, air(s)};
  gas.diameter = s.feed, gas.most_steps = 200;
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, contacts(s), std::move(gas), breakage(s)};
  furnish(sim, s);
  // Large grains press fragments deeper into walls than impacts of equal grains do.
  sim.guard.max_overlap = 0.89, sim.guard.max_travel = 0.1;
  return sim;
}

}  // namespace jet_mill
