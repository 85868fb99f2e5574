// silt - BSD-3-Clause, see LICENSE
// Cohesion from a fraction of the weight to orders of magnitude above it.

#include <cmath>

#include <silt/contact/adhesion.hpp>
#include <silt/contact/cohesion/van_der_waals.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/jkr.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace sticky_rows {

using namespace silt;

constexpr double g = 9.81, radius = 20e-6, density = 2500;  // [m/s2], [m], [kg/m3]
constexpr double modulus = 1e7;                             // [Pa]

AdhesivePair with_wall(double work) {
  return {effective_modulus(modulus, 0.3, modulus, 0.3), radius, work};
}
/// The work of adhesion [J/m2] whose pull-off force at a wall is `ratio` times the weight.
double work_for(double ratio) {
  return ratio * mass_of(radius, density) * g / jkr_pull_off(with_wall(1));
}
Contacts<Jkr> jkr(double work, double e) { return Contacts<Jkr>{{modulus, 0.3, work, e, 0.5}}; }

/// A sphere hangs from a ceiling at the overlap without load; its weight lowers it slightly. With a
/// pull-off force below its weight it falls.
template <class Precision>
Measures hangs(double ratio, double share) {
  const double m = mass_of(radius, density);
  const auto pair = with_wall(work_for(ratio));
  const double depth = jkr_overlap_at_rest(pair);
  const auto contacts = jkr(work_for(ratio), 0.3);
  Particles<Sphere> spheres;
  spheres.add({.position = {0, 0, -radius + depth}, .radius = radius, .density = density});
  Simulation sim{std::move(spheres), contacts, Precision{}};
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, -1}}, contacts.material(0));
  sim.gravity = {0, 0, -g};
  sim.threads = 1;
  if (share > 0) {
    sim.run(0);
    sim.time_step = 0.999 * share * sim.step_length() * 20 / 8;
  }
  sim.run(2e-2);
  const double now = sim.position(0).z + radius, speed = std::abs(sim.velocity(0).z);
  if (ratio < 1) return {{"fall", std::abs(speed / (g * sim.time()) - 1), 0.1}};
  // The stiffness there is above E* a: the weight lowers it by less than m g/(E* a).
  const double sag = m * g / (pair.E_eff * jkr_radius_at_rest(pair));
  Measures out{{"load of the ceiling", std::abs(-sim.wall(0).force.z / (m * g) - 1),
                // Rounding of attraction and repulsion, which are `ratio` times the weight.
                (std::is_same_v<Precision, Mixed> ? 3e-7 : 1e-12) * ratio + 1e-3},
               {"energy", 0.5 * m * speed * speed / jkr_energy_loss(pair), 1e-6}};
  if (ratio > 10) out.push_back({"overlap", std::abs(now - depth) / depth, sag / depth + 1e-5});
  return out;
}

/// A sphere hits a plane at `over` times its sticking speed, e = 1 except for adhesion. The force
/// jumps at attachment (to 8/9 of the pull-off force) and at separation (from 5/9). Each may be one
/// step late: an energy error of 13/9 F v dt; plus leapfrog's own error.
template <class Precision>
Measures sticks(double ratio, double over) {
  const double m = mass_of(radius, density), work = work_for(ratio);
  const auto pair = with_wall(work);
  const double speed = over * jkr_sticking_speed(pair, m), energy = 0.5 * m * speed * speed;
  const auto contacts = jkr(work, 1);
  double worst = 0, bound = 0;
  for (int phase = 0; phase < 8; ++phase) {
    const double gap = 0.01 * (1 + 0.37 * phase) * radius;
    Particles<Sphere> spheres;
    spheres.add({.position = {0, 0, radius + gap},
                 .radius = radius,
                 .density = density,
                 .velocity = {0, 0, -speed}});
    Simulation sim{std::move(spheres), contacts, Precision{}};
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
    sim.threads = 1;
    const double contact = hertz_contact_time(pair.E_eff, radius, m, speed);
    sim.run(gap / speed + 30 * contact);
    const double n = contact / sim.step_length(), v = sim.velocity(0).z;
    const bool is_off = sim.position(0).z > radius - 3 * jkr_overlap_at_parting(pair);
    const double lost = jkr_energy_loss(pair) / energy;  // [-] of a rebound
    worst = std::max(worst, over > 1 ? std::abs(0.5 * m * v * v / energy - (1 - lost)) : is_off);
    bound = 13.0 / 9 * jkr_pull_off(pair) * speed * sim.step_length() / energy + 3.8 / (n * n);
  }
  return {{over > 1 ? "energy" : "let go", worst, over > 1 ? bound : 0}};
}

/// Sticky grains collide in a crowd: they must come to rest as a lump, without gaining energy.
template <class Law>
Measures lump(const Contacts<Law>& contacts, double speed) {
  Particles<Sphere> spheres;
  const double side = 9 * radius;
  spheres.fill({.min = {0, 0, 0}, .max = {side, side, side}},
               {.radius = uniform(0.8 * radius, radius),
                .density = density,
                .count = 60,
                .arrangement = Arrangement::Random});
  const Vec3d middle{side / 2, side / 2, side / 2};
  for (std::size_t k = 0; k < spheres.size(); ++k)
    spheres[k].velocity = speed / (side / 2) * (middle - spheres[k].position);
  Simulation sim{std::move(spheres), contacts};
  sim.threads = 1;
  const auto energy = [&] {  // [J] of the motion about the common centre
    double sum = 0, mass = 0;
    Vec3d momentum{0, 0, 0};
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      sum += 0.5 * sim.mass(k) * dot(sim.velocity(k), sim.velocity(k));
      momentum += sim.mass(k) * sim.velocity(k), mass += sim.mass(k);
    }
    return sum - 0.5 * dot(momentum, momentum) / mass;
  };
  const double before = energy();
  sim.run(side / speed);
  const double early = energy();
  sim.run(side / speed);
  return {{"energy at the end", energy() / before, 0.1},
          {"energy gained meanwhile", std::max(energy() / early - 1, 0.0), 0.01}};
}

/// A sphere hits a plane that attracts it before touch, e = 1: it returns at the same speed.
Measures attracted(double ratio, double speed) {
  using Law = Cohesive<HertzMindlin, VanDerWaals>;
  const double m = mass_of(radius, density), closest = 1e-8;
  const double hamaker = ratio * m * g * 6 * closest * closest / radius;  // F = A R/(6 h0^2)
  const typename Law::Material dust{{modulus, 0.3, 1.0, 0.3},
                                    {.hamaker = hamaker, .closest = closest, .cutoff = 1e-6}};
  const Contacts<Law> contacts{dust};
  const double start = 1.1e-6;  // [m] out of the range
  Particles<Sphere> spheres;
  spheres.add({.position = {0, 0, radius + start},
               .radius = radius,
               .density = density,
               .velocity = {0, 0, -speed}});
  Simulation sim{std::move(spheres), contacts};
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, dust);
  sim.threads = 1;
  sim.run(2.5 * start / speed + 3 * hertz_contact_time(with_wall(0).E_eff, radius, m, speed));
  return {{"speed", std::abs(sim.velocity(0).z / speed - 1), 0.01}};
}

}  // namespace sticky_rows

void sticky(Table& table) {
  using namespace sticky_rows;
  table.scene("A grain of 40 um hangs from a ceiling by JKR adhesion, over its weight",
              "at the overlap of JKR's theory, without motion; below 1 it falls freely");
  for (const double ratio : {0.5, 1.2, 1e2, 1e4, 1e6})
    for (const double share : {0.0, 1.0}) {
      const auto run = [&] { return hangs<Double>(ratio, share); };
      const std::string name = text("pull-off ", ratio, " weights, ",
                                    share > 0 ? "step at the limit" : "step as chosen");
      if (ratio > 1e5)  // JKR's overlap at rest is 0.36 of the radius
        table.stops(name, "guard.max_overlap", run);
      else
        table.row(name, share > 0 ? Setting::Extreme : Setting::Tame, run);
    }
  for (const double ratio : {1e2, 1e4})
    table.row(text("pull-off ", ratio, " weights, mixed precision"), Setting::Tame,
              [&] { return hangs<Mixed>(ratio, 0); });

  table.scene(
      "It hits a plane, e = 1 but for the adhesion (pull-off 1e4 weights)",
      "below the sticking speed v_s it stays, above it leaves with the energy of v^2 - v_s^2 but "
      "for\n          13/9 F v dt + 3.8/n^2 (force jumps as it attaches and lets go)");
  for (const double over : {0.1, 0.5, 0.9, 1.1, 2.0, 10.0})
    table.row(text(over, " of the sticking speed"), Setting::Tame,
              [&] { return sticks<Double>(1e4, over); });
  table.row("2 of the sticking speed, mixed precision", Setting::Tame,
            [&] { return sticks<Mixed>(1e4, 2); });

  table.scene("60 sticky grains fly together",
              "they end as a lump: below 10 % of the energy of motion, and it does not grow");
  for (const double ratio : {1e2, 1e4, 1e5})
    for (const double speed : {0.1, 1.0})
      table.row(text("JKR, pull-off ", ratio, " weights, ", speed, " m/s"), Setting::Tame,
                [&] { return lump(jkr(work_for(ratio), 0.3), speed); });

  table.scene("Van der Waals attraction over the weight, e = 1",
              "it comes back as fast as it came, within 1 %");
  for (const double ratio : {1.0, 1e2, 1e4})
    for (const double speed : {0.01, 0.1, 1.0})
      table.row(text(ratio, " weights, ", speed, " m/s"),
                // 1e4 times the weight accelerates it to 0.01 m/s more than the step was chosen
                // for.
                ratio < 1e3 || speed > 0.05 ? Setting::Tame : Setting::Extreme,
                [&] { return attracted(ratio, speed); });
}

}  // namespace stability
