// silt - BSD-3-Clause, see LICENSE
// Friction from 0 to 2, rolling and twisting resistance.

#include <cmath>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/contact/rolling/twisting.hpp>
#include <silt/io/observers.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace rough_rows {

using namespace silt;
using Rolling = Both<RollingEpsd, Twisting>;
using Rough = Contacts<HertzMindlin, Rolling>;

constexpr double g = 9.81, radius = 1e-3, density = 2500;  // [m/s2], [m], [kg/m3]
constexpr double modulus = 1e8, poisson = 0.2;

struct Resistance {
  double friction, rolling, twisting;  // [-]
  double damping = 0.3;                // [-] of rolling and twisting, over the critical one
};

Rough rough(double e, const Resistance& r) {
  return {{modulus, poisson, e, r.friction}, {{r.rolling, r.damping}, {r.twisting, r.damping}}};
}

template <class Sim>
double kinetic_energy(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d v = sim.velocity(k), w = sim.angular_velocity(k);
    sum += sim.mass(k) * (0.5 * dot(v, v) + 0.2 * sim.radius(k) * sim.radius(k) * dot(w, w));
  }
  return sum;
}

template <class ContactsType>
auto thrown(const ContactsType& contacts, const Vec3d& velocity, const Vec3d& spin, double height) {
  Particles<Sphere> spheres;
  spheres.add({.position = {0, 0, radius + height},
               .radius = radius,
               .density = density,
               .velocity = velocity,
               .angular_velocity = spin});
  Simulation sim{std::move(spheres), contacts};
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
  sim.threads = 1;
  return sim;
}

/// A sphere without spin hits a plane at 45 to 87 degrees: gross sliding where v_t > 3.5 mu (1 + e)
/// v_n, otherwise it may stick; energy never increases.
Measures oblique(double friction, double tangential, double normal) {
  const double e = 0.5;
  const Contacts<HertzMindlin> contacts{{modulus, poisson, e, friction}};
  auto sim = thrown(contacts, {tangential, 0, -normal}, {0, 0, 0}, 0.01 * radius);
  const double before = kinetic_energy(sim);
  const double contact = hertz_contact_time(effective_modulus(modulus, poisson, modulus, poisson),
                                            radius, sim.mass(0), normal);
  sim.run(0.01 * radius / normal + 4 * contact);
  const double n = contact / sim.step_length();
  const double bound = rebound_bound(damping_ratio(e, DampingEnd::ZeroForce), n);
  // The lever arm of the friction is the radius minus the overlap.
  const double arm = sim.peak_overlap();
  Measures out{{"energy gained", std::max(kinetic_energy(sim) / before - 1, 0.0), 1e-9}};
  if (tangential > 3.5 * friction * (1 + e) * normal) {
    const double lost = friction * (1 + e) * normal;  // [m/s]
    const double spin = radius * sim.angular_velocity(0).y;
    out.push_back({"tangential speed", std::abs(tangential - sim.velocity(0).x - lost) / normal,
                   std::max(friction * e * bound, 1e-9)});
    out.push_back({"spin", std::abs(spin - 2.5 * lost) / normal,
                   std::max(2.5 * friction * (e * bound + (1 + e) * arm), 1e-9)});
  }
  return out;
}

/// A sphere slides on a plane until it rolls: then at 5/7 of its speed, for any friction.
Measures sliding(double friction) {
  const double v = 0.5, m = mass_of(radius, density);
  const Contacts<HertzMindlin> contacts{{modulus, poisson, 0.5, friction}};
  const double kH = hertz_stiffness(effective_modulus(modulus, poisson, modulus, poisson), radius);
  auto sim = thrown(contacts, {v, 0, 0}, {0, 0, 0}, -std::pow(m * g / kH, 2.0 / 3.0));
  sim.gravity = {0, 0, -g};
  sim.run(friction > 0 ? 1.5 * 2 * v / (7 * friction * g) : 0.05);
  const double expected = friction > 0 ? 5.0 / 7 * v : v;
  return {{"speed", std::abs(sim.velocity(0).x / expected - 1), 1e-3}};
}

/// silt's choice of the time step, or the limit of the guard.
template <class Sim>
void set_step(Sim& sim, bool at_limit) {
  sim.run(0);
  if (at_limit) sim.time_step = 0.999 * sim.step_length() * 20 / 8;
}

/// A sphere with a general velocity and spin comes to rest, and its energy never exceeds the
/// initial one.
Measures comes_to_rest(const Resistance& r, bool at_limit) {
  const double m = mass_of(radius, density);
  auto sim = thrown(rough(0.3, r), {0.3, 0.1, 0}, {100, -200, 20}, 0.2 * radius);
  sim.gravity = {0, 0, -g};
  set_step(sim, at_limit);
  double highest = 0, last = 0;
  const double first = kinetic_energy(sim) + m * g * sim.position(0).z;
  sim.run(3.0, at(every(1e-4), [&](const auto& s) {
            last = kinetic_energy(s);
            highest = std::max(highest, (last + m * g * s.position(0).z) / first - 1);
          }));
  return {{"energy gained", highest, 1e-3}, {"energy at the end", last / first, 1e-6}};
}

auto heap_of(const Resistance& r, std::size_t count) {
  Particles<Sphere> spheres;
  const double side = 12 * radius;
  spheres.fill({.min = {0, 0, 0}, .max = {side, side, 2 * side}},
               {.radius = uniform(0.8 * radius, radius),
                .density = density,
                .count = count,
                .arrangement = Arrangement::Random});
  const auto contacts = rough(0.3, r);
  Simulation sim{std::move(spheres), contacts};
  sim.gravity = {0, 0, -g};
  sim.add_wall(box({0, 0, 0}, {side, side, 4 * side}), contacts.material(0));
  sim.threads = 1;
  return sim;
}

/// A heap of grains in a box with friction and all resistances: it comes to rest, and stays there.
Measures heap(const Resistance& r, bool at_limit) {
  auto sim = heap_of(r, 150);
  set_step(sim, at_limit);
  sim.run(0.4);
  double weight = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) weight += sim.mass(k) * g;
  return {{"energy over weight times radius", kinetic_energy(sim) / (weight * radius), 1e-6},
          {"load of the walls", std::abs(-sim.wall(0).force.z / weight - 1), 1e-2}};
}

/// The same heap twice, or with two threads: number of differing positions and velocities.
Measures same_bits(int threads) {
  auto a = heap_of({0.5, 0.1, 0.5}, 150), b = heap_of({0.5, 0.1, 0.5}, 150);
  b.threads = threads;
  a.run(0.05), b.run(0.05);
  // Compared, not subtracted: x y - x y is not 0 if the compiler uses a fused multiply-add.
  double differ = 0;
  for (std::uint32_t id = 0; id < 150; ++id) {
    const auto i = a.find(id), j = b.find(id);
    differ += a.position(i) != b.position(j) || a.velocity(i) != b.velocity(j) ||
              a.angular_velocity(i) != b.angular_velocity(j);
  }
  return {{"particles that differ", differ, 0}};
}

}  // namespace rough_rows

void rough(Table& table) {
  using namespace rough_rows;
  table.scene(
      "Friction 0 to 2, oblique impacts",
      "never more energy than before; if it slides throughout: tangential speed and spin as "
      "mu (1 + e) v_n");
  for (const double friction : {0.0, 0.1, 0.5, 1.0, 2.0})
    for (const double tangential : {0.01, 1.0, 30.0})
      table.row(text("friction ", friction, ", ", tangential, " m/s along, 1 m/s down"),
                Setting::Tame, [&] { return oblique(friction, tangential, 1); });
  table.scene("A sphere slides until it rolls", "at 5/7 of its speed then, within 0.1 %");
  for (const double friction : {0.0, 0.05, 0.5, 2.0})
    table.row(text("friction ", friction), Setting::Tame, [&] { return sliding(friction); });

  const auto all = [&](auto run) {
    const auto row = [&](const Resistance& r, bool at_limit) {
      std::string name =
          text("friction ", r.friction, ", rolling ", r.rolling, ", twisting ", r.twisting);
      if (r.damping != 0.3) name += text(", damping ", r.damping);
      table.row(name + (at_limit ? ", step at the limit" : ""),
                r.rolling > 1 || r.damping > 1 || at_limit ? Setting::Extreme : Setting::Tame,
                [&] { return run(r, at_limit); });
    };
    for (const double friction : {0.1, 2.0})
      for (const double rolling : {0.1, 0.5, 1.0, 2.0, 10.0})
        for (const bool at_limit : {false, true})
          if (!table.quick || (rolling != 0.5 && rolling != 1))
            row({friction, rolling, friction}, at_limit);
    for (const double damping : {1.0, 10.0}) row({0.5, 0.5, 0.5, damping}, false);
  };
  table.scene("Friction with resistance to rolling and twisting",
              "no energy gained, at rest after 3 s");
  all(comes_to_rest);
  table.scene("150 grains fall into a box, with friction, rolling and twisting",
              "at rest after 0.4 s: energy of motion below 1e-6 of weight times radius");
  all(heap);
  table.scene("The same heap again", "places and speeds to the last bit");
  table.row("the same program twice", Setting::Tame, [] { return same_bits(1); });
  table.row("one thread and two", Setting::Tame, [] { return same_bits(2); });
}

}  // namespace stability
