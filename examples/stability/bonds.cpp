// silt - BSD-3-Clause, see LICENSE
// Bonds: stiff and strongly damped ones, very weak ones, between unequal spheres, and fibres that
// hit a wall.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/hertz_mindlin.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace bond_rows {

using namespace silt;

constexpr double radius = 1e-3, density = 2500;  // [m], [kg/m3]
constexpr double modulus = 1e7;                  // [Pa] of contacts
constexpr double infinite = std::numeric_limits<double>::infinity();

Contacts<HertzMindlin> hertz(double e, double friction, double stiffness = modulus) {
  return Contacts<HertzMindlin>{
      {.youngs_modulus = stiffness, .poisson_ratio = 0.3, .restitution = e, .friction = friction}};
}
auto scene(const ParallelBond& bond, double e = 1, double friction = 0, double contacts = modulus) {
  Simulation sim{Particles<Sphere>{}, hertz(e, friction, contacts), Bonds{bond}, EnergyLedger{}};
  sim.threads = 1;
  return sim;
}
template <class Sim>
double fastest(const Sim& sim) {
  double most = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) most = std::max(most, norm(sim.velocity(k)));
  return most;
}
/// [J] kinetic energy, energy of contact springs and bonds.
template <class Sim>
double held(const Sim& sim) {
  const auto e = sim.energy();
  return e.kinetic() + e.elastic();
}

/// A fibre of ten spheres is hit obliquely at its end, and oscillates. `step`: over the longest
/// allowed step; 0: silt's choice.
Measures swings(double stiffness, double damping, double step) {
  const auto make = [&] {
    auto sim = scene({.youngs_modulus = stiffness * modulus, .damping = damping});
    add_bonded(sim, fibre({0, 0, 0}, {18 * radius, 0, 0}, 10, {radius, density}));
    sim.set_velocity(0, {0.01, 0.02, 0.01});
    return sim;
  };
  auto sim = make();
  if (step > 0) {
    // The limit is read from the message that refuses a longer step; with silt's choice from the
    // same scene.
    auto other = make();
    other.run(0);
    double low = other.step_length(), high = 20 * low;
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      auto trial = make();
      trial.time_step = middle;
      try {
        trial.run(0);
        low = middle;
      } catch (const InputError&) {
        high = middle;
      }
    }
    sim.time_step = step * low;
  }
  sim.run(0);
  const double start = held(sim);
  double most = 0, least = infinite, off = 0;
  for (int k = 0; k < 60; ++k) {
    sim.run(50 * sim.step_length());
    most = std::max(most, held(sim) / start), least = std::min(least, held(sim) / start);
    off = std::max(off, std::abs(sim.energy().residual()) / start);
  }
  // For the fastest oscillation, (w dt)^2/8 of its energy; the step is at most 0.8/w.
  const double w_dt = step > 0 ? 0.8 * step : std::numbers::pi / 20;
  if (damping > 0) return {{"energy gained", most - 1, 1e-9}, {"energy at the end", least, 0.7}};
  return {{"energy gained", most - 1, w_dt * w_dt / 8}, {"ledger", off, w_dt * w_dt / 8}};
}

/// A block of 4 x 4 x 4 spheres, compressed by `overlap` of the radius and bonded with almost zero
/// strength: it disintegrates without a push.
Measures hardly_holds(double strength, double overlap, double e) {
  auto sim = scene({.youngs_modulus = modulus,
                    .tensile_strength = strength,
                    .shear_strength = strength,
                    .weibull_modulus = 3},
                   e, 0.5);
  Particles<Sphere> block;
  const double pitch = (2 - overlap) * radius;
  for (int k = 0; k < 64; ++k)
    block.add({.position = {k % 4 * pitch, k / 4 % 4 * pitch, k / 16 * pitch},
               .radius = radius,
               .density = density,
               .velocity = {0.01 * ((k * 7) % 5 - 2), 0.01 * ((k * 11) % 7 - 3), 0}});
  sim.add(block);
  const std::size_t made = bond_near(sim, 1e-6 * radius);
  sim.run(0);
  const double start = held(sim);
  double most = 0;
  for (int k = 0; k < 20; ++k) {
    sim.run(1e-3);
    most = std::max(most, held(sim) / start);
  }
  return {{"bonds that hold", static_cast<double>(sim.bonds()) / static_cast<double>(made), 0},
          {"energy gained", most - 1, 1e-4},
          {"ledger", std::abs(sim.energy().residual()) / start, 2e-3}};
}

/// A sphere bonded to one `ratio` times as large, without dashpots.
auto bonded_two(double ratio, double stiffness) {
  auto sim = scene({.youngs_modulus = stiffness * modulus, .damping = 0});
  Particles<Sphere> two;
  two.add({.position = {0, 0, 0}, .radius = ratio * radius, .density = density});
  two.add({.position = {0, 0, (1 + ratio) * radius}, .radius = radius, .density = density});
  sim.add(two);
  sim.bond(0, 1);
  return sim;
}
/// A sphere bonded to one `ratio` times as large, of the same density, oscillates along their bond:
/// its period, against the one from the reduced mass.
Measures unequal(double ratio, double stiffness) {
  auto sim = bonded_two(ratio, stiffness);
  const double length = (1 + ratio) * radius, area = std::numbers::pi * radius * radius;
  const double m = mass_of(radius, density), M = mass_of(ratio * radius, density);
  const double w = std::sqrt(stiffness * modulus * area / length * (1 / m + 1 / M)), v = 1e-3;
  sim.set_velocity(1, {0, 0, v});
  sim.run(20 * std::numbers::pi / w);  // ten swings
  const double share = M / (m + M), relative = sim.velocity(1).z - sim.velocity(0).z;
  // Leapfrog is early by (w dt)^2/24, and the run ends within one step of the requested time.
  const double w_dt = w * sim.step_length(),
               phase = 20 * std::numbers::pi * w_dt * w_dt / 24 + w_dt;
  return {{"speed after ten swings", std::abs(relative / v - 1), phase * phase / 2 + 1e-4},
          {"centre of mass", std::abs(sim.mean_velocity().z / v / (1 - share) - 1), 1e-9},
          {"ledger", std::abs(sim.energy().residual()) / (0.5 * m * v * v), 0.02}};
}
/// The same, hit sideways: rotation and bending; energy is constant.
Measures unequal_across(double ratio, double stiffness) {
  auto sim = bonded_two(ratio, stiffness);
  sim.set_velocity(1, {1e-3, 0, 0}), sim.set_angular_velocity(1, {0.5, 1, 2});
  sim.run(0);
  const double start = held(sim);
  double off = 0;
  for (int k = 0; k < 40; ++k) {
    sim.run(50 * sim.step_length());
    off = std::max(off, std::abs(held(sim) / start - 1));
  }
  return {{"energy", off, std::pow(std::numbers::pi / 20, 2) / 4}};
}

struct Throw {
  double speed;                // [m/s]
  double contacts, stiffness;  // [Pa], of bonds over that
  double strength, e;          // [Pa], [-]
  bool moving;                 // wall
};
/// A fibre of ten spheres hits a wall obliquely.
Measures thrown(const Throw& t) {
  const auto [speed, contacts, stiffness, strength, e, moving] = t;
  auto sim = scene({.youngs_modulus = stiffness * contacts,
                    .tensile_strength = strength,
                    .shear_strength = strength,
                    .damping = e < 1 ? 0.2 : 0},
                   e, e < 1 ? 0.5 : 0, contacts);
  const double s = std::sqrt(0.5);
  const Vec3d from{0, 0, 1.2 * radius}, way{18 * s * radius, 0, 18 * s * radius};
  auto one = fibre(from, from + way, 10, {radius, density});
  const double of_wall = moving ? 0.5 * speed : 0;
  add_bonded(sim, placed(one, {0, 0, 0}, {}, {0.1 * speed, 0, of_wall - speed}));
  const Plane plane{{0, 0, 0}, {0, 0, 1}};
  const auto material = hertz(e, e < 1 ? 0.5 : 0, contacts).material(0);
  if (moving)
    sim.add_wall(plane, material, translation({0, 0, of_wall}));
  else
    sim.add_wall(plane, material);
  sim.run(0);
  const double start = held(sim);
  sim.run(25 * radius / speed);
  const auto now = sim.energy();
  const double gained = (held(sim) - start - now.walls) / start;
  double behind = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) behind += sim.position(k).z < of_wall * sim.time();
  Measures all{{"behind the wall", behind, 0}, {"ledger", std::abs(now.residual()) / start, 0.02}};
  if (e == 1 && strength == infinite) all.push_back({"energy", std::abs(gained), 0.02});
  if (e < 1) all.push_back({"energy gained", std::max(gained, 0.0), 1e-3});
  if (strength < infinite) all.push_back({"fastest", fastest(sim) / speed, 3});
  return all;
}

}  // namespace bond_rows

void bonds(Table& table) {
  using namespace bond_rows;
  table.scene("A fibre of ten is hit askew, bonds of up to 1e6 times the contacts' modulus",
              "without dashpots energy is kept within (w dt)^2/8, with them it falls by a third");
  for (const double stiffness : {1.0, 1e3, 1e6})
    for (const double damping : {0.0, 0.1, 1.0, 10.0})
      for (const double step : {0.0, 0.999, 1.01})
        table.row(text("E x ", stiffness, ", damping ", damping, ", ",
                       step > 0 ? text("step ", step, " of the limit") : "step as chosen"),
                  step > 0 ? Setting::Extreme : Setting::Tame,
                  [&] { return swings(stiffness, damping, step); });

  table.scene("A block of 64 whose bonds hold next to nothing, pressed together before",
              "no bond holds, no energy comes from what they overlap by");
  for (const double strength : {1e-6, 1.0})
    for (const double overlap : {0.0, 0.01, 0.1})
      for (const double e : {1.0, 0.3})
        table.row(text("strength ", strength, " Pa, overlap ", overlap, ", e = ", e), Setting::Tame,
                  [&] { return hardly_holds(strength, overlap, e); });

  table.scene("A sphere bonded to one up to 100 times as large", "swings as the closed form says");
  for (const double ratio : {1.0, 10.0, 100.0})
    for (const double stiffness : {1.0, 1e3}) {
      table.row(text("1:", ratio, ", E x ", stiffness, ", along"), Setting::Tame,
                [&] { return unequal(ratio, stiffness); });
      table.row(text("1:", ratio, ", E x ", stiffness, ", across"), Setting::Tame,
                [&] { return unequal_across(ratio, stiffness); });
    }

  table.scene("A fibre of ten is thrown at a wall, askew",
              "no sphere is behind the wall, no energy comes from nowhere, e = 1 keeps it");
  for (const double stiffness : {1.0, 1e3})
    for (const double speed : {0.1, 1.0, 10.0, 100.0})
      // Soft, or with the same overlap at all speeds.
      for (const double contacts :
           speed > 1 ? std::vector{1e7, 1e7 * speed * speed} : std::vector{1e7}) {
        if (stiffness > 1 && (table.quick || speed < 1)) continue;  // at 0.1 m/s 1e7 steps
        for (const double e : {1.0, 0.5})
          for (const double strength : {infinite, 1e-3 * contacts})
            for (const bool moving : {false, true})
              table.row(text(speed, " m/s, E = ", contacts, " Pa, x ", stiffness, ", e = ", e,
                             strength < infinite ? ", breaks" : "", moving ? ", moving wall" : ""),
                        speed > 1 && contacts < 1e8 ? Setting::Extreme : Setting::Tame, [&] {
                          return thrown({speed, contacts, stiffness, strength, e, moving});
                        });
      }
}

}  // namespace stability
