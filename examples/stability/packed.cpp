// silt - BSD-3-Clause, see LICENSE
// Many simultaneous contacts: columns, packings that overlap at the start, compressed lattices, a
// fine grain under a large one.

#include <array>
#include <cmath>

#include <silt/boundary/domain.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/core/random.hpp>
#include <silt/io/observers.hpp>
#include <silt/simulation.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace packed_rows {

using namespace silt;

constexpr double g = 9.81;  // [m/s2]

Contacts<HertzMindlin> hertz(double modulus, double e, double friction = 0) {
  return Contacts<HertzMindlin>{
      {.youngs_modulus = modulus, .poisson_ratio = 0.3, .restitution = e, .friction = friction}};
}
/// k_H [N/m^1.5] of a pair or, with R_eff = radius, of a sphere on a wall.
double stiffness(double modulus, double R_eff) {
  return hertz_stiffness(effective_modulus(modulus, 0.3, modulus, 0.3), R_eff);
}
/// The overlap [m] under a load [N].
double overlap_under(double load, double kH) { return std::pow(load / kH, 2.0 / 3.0); }

template <class Sim>
double kinetic_energy(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k) && std::isfinite(sim.mass(k)))
      sum += 0.5 * sim.mass(k) * dot(sim.velocity(k), sim.velocity(k));
  return sum;
}

// ---- columns ------------------------------------------------------------------------------------

/// Spheres on top of each other, at the exact equilibrium: contact k carries the weight above it.
/// They must stay there.
template <class Precision>
Measures column(int count, double radius, double modulus, int steps) {
  const double m = mass_of(radius, 2500), weight = count * m * g;
  const double on_floor = overlap_under(weight, stiffness(modulus, radius));
  Particles<Sphere> spheres;
  double z = radius - on_floor;
  for (int k = 0; k < count; ++k) {
    spheres.add({.position = {0, 0, z}, .radius = radius, .density = 2500});
    z += 2 * radius - overlap_under((count - 1 - k) * m * g, stiffness(modulus, radius / 2));
  }
  const double top = spheres[spheres.size() - 1].position.z;
  const auto contacts = hertz(modulus, 0.5, 0.5);
  Simulation sim{std::move(spheres), contacts, Precision{}};
  sim.gravity = {0, 0, -g};
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
  sim.threads = 1;
  sim.run(0);
  sim.run(steps * sim.step_length());
  double sideways = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sideways = std::max(sideways, std::hypot(sim.position(k).x, sim.position(k).y));
  const double first = radius - sim.position(sim.find(0)).z;
  const double last = sim.position(sim.find(static_cast<std::uint32_t>(count - 1))).z;
  // Equilibrium is an exact solution: motion is rounding, of float forces in mixed precision.
  const double rounding = std::is_same_v<Precision, Mixed> ? 1e-5 : 1e-9;
  return {{"load of the floor", std::abs(-sim.wall(0).force.z / weight - 1), rounding},
          {"lowest overlap", std::abs(first / on_floor - 1), rounding},
          {"height", std::abs(last / top - 1), rounding},
          {"sideways over radius", sideways / radius, rounding},
          {"kinetic energy", kinetic_energy(sim) / (weight * on_floor), rounding}};
}

/// Spheres that fall into a narrow shaft, 10 m tall, and come to rest there.
Measures shaft(double modulus) {
  const double radius = 0.02, width = 0.1, height = 10, e = 0.2;
  const auto contacts = hertz(modulus, e, 0.5);
  Particles<Sphere> spheres;
  spheres.fill({.min = {0, 0, 0}, .max = {width, width, height}},
               {.radius = uniform(0.9 * radius, radius), .density = 2500, .gap = 0.0002});
  Simulation sim{std::move(spheres), contacts};
  sim.gravity = {0, 0, -g};
  sim.add_wall(box({0, 0, 0}, {width, width, height + 1}), contacts.material(0));
  const auto count = sim.size();
  sim.threads = 1;
  sim.run(1.5);
  double weight = 0, lost = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d p = sim.position(k);
    weight += sim.mass(k) * g;
    lost += p.x < 0 || p.y < 0 || p.z < 0 || p.x > width || p.y > width || p.z > height;
  }
  lost += static_cast<double>(count - sim.size());
  const double per_grain = weight / static_cast<double>(count) * radius;
  return {{"lost grains", lost, 0},
          {"load of the walls", std::abs(-sim.wall(0).force.z / weight - 1), 0.01},
          {"kinetic energy", kinetic_energy(sim) / static_cast<double>(count) / per_grain, 1e-3}};
}

// ---- packings that overlap at the start ---------------------------------------------------------

struct Lattice {
  Particles<Sphere> spheres;
  double contacts;  // [-] number of touching pairs
};

/// n^3 cells of a face-centred cubic lattice whose neighbours overlap by `overlap` of the radius.
Lattice lattice(int n, double radius, double overlap, bool repeats) {
  const double a = (2 - overlap) * radius * std::sqrt(2.0);  // [m] edge of a cell
  const std::array<Vec3d, 4> basis{Vec3d{0, 0, 0}, Vec3d{a / 2, a / 2, 0}, Vec3d{a / 2, 0, a / 2},
                                   Vec3d{0, a / 2, a / 2}};
  Lattice out{{}, 0};
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z)
        for (const Vec3d& b : basis)
          out.spheres.add(
              {.position = Vec3d{x * a, y * a, z * a} + b, .radius = radius, .density = 2500});
  if (repeats) {
    out.contacts = 6.0 * static_cast<double>(out.spheres.size());
    return out;
  }
  for (const auto& p : out.spheres)
    for (const auto& q : out.spheres)
      out.contacts += &p < &q && norm(p.position - q.position) < 2 * radius;
  return out;
}

/// silt's choice of the time step [s] for two spheres that meet at 1 m/s.
double chosen_step(double modulus, double radius, double speed) {
  return hertz_contact_time(effective_modulus(modulus, 0.3, modulus, 0.3), radius / 2,
                            mass_of(radius, 2500) / 2, speed) /
         20;
}

/// Spheres that overlap at the start separate: with e = 1 the stored energy becomes kinetic, with
/// less it may not exceed that. `share` [-]: the time step over silt's choice for the speed of
/// separation.
Measures released(double overlap, double e, double share) {
  const double radius = 1e-3, modulus = 1e7;
  auto [spheres, count] = lattice(4, radius, overlap, false);
  const double n = static_cast<double>(spheres.size());
  const double stored =
      count * 0.4 * stiffness(modulus, radius / 2) * std::pow(overlap * radius, 2.5);
  const double speed = std::sqrt(2 * stored / (n * mass_of(radius, 2500)));
  Simulation sim{std::move(spheres), hertz(modulus, e)};
  sim.threads = 1;
  sim.guard.max_overlap = 0.35;
  sim.time_step = share * chosen_step(modulus, radius, speed);
  sim.run(40 * radius / speed);
  Vec3d momentum{0, 0, 0};
  double size = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    momentum += sim.mass(k) * sim.velocity(k);
    size += sim.mass(k) * norm(sim.velocity(k));
  }
  const double energy = kinetic_energy(sim) / stored;
  return {{e == 1 ? "energy" : "energy gained",
           e == 1 ? std::abs(energy - 1) : std::max(energy - 1, 0.0), 0.02},
          {"momentum", norm(momentum) / size, 1e-12}};
}

/// A compressed lattice in a periodic box, e = 1, no friction: small motions keep their energy.
/// `share` [-]: the time step over the limit of the guard for their speed.
Measures pressed(double overlap, double share, double lifted_to) {
  const double radius = 1e-3, modulus = 1e8, speed = 0.01;
  auto [spheres, count] = lattice(4, radius, overlap, true);
  const double side = 4 * (2 - overlap) * radius * std::sqrt(2.0);
  Random random(1);
  for (std::size_t k = 0; k < spheres.size(); ++k)
    spheres[k].velocity =
        speed / std::sqrt(3.0) *
        Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  const double kH = stiffness(modulus, radius / 2);
  const PeriodicBox repeats{{{0, 0, 0}, {side, side, side}}, {true, true, true}};
  Simulation sim{std::move(spheres), hertz(modulus, 1), repeats};
  sim.threads = 1;
  sim.time_step = share * 20.0 / 8.0 * chosen_step(modulus, radius, speed);
  if (lifted_to > 0) sim.guard.max_time_step = lifted_to;
  const auto energy = [&](const auto& s) {
    double stored = 0;
    for (std::size_t i = 0; i < s.rows(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3d d = repeats.shortest(s.position(i) - s.position(j));
        if (const double depth = 2 * radius - norm(d); depth > 0)
          stored += 0.4 * kH * std::pow(depth, 2.5);
      }
    return stored + kinetic_energy(s);
  };
  // In a leapfrog step the energy oscillates by up to (omega dt)^2/4, but its mean must stay.
  double early = 0, late = 0, kinetic = kinetic_energy(sim);
  const double dt = *sim.time_step;
  const auto add = [&](double& sum) {
    return at(every(4 * dt), [&](const auto& s) { sum += energy(s) / 26; });
  };
  sim.run(100 * dt, add(early));
  sim.run(400 * dt);
  sim.run(100 * dt, add(late));
  return {{"energy over that of motion", std::abs(late - early) / kinetic, 0.1}};
}

// ---- a fine grain under a large one -------------------------------------------------------------

/// A large sphere rests on a small one, both at the exact equilibrium. `weight` [-]: of the large
/// one over that at its own density.
Measures squeezed(double ratio, double density_ratio, double modulus, double share) {
  const double small = 1e-4, large = ratio * small, density = 2500;
  const double mass = mass_of(large, density * density_ratio), light = mass_of(small, density);
  const double load = mass * g;
  const double below = overlap_under(load + light * g, stiffness(modulus, small));
  const double above = overlap_under(load, stiffness(modulus, effective_radius(small, large)));
  Particles<Sphere> spheres;
  spheres.add({.position = {0, 0, small - below}, .radius = small, .density = density});
  spheres.add({.position = {0, 0, 2 * small - below - above + large},
               .radius = large,
               .density = density * density_ratio});
  const auto contacts = hertz(modulus, 0.5, 0.5);
  Simulation sim{std::move(spheres), contacts};
  sim.gravity = {0, 0, -g};
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
  sim.threads = 1;
  sim.run(0);
  if (share > 0) {
    sim.time_step = 0.999 * share * sim.step_length() * 20 / 8;
    sim.guard.max_time_step = std::max(1.0, share) / 8;
  }
  sim.run(20000 * sim.step_length());
  const double now = small - sim.position(sim.find(0)).z;
  return {{"overlap", std::abs(now / below - 1), 1e-6},
          {"load of the floor", std::abs(-sim.wall(0).force.z / (load + light * g) - 1), 1e-6},
          {"kinetic energy", kinetic_energy(sim) / (load * below), 1e-6}};
}

/// Two plates slowly compress a grain, at `speed` [m/s], to `depth` of its radius on either side. e
/// = 1: only the method can add or remove energy. `share`: as above, for the speed of the plates.
Measures slow_press(double modulus, double speed, double depth, double share) {
  const double radius = 1e-3;
  Particles<Sphere> spheres;
  spheres.add({.position = {0, 0, radius}, .radius = radius, .density = 2500});
  const auto contacts = hertz(modulus, 1, 0.5);
  Simulation sim{std::move(spheres), contacts};
  sim.threads = 1;
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0), translation({0, 0, speed / 2}));
  sim.add_wall(Plane{{0, 0, 2 * radius}, {0, 0, -1}}, contacts.material(0),
               translation({0, 0, -speed / 2}));
  sim.time_step = share * 20.0 / 8.0 * chosen_step(modulus, radius, speed);
  const double duration = 2 * depth * radius / speed;
  sim.run(duration);
  const double expected = stiffness(modulus, radius) * std::pow(depth * radius, 1.5);
  // The plates continue for part of a step.
  const double slack = 4 * sim.step_length() * speed / (depth * radius);
  return {{"force on the lower plate", std::abs(-sim.wall(0).force.z / expected - 1), 1e-3 + slack},
          {"speed over that of the plates", norm(sim.velocity(0)) / speed, 0.5}};
}

}  // namespace packed_rows

void packed(Table& table) {
  using namespace packed_rows;
  table.scene(
      "Columns 10 m tall: spheres on top of each other, at rest",
      "they stay there: loads, overlaps and height as the sum of Hertz contacts, to rounding");
  const int steps = table.quick ? 1000 : 10000;
  table.stops("1000 of 10 mm, E = 1e+06 Pa", "guard.max_overlap",
              [&] { return column<Double>(1000, 5e-3, 1e6, steps); });
  for (const double modulus : {1e7, 1e9, 2e11})
    table.row(text("1000 of 10 mm, E = ", modulus, " Pa"), Setting::Tame,
              [&] { return column<Double>(1000, 5e-3, modulus, steps); });
  table.row("1000 of 10 mm, E = 1e+07 Pa, mixed", Setting::Tame,
            [&] { return column<Mixed>(1000, 5e-3, 1e7, steps); });
  table.row("10000 of 1 mm, E = 1e+08 Pa", Setting::Tame,
            [&] { return column<Double>(10000, 5e-4, 1e8, steps / 10); });
  if (!table.quick) {
    table.scene("A shaft 10 m tall and 0.1 m wide fills and comes to rest",
                "none lost, the walls bear the weight within 1 %, no motion left after 1.5 s");
    table.stops("40 mm spheres, E = 1e+07 Pa", "guard.max_overlap", [&] { return shaft(1e7); });
    table.row("40 mm spheres, E = 1e+08 Pa", Setting::Tame, [&] { return shaft(1e8); });
  }

  table.scene("A packing that overlaps at the start flies apart (365 spheres of a lattice)",
              "the energy of motion is what the overlaps had stored, within 2 %; e < 1: no more");
  for (const double overlap : {0.01, 0.1, 0.3, 0.5})
    for (const double e : {1.0, 0.3})
      for (const double share : {1.0, 2.0, 4.0}) {
        const auto run = [&] { return released(overlap, e, share); };
        const std::string name =
            text("overlap ", overlap, " of the radius, e = ", e, ", step x ", share);
        if (overlap > 0.35)
          table.stops(name, "guard.max_overlap = 0.35", run);
        else
          table.row(name, share == 1 ? Setting::Tame : Setting::Extreme, run);
      }

  table.scene(
      "A pressed lattice trembles at 0.01 m/s (256 spheres, 12 contacts each, e = 1)",
      "the mean energy of 100 steps kept within 10 % of that of the motion, over 500 steps");
  for (const double overlap : {1e-4, 0.01, 0.1})
    for (const double share : {0.1, 0.4, 1.0, 2.0, 4.0, 10.0}) {
      const bool lifted = share > 1;
      table.row(
          text("overlap ", overlap, ", step ", share, " of the limit", lifted ? ", lifted" : ""),
          share < 0.3 || (share < 0.5 && overlap < 0.1) ? Setting::Tame : Setting::Extreme,
          [&] { return pressed(overlap, 0.999 * share, lifted ? 100 : 0); });
    }

  table.scene("A fine grain carries a large one: size ratio 1:100, mass ratio 1e6 and more",
              "both stay at the rest that is known, within 1e-6, over 20 000 steps");
  for (const double density_ratio : {1.0, 10.0, 1000.0})
    for (const double modulus : {1e9, 2e11})
      for (const double share : {0.0, 1.0, 2.0, 5.0}) {
        const auto run = [&] { return squeezed(100, density_ratio, modulus, share); };
        const std::string name =
            text("mass ratio ", 1e6 * density_ratio, ", E = ", modulus, " Pa, step ",
                 share > 0 ? text(share, " of the limit") : "chosen");
        // At 1e9 the small one is crushed, or too stiff for the step of an impact.
        if (density_ratio > 100)
          table.stops(name, modulus < 1e10 ? "guard.max_overlap" : "are too stiff", run);
        else
          table.row(name, share == 0 ? Setting::Tame : Setting::Extreme, run);
      }

  table.scene("Two plates press a grain slowly to 10 % of its radius",
              "force as Hertz, no motion of the grain but the plates'");
  for (const double speed : {0.1, 0.01, 0.001})
    for (const double share : {0.4, 1.0})
      table.row(text(speed, " m/s, step ", share, " of the limit"),
                share < 0.5 && speed > 5e-3 ? Setting::Tame : Setting::Extreme,
                [&] { return slow_press(1e8, speed, 0.1, 0.999 * share); });
}

}  // namespace stability
