// silt - BSD-3-Clause, see LICENSE
//
// A transfer point between two belts. Ore and fines enter on a belt, which throws them at a hinged
// plate; they fall onto a second belt, which carries them away at a right angle. Results of
// interest for a plant: throughput, residence time, power of the belts, and position of the plate.

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include <silt/contact/rolling/epsd.hpp>
#include <silt/silt.hpp>

#include "support/example.hpp"

namespace {

using silt::Vec3d;
using Law = silt::HertzMindlin;

constexpr double g = 9.81;  // [m/s2]

/// Residence time of each grain.
struct Age {
  struct Fields {
    double age = 0;  // [s]
  };
  static constexpr std::array names{"age [s]"};
  void update(const silt::Seen&, Fields& f, double dt) const { f.age += dt; }
};

struct Scene {
  double rate = 2;                         // [kg/s] of the feed
  double measured = 2.5;                   // [s] of steady flow
  double upper = 1, lower = 1.2;           // [m/s] of the belts
  double plate_mass = 1.5;                 // [kg]
  static constexpr double density = 2700;  // [kg/m3]

  // Belts: the upper one along x, its end at x = 0; the lower one along y.
  static constexpr double length = 0.5, half_width = 0.08, top = 0.3;   // [m]
  static constexpr double across = 0.15, behind = -0.15, end = 0.5;     // [m] of the lower one
  static constexpr double skirt = 0.08;                                 // [m] height
  static constexpr double at_plate = 0.11, hinge = 0.43, plate = 0.29;  // [m]

  // The feed: a quarter of the grains by number are lumps, the rest fines.
  static constexpr double lumps = 0.25, small[2] = {3e-3, 5e-3}, large[2] = {6e-3, 8e-3};  // [m]

  double steady() const {  // [s] from when the flow is: half as long again as both belts take
    return 0.5 + 1.5 * (length / upper + (end - behind) / lower);
  }
  /// Mean of r^n of the feed [m^n].
  static double moment(int n) {
    const auto of = [n](const double(&r)[2]) {
      return (std::pow(r[1], n + 1) - std::pow(r[0], n + 1)) / ((n + 1) * (r[1] - r[0]));
    };
    return (1 - lumps) * of(small) + lumps * of(large);
  }
  /// Standard deviation of the mass fed within a time [s], over its mean [-]: the number of grains
  /// is exact, their masses are random.
  double scatter(double time) const {
    const double mass = density * silt::Sphere::volume(1) * moment(3);
    return std::sqrt((moment(6) / (moment(3) * moment(3)) - 1) * mass / (rate * time));
  }

  Law::Material ore() const { return solid(0.5); }
  Law::Material fines() const { return solid(0.6); }
  Law::Material rubber() const {
    return {.youngs_modulus = 4e7, .poisson_ratio = 0.45, .restitution = 0.3, .friction = 0.8};
  }
  Law::Material steel() const {
    return {.youngs_modulus = 1e8, .poisson_ratio = 0.3, .restitution = 0.4, .friction = 0.35};
  }

 private:
  static Law::Material solid(double friction) {
    return {.youngs_modulus = 5e7, .poisson_ratio = 0.25, .restitution = 0.3, .friction = friction};
  }
};

auto contacts_of(const Scene& s) {
  silt::Contacts<Law, silt::SeveralMaterials, silt::RollingEpsd> contacts{
      s.ore(), {.rolling_friction = 0.15}};
  contacts.add(s.ore(), "ore"), contacts.add(s.fines(), "fines");
  contacts.add(s.rubber(), "rubber"), contacts.add(s.steel(), "steel");
  contacts.set_pair(s.ore(), s.fines(), {.restitution = 0.3, .friction = 0.55});
  for (const auto& solid : {s.ore(), s.fines()}) {
    contacts.set_pair(solid, s.rubber(), {.restitution = 0.3, .friction = 0.8});
    contacts.set_pair(solid, s.steel(), {.restitution = 0.4, .friction = 0.35});
  }
  return contacts;
}

auto make_simulation(const Scene& s) {
  const double w = Scene::half_width, top = Scene::top, a = Scene::across, h = Scene::skirt;
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, contacts_of(s), Age{}};
  sim.gravity = {0, 0, -g};

  const double x0 = -Scene::length, y0 = Scene::behind, long_y = Scene::end - Scene::behind;
  sim.add_wall(silt::rectangle({x0, -w, top}, {Scene::length, 0, 0}, {0, 2 * w, 0}), s.rubber(),
               {.name = "upper belt", .surface_velocity = {.velocity = {s.upper, 0, 0}}});
  sim.add_wall(silt::rectangle({-a, y0, 0}, {2.2 * a, 0, 0}, {0, long_y, 0}), s.rubber(),
               {.name = "lower belt", .surface_velocity = {.velocity = {0, s.lower, 0}}});
  const double hair = 1e-3;  // [m] between a belt and what stands over it
  sim.add_wall(silt::rectangle({x0, -w, top + hair}, {Scene::length, 0, 0}, {0, 0, h}), s.steel(),
               {.name = "upper skirt, right"});
  sim.add_wall(silt::rectangle({x0, w, top + hair}, {Scene::length, 0, 0}, {0, 0, h}), s.steel(),
               {.name = "upper skirt, left"});
  sim.add_wall(silt::rectangle({x0, -w, top + hair}, {0, 2 * w, 0}, {0, 0, 2 * h}), s.steel(),
               {.name = "upper back"});
  sim.add_wall(silt::rectangle({-a, y0, hair}, {0, long_y, 0}, {0, 0, 1.5 * h}), s.steel(),
               {.name = "lower skirt, near"});
  sim.add_wall(silt::rectangle({1.2 * a, y0, hair}, {0, long_y, 0}, {0, 0, 1.5 * h}), s.steel(),
               {.name = "lower skirt, far"});
  sim.add_wall(silt::rectangle({-a, y0, hair}, {2.2 * a, 0, 0}, {0, 0, 1.5 * h}), s.steel(),
               {.name = "lower back"});
  // Hangs from its upper edge, and swings in the plane of the stream.
  const double x = Scene::at_plate, L = Scene::plate;
  sim.add_wall(silt::rectangle({x, -1.4 * w, Scene::hinge - L}, {0, 2.8 * w, 0}, {0, 0, L}),
               s.steel(),
               {.name = "plate",
                .drive = silt::Hinge{.centre = {x, 0, Scene::hinge},
                                     .axis = {0, -1, 0},
                                     .inertia = s.plate_mass * L * L / 3,
                                     .mass = s.plate_mass,
                                     .centre_of_mass = {x, 0, Scene::hinge - L / 2},
                                     .damping = 0.05}});  // [N m s/rad] of its bearings
  sim.set_reference("plate", {x, 0, Scene::hinge});

  sim.add_inlet(silt::Box{{x0 + 0.01, -w + 0.01, top + 0.11}, {x0 + 0.13, w - 0.01, top + 0.2}},
                {.radius = silt::uniform(Scene::small[0], Scene::small[1]),
                 .density = Scene::density,
                 .velocity = {0, 0, -1},
                 .material = sim.find_material("fines"),
                 .mass_rate = s.rate,
                 .recipe = {{.share = Scene::lumps,
                             .radius = silt::uniform(Scene::large[0], Scene::large[1]),
                             .density = Scene::density,
                             .material = sim.find_material("ore")}}});
  sim.add_outlet({{-1, Scene::end, -1}, {1, 1, -0.05}});   // over the lower belt's end
  sim.add_outlet({{-1, -1, -1}, {1, Scene::end, -0.05}});  // what is spilled
  return sim;
}

/// Sums over the grains: all of them, and those that have just left the lower belt.
struct Held {
  double mass = 0, left = 0;     // [kg]
  double age = 0, momentum = 0;  // [kg s], [kg m/s] along the belt, of those that have left

  template <class Sim>
  explicit Held(const Sim& sim) {
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k)) continue;
      const double m = sim.mass(k);
      mass += m;
      if (sim.position(k).y < Scene::end) continue;
      left += m, age += m * sim.template field<Age>(k).age, momentum += m * sim.velocity(k).y;
    }
  }
};

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  auto sim = make_simulation(s);
  sim.threads = options.threads;
  silt::make_folder(options.out);
  const std::string& out = options.out;

  example::Summary summary;
  summary.input("feed_kg_s", s.rate);
  summary.input("upper_belt_m_s", s.upper);
  summary.input("lower_belt_m_s", s.lower);
  summary.input("plate_mass_kg", s.plate_mass);
  summary.input("steady_from_s", s.steady());
  summary.input("measured_s", s.measured);

  const auto watch = [&](const auto& at) {
    const Held held(at);
    return std::array<double, 6>{at.time(),         at.inlet(0).mass,
                                 held.mass,         at.outlet(0).mass,
                                 at.outlet(1).mass, at.wall("plate").state.way * 180 / M_PI};
  };
  // Means over the time of steady flow.
  double degrees = 0, lever = 0, age = 0, momentum = 0, weight = 0;
  std::size_t samples = 0;
  const auto mean = [&](const auto& at) {
    if (at.time() < s.steady()) return;
    const double angle = at.wall("plate").state.way;
    const Held held(at);
    degrees += angle * 180 / M_PI, lever += std::sin(angle), ++samples;
    age += held.age, momentum += held.momentum, weight += held.left;
  };
  auto table = silt::table(out + "/transfer.csv",
                           {"time [s]", "fed [kg]", "held [kg]", "carried off [kg]", "spilled [kg]",
                            "angle of the plate [deg]"},
                           silt::every(0.02), watch);
  auto means = silt::at(silt::every(0.005), mean);
  auto frames = silt::vtk_series(out + "/vtk", silt::every(0.05));
  auto drive_upper = silt::wall_series(out + "/upper_belt.csv", "upper belt", silt::every(0.05));
  auto drive_lower = silt::wall_series(out + "/lower_belt.csv", "lower belt", silt::every(0.05));
  const auto run = [&](double duration, auto&&... more) {
    sim.run(duration, table, means, frames, drive_upper, drive_lower,
            silt::on_failure(out + "/failed", silt::every(0.5)), silt::progress(), more...);
  };
  run(s.steady());
  const double fed_before = sim.inlet(0).mass, off_before = sim.outlet(0).mass + sim.outlet(1).mass;
  std::vector<silt::MeanLoad> loads;
  for (std::size_t w = 0; w < sim.walls(); ++w) loads.emplace_back(sim, w);
  run(s.measured, silt::contact_series(out + "/vtk", silt::every(0.05)));

  const double span = s.measured;  // [s]
  const double in = (sim.inlet(0).mass - fed_before) / span;
  const double off = (sim.outlet(0).mass + sim.outlet(1).mass - off_before) / span;
  std::vector<silt::MeanLoad::Load> on;
  for (auto& load : loads) on.push_back(load.read(sim));
  const auto& upper = on[sim.wall_number("upper belt")];
  const auto& lower = on[sim.wall_number("lower belt")];
  const auto& plate = on[sim.wall_number("plate")];
  double push = 0;  // [N] along the lower belt, of all walls on the grains
  for (const auto& load : on) push -= load.force.y;
  double upper_push = 0;  // [N] along the upper belt, of it and of its skirts
  for (const char* name : {"upper belt", "upper skirt, right", "upper skirt, left", "upper back"})
    upper_push -= on[sim.wall_number(name)].force.x;
  const double leaves_with = momentum / weight;  // [m/s]
  const double hangs = degrees / static_cast<double>(samples);
  const double weight_turns =
      s.plate_mass * g * Scene::plate / 2 * lever / static_cast<double>(samples);
  const double turned_by = -plate.torque.y;  // [N m] of the grains, about the hinge
  const double power = -upper.force.x * s.upper - lower.force.y * s.lower;  // [W] of both belts

  summary.result("fed_kg_s", in);
  summary.result("carried_off_kg_s", off);
  summary.result("spilled_kg", sim.outlet(1).mass);
  summary.result("grains_at_the_end", static_cast<double>(sim.size()));
  summary.result("leaves_with_m_s", leaves_with);
  summary.result("age_at_the_end_of_the_belts_s", age / weight);
  summary.result("upper_belt_w", -upper.force.x * s.upper);
  summary.result("lower_belt_w", -lower.force.y * s.lower);
  summary.result("upper_belt_w_over_feed_times_speed_squared", -upper.force.x / (in * s.upper));
  summary.result("plate_hangs_at_deg", hangs);
  summary.result("grains_turn_the_plate_by_n_m", turned_by);
  summary.result("its_weight_turns_it_by_n_m", weight_turns);
  summary.result("largest_overlap_over_radius", sim.peak_overlap());
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("wall_time_s", whole.seconds());
  const double scatter = s.scatter(span);
  summary.check_within("fed_kg_s", in, s.rate, 4 * scatter * s.rate,
                       "four standard deviations of grains of random masses");
  summary.check_within("carried_off_over_fed", off / in, 1, 3 * std::sqrt(2.0) * scatter,
                       "three, as those that leave came earlier than those that come");
  const auto gone = sim.outlet(0).count + sim.outlet(1).count;
  summary.check_within(
      "grains_held_and_gone_over_placed",
      static_cast<double>(sim.size() + gone) / static_cast<double>(sim.inlet(0).placed), 1, 0,
      "numbers");
  summary.check_within(
      "mass_held_and_gone_over_fed",
      (Held(sim).mass + sim.outlet(0).mass + sim.outlet(1).mass) / sim.inlet(0).mass, 1, 1e-10,
      "rounding of sums");
  summary.check_within("torque_on_plate_over_weight", turned_by / weight_turns, 1, 0.05,
                       "it still swings at the ends of the interval");
  summary.check_within("push_of_walls_over_momentum_carried_off", push / (off * leaves_with), 1,
                       scatter + 0.05, "what is on the belts has changed by the end");
  summary.check_within(
      "push_of_upper_belt_and_skirts_over_feed_times_speed", upper_push / (in * s.upper), 1,
      scatter + 0.05,
      "what is on the belt has changed by the end; grains come with no speed along it");
  summary.check_at_most("spilled_over_fed", sim.outlet(1).mass / sim.inlet(0).mass, 0.01);
  summary.write(out + "/summary.json");

  silt::write_particles(out + "/end.vtp", sim);
  silt::write_walls(out + "/walls.vtp", sim);
  silt::write_contacts(out + "/contacts.vtp", sim);
  const bool drawn =
      example::draw({"draw", out + "/end.vtp", "--colour", "age", "--walls", out + "/walls.vtp",
                     "--title", "Ore, by its age", "--out", out + "/transfer.png"}) &&
      example::draw({"curves", out + "/transfer.csv", "--x", "time", "--y", "fed,held,carried off",
                     "--y-label", "mass [kg]", "--title", "Mass", "--out", out + "/mass.png"}) &&
      example::draw({"curves", out + "/transfer.csv", "--x", "time", "--y", "angle of the plate",
                     "--title", "The plate", "--out", out + "/plate.png"}) &&
      example::draw({"curves", out + "/upper_belt.csv", out + "/lower_belt.csv", "--labels",
                     "upper belt", "lower belt", "--x", "time", "--y", "force x,force y",
                     "--y-label", "force of the ore [N]", "--title",
                     "Forces of the ore on the belts", "--out", out + "/belts.png"}) &&
      example::draw({"draw", out + "/contacts.vtp", "--walls", out + "/walls.vtp", "--title",
                     "Contact forces at the end", "--out", out + "/chains.png"});
  std::printf(
      "\n%.3g kg/s come and %.3g leave, %.3g s later; the belts need %.3g W, the plate hangs at "
      "%.3g degrees.\n",
      in, off, age / weight, power, hangs);
  summary.print_checks();
  const auto named = [&](const char* file) { return out + "/" + file; };
  std::printf(
      "Look at: %s%s (ParaView), %s, %s, %s\n",
      drawn ? (named("transfer.png") + ", mass.png, plate.png, belts.png, chains.png, ").c_str()
            : "",
      named("vtk").c_str(), named("transfer.csv").c_str(), named("upper_belt.csv").c_str(),
      named("summary.json").c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("A transfer of ore between two conveyor belts, by a hinged plate");
  Scene scene;
  command.leave_out("--restart");
  command.add("--rate", scene.rate, 0.1, 20, "Feed rate [kg/s]");
  command.add("--upper", scene.upper, 0.2, 3, "Speed of the upper belt [m/s]");
  command.add("--lower", scene.lower, 0.2, 3, "Speed of the lower belt [m/s]");
  command.add("--plate", scene.plate_mass, 0.2, 50, "Mass of the hinged plate [kg]");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--rate")) scene.rate = 0.6;
      scene.measured = 1.5;
    }
    return simulate(scene, command.options);
  });
}
