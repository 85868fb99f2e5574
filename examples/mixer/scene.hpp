// silt - BSD-3-Clause, see LICENSE
#pragma once

// The mixer's scene: a vessel, two blades that are driven from below and can be raised, and grains
// of two colours.
//
//   mixer::Scene s;
//   mixer::charge(s, threads, "charged.silt");
//   auto sim = mixer::make_mixer(s, threads);
//   sim.remove_wall("chute");
//   silt::load_checkpoint(sim, "charged.silt", {.motions = true});
//   sim.set_motion("blade", mixer::turning(sim.time(), s.rate()));
//   sim.run(s.turn(), silt::wall_series("blade.csv", "blade", silt::every(0.01)));

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <silt/silt.hpp>

namespace mixer {

using silt::Vec3d;
using Law = silt::HertzMindlin;

struct Scene {
  std::size_t grains = 5000;
  double grain = 3e-3;         // [m] mean radius; sizes from 0.8 to 1.2 of it
  double radius = 80e-3;       // [m] of the vessel
  double rpm = 60;             // [1/min] of the blade that has a fixed speed
  double turns = 5;            // of each run, before the blades are raised
  double pitched = 1.5;        // turns after that
  double pitch = 45;           // [degrees] slant of the blades, which are raised to 90
  double friction = 0.4;       // [-] between grains
  double wall_friction = 0.3;  // [-] on vessel and blades
  double share = 1;            // [-] of the servo's torque, of the mean torque at the fixed speed
  double gain = 1;             // [-] of the servo: the quickest, for a bed that flows
  static constexpr double density = 1500, g = 9.81;  // [kg/m3] of the grains, [m/s2]
  // Soft: real granules are 1000 times stiffer, with time steps a sixteenth as long. The bed flows
  // like one of stiff grains if overlaps stay below 1 % of a diameter; this is checked.
  static constexpr double modulus = 2e6;  // [Pa]

  double rate() const { return rpm * std::numbers::pi / 30; }  // [rad/s]
  double turn() const { return 60 / rpm; }                     // [s]
  double inner() const { return 0.15 * radius; }               // [m] from the axis to the blades
  double chord() const { return 0.4 * radius; }                // [m] of a blade
  /// [m] between blade and floor, and wall. Less than a grain's radius: an edge above the centre of
  /// a grain would press it down, and crush it if the bed ahead holds it.
  double gap() const { return 0.3 * grain; }
  double height() const { return 2.2 * radius; }  // [m] of the vessel
  double sample() const { return 6 * grain; }     // [m] side of a sample
  double filling() const { return 0.4; }          // [s] until the grains have fallen
  double slant() const { return pitch * std::numbers::pi / 180; }  // [rad]
  /// [rad] after a fraction of the time in which the blades are raised; from rest to rest.
  double slant_after(double done) const {
    return slant() +
           (0.5 * std::numbers::pi - slant()) * 0.5 * (1 - std::cos(std::numbers::pi * done));
  }
  double chute() const { return 0.6 * radius; }  // [m] half of its side
  static Law::Material solid(double mu) {
    return {.youngs_modulus = modulus, .poisson_ratio = 0.25, .restitution = 0.5, .friction = mu};
  }
  Law::Material granules() const { return solid(friction); }
  Law::Material steel() const { return solid(wall_friction); }
};

/// Two flat blades whose lower edges are hinges. Angle [rad]: at 45 degrees the face is tilted back
/// and grains climb it, at 90 it is upright. (At 135 degrees the blade leans over the grains and
/// presses them into the corner of floor and wall; overlaps exceed the guard's limit.) The blades'
/// ends follow the vessel. All angles have the same triangles with other vertices; set_mesh moves
/// them.
inline silt::TriangleMesh blades(const Scene& s, double slant) {
  constexpr int strips = 8;
  std::vector<std::array<Vec3d, 3>> all;
  // Ends of the first blade at height k; the second blade is the first rotated by 180 degrees.
  const auto corner = [&](double side, int k, bool outer) {
    const double along = s.chord() * k / strips, y = -along * std::cos(slant);
    const double x = outer ? std::sqrt(std::pow(s.radius - s.gap(), 2) - y * y) : s.inner();
    return Vec3d{side * x, side * y, s.gap() + along * std::sin(slant)};
  };
  for (const double side : {1.0, -1.0})
    for (int k = 0; k < strips; ++k) {
      const Vec3d a = corner(side, k, false), b = corner(side, k, true);
      const Vec3d c = corner(side, k + 1, true), d = corner(side, k + 1, false);
      all.push_back({a, b, c}), all.push_back({a, c, d});
    }
  return silt::TriangleMesh(all);
}

/// Rotates the blades from the time `now` [s] on.
inline silt::Motion turning(double now, double rate) {
  return silt::from(now, silt::rotation({0, 0, 0}, {0, 0, 1}, rate));
}

/// Vessel, blades, and grains in the chute above it.
inline auto make_mixer(const Scene& s, int threads) {
  const double half = s.chute(), low = 0.7 * s.radius;
  // Low: grains land at about 2 m/s, which their stiffness allows.
  const double solid = static_cast<double>(s.grains) * silt::Sphere::volume(1.03 * s.grain);
  const double high = low + solid / (0.25 * 4 * half * half);  // a grid of mixed sizes is loose
  silt::Particles<silt::Sphere> grains;
  grains.fill({{-half, -half, low}, {half, half, high}},
              {.radius = silt::uniform(0.8 * s.grain, 1.2 * s.grain),
               .density = Scene::density,
               .count = s.grains,
               .velocity = {0, 0, -0.3}});
  silt::Contacts<Law, silt::SeveralMaterials> contacts{s.granules()};
  contacts.add(s.granules(), "blue"), contacts.add(s.granules(), "amber");
  contacts.add(s.steel(), "steel");
  silt::Simulation sim{std::move(grains), contacts, silt::EnergyLedger{}};
  sim.threads = threads;
  sim.gravity = {0, 0, -Scene::g};
  sim.set_pair("blue", "amber", {.restitution = 0.5, .friction = s.friction});
  for (const char* colour : {"blue", "amber"})
    sim.set_pair(colour, "steel", {.restitution = 0.5, .friction = s.wall_friction});
  sim.add_wall(silt::capped_cylinder({0, 0, 0}, {0, 0, s.height()}, s.radius, 64, true), s.steel(),
               {.name = "vessel"});
  sim.add_wall(blades(s, s.slant()), s.steel(), {.name = "blade"});
  // A box without floor and lid guides the grains into the vessel.
  using enum silt::Face;
  sim.add_wall(silt::open_box({-half, -half, low}, {half, half, high}, {ZLow, ZHigh}), s.steel(),
               {.name = "chute"});
  return sim;
}

/// Drives the blades with a torque [N m].
inline silt::ServoTorque motor(const Scene& s, double torque) {
  return {.centre = {0, 0, 0},
          .axis = {0, 0, 1},
          .torque = torque,
          .max_rate = 4 * s.rate(),
          .gain = s.gain};
}

/// Fills the vessel through the chute, levels the bed by one turn of the blades, and colours it;
/// runs go on from the file.
inline void charge(const Scene& s, int threads, const std::string& file) {
  auto sim = make_mixer(s, threads);
  sim.run(s.filling());
  sim.remove_wall("chute");
  sim.set_motion("blade", turning(sim.time(), s.rate()));
  sim.run(s.turn());
  sim.set_motion("blade", {});
  sim.run(0.3);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.set_material(sim.id(k), sim.position(k).x < 0 ? "blue" : "amber");
  silt::save_checkpoint(sim, file);
}

}  // namespace mixer
