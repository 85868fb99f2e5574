// silt - BSD-3-Clause, see LICENSE
//
// A rotating drum with a hot wall and cold grains: how fast the bed heats up, and how uniform its
// temperature is. Grains are soft, and heat conduction uses their large contact areas. With
// --modulus 70 it uses those of metal of 70 GPa; they are 24 times smaller, and heating takes 24
// times as long.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/silt.hpp>

#include "support/example.hpp"

namespace {

using Law = silt::HertzMindlin;

struct Scene {
  std::size_t particles = 1500;
  double radius = 0.04;   // [m] of the drum, which is periodic along its axis
  double length = 0.02;   // [m] of a period
  double grain = 1.5e-3;  // [m] mean radius of the grains
  double rpm = 15;        // [1/min]
  double turns = 4;
  double wall = 400, start = 300;      // [K]
  double conductivity = 200;           // [W/(m K)] of aluminium, as what follows
  double heat_capacity = 900;          // [J/(kg K)]
  double density = 2700;               // [kg/m3]
  double modulus = 0;                  // [GPa] of the real solid; 0: contacts' own
  static constexpr double fall = 0.4;  // [s] for the bed to come to rest

  double rate() const { return rpm * std::numbers::pi / 30; }  // [rad/s]
  Law::Material material() const {
    return {.youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.5};
  }
  silt::HeatConduction heat() const {
    return {.conductivity = conductivity,
            .heat_capacity = heat_capacity,
            .youngs_modulus = modulus * 1e9,
            .start_temperature = start,
            .walls = {silt::held_at(wall)}};
  }
};

/// The drum rotates from Scene::fall on.
auto make_simulation(const Scene& s) {
  const silt::Box period{{-s.radius, 0, -s.radius}, {s.radius, s.length, s.radius}};
  const double half = 0.65 * s.radius;
  silt::Particles<silt::Sphere> grains;
  grains.fill({{-half, 0, -half}, {half, s.length, half}},
              {.radius = silt::uniform(0.9 * s.grain, 1.1 * s.grain),
               .density = s.density,
               .count = s.particles,
               .arrangement = silt::Arrangement::Lattice});
  silt::Simulation sim{std::move(grains), silt::Contacts<Law>{s.material()},
                       silt::PeriodicBox{period, {false, true, false}}, s.heat()};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(
      silt::Cylinder{{0, -s.length, 0}, {0, 2 * s.length, 0}, s.radius, silt::Side::Inside},
      s.material(), [turn = silt::rotation({0, 0, 0}, {0, 1, 0}, s.rate())](double time) {
        return turn(std::max(time - Scene::fall, 0.0));
      });
  return sim;
}

struct Temperatures {
  double mean, deviation, least, most, stored;  // [K], [J]
};
template <class Sim>
Temperatures temperatures_of(const Sim& sim, const Scene& s) {
  Temperatures t{0, 0, std::numeric_limits<double>::infinity(), 0, 0};
  double mass = 0, squares = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const double T = sim.template field<silt::Temperature>(k), m = sim.mass(k), over = T - s.start;
    mass += m, t.stored += m * s.heat_capacity * over, squares += m * over * over;
    t.least = std::min(t.least, T), t.most = std::max(t.most, T);
  }
  const double over = t.stored / (mass * s.heat_capacity);
  t.mean = s.start + over, t.deviation = std::sqrt(std::max(squares / mass - over * over, 0.0));
  return t;
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  silt::make_folder(options.out);
  example::Summary summary;
  summary.input("particles", static_cast<double>(s.particles));
  summary.input("drum_radius_m", s.radius);
  summary.input("drum_length_m", s.length);
  summary.input("grain_radius_m", s.grain);
  summary.input("rpm", s.rpm);
  summary.input("turns", s.turns);
  summary.input("wall_temperature_k", s.wall);
  summary.input("start_temperature_k", s.start);
  summary.input("conductivity_w_mk", s.conductivity);
  summary.input("heat_capacity_j_kgk", s.heat_capacity);
  summary.input("real_modulus_gpa", s.modulus);

  sim.run(Scene::fall);
  // Heat is counted from here: grains are cold again, and the drum rotates.
  for (std::size_t k = 0; k < sim.rows(); ++k) sim.field<silt::Temperature>(k) = s.start;
  const double given_before = sim.given_by_wall<silt::HeatConduction>(0).sum;
  const double turn = 60 / s.rpm;  // [s]
  const auto watch = [&](const auto& at) {
    const Temperatures t = temperatures_of(at, s);
    return std::array<double, 5>{at.time() - Scene::fall, t.mean, t.least, t.most, t.deviation};
  };
  sim.run(s.turns * turn,
          silt::table(options.out + "/temperatures.csv",
                      {"time [s]", "mean [K]", "coldest [K]", "hottest [K]", "deviation [K]"},
                      silt::every(turn / 100), watch),
          silt::vtk_series(options.out + "/vtk", silt::every(turn / 20)), silt::progress());

  const Temperatures end = temperatures_of(sim, s);
  const double given = sim.given_by_wall<silt::HeatConduction>(0).sum - given_before;
  silt::write_particles(options.out + "/end.vtp", sim);
  summary.result("heat_from_wall_j", given);
  summary.result("heat_stored_j", end.stored);
  summary.result("mean_temperature_k", end.mean);
  summary.result("deviation_k", end.deviation);
  summary.result("hottest_k", end.most);
  summary.result("time_step_s", sim.step_length());
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("wall_time_s", whole.seconds());
  summary.check_within("heat_stored_over_heat_from_wall", end.stored / given, 1, 1e-9,
                       "rounding: what one end of a contact gets the other loses");
  // Second law: conduction between bodies of 300 to 400 K makes none hotter or colder than that.
  summary.check_at_most("hottest_k", end.most, s.wall);
  summary.check_at_least("coldest_k", end.least, s.start);
  // Fails if contacts are left out: no heat would flow.
  summary.check_at_least("mean_rise_k", end.mean - s.start, 0.1);
  summary.write(options.out + "/summary.json");
  const bool drawn = example::draw({"draw", options.out + "/end.vtp", "--colour", "temperature",
                                    "--title", silt::text(s.turns, " turns at ", s.rpm, " rpm"),
                                    "--out", options.out + "/drum.png"}) &&
                     example::draw({"curves", options.out + "/temperatures.csv", "--x", "time",
                                    "--y", "coldest,mean,hottest", "--y-label", "temperature [K]",
                                    "--title", silt::text("Grains in a drum of ", s.wall, " K"),
                                    "--out", options.out + "/temperatures.png"});
  std::printf("\n%.4g J from the wall; grains at %.2f K on the mean, deviation %.2f K.\n", given,
              end.mean, end.deviation);
  summary.print_checks();
  std::printf(
      "Look at: %s%s/vtk (ParaView), %s/temperatures.csv, %s/summary.json\n",
      drawn ? (options.out + "/drum.png, " + options.out + "/temperatures.png, ").c_str() : "",
      options.out.c_str(), options.out.c_str(), options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("Cold grains in a rotating drum whose wall is hot");
  Scene scene;
  command.leave_out("--restart");
  command.add("--particles", scene.particles, 50, 20000, "Number of grains");
  command.add("--rpm", scene.rpm, 1, 100, "Turns of the drum per minute");
  command.add("--turns", scene.turns, 0.1, 100, "Turns of the drum");
  command.add("--wall", scene.wall, 300, 2000,
              "Temperature of the drum [K]; grains begin at 300 K");
  command.add("--conductivity", scene.conductivity, 0.01, 1000,
              "Conductivity of the grains [W/(m K)]");
  command.add("--modulus", scene.modulus, 0, 1000,
              "Young's modulus of the real solid [GPa], for its contact circles; 0: as it is used");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--particles")) scene.particles = 250;
      if (!command.given("--turns")) scene.turns = 0.5;
      if (!command.given("--rpm")) scene.rpm = 40;
      scene.radius = 0.025, scene.length = 0.0125;
    }
    return simulate(scene, command.options);
  });
}
