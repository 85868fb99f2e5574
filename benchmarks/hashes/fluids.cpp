// silt - BSD-3-Clause, see LICENSE
// Fluids: modes, orientation-dependent drag, forces, inflow.

#include <silt/fluid.hpp>

#include "scene_hash.hpp"

namespace {

const silt::HertzMindlin::Material glass{.youngs_modulus = 1e6, .poisson_ratio = 0.3};
constexpr double width = 0.012, height = 0.04;  // [m]

template <class Mode>
auto blown(const Mode& mode) {
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 0}, {width, width, 0.5 * height}},
              {.radius = silt::uniform(0.45e-3, 0.55e-3), .density = 1500, .count = 800});
  silt::FlowSolver air(silt::Grid({{0, 0, 0}, {width, width, height}}, {6, 6, 20}),
                       {.density = 1.2, .viscosity = 1.8e-5});
  air.set_side(2, 0, silt::Inflow{.velocity = {0, 0, 0.8}});
  air.set_side(2, 1, silt::Outflow{.pressure = 0});
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::CoupledFlow{silt::Gidaspow{}, mode, air}};
  sim.add_wall(silt::box({0, 0, 0}, {width, width, 2 * height}), glass);
  sim.gravity = {0, 0, -9.81};
  return sim;
}

auto rods() {
  silt::Particles<silt::SuperEllipsoid> all;
  const auto form = all.add_form(silt::SuperEllipsoid{.a = 3, .b = 1, .c = 1});
  all.fill({{0.002, 0.002, 0.002}, {0.028, 0.028, 0.028}},
           {.radius = 1.5e-3, .density = 300, .count = 60, .form = form});
  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {0.03, 0.03, 0.03}}, {6, 6, 6}),
                        {.density = 1.2, .viscosity = 1.8e-5});
  silt::Simulation sim{std::move(all), silt::Contacts<silt::HertzMindlin>{{1e6, 0.3, 0.8, 0.3}},
                       silt::CoupledFlow{silt::OrientedDrag{}, silt::Kernel{}, flow,
                                         silt::InclinedLift{}, silt::EllipsoidTorque{}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.03, 0.03, 0.03}),
               silt::HertzMindlin::Material{1e6, 0.3, 0.8, 0.3});
  return sim;
}

}  // namespace

void hashes::fluids() {
  print("gas, kernel", 0.02, [] { return blown(silt::Kernel{}); });
  print("gas, unresolved", 0.02, [] { return blown(silt::Unresolved{}); });
  print("rods in gas", 0.05, rods);
}
