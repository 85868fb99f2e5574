// silt - BSD-3-Clause, see LICENSE
// Bodies of all shapes: impacts on walls and on each other, overlapping, stacked, wedged, in heaps.

#include <algorithm>
#include <array>
#include <numbers>

#include <silt/io/observers.hpp>
#include <silt/shape/surface_mesh.hpp>

#include "stability/bodies.hpp"
#include "stability/table.hpp"

namespace stability {

namespace bodies_rows {

using namespace silt;

constexpr double g = 9.81, size = 1e-3,
                 density = 2500;  // [m/s2], [m] radius of the volume's sphere

enum class At { Plane, Cylinder, Mesh, MovingPlane, MovingMesh };
const char* name_of(At at) {
  constexpr const char* names[] = {"plane", "cylinder", "mesh", "moving plane", "moving mesh"};
  return names[static_cast<int>(at)];
}
bool moves(At at) { return at == At::MovingPlane || at == At::MovingMesh; }

constexpr double drum = 60 * size;  // [m] radius of the cylinder, whose axis is 60 mm up

Surfaces surface(At at) {
  const double s = 200 * size;
  const Vec3d a{-s, -s, 0}, b{s, -s, 0}, c{s, s, 0}, d{-s, s, 0};
  if (at == At::Mesh || at == At::MovingMesh) return TriangleMesh({{a, b, c}, {a, c, d}});
  if (at == At::Cylinder) return Cylinder{{0, -s, drum}, {0, s, drum}, drum, Side::Inside};
  return Plane{{0, 0, 0}, {0, 0, 1}};
}
/// Distance [m] of a point from the wall, negative behind it; `risen`: displacement of a moving
/// wall.
double clearance(At at, const Vec3d& p, double risen) {
  return at == At::Cylinder ? drum - std::hypot(p.x, p.z - drum) : p.z - risen;
}

Particles<Grains> of(const Form& form) {
  Particles<Grains> bodies;
  bodies.add_form(form.shape);
  return bodies;
}
Quaternion phase(int k) {
  return rotation_about(normalised(Vec3d{0.3 + k, 1.0, 0.7 * k - 1.0}), 0.4 + 1.7 * k);
}

struct Throw {
  At at = At::Plane;
  double modulus = 1e8, e = 1, friction = 0;  // [Pa], [-], [-]
  double speed = 1;                           // [m/s]
  double share = 0;                           // [-] of the limit of the time step; 0: chosen
  bool lifted = false;                        // guard.max_time_step
};

/// Allowed error of the energy with n steps per contact. On a face with hardly any curvature (s =
/// 40: 6300 semi-axes) the contact point moves from edge to edge within a step: ten times as much.
double energy_bound(bool sharp, double n) { return (sharp ? 40 : 4) / (n * n); }

/// A body and a wall collide, in the worst of some orientations. Without friction and dissipation
/// its energy, in the frame of the wall, is constant; otherwise it does not increase. The body
/// leaves the wall again.
Measures thrown(const Form& form, const Throw& t, int phases) {
  const bool keeps = t.e == 1 && t.friction == 0;
  double energy = 0, behind = 0, stays = 0;
  for (int k = 0; k < phases; ++k) {
    auto bodies = of(form);
    const double reach = reach_of(bodies.forms()[0], size), away = 1.05 * reach;
    const double wall_speed = moves(t.at) ? t.speed : 0;
    bodies.add({.position = {0.1 * size, 0.2 * size, away},
                .orientation = phase(k),
                .radius = reach,
                .density = density,
                .velocity = {0, 0, moves(t.at) ? 0 : -t.speed}});
    const auto contacts = law(t.modulus, t.e, t.friction);
    Simulation sim{std::move(bodies), contacts};
    sim.threads = 1;
    Motion motion;
    if (moves(t.at)) motion = translation({0, 0, t.speed});
    sim.add_wall(surface(t.at), contacts.material(0), motion);
    const Vec3d frame{0, 0, wall_speed};
    if (t.lifted) sim.guard.max_time_step = 1e3;
    sim.run(0);
    if (t.share > 0) sim.time_step = 0.999 * t.share * sim.step_length() * 20 / 8;
    const double before = energy_of(sim, frame);
    // It rotates as it leaves, and may touch repeatedly.
    for (int slice = 0; slice < 60; ++slice) {
      sim.run(0.5 * reach / t.speed);
      const double up = clearance(t.at, sim.position(0), wall_speed * sim.time());
      if (up < 0) behind += 1;
      if (up < 0 || (slice > 3 && up > 1.05 * reach)) break;
      if (slice == 59 && keeps) stays += 1;
    }
    const double change = energy_of(sim, frame) / before - 1;
    energy = std::max(energy, keeps ? std::abs(change) : change);
  }
  const double steps = t.share > 0 ? 8 / t.share : 20;
  return {
      {keeps ? "energy" : "energy gained", energy, keeps ? energy_bound(form.sharp, steps) : 1e-6},
      {"behind the wall", behind, 0},
      {"does not leave", stays, 0}};
}

/// Two bodies collide: momentum is constant, energy too if e = 1.
Measures collision(const Form& a, const Form& b, double ratio, double mass_ratio, double speed) {
  double energy = 0, momentum = 0;
  for (int k = 0; k < 3; ++k) {
    Particles<Grains> bodies;
    bodies.add_form(a.shape), bodies.add_form(b.shape);
    const double r = reach_of(bodies.forms()[0], size * ratio),
                 q = reach_of(bodies.forms()[1], size);
    bodies.add({.form = 0,
                .position = {-r, 0, 0},
                .orientation = phase(k),
                .radius = r,
                .density = density * mass_ratio});
    bodies.add({.form = 1,
                .position = {1.02 * q, 0.1 * q, 0.05 * q},
                .orientation = phase(k + 3),
                .radius = q,
                .density = density,
                .velocity = {-speed, 0, 0}});
    Simulation sim{std::move(bodies), law(1e8, 1, 0)};
    sim.threads = 1;
    const auto total = [&] {
      return sim.mass(0) * sim.velocity(0) + sim.mass(1) * sim.velocity(1);
    };
    sim.run(0);
    const double before = energy_of(sim);
    const Vec3d was = total();
    sim.run(4 * (q + r) / speed);
    energy = std::max(energy, std::abs(energy_of(sim) / before - 1));
    momentum = std::max(momentum, norm(total() - was) / norm(was));
  }
  return {{"energy", energy, energy_bound(a.sharp || b.sharp, 20)}, {"momentum", momentum, 1e-11}};
}

/// 27 bodies side by side, each with its box around it, overlap by a fraction of their smallest
/// width and separate: with the energy found at half the step, within 5 %; with dissipation, not
/// more than that.
Measures released(const Form& form, double overlap, double e) {
  Box around;
  for (const Vec3d& p : surface_of(form.shape).points) around.include(p);
  double touching = 0;
  const auto found = [&](double restitution, double share) {
    auto bodies = of(form);
    const double reach = reach_of(bodies.forms()[0], size);
    const Vec3d wide = reach / bodies.forms()[0].radius * around.extent();
    const double deep = overlap * std::min({wide.x, wide.y, wide.z});
    for (int k = 0; k < 27; ++k)
      bodies.add({.position = {k % 3 * (wide.x - deep), k / 3 % 3 * (wide.y - deep),
                               k / 9 * (wide.z - deep)},
                  .radius = reach,
                  .density = density});
    Simulation sim{std::move(bodies), law(1e7, restitution, 0)};
    sim.gravity = {0, 0, -g};  // falling, it has a speed to choose a time step by
    sim.threads = 1;
    sim.run(0);
    touching = static_cast<double>(sim.touching_pairs());
    sim.time_step = share * sim.step_length();
    sim.run(0.01);
    return energy_of(sim, {0, 0, -g * sim.time()});
  };
  const double exact = found(1, 0.25), error = e == 1 ? found(1, 0.5) / exact - 1 : 0;
  return {{"energy", std::abs(error), 0.05},
          {"energy of what was stored", e < 1 ? found(e, 0.5) / exact : 0, 1},
          {"pairs that do not touch", touching > 0 ? 0.0 : 1.0, 0}};
}

/// Stacked blocks stay in place, the top one heavier.
Measures stack(int count, double mass_ratio, double modulus, double friction) {
  auto bodies = of({"block", brick(1, 1, 0.5)});
  const double scale = size / 1.0;
  for (int k = 0; k < count; ++k)
    bodies.add({.position = {0, 0, (k + 0.5) * scale},
                .orientation = rotation_about({0, 0, 1}, 0.1 * k),
                .radius = scale * bodies.forms()[0].radius,
                .density = density * (k + 1 == count ? mass_ratio : 1.0)});
  const auto contacts = law(modulus, 0.5, friction);
  Simulation sim{std::move(bodies), contacts};
  sim.gravity = {0, 0, -g};
  sim.threads = 1;
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
  sim.run(0.3);
  double weight = 0, aside = 0, fallen = 0;
  for (std::uint32_t k = 0; k < sim.size(); ++k) {
    const auto row = sim.find(k);
    weight += sim.mass(row) * g;
    aside = std::max(aside, std::hypot(sim.position(row).x, sim.position(row).y) / size);
    fallen = std::max(fallen, std::abs(sim.position(row).z / ((k + 0.5) * scale) - 1));
  }
  // The dashpots use the mass of a block, not of its load: a heavy stack oscillates longer.
  const bool heavy = mass_ratio > 1;
  return {{"load of the floor", std::abs(-sim.wall(0).force.z / weight - 1), heavy ? 1 : 1e-3},
          {"aside", aside, 1e-3},
          {"height", fallen, 0.1},
          {"energy over weight times size", energy_of(sim) / (weight * size), heavy ? 0.1 : 1e-8}};
}

/// A body falls between two planes that meet at `angle`, and is pressed in: they carry the load.
Measures wedged(const Form& form, double angle, double pull, double friction) {
  auto bodies = of(form);
  const double reach = reach_of(bodies.forms()[0], size), half = angle / 2 * std::numbers::pi / 180;
  bodies.add({.position = {0, 0, 1.02 * reach / std::sin(half)},
              .orientation = phase(1),
              .radius = reach,
              .density = density});
  const auto contacts = law(1e8, 0.2, friction);
  Simulation sim{std::move(bodies), contacts};
  sim.threads = 1;
  sim.gravity = {0, 0, -pull * g};
  sim.add_wall(Plane{{0, 0, 0}, {std::cos(half), 0, std::sin(half)}}.unit(), contacts.material(0));
  sim.add_wall(Plane{{0, 0, 0}, {-std::cos(half), 0, std::sin(half)}}.unit(), contacts.material(0));
  const double load = sim.mass(0) * pull * g, from = sim.position(0).z;
  const double fall = std::sqrt(2 * from / (pull * g));
  double gained = 0, behind = 0, borne = 0, samples = 0;
  const auto look = [&](const auto& s) {
    const Vec3d p = s.position(0);
    gained = std::max(gained, energy_of(s) / (load * from) + p.z / from - 1);
    behind += std::sin(half) * p.z < std::cos(half) * std::abs(p.x);
    if (s.time() > 8 * fall) borne -= s.wall(0).force.z + s.wall(1).force.z, samples += 1;
  };
  sim.run(10 * fall, at(every(10 * fall / 1000), look));
  // Smooth bodies roll along the wedge and rock in it undamped. At half the impact speed, down and
  // up, the mean load over two fall times is off by half.
  return {{"energy gained", gained, 1e-3},
          {"behind a wall", behind, 0},
          {"mean load of the walls", std::abs(borne / samples / load - 1), 0.5}};
}

/// Two plates close on a body that cannot escape.
Measures closing(const Form& form, At at, double speed) {
  auto bodies = of(form);
  const double reach = reach_of(bodies.forms()[0], size);
  bodies.add({.position = {0, 0, 0}, .orientation = phase(2), .radius = reach, .density = density});
  const auto contacts = law(1e9, 0.5, 0.3);
  Simulation sim{std::move(bodies), contacts};
  sim.threads = 1;
  const auto from = [=](double start, double v) -> Motion {
    return [=](double t) { return Pose{{}, {0, 0, start + v * t}}; };
  };
  sim.add_wall(surface(at), contacts.material(0), from(-1.1 * reach, speed));
  sim.add_wall(at == At::Mesh ? surface(at) : Surfaces(Plane{{0, 0, 0}, {0, 0, -1}}),
               contacts.material(0), from(1.1 * reach, -speed));
  sim.run(2.2 * reach / speed);
  return {{"let two plates pass", 1, 0}};
}

/// Bodies of some forms fall into a box and come to rest; the floor carries them.
Measures heap(const std::vector<Form>& forms, double e, double friction) {
  Particles<Grains> bodies;
  const double side = 12 * size;
  for (const Form& f : forms)
    if (!f.slender) bodies.add_form(f.shape);
  const std::size_t kinds = bodies.forms().size();
  for (std::size_t f = 0; f < kinds; ++f) {
    const double reach = reach_of(bodies.forms()[f], size);
    bodies.fill({.min = {0, 0, 0}, .max = {side, side, 20 * side}},
                {.radius = uniform(0.7 * reach, reach),
                 .density = density,
                 .count = 36 / kinds,
                 .velocity = {0.1, 0.05, -0.3},
                 .form = f});
  }
  const auto contacts = law(1e7, e, friction);
  Simulation sim{std::move(bodies), contacts};
  sim.gravity = {0, 0, -g};
  sim.add_wall(box({0, 0, 0}, {side, side, 22 * side}), contacts.material(0));
  sim.threads = 1;
  const auto all = [&] {  // [J] of motion and height
    double sum = energy_of(sim);
    for (std::size_t k = 0; k < sim.rows(); ++k) sum += sim.mass(k) * g * sim.position(k).z;
    return sum;
  };
  sim.run(0);
  const double before = all();
  sim.run(0.25);
  double weight = 0, outside = 0, borne = 0, samples = 0;
  sim.run(0.05, at(every(0.001), [&](const auto& s) { borne -= s.wall(0).force.z, samples += 1; }));
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d p = sim.position(k);
    weight += sim.mass(k) * g;
    outside += p.x < 0 || p.x > side || p.y < 0 || p.y > side || p.z < 0;
  }
  Measures out{{"outside of the box", outside, 0},
               {"energy gained", std::max(all() / before - 1, 0.0), 1e-3}};
  if (e == 1 || friction == 0) return out;
  out.push_back({"mean load of the floor", std::abs(borne / samples / weight - 1), 0.02});
  // Round ones continue to roll.
  out.push_back({"energy over weight times size", energy_of(sim) / (weight * size), 1e-2});
  return out;
}

}  // namespace bodies_rows

void bodies(Table& table) {
  using namespace bodies_rows;
  const auto forms = all_forms(table.quick);
  const int phases = table.quick ? 2 : 4;
  const auto tame = [](bool yes) { return yes ? Setting::Tame : Setting::Extreme; };

  table.scene("Bodies of all shapes hit walls, at rest and moving, at 0.01 to 100 m/s, e = 1",
              text("energy as before, seen from the wall, within 4/n^2 (n steps a contact); away "
                   "again;\n          the worst of ",
                   phases, " orientations"));
  for (const auto& f : forms)
    for (const At at : {At::Plane, At::Cylinder, At::Mesh, At::MovingPlane, At::MovingMesh})
      for (const double speed : {0.01, 1.0, 100.0}) {
        if (table.quick && speed != 1) continue;
        if (speed < 1 && (f.slender || at > At::Mesh)) continue;  // many steps
        const Throw t{.at = at, .modulus = speed > 10 ? 7e10 : 1e8, .speed = speed};
        table.row(text(f.name, ", ", name_of(at), ", ", speed, " m/s"),
                  tame(speed < 10 && !f.slender), [&] { return thrown(f, t, phases); });
      }

  table.scene("The same on a plane, with losses and friction", "no energy gained");
  for (const auto& f : forms)
    for (const double e : {0.05, 0.5, 1.0})
      for (const double friction : {0.0, 0.5, 2.0})
        if ((e < 1 || friction > 0) && !(table.quick && e == 0.5))
          table.row(text(f.name, ", e = ", e, ", friction ", friction), tame(!f.slender),
                    [&] { return thrown(f, {.e = e, .friction = friction}, phases); });

  table.scene("The same, time steps from 0.01 to 10 times the limit, e = 1", "energy as before");
  for (const auto& f : forms)
    for (const double share : {0.01, 0.1, 0.4, 1.0, 2.0, 5.0, 10.0})
      if (!(table.quick && share < 0.4))
        table.row(text(f.name, ", step ", share, " of the limit"), tame(share < 0.5 && !f.slender),
                  [&] { return thrown(f, {.share = share, .lifted = share > 1}, phases); });

  table.scene("Two bodies meet: sizes 1:10, mass ratios to 1:1e6, e = 1",
              "energy as before within 1 %, momentum to rounding, in three orientations");
  for (std::size_t a = 0; a < forms.size(); ++a)
    for (const double ratio : {1.0, 10.0})
      for (const double heavier : {1.0, 1000.0}) {
        if (table.quick && heavier > 1) continue;
        const auto& other = forms[(a + 2) % forms.size()];
        table.row(text(forms[a].name, " ", ratio, ":1 ", other.name, ", density ", heavier, ":1"),
                  tame(!forms[a].slender && !other.slender),
                  [&] { return collision(forms[a], other, ratio, heavier, 1); });
      }

  table.scene("27 bodies that overlap at the start fly apart",
              "energy as with half the step, within 5 %; with losses no more than without");
  for (const auto& f : forms)
    for (const double overlap : {0.01, 0.05, 0.3})
      for (const double e : {1.0, 0.3})
        if (!table.quick || overlap < 0.02) {
          const auto run = [&] { return released(f, overlap, e); };
          const std::string name = text(f.name, ", overlap ", overlap, ", e = ", e);
          if (overlap > 0.2)  // of the diameter, the guard's limit is 0.3 of the radius
            table.stops(name, "guard.max_overlap", run);
          else
            table.row(name, tame(overlap < 0.02), run);
        }

  table.scene("Blocks on top of each other", "they stay, the floor bears them, no motion");
  for (const int count : {2, 10})
    for (const double mass_ratio : {1.0, 100.0, 1e4})
      for (const double modulus : {1e7, 1e9})
        if (table.quick ? modulus < 1e8 && (count == 2 || mass_ratio < 2)
                        : modulus < 1e8 || count == 2)
          table.row(
              text(count, ", the top one ", mass_ratio, " times as heavy, E = ", modulus, " Pa"),
              tame(mass_ratio < 10), [&] { return stack(count, mass_ratio, modulus, 0.5); });

  table.scene("A body wedged between two planes",
              "no energy gained; they bear its load in the mean, within half");
  for (const auto& f : forms)
    for (const double angle : {90.0, 30.0})
      for (const double pull : {1.0, 1000.0})
        for (const double friction : {0.3, 2.0})
          if (!(table.quick && (pull > 1 || friction > 1 || angle > 30 || f.slender)))
            table.row(text(f.name, ", ", angle, " degrees, ", pull, " g, friction ", friction),
                      tame(pull < 2 || !f.slender),
                      [&] { return wedged(f, angle, pull, friction); });

  table.scene("Two plates close on a body", "stopped, since there is no way out");
  for (const auto& f : forms)
    for (const At at : {At::Plane, At::Mesh})
      for (const double speed : {1.0, 100.0})
        if (!(table.quick && speed > 1))
          table.row(text(f.name, ", ", name_of(at), ", ", speed, " m/s"), Setting::Extreme,
                    [&] { return closing(f, at, speed); });

  if (table.quick) return;
  table.scene(
      "36 bodies (none slender) fall into a box",
      "none outside, no energy gained; with losses at rest, the floor bears them within 2 %");
  for (const double e : {0.05, 0.5, 1.0})
    for (const double friction : {0.0, 0.5, 2.0})
      if (e == 0.5 || friction == 0.5)
        table.row(text("all shapes, e = ", e, ", friction ", friction), tame(friction > 0 && e < 1),
                  [&] { return heap(forms, e, friction); });
}

}  // namespace stability
