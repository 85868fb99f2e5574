// silt - BSD-3-Clause, see LICENSE
// Suspensions with particles from 1e-6 to 1e6 times the density of the liquid.

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <silt/fluid.hpp>

#include "stability/table.hpp"

namespace stability {

namespace light_rows {

using namespace silt;

constexpr double water = 1000, mu = 1e-3, g = 9.81, d = 0.5e-3;  // [kg/m3], [Pa s], [m/s2], [m]

/// A disturbed lattice of spheres in water between a floor and a lid, from rest, with fluid steps
/// of half the relaxation time, or the longest that the flow allows.
template <class... Forces>
Measures crowd(double ratio, double voidage, const Forces&... forces) {
  const int n = 4, layers = 14, steps = 5;
  const double density = ratio * water, V = Sphere::volume(d / 2);
  const double pitch = d * std::cbrt(std::acos(-1.0) / 6 / (1 - voidage)), W = n * pitch,
               H = (layers + 2) * pitch;
  const Box box{{0, 0, 0}, {W, W, H}};
  FlowSolver flow(Grid(box, {4, 4, 16}, {true, true, false}), {water, mu}, {.tolerance = 1e-8});
  Particles<Sphere> grains;
  Random random(1);
  for (int k = 0; k < n * n * layers; ++k) {
    const auto shift = [&] { return 0.1 * (pitch - d) * random.uniform(-1, 1); };
    grains.add({.position = {(k % n + 0.5) * pitch + shift(), (k / n % n + 0.5) * pitch + shift(),
                             (k / (n * n) + 1.5) * pitch + shift()},
                .radius = d / 2,
                .density = density});
  }
  const double law = minimum_fluidisation_velocity(Gidaspow{}, voidage, d, density, water, mu);
  const double K = drag_coefficient(Gidaspow{}, voidage, law * water * d / mu, d, mu);
  const double relaxation = voidage * voidage * (density + water) * V / K;
  constexpr bool added = (false || ... || std::is_same_v<Forces, VirtualMass>);
  const double settling = (added ? 25 : 8) * relaxation;
  // Short enough for the lattice to persist.
  const double longest = (added ? 0.9 : 0.3) * pitch / law;
  const double span = std::min({0.5 * relaxation, 0.9 * flow.stable_step(), longest / 40});
  CoupledFlow fluid{Gidaspow{}, Kernel{}, std::move(flow), forces...};
  fluid.steps = steps;
  // Zero stiffness: only the fluid matters here.
  Simulation sim{std::move(grains), Contacts<HertzMindlin>{{1e-14, 0.3, 0.5, 0.3}},
                 PeriodicBox{box, {true, true, false}}, std::move(fluid)};
  sim.gravity = {0, 0, -g}, sim.time_step = span / steps, sim.threads = 1;
  sim.guard.max_time_step = sim.guard.max_rate = sim.guard.max_overlap = 1e30;
  sim.run(std::min(std::max(settling, 40 * span), longest));
  double mean = 0, fastest = 0, seen = 0;
  int count = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    // The kernel smooths the suspension's ends over some diameters.
    if (std::abs(sim.position(k).z / H - 0.5) > 0.08) continue;
    mean += sim.velocity(k).z, ++count;
    seen += sim.fluid().voidage_at_particles()[k];
    fastest = std::max(fastest, norm(sim.velocity(k)));
  }
  // From the law at the void fraction that the grains see.
  mean *= (ratio < 1 ? 1.0 : -1.0) / count /
          minimum_fluidisation_velocity(Gidaspow{}, seen / count, d, density, water, mu);
  const bool settled = settling < longest;
  Measures all{{"momentum exchanged", sim.fluid().closure().momentum, 1e-12},
               {"largest velocity", fastest / law, 1.3}};
  // Heavy ones are still accelerating, which takes longer than the lattice persists.
  if (settled)
    all.push_back({"velocity", std::abs(mean - 1), 0.05});
  else
    all.push_back({"velocity beyond the final one", mean - 1, 0.05});
  return all;
}

/// 15 % of solids rise in a closed box of water, collect under its lid and come to rest, with fluid
/// steps chosen by silt.
template <class... Forces>
Measures under_lid(double density, double restitution, const Forces&... forces) {
  const int n = 3, layers = 8;
  const double grain = 0.66e-3, V = Sphere::volume(grain / 2);
  const double pitch = std::cbrt(V / 0.15), W = n * pitch, H = 1.5 * layers * pitch;
  const Box box{{0, 0, 0}, {W, W, H}};
  FlowSolver flow(Grid(box, {2, 2, 8}, {true, true, false}), {water, mu});
  Particles<Sphere> grains;
  Random random(1);
  for (int k = 0; k < n * n * layers; ++k) {
    const auto place = [&](int i) { return (i + 0.5 + 0.05 * random.uniform(-1, 1)) * pitch; };
    grains.add({.position = {place(k % n), place(k / n % n), place(k / (n * n))},
                .radius = grain / 2,
                .density = density});
  }
  const HertzMindlin::Material soft{density < 10 ? 1e4 : 1e5, 0.3, restitution, 0.3};
  Simulation sim{std::move(grains), Contacts<HertzMindlin>{soft},
                 PeriodicBox{box, {true, true, false}},
                 CoupledFlow{Gidaspow{}, Kernel{}, std::move(flow), forces...}};
  sim.gravity = {0, 0, -g}, sim.threads = 1;
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, soft);
  const auto lid = sim.add_wall(Plane{{0, 0, H}, {0, 0, -1}}, soft);
  const double law = minimum_fluidisation_velocity(Gidaspow{}, 0.85, grain, density, water, mu);
  const double count = n * n * layers, free = 0.7 * (H - layers * pitch) / law;
  double swing = 0, left = 0;
  while (sim.time() < free) {
    sim.run(free / 20);
    double mean = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k) mean += sim.velocity(k).z / law / count;
    if (sim.time() > 0.15 * free) swing = std::max(swing, std::abs(mean - 1));
  }
  sim.run(0.3 - sim.time());
  for (std::size_t k = 0; k < sim.rows(); ++k) left = std::max(left, norm(sim.velocity(k)) / law);
  const double load = sim.wall(lid).force.z / (count * (water - density) * V * g);
  // Both ends of the packing are looser than its middle.
  return {{"momentum exchanged", sim.fluid().closure().momentum, 1e-12},
          {"velocity while they rise", swing, 0.25},
          {"velocity at rest", left, 1e-3},
          {"load of the lid", std::abs(load - 1), 0.01}};
}

}  // namespace light_rows

void light(Table& table) {
  using namespace light_rows;
  table.scene("Crowds in water, density over that of water by void fraction",
              "the velocity by the balance of drag, weight and pressure within 5 %; momentum of "
              "both to rounding");
  for (const double ratio : {1e-6, 1e-3, 0.02, 0.1, 0.5, 2.0, 1e3, 1e6})
    for (const double voidage : {0.48, 0.6, 0.85, 0.99}) {
      if (table.quick && voidage != 0.85) continue;
      table.row(text("density ratio ", ratio, ", voids ", voidage), Setting::Tame,
                [&] { return crowd(ratio, voidage); });
    }
  for (const double ratio : {1e-6, 0.02, 0.5}) {
    table.row(text("density ratio ", ratio, ", virtual mass"), Setting::Tame,
              [&] { return crowd(ratio, 0.85, VirtualMass{}); });
    table.row(text("density ratio ", ratio, ", drag that follows"), Setting::Tame,
              [&] { return crowd(ratio, 0.85, FollowedDrag{}); });
  }
  table.scene("Light grains gather under a lid in water, 15 % of solids of 0.66 mm",
              "they rise with the velocity of their drag law within 25 %, come to rest, and the "
              "lid bears their buoyancy within 1 %");
  for (const double density : {100.0, 20.0, 1.0})
    for (const double restitution : {0.5, 0.9}) {
      if (table.quick && (density != 20.0 || restitution < 0.9)) continue;
      table.row(text(density, " kg/m3, e = ", restitution), Setting::Tame,
                [&] { return under_lid(density, restitution); });
    }
  table.row("20 kg/m3, e = 0.9, virtual mass", Setting::Tame,
            [&] { return under_lid(20, 0.9, VirtualMass{}); });
  table.row("20 kg/m3, e = 0.9, drag that follows", Setting::Tame,
            [&] { return under_lid(20, 0.9, FollowedDrag{}); });
}

}  // namespace stability
