// silt - BSD-3-Clause, see LICENSE
#pragma once

// The pellets' scene: cylinders of bonded spheres in a drum with a bar, which is periodic along its
// axis.
//
//   pellet::Scene s;
//   pellet::settle(s, "settled.silt", threads);
//   auto sim = pellet::make_simulation(s);
//   silt::load_checkpoint(sim, "settled.silt", {.materials = true});  // bonds get their strength
//   pellet::begin_to_turn(sim, s);
//   sim.run(s.turns * s.turn(), silt::vtk_series("out", silt::every(0.1)));

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <silt/silt.hpp>

namespace pellet {

using Law = silt::HertzMindlin;
using silt::Vec3d;

struct Scene {
  std::size_t pellets = 24;
  double radius = 3e-3, length = 12e-3;  // [m] of a pellet, a cylinder
  double sphere = 0.75e-3;               // [m]
  double density = 1200;                 // [kg/m3] of the spheres
  double strength = 30;                  // [kPa] of bonds, in pull and shear, mean; 0: unbreakable
  double scatter = 4;                    // [-] Weibull modulus
  double drum = 0.03, width = 0.03;      // [m] radius, and length of a period along the axis
  double rpm = 50;
  double turns = 2;
  double sieve = 0.05;  // [-] of a pellet's mass: pieces below it are fines

  double turn() const { return 60 / rpm; }                     // [s]
  double rate() const { return rpm * std::numbers::pi / 30; }  // [rad/s]
  Law::Material material() const {
    return {.youngs_modulus = 4e6, .poisson_ratio = 0.3, .restitution = 0.4, .friction = 0.5};
  }
  silt::ParallelBond bonds() const {
    const double most = strength > 0 ? 1e3 * strength : std::numeric_limits<double>::infinity();
    return {.youngs_modulus = 4e6,
            .tensile_strength = most,
            .shear_strength = most,
            .damping = 0.2,
            .weibull_modulus = scatter};
  }
};

/// Mass of the piece that contains a sphere, over that of a pellet [-].
using Piece = silt::Field<"piece over pellet [-]">;

inline auto make_simulation(const Scene& s) {
  const silt::Box period{{-s.drum, 0, -s.drum}, {s.drum, s.width, s.drum}};
  silt::Simulation sim{silt::Particles<silt::Sphere>{},
                       silt::Contacts<Law>{s.material()},
                       silt::PeriodicBox{period, {false, true, false}},
                       silt::Bonds{s.bonds()},
                       silt::EnergyLedger{},
                       Piece{}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cylinder{{0, -s.width, 0}, {0, 2 * s.width, 0}, s.drum, silt::Side::Inside},
               s.material(), {.name = "drum"});
  // Too thick for a sphere to get around: 20 % of the drum's radius. It goes down first.
  sim.add_wall(silt::box_mesh({0.8 * s.drum, 0, -1.5e-3}, {1.01 * s.drum, s.width, 1.5e-3}),
               s.material(), {.name = "bar"});
  return sim;
}

/// Whether no sphere is within `room` [m] of x, including periodic images.
template <class Sim>
bool is_free(const Sim& sim, const Scene& s, const Vec3d& x, double room) {
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    Vec3d d = sim.position(k) - x;
    d.y -= s.width * std::round(d.y / s.width);
    if (norm(d) < room + s.sphere) return false;
  }
  return true;
}

/// As many pellets as fit without touching, in random orientations. Returns their number.
template <class Sim>
std::size_t add_pellets(Sim& sim, const Scene& s, silt::Random& random, std::size_t placed) {
  // Spheres at an end that are too far from the others for a bond are left out.
  const auto pellet = silt::largest_piece(silt::agglomerate(
      silt::CylinderRegion{{0, 0, -0.5 * s.length}, {0, 0, 0.5 * s.length}, s.radius},
      {.radius = s.sphere}, 0.3 * s.sphere, {.density = s.density}));
  const double room = std::hypot(s.length, 2 * s.radius) * 1.02;  // [m] from centre to centre
  const double reach = s.drum - 0.5 * room;
  for (double z = -reach; z <= reach; z += room)
    for (double x = -reach; x <= reach; x += room)
      for (double y = 0.5 * room; y + 0.5 * room <= s.width; y += room) {
        if (placed == s.pellets || std::hypot(x, z) > reach) continue;
        if (x > 0.8 * s.drum - 0.5 * room && std::abs(z) < 0.5 * room + 1.5e-3)
          continue;  // the bar
        if (!is_free(sim, s, {x, y, z}, 0.5 * room)) continue;
        const Vec3d axis{random.normal(), random.normal(), random.normal()};
        const auto turn =
            silt::rotation_about((1 / norm(axis)) * axis, random.uniform(0, std::numbers::pi));
        silt::add_bonded(sim, silt::placed(pellet, {x, y, z}, turn));
        ++placed;
      }
  return placed;
}

/// Saves the pellets at rest in the drum at rest: they fall in batches, and nothing breaks.
inline void settle(Scene s, const std::string& checkpoint, int threads) {
  s.strength = 0;
  auto sim = make_simulation(s);
  sim.threads = threads;
  silt::Random random(7);
  for (std::size_t placed = 0; placed < s.pellets;) {
    const std::size_t before = std::exchange(placed, add_pellets(sim, s, random, placed));
    silt::require(placed > before, "only ", placed, " of ", s.pellets,
                  " pellets have room in the drum; give --pellets at most that");
    sim.run(0.15);
  }
  sim.run(0.25);
  silt::save_checkpoint(sim, checkpoint);
}

template <class Sim>
void begin_to_turn(Sim& sim, const Scene& s) {
  const silt::Rotation turning{.centre = {0, 0, 0}, .axis = {0, 1, 0}, .rate = s.rate()};
  for (const char* wall : {"drum", "bar"}) sim.set_motion(wall, silt::from(sim.time(), turning));
}

}  // namespace pellet
