// silt - BSD-3-Clause, see LICENSE
#pragma once

// The crater's scene: a pot with a bed that is settled once, and what changes as it goes on.
//
//   crater::Scene s;
//   auto sim = crater::make_simulation(s, true);  // the grains settle
//   crater::run_until_rest(s, sim);
//   silt::save_checkpoint(sim, "bed.silt");
//   const crater::Drop fall{.density = 7800, .height = 0.05, .level = 0.03};  // [kg/m3], [m], [m]
//   auto drop = crater::make_simulation(s, false, fall);
//   silt::load_checkpoint(drop, "bed.silt", {.materials = true, .walls = true});

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

template <class Sim>
double unrest(const Scene& s, const Sim& sim) {  // [-] mean energy over weight times diameter
  return sim.kinetic_energy() / (sim.total_mass() * g * s.grain);
}
/// Until the grains rest, but no longer than s.longest.
template <class Sim>
void run_until_rest(const Scene& s, Sim& sim) {
  const double start = sim.time();
  do sim.run(0.02, silt::progress());
  while (unrest(s, sim) > 5e-4 && sim.time() - start < s.longest);
}

}  // namespace crater
