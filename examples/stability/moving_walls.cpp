// silt - BSD-3-Clause, see LICENSE
// Fast moving walls: a plate or a mesh that hits a grain, two plates that close on one.

#include <array>
#include <cmath>

#include <silt/contact/hertz_mindlin.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace moving_walls_rows {

using namespace silt;

constexpr double radius = 1e-3, density = 2500;  // [m], [kg/m3]

Contacts<HertzMindlin> hertz(double modulus, double e) {
  return Contacts<HertzMindlin>{
      {.youngs_modulus = modulus, .poisson_ratio = 0.3, .restitution = e, .friction = 0.3}};
}
double contact_time(double modulus, double speed) {
  return hertz_contact_time(effective_modulus(modulus, 0.3, modulus, 0.3), radius,
                            mass_of(radius, density), speed);
}

/// A square about the origin in the plane z = 0, as a mesh or as a plane with its free side up or
/// down.
Surfaces plate(bool mesh, double up) {
  if (!mesh) return Plane{{0, 0, 0}, {0, 0, up}};
  const double s = 20 * radius;
  const Vec3d a{-s, -s, 0}, b{s, -s, 0}, c{s, s, 0}, d{-s, s, 0};
  return TriangleMesh({{a, b, c}, {a, c, d}});
}
Motion moving(double from, double speed) {
  return [=](double t) { return Pose{{}, {0, 0, from + speed * t}}; };
}

/// A rising plate hits a grain at rest, which leaves at (1 + e) times the plate's speed. `step`:
/// over 1/20 of the contact at the plate's speed; 0: silt's choice, with gravity.
Measures hit_by(bool mesh, double modulus, double speed, double step) {
  const double e = 0.5, contact = contact_time(modulus, speed);
  double worst = 0, behind = 0, n = 0;
  for (int phase = 0; phase < 4; ++phase) {
    Particles<Sphere> spheres;
    spheres.add({.position = {0, 0, 0}, .radius = radius, .density = density});
    const auto contacts = hertz(modulus, e);
    Simulation sim{std::move(spheres), contacts};
    sim.threads = 1;
    double gap = 0.02 * radius;
    if (step > 0) {
      sim.time_step = step * contact / 20;
      gap = std::max(gap, (3 + 0.25 * phase) * speed * *sim.time_step);
    } else {
      sim.gravity = {0, 0, -9.81};  // else nothing moves, and no time step can be chosen
      gap *= 1 + 0.3 * phase;
    }
    sim.add_wall(plate(mesh, 1), contacts.material(0), moving(-radius - gap, speed));
    sim.run(gap / speed + 4 * contact + 4 * sim.time_step.value_or(0));
    n = contact / sim.step_length();
    const double wall = -radius - gap + speed * sim.time();
    behind += sim.position(0).z < wall;
    const double gravity = step > 0 ? 0 : 9.81 * sim.time();  // what it loses in the meantime
    worst = std::max(worst, std::abs((sim.velocity(0).z - speed) / speed - e) - gravity / speed);
  }
  return {{"behind the plate", behind, 0},
          {"restitution", worst, e * rebound_bound(damping_ratio(e, DampingEnd::ZeroForce), n)}};
}

/// Two plates close on a grain that cannot escape.
Measures closing(bool mesh, double modulus, double speed, double step) {
  Particles<Sphere> spheres;
  spheres.add({.position = {0, 0, 0}, .radius = radius, .density = density});
  const auto contacts = hertz(modulus, 0.5);
  Simulation sim{std::move(spheres), contacts};
  sim.threads = 1;
  sim.time_step = step * contact_time(modulus, speed) / 20;
  const double gap = std::max(0.1 * radius, 2.5 * speed * *sim.time_step);
  sim.add_wall(plate(mesh, 1), contacts.material(0), moving(-radius - gap, speed));
  sim.add_wall(plate(mesh, -1), contacts.material(0), moving(radius + gap, -speed));
  sim.run(2 * (radius + gap) / speed);
  return {{"let two plates pass", 1, 0}};
}

}  // namespace moving_walls_rows

void moving_walls(Table& table) {
  using namespace moving_walls_rows;
  table.scene(
      "A plate hits a grain at rest, e = 0.5",
      "the grain leaves with (1 + e) times the speed of the plate, in the worst of 4 phases;"
      "\n          steps over a twentieth of the contact at the speed of the plate");
  for (const bool mesh : {false, true})
    for (const double speed : {0.1, 10.0, 100.0, 300.0}) {
      const std::string name =
          text(mesh ? "mesh" : "plane", ", E = 7e+10 Pa, ", speed, " m/s, step ");
      for (const double step : {1.0, 10.0, 100.0, 1000.0})
        table.row(name + text("x ", step), step > 2 ? Setting::Extreme : Setting::Tame,
                  [&] { return hit_by(mesh, 7e10, speed, step); });
      table.row(name + "as chosen", Setting::Tame, [&] { return hit_by(mesh, 7e10, speed, 0); });
    }

  table.scene("Two plates close on a grain", "stopped, since there is no way out");
  for (const bool mesh : {false, true})
    for (const double speed : {1.0, 100.0})
      for (const double step : {1.0, 10.0, 1000.0})
        table.row(text(mesh ? "meshes, " : "planes, ", speed, " m/s, step x ", step),
                  Setting::Extreme, [&] { return closing(mesh, 1e9, speed, step); });
}

}  // namespace stability
