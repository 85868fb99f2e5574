// silt - BSD-3-Clause, see LICENSE
#pragma once

// The fluidised bed's scene: sizes and materials, grains settled on the floor between two walls,
// gas that enters through the floor. A program of one's own needs this file and drag.hpp:
//
//   fluidised::Scene s;
//   auto sim = fluidised::make_simulation(s, fluidised::settle<silt::Sphere>(s, threads));
//   sim.fluid().flow().set_side(2, 0, silt::Inflow{{0, 0, 1.0}});  // [m/s]
//   sim.run(1.0, silt::vtk_series("out", silt::every(0.01)));

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <silt/coupling/drag/oriented.hpp>
#include <silt/fluid.hpp>

#include "fluidised_bed/drag.hpp"

namespace fluidised {

using Law = silt::HertzMindlin;
using silt::Vec3d;

struct Scene {
  std::size_t particles = 5000;
  double diameter = 1e-3;     // [m] of the sphere of a grain's volume
  double density = 2500;      // [kg/m3]
  double cell = 1e-3;         // [m]
  double kernel = 1.5;        // [diameters] its reach
  int across = 16, deep = 4;  // [cells] of the slice
  int high = 150;             // [cells] of the box, above the floor
  double modulus = 1e6;       // [Pa] soft, for a long time step
  double bubbling = 1.5;      // [-] times the minimum fluidisation velocity
  double settling = 0.1;      // [s] after the last grain has fallen
  double relaxing = 0.03;     // [s] after a step of the gas's velocity,
  double averaging = 0.02;    // [s] and then means are taken,
  double moving = 0.25;       // [s] longer ones where the bed does not rest,
  double plateau = 1.0;       // [s] and where it is all borne: 0.07 m/s over 0.7 s are 1 %
  double blowing = 1.0;       // [s] the bubbling bed; its first quarter is not measured
  double step = 0.1;          // [m/s] of the gas's velocity; a quarter of it near fluidisation
  double most_off = 0.02;     // [-] of minimum fluidisation from the law's
  double by_layers = 0.01;    // [-] of what the law by layers misses
  double at_rest = 5e-3;      // [m/s] mean speed of the grains in a bed that is not fluidised
  std::string shape = "sphere", drag = "gidaspow";
  /// With hot gas: both start at `cold`. Glass grains with an 84th of the heat capacity of glass:
  /// the bed heats up within a second or two instead of minutes.
  double cold = 300, hot_gas = 400;               // [K]
  double grain_capacity = 10;                     // [J/(kg K)]
  double gas_capacity = 1005;                     // [J/(kg K)]
  double conductivity = 1, gas_conducts = 0.026;  // [W/(m K)]
  silt::FluidProperties gas{.density = 1.2, .viscosity = 1.8e-5};

  double width() const { return across * cell; }                        // [m]
  double depth() const { return deep * cell; }                          // [m]
  double area() const { return width() * depth(); }                     // [m2]
  double volume() const { return silt::Sphere::volume(diameter / 2); }  // [m3] of a grain
  /// Weight minus buoyancy of all grains, over the area [Pa]: the pressure drop that carries all of
  /// them.
  double weight() const {
    return static_cast<double>(particles) * volume() * (density - gas.density) * 9.81 / area();
  }
  double mass() const { return density * volume(); }  // [kg] of a grain
  template <class DragLaw>                            // [m/s] of minimum fluidisation
  double velocity_by(const DragLaw& law, double voidage) const {
    return silt::minimum_fluidisation_velocity(law, voidage, diameter, density, gas.density,
                                               gas.viscosity);
  }
  /// The drag law of spheres. Syamlal and O'Brien's law is calibrated to a bed of these grains at
  /// the void fraction 0.4 that follows Ergun's equation.
  BedDrag drag_law() const {
    if (drag == "own") return {BedDrag::Law::Own};
    if (drag != "syamlal") return {BedDrag::Law::Gidaspow};
    return {BedDrag::Law::Syamlal,
            silt::SyamlalOBrien::calibrated({.velocity = velocity_by(silt::Ergun{}, 0.4),
                                             .voidage = 0.4,
                                             .diameter = diameter,
                                             .particle_density = density,
                                             .fluid = gas})};
  }
  std::string name_of_law() const {
    return shape != "sphere"   ? "Drag law"
           : drag == "own"     ? "Own law"
           : drag == "syamlal" ? "Syamlal and O'Brien"
                               : "Ergun";
  }
  Law::Material material() const {
    return {.youngs_modulus = modulus, .poisson_ratio = 0.3, .restitution = 0.9, .friction = 0.3};
  }
  Law::Material settling_material() const {  // as tapping packs
    return {.youngs_modulus = modulus, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.05};
  }
};

/// Grains on a lattice above the floor.
template <class Shape>
silt::Particles<Shape> fill(const Scene& s) {
  silt::Particles<Shape> grains;
  double reach = s.diameter / 2;  // [m] bounding radius
  if constexpr (silt::BodyShape<Shape>) {
    grains.add_form(Shape{.a = 1.5, .b = 1, .c = 1});
    const auto& form = grains.forms()[0];
    reach = form.radius * s.diameter / 2 * std::cbrt(silt::Sphere::volume(1) / form.mass.volume);
  }
  silt::Random random(1);
  const double pitch = 2.002 * reach;
  const int nx = static_cast<int>(s.width() / pitch), ny = static_cast<int>(s.depth() / pitch);
  for (int n = 0; n < static_cast<int>(s.particles); ++n) {
    typename silt::Particles<Shape>::Particle p{};
    p.position = {(n % nx + 0.5) * s.width() / nx, (n / nx % ny + 0.5) * s.depth() / ny,
                  (n / (nx * ny) + 0.5) * pitch};
    p.radius = reach, p.density = s.density;
    p.velocity = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0};
    if constexpr (silt::BodyShape<Shape>) p.orientation = silt::random_orientation(random);
    grains.add(p);
  }
  return grains;
}

inline silt::PeriodicBox domain(const Scene& s) {
  return {{{0, 0, 0}, {s.width(), s.depth(), s.high * s.cell}}, {false, true, false}};
}
inline constexpr int floor_and_walls = 3;
template <class Sim>
void add_floor_and_walls(Sim& sim, const Scene& s, const Law::Material& material) {
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, material);
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, material);
  sim.add_wall(silt::Plane{{s.width(), 0, 0}, {-1, 0, 0}}, material);
}

/// A dense bed at rest.
template <class Shape>
silt::Particles<Shape> settle(const Scene& s, int threads) {
  auto grains = fill<Shape>(s);
  silt::Particles<Shape> settled;
  if constexpr (silt::BodyShape<Shape>) settled.add_form(grains.forms()[0].shape);
  silt::Simulation sim{std::move(grains), silt::Contacts<Law>{s.settling_material()}, domain(s)};
  add_floor_and_walls(sim, s, s.settling_material());
  sim.threads = threads;
  double top = 0;  // [m] from where the last grains fall
  for (std::size_t k = 0; k < sim.rows(); ++k) top = std::max(top, sim.position(k).z);
  sim.run(std::sqrt(2 * top / 9.81) + s.settling, silt::progress());
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    typename silt::Particles<Shape>::Particle p{};
    p.position = sim.position(k), p.radius = sim.radius(k), p.density = s.density;
    if constexpr (silt::BodyShape<Shape>) p.orientation = sim.orientation(k);
    settled.add(p);
  }
  return settled;
}

/// Spheres: the law of --drag; by default Ergun's equation in dense beds, Wen and Yu's in dilute
/// regions. Bodies: the law of Hoelzer and Sommerfeld by their projected areas, with Di Felice's
/// voidage function.
template <class Shape>
auto make_fluid(const Scene& s, silt::FlowSolver flow) {
  const silt::Kernel kernel{.width = s.kernel};
  if constexpr (silt::BodyShape<Shape>)
    return silt::CoupledFlow{silt::OrientedDrag<>{}, kernel, std::move(flow),
                             silt::InclinedLift<>{}};
  else
    return silt::CoupledFlow{s.drag_law(), kernel, std::move(flow)};
}

/// The settled grains in gas at rest.
template <class Shape>
auto make_simulation(const Scene& s, silt::Particles<Shape> grains) {
  silt::FlowSolver flow(
      silt::Grid(domain(s).box(), {s.across, s.deep, s.high}, {false, true, false}), s.gas);
  flow.set_side(2, 0, silt::Inflow{});
  flow.set_side(2, 1, silt::Outflow{});
  silt::Simulation sim{std::move(grains), silt::Contacts<Law>{s.material()}, domain(s),
                       make_fluid<Shape>(s, std::move(flow))};
  if (silt::BodyShape<Shape>) sim.fluid().least_voidage = 0.1;  // they lie denser than spheres
  add_floor_and_walls(sim, s, s.material());
  return sim;
}

/// The same, with heat: gas and grains begin at s.cold.
inline auto make_hot_bed(const Scene& s, silt::Particles<silt::Sphere> grains) {
  silt::FlowSolver flow(
      silt::Grid(domain(s).box(), {s.across, s.deep, s.high}, {false, true, false}), s.gas);
  flow.set_side(2, 0, silt::Inflow{});
  flow.set_side(2, 1, silt::Outflow{});
  flow.set_heat({.heat_capacity = s.gas_capacity,
                 .conductivity = s.gas_conducts,
                 .start_temperature = s.cold});
  silt::Simulation sim{
      std::move(grains), silt::Contacts<Law>{s.material()}, domain(s),
      silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{.width = s.kernel}, std::move(flow)},
      silt::Heat{silt::HeatConduction{.conductivity = s.conductivity,
                                      .heat_capacity = s.grain_capacity,
                                      .youngs_modulus = 63e9,  // [Pa] of glass
                                      .start_temperature = s.cold},
                 silt::FluidConvection<silt::Gunn>{}}};
  add_floor_and_walls(sim, s, s.material());
  return sim;
}

}  // namespace fluidised
