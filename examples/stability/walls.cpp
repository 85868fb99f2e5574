// silt - BSD-3-Clause, see LICENSE
// Walls at rest: a wedge, a mesh corner, thin meshes hit at large time steps.

#include <array>
#include <cmath>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/linear_spring.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace walls_rows {

using namespace silt;

constexpr double g = 9.81, radius = 1e-3, density = 2500;  // [m/s2], [m], [kg/m3]

Contacts<HertzMindlin> hertz(double modulus, double e, double friction) {
  return Contacts<HertzMindlin>{
      {.youngs_modulus = modulus, .poisson_ratio = 0.3, .restitution = e, .friction = friction}};
}
double stiffness(double modulus) {
  return hertz_stiffness(effective_modulus(modulus, 0.3, modulus, 0.3), radius);
}

using Soup = std::vector<std::array<Vec3d, 3>>;

/// A square of `side` [m] about the origin, in the plane z = 0, of 2 n^2 triangles.
Soup square(double side, int n) {
  Soup out;
  const double a = side / n;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = i * a - side / 2, y = j * a - side / 2;
      const Vec3d p{x, y, 0}, q{x + a, y, 0}, r{x + a, y + a, 0}, s{x, y + a, 0};
      out.push_back({p, q, r}), out.push_back({p, r, s});
    }
  return out;
}

/// A pit with n sides that slope by `angle` [rad] down to the origin.
Soup pit(int n, double angle, double width) {
  Soup out;
  const auto corner = [&](int k) {
    const double phi = 2 * std::numbers::pi * (k + 0.5) / n;
    // The sides slope by `angle`, the edges by less.
    const double out_to = width / std::cos(std::numbers::pi / n);
    return Vec3d{out_to * std::cos(phi), out_to * std::sin(phi), width * std::tan(angle)};
  };
  for (int k = 0; k < n; ++k) out.push_back({Vec3d{0, 0, 0}, corner(k), corner(k + 1)});
  return out;
}

/// A sphere in a pit of n planes or of a mesh, pressed in by `pull` times its weight: each side
/// carries the same load, F = m a/(n cos(slope)).
Measures pressed_in(const Surfaces& surfaces, int n, double slope, double pull, double modulus,
                    double friction) {
  const double m = mass_of(radius, density), a = pull * g;
  const double load = m * a / (n * std::cos(slope));
  const double depth = std::pow(load / stiffness(modulus), 2.0 / 3.0);
  Particles<Sphere> spheres;
  spheres.add(
      {.position = {0, 0, radius * 1.001 / std::cos(slope)}, .radius = radius, .density = density});
  const auto contacts = hertz(modulus, 0.1, friction);
  Simulation sim{std::move(spheres), contacts};
  sim.gravity = {0, 0, -a};
  sim.add_wall(surfaces, contacts.material(0));
  sim.threads = 1;
  sim.run(0);
  // It oscillates along slopes on springs of the stiffness 3/2 F/d; some tens of periods are
  // enough.
  const double omega = std::cos(slope) * std::sqrt(n * 1.5 * load / depth / m);
  sim.run(std::max(80 / omega / std::cos(slope), 200 * sim.step_length()));
  const Vec3d p = sim.position(0), v = sim.velocity(0);
  const double now = radius - p.z * std::cos(slope);
  Measures out{{"load of the walls", std::abs(-sim.wall(0).force.z / (m * a) - 1), 1e-3},
               {"speed", norm(v) / (depth * omega), 1e-3},
               {"off the middle", std::hypot(p.x, p.y) / depth, 1e-3}};
  if (friction == 0) out.push_back({"overlap", std::abs(now / depth - 1), 2e-3});
  return out;
}

Surfaces wedge(double angle) {
  const double c = std::cos(angle / 2), s = std::sin(angle / 2);
  std::vector<Surface> parts;
  parts.emplace_back(Plane{{0, 0, 0}, {c, 0, s}}.unit());
  parts.emplace_back(Plane{{0, 0, 0}, {-c, 0, s}}.unit());
  return Surfaces(std::move(parts));
}

/// Spheres that hit a mesh without thickness, at different phases of a step. None may get behind
/// it, and all must rebound by the law.
template <class Law>
Measures thin(const Contacts<Law>& contacts, double e, double speed, double step, bool lifted) {
  constexpr int count = 16;
  const double dt = step * radius / speed;
  Particles<Sphere> spheres;
  for (int k = 0; k < count; ++k)
    spheres.add({.position = {(k % 4) * 4 * radius, (k / 4) * 4 * radius,
                              radius * (1.01 + step * (2 + k / double(count)))},
                 .radius = radius,
                 .density = density,
                 .velocity = {0, 0, -speed}});
  Simulation sim{std::move(spheres), contacts};
  sim.add_wall(TriangleMesh(square(40 * radius, 5)), contacts.material(0));
  sim.threads = 1;
  sim.time_step = dt;
  if (lifted) sim.guard.max_time_step = 1e6;
  sim.run(3 * step * radius / speed + 6 * radius / speed);
  double behind = 0, worst = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    behind += sim.position(k).z < 0;
    worst = std::max(worst, std::abs(sim.velocity(k).z / speed / e - 1));
  }
  return {{"behind the mesh", behind, 0}, {"restitution", worst, 0.2}};
}

}  // namespace walls_rows

void walls(Table& table) {
  using namespace walls_rows;
  table.scene("A sphere wedged between two planes, pressed in by up to 1e5 times its weight",
              "it rests where the Hertz forces balance the load: F = m a/(2 sin(angle/2)), walls "
              "bear m a");
  for (const double angle : {90.0, 10.0, 2.0})
    for (const double pull : {1.0, 1e3, 1e5})
      for (const double friction : {0.0, 2.0}) {
        const auto run = [&] {
          const double slope = (90 - angle / 2) * std::numbers::pi / 180;
          return pressed_in(wedge(angle * std::numbers::pi / 180), 2, slope, pull, 1e9, friction);
        };
        const std::string name = text(angle, " degrees, ", pull, " g, friction ", friction);
        if (angle < 5 && pull > 1e3 && friction == 0)
          table.stops(name, "guard.max_overlap", run);
        else
          table.row(name, Setting::Tame, run);
      }

  table.scene(
      "A sphere in a mesh corner: a pit of n sides, slope 60 degrees, 1000 times its weight",
      "it rests where the n Hertz forces balance the load, in the middle");
  for (const int n : {3, 4, 5, 6, 8}) {
    const auto run = [&] {
      const double slope = std::numbers::pi / 3;
      return pressed_in(TriangleMesh(pit(n, slope, 10 * radius)), n, slope, 1e3, 1e9, 0);
    };
    if (n > 4)
      table.stops(text(n, " sides"), "in more than 4 places at once", run);
    else
      table.row(text(n, " sides"), Setting::Tame, run);
  }

  table.scene("A mesh without thickness, hit in steps up to ten radii (16 spheres)",
              "none behind the mesh, restitution within 20 %");
  const double m = mass_of(radius, density);
  for (const double speed : {1.0, 300.0}) {
    // Springs that allow an overlap of 10 % of the radius; steps longer than 0.02 radii need a
    // lifted limit.
    const double k = m * speed * speed / (0.01 * radius * radius);
    for (const double step : {0.01, 0.03, 0.1, 0.3, 1.0, 2.0, 5.0, 10.0})
      table.row(text("linear spring, ", speed, " m/s, ", step, " radii a step"),
                step < 0.05 ? Setting::Tame : Setting::Extreme, [&] {
                  return thin(Contacts<LinearSpring>{{.stiffness = k, .restitution = 0.5}}, 0.5,
                              speed, step, true);
                });
  }
  // Springs soft enough that the time step limit from their contact time is far away.
  for (const double step : {0.1, 1.0, 3.0, 10.0})
    table.row(text("very soft spring, 300 m/s, ", step, " radii a step"), Setting::Extreme, [&] {
      const double soft = 1e-6 * m * 9e4 / (radius * radius);
      return thin(Contacts<LinearSpring>{{.stiffness = soft, .restitution = 0.5}}, 0.5, 300, step,
                  false);
    });
  for (const double modulus : {1e5, 1e7})
    for (const double step : {0.05, 0.5, 3.0})
      table.row(text("Hertz, E = ", modulus, " Pa, 300 m/s, ", step, " radii a step"),
                Setting::Extreme,
                [&] { return thin(hertz(modulus, 0.5, 0), 0.5, 300, step, false); });
}

}  // namespace stability
