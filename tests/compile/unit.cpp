// silt - BSD-3-Clause, see LICENSE
// Compiled twice into one program, with other instruction sets: SILT_UNIT and SILT_FAILS name the
// functions.
#include "unit.hpp"

#include <typeinfo>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/simulation.hpp>

namespace {

template <class Precision>
auto fallen() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};
  silt::Particles<silt::Sphere> beads;
  for (int k = 0; k < 27; ++k)
    beads.add(
        {.position = {2.1e-3 * (k % 3) + 1e-4 * (k / 9), 2.1e-3 * (k / 3 % 3), 2.1e-3 * (k / 9)},
         .radius = 1e-3,
         .density = 2500,
         .velocity = {0, 0, -0.2}});
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}, Precision{}};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.add_wall(silt::Plane{{0, 0, -1e-3}, {0, 0, 1}}, glass);
  sim.run(5e-3);
  return sim;
}

template <class Sim>
std::vector<double> positions(const Sim& sim) {
  std::vector<double> all;
  for (std::uint32_t id = 0; id < 27; ++id) {
    const auto p = sim.position(sim.find(id));
    all.insert(all.end(), {p.x, p.y, p.z});
  }
  return all;
}

}  // namespace

UnitResult SILT_UNIT() {
  const auto sim = fallen<silt::Double>();
  UnitResult result{silt::Lanes<silt::DefaultArch>::width, typeid(sim).name(), positions(sim), {}};
#ifdef SILT_LONG_TESTS
  result.mixed = positions(fallen<silt::Mixed>());
#endif
  return result;
}

void SILT_FAILS() {
  const silt::HertzMindlin::Material glass{.youngs_modulus = 1e7, .poisson_ratio = 0.25};
  silt::Particles<silt::Sphere> beads;
  beads.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500});
  beads.add({.position = {0, 0, 1e-3}, .radius = 1e-3, .density = 2500, .velocity = {0, 0, 1}});
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}};
  sim.run(1e-3);
}
