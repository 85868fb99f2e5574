// silt - BSD-3-Clause, see LICENSE
// Breakage: strengths near zero, many breakages in a corner, fragments of unequal sizes under a
// piston.

#include <algorithm>
#include <cmath>
#include <vector>

#include <silt/breakage/breakage.hpp>
#include <silt/breakage/equivalence.hpp>
#include <silt/breakage/sizes.hpp>
#include <silt/breakage/strength.hpp>
#include <silt/contact/hertz_mindlin.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace breakage_rows {

using namespace silt;

constexpr double radius = 1e-3, density = 2500;  // [m], [kg/m3]

HertzMindlin::Material solid(double modulus, double e) {
  return {.youngs_modulus = modulus, .poisson_ratio = 0.3, .restitution = e, .friction = 0.3};
}
/// One strength [N] for all sizes.
auto policy(double strength, BreakageRules rules) {
  return Breakage{LogLogisticStrength{strength, 2 * radius, 0, 50}, HertzEquivalence{},
                  GaudinSchuhmann{1, 0.8}, std::move(rules)};
}
auto scene(double modulus, double e, double strength, BreakageRules rules) {
  Simulation sim{Particles<Sphere>{}, Contacts<HertzMindlin>{solid(modulus, e)}, EnergyLedger{},
                 policy(strength, std::move(rules))};
  sim.threads = 1;
  return sim;
}
/// Energy of unknown origin, over that at the start; the energies from separating fragments and
/// lost with dust are known.
template <class Sim>
double gained(const Sim& sim, double start) {
  const auto e = sim.energy();
  return (e.kinetic() + e.elastic() - start - e.walls - e.openings - e.parting) / start;
}
/// The ledger's error is quadratic in the step: with 20 steps per impact up to 0.6 % at e = 0.3.
template <class Sim>
Measures judged(const Sim& sim, double start, double behind) {
  const auto m = sim.mass_balance();
  const auto e = sim.energy();
  return {{"mass", std::abs(m.residual()) / m.fed, 1e-12},
          {"energy gained", std::max(gained(sim, start), 0.0), 1e-3},
          {"ledger", std::abs(e.residual()) / (start + e.parting), 2e-2},
          {"behind a wall", behind, 0}};
}
template <class Sim>
double start_of(Sim& sim) {
  sim.run(0);
  return sim.energy().kinetic() + sim.energy().elastic();
}

/// Grains hit a corner of three planes and break at every contact, repeatedly.
Measures corner(double speed, double modulus, double e, double strength) {
  auto sim = scene(modulus, e, strength, {.dust_below = 0.3 * radius, .most_fragments = 20});
  Particles<Sphere> grains;
  for (int k = 0; k < 27; ++k)
    grains.add({.position = {(1.1 + 2.1 * (k % 3)) * radius, (1.1 + 2.1 * (k / 3 % 3)) * radius,
                             (1.1 + 2.1 * (k / 9)) * radius},
                .radius = radius,
                .density = density,
                .velocity = {-0.5 * speed, -0.6 * speed, -0.6 * speed},
                .angular_velocity = {speed / radius, 0, -speed / radius}});
  sim.add(grains);
  for (const Vec3d& n : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
    sim.add_wall(Plane{{0, 0, 0}, n}, solid(modulus, e));
  const double start = start_of(sim);
  sim.run(4 * radius / speed);
  double behind = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) {
      const Vec3d x = sim.position(k);
      behind += std::min({x.x, x.y, x.z}) < 0;
    }
  return judged(sim, start, behind);
}

/// All grains of a block that touches three walls break in one step.
Measures burst(int side, std::size_t fragments, double separation) {
  auto sim = scene(
      1e9, 0.5, 1e6,
      {.dust_below = 0.1 * radius, .most_fragments = fragments, .separation_speed = separation});
  Particles<Sphere> grains;
  for (int k = 0; k < side * side * side; ++k)
    grains.add({.position = {(1 + 2 * (k % side)) * radius, (1 + 2 * (k / side % side)) * radius,
                             (1 + 2 * (k / side / side)) * radius},
                .radius = radius,
                .density = density,
                .velocity = {0, 0, -0.1}});
  sim.add(grains);
  for (const Vec3d& n : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
    sim.add_wall(Plane{{0, 0, 0}, n}, solid(1e9, 0.5));
  const double start = start_of(sim);
  for (ParticleId id = 0; id < static_cast<ParticleId>(side * side * side); ++id)
    sim.break_particle(id);
  sim.run(400 * sim.step_length());
  double behind = 0, fastest = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) {
      const Vec3d x = sim.position(k);
      behind += std::min({x.x, x.y, x.z}) < 0;
      fastest = std::max(fastest, norm(sim.velocity(k)));
    }
  auto all = judged(sim, start, behind);
  // 2 m* v^2 from each of about twenty pairs of a light fragment with heavy ones: 2 v sqrt(20).
  all.push_back({"fastest", fastest / (0.1 + separation), 9});
  return all;
}

/// Grains that have broken into fragments of sizes up to 1:`ratio` are compressed by a piston that
/// moves down by a tenth of their height.
Measures piston(double ratio, double modulus) {
  auto sim = scene(modulus, 0.5, 1e6, {.dust_below = 2 * radius / ratio, .most_fragments = 30});
  Particles<Sphere> grains;
  for (int k = 0; k < 8; ++k)
    grains.add({.position = {(1 + 2 * (k % 2)) * radius, (1 + 2 * (k / 2 % 2)) * radius,
                             (1 + 2 * (k / 4)) * radius},
                .radius = radius,
                .density = density});
  sim.add(grains);
  for (const auto& [p, n] : {std::pair{Vec3d{0, 0, 0}, Vec3d{1, 0, 0}},
                             {Vec3d{4 * radius, 0, 0}, Vec3d{-1, 0, 0}},
                             {Vec3d{0, 0, 0}, Vec3d{0, 1, 0}},
                             {Vec3d{0, 4 * radius, 0}, Vec3d{0, -1, 0}},
                             {Vec3d{0, 0, 0}, Vec3d{0, 0, 1}}})
    sim.add_wall(Plane{p, n}, solid(modulus, 0.5));
  const double speed = 1;  // [m/s]
  sim.add_wall(Plane{{0, 0, 4 * radius}, {0, 0, -1}}, solid(modulus, 0.5),
               translation({0, 0, -speed}));
  sim.run(0);
  for (ParticleId id = 0; id < 8; ++id) sim.break_particle(id);
  sim.run(0.4 * radius / speed);
  const auto e = sim.energy();
  const auto m = sim.mass_balance();
  double behind = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) behind += sim.position(k).z < 0 || sim.position(k).z > 4 * radius;
  return {{"mass", std::abs(m.residual()) / m.fed, 1e-12},
          {"ledger", std::abs(e.residual()) / (e.walls + e.parting), 2e-2},
          {"behind a wall", behind, 0}};
}

}  // namespace breakage_rows

void breakage(Table& table) {
  using namespace breakage_rows;
  table.scene("Grains with strengths near zero fly into a corner",
              "mass is kept, no energy comes from nowhere, none is behind a wall");
  for (const double strength : {1e-12, 1e-3})
    for (const double e : {0.9, 0.3})
      for (const double speed : {0.1, 10.0, 100.0})
        table.row(text(speed, " m/s, E = ", 1e8 * std::max(1.0, speed * speed), " Pa, e = ", e,
                       ", strength ", strength, " N"),
                  speed > 1 ? Setting::Extreme : Setting::Tame,
                  [&] { return corner(speed, 1e8 * std::max(1.0, speed * speed), e, strength); });

  table.scene("A block of grains in a corner bursts in one step",
              "mass is kept, nothing is faster than the parting allows");
  for (const double separation : {0.0, 0.1, 1.0})
    for (const int side : table.quick ? std::vector{4} : std::vector{4, 10})
      for (const std::size_t fragments : {10, 100})
        table.row(text(side * side * side, " grains, up to ", fragments,
                       " fragments each, part at ", separation, " m/s"),
                  Setting::Tame, [&] { return burst(side, fragments, separation); });

  table.scene("A piston presses what eight grains have burst into, by a tenth",
              "mass is kept, the ledger closes, none is behind a wall");
  for (const double ratio : table.quick ? std::vector{5.0, 20.0} : std::vector{5.0, 20.0, 100.0})
    table.row(text("1:", ratio), Setting::Extreme, [&] { return piston(ratio, 1e9); });
}

}  // namespace stability
