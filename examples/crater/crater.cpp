// silt - BSD-3-Clause, see LICENSE
//
// Low-speed impact: a ball of metal, a free body made of a mesh, falls from several heights onto a
// bed of grains and stops in it. The bed is settled once; each drop goes on from its checkpoint in
// a scene that has changed: with the ball, other restitution and another time step. Once more it
// goes on with gravity tilted, which gives the angle of repose that the law of the depths needs.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "crater/scene.hpp"
#include "support/example.hpp"

namespace {

using crater::Drop, crater::g, crater::Scene, crater::Surface;
using silt::Vec3d;

/// Where each grain is and how fast, by its id.
struct State {
  std::map<std::uint64_t, std::array<Vec3d, 2>> grains;
  template <class Sim>
  explicit State(const Sim& sim) {
    for (std::size_t k = 0; k < sim.rows(); ++k)
      grains[sim.id(k)] = {sim.position(k), sim.velocity(k)};
  }
  /// How many of these are not, bit for bit, as they are there.
  std::size_t differ(const State& from) const {
    std::size_t count = grains.size() > from.grains.size() ? 0 : from.grains.size() - grains.size();
    for (const auto& [id, state] : grains) {
      const auto other = from.grains.find(id);
      count += other == from.grains.end() || state != other->second;
    }
    return count;
  }
};

/// What is settled once: the checkpoint, and what was read of it.
struct Bed {
  std::string file;
  State state;
  double level, fraction, step, slope;                          // [m], [-] of solid, [s], [degrees]
  double density() const { return fraction * Scene::density; }  // [kg/m3] of the bed
};

/// How the body is at a time, and what it has of its books.
struct Sample {
  double time, depth, speed;  // [s] since it met the bed's level, [m], [m/s] downwards
  double force;               // [N] upwards, mean since the last sample
};

struct Outcome {
  Drop drop;
  double depth = 0, total = 0;       // [m] at rest; [m] height of fall with it
  double stopped = 0, most = 0;      // [s] since the impact; [g] the largest deceleration
  double momentum = 0, spin = 0;     // [-] errors of the books, over those of the impact
  double lost = 0, booked = 0;       // [J] by the body; by grains: dissipated and stored
  double friction = 0, lifted = 0;   // [J] of it
  double aside = 0, bears = 0;       // [m] from the axis; [-] force of the grains over its weight
  double overlap = 0;                // [-] of the radius, the largest
  std::size_t changed = 0;           // grains that are not as in the checkpoint
  double d1 = 0, k = 0, by_law = 0;  // [m], [1/s2], [m] of F/m = v^2/d1 + k z, and its depth
  std::vector<Sample> samples;
};

template <class Sim>
double unrest(const Scene& s, const Sim& sim) {  // [-] mean energy over weight times diameter
  return sim.kinetic_energy() / (sim.total_mass() * g * s.grain);
}
template <class Sim>
void run_until_rest(const Scene& s, Sim& sim) {
  const double start = sim.time();
  do sim.run(0.02, silt::progress());
  while (unrest(s, sim) > 3e-4 && sim.time() - start < s.longest);
}

Bed settle(const Scene& s, const example::Options& options) {
  std::printf("%zu grains settle\n", s.grains());
  auto sim = make_simulation(s, true);
  sim.threads = options.threads;
  run_until_rest(s, sim);
  const Surface surface(s, sim);
  const std::string file = options.out + "/bed.silt";
  silt::save_checkpoint(sim, file);
  return {file,           State(sim), surface.level(), surface.fraction(), sim.step_length(),
          surface.slope()};
}

/// [degrees] The bed goes on with gravity tilted, and flows until its surface is no steeper.
double repose(const Scene& s, const Bed& bed, const example::Options& options) {
  std::printf("gravity tilted by %.0f degrees\n", s.tilt);
  auto sim = make_simulation(s, false);
  sim.threads = options.threads;
  silt::load_checkpoint(sim, bed.file, {.materials = true});
  const double angle = s.tilt * std::numbers::pi / 180;
  sim.gravity = {g * std::sin(angle), 0, -g * std::cos(angle)};
  run_until_rest(s, sim);
  silt::write_particles(options.out + "/tilted.vtp", sim);
  return s.tilt - Surface(s, sim).slope() + bed.slope;
}

/// Books of the body: momentum and spin about the axis against what the wall's loads have given.
class Books {
 public:
  template <class Sim>
  void look(const Sim& sim, Outcome& out) {
    const auto& wall = sim.wall("body");
    const auto& body = std::get<silt::FreeBody>(wall.drive);
    const auto& state = wall.state;  // velocities of the half step, which the loads have pushed
    const Vec3d arm = state.centre - wall.reference;
    const Vec3d left =
        body.mass * state.velocity - wall.impulse - sim.time() * body.mass * sim.gravity;
    const double turn = body.mass * cross(arm, state.velocity).z +
                        rotate(state.turn, state.momentum).z - wall.angular_impulse.z;
    if (!started_) left_ = left, turn_ = turn, started_ = true;
    const double impact = body.mass * std::sqrt(2 * g * out.drop.height);  // [N s]
    out.momentum = std::max(out.momentum, norm(left - left_) / impact);
    out.spin = std::max(out.spin, std::abs(turn - turn_) / (impact * size_));
  }
  explicit Books(double size) : size_(size) {}

 private:
  double size_;  // [m]
  bool started_ = false;
  Vec3d left_{};
  double turn_ = 0;
};

/// The force law of Katsuragi and Durian (Nature Phys. 3 (2007) 420), fitted to the way down, and
/// the depth at which it stops the body.
void fit_force(const Scene& s, Outcome& out, double mass) {
  std::vector<std::array<double, 2>> x;
  std::vector<double> y;
  for (const Sample& p : out.samples)
    if (p.depth > 0 && p.speed > 0.05 * std::sqrt(2 * g * out.drop.height))
      x.push_back({p.speed * p.speed, p.depth}), y.push_back(p.force / mass);
  const crater::Fit<2> fit(x, y);
  out.d1 = 1 / fit.value[0], out.k = fit.value[1];
  double v = std::sqrt(2 * g * out.drop.height);
  for (const double dt = 1e-5; v > 0 && out.by_law < s.bed(); out.by_law += v * dt)
    v += dt * (g - v * v * fit.value[0] - out.k * out.by_law);
}

Outcome fall(const Scene& s, const Bed& bed, const Drop& drop, bool last,
             const example::Options& options) {
  std::printf("%.0f kg/m3 from %.0f mm\n", drop.density, 1e3 * drop.height);
  Outcome out;
  out.drop = drop;
  auto sim = make_simulation(s, false, drop);
  sim.threads = options.threads;
  silt::load_checkpoint(sim, bed.file, {.materials = true, .walls = true});
  sim.time_step = 0.8 * bed.step;
  const State before(sim);
  out.changed = before.differ(bed.state);

  const auto& body = std::get<silt::FreeBody>(sim.wall("body").drive);
  const double weight = body.mass * g;
  const auto depth = [&] { return bed.level - sim.wall("body").state.centre.z + s.body() / 2; };
  const double start = sim.time() - depth() / std::sqrt(2 * g * drop.height);  // [s] of the impact
  Books books(s.body());
  silt::MeanLoad load(sim, "body");
  std::optional<silt::EnergyBalance> first;
  bool slow = false;
  const auto watch = [&](const auto& at) {
    books.look(at, out);
    if (!first) first = at.energy();
    const auto mean = load.read(at);
    const double speed = -at.wall("body").state.velocity_now.z;
    if (mean.duration == 0) return;
    out.samples.push_back({at.time() - start, depth(), speed, mean.force.z});
    out.most = std::max(out.most, mean.force.z / weight - 1);
    if (out.stopped == 0 && speed <= 0) out.stopped = at.time() - start;
    if (last && !slow && depth() > 0 && speed < 0.5 * std::sqrt(2 * g * drop.height)) {
      slow = true;
      silt::write_particles(options.out + "/early.vtp", at);
      silt::write_walls(options.out + "/early_walls.vtp", at);
    }
  };
  auto samples = silt::at(silt::every(0.5e-3), watch);
  auto frames = silt::vtk_series(options.out + "/vtk", silt::every(0.01));
  const double slice = 0.02;  // [s]
  double was;
  do {
    was = depth();
    if (last)
      sim.run(slice, samples, frames, silt::progress());
    else
      sim.run(slice, samples, silt::progress());
  } while ((std::abs(depth() - was) > 2e-3 * s.body() || out.stopped == 0) &&
           sim.time() - start < s.longest);
  silt::MeanLoad at_rest(sim, "body");
  sim.run(0.01, samples);
  out.bears = at_rest.read(sim).force.z / weight;

  const silt::EnergyBalance end = sim.energy();
  out.lost = first->free_walls - end.free_walls;
  out.booked = end.held() - first->held() + end.dissipated() - first->dissipated();
  out.friction = end.friction - first->friction, out.lifted = end.gravity - first->gravity;
  out.depth = depth(), out.total = drop.height + out.depth, out.overlap = sim.peak_overlap();
  const Vec3d centre = sim.wall("body").state.centre;
  out.aside = std::hypot(centre.x, centre.y);
  fit_force(s, out, body.mass);

  const std::string name =
      silt::text(options.out, '/', drop.density, '_', std::round(1e3 * drop.height));
  silt::write_particles(name + ".vtp", sim, [&](const auto& at, auto& fields, const auto& places) {
    static std::vector<float> moved;
    moved.clear();
    for (const auto k : places)
      moved.push_back(static_cast<float>(norm(at.position(k) - before.grains.at(at.id(k))[0])));
    fields.add("moved [m]", moved);
  });
  silt::write_walls(name + "_walls.vtp", sim);
  silt::CsvTable table(name + ".csv", {"time [s]", "depth [m]", "speed [m/s]", "deceleration [g]"});
  for (const Sample& p : out.samples)
    table.add_row({p.time, p.depth, p.speed, p.force / weight - 1});
  return out;
}

/// What all drops say together: ln(depth/D) = c + n ln(H/D) + b ln(density of ball over bed).
crater::Fit<3> fit_depths(const Scene& s, const Bed& bed, const std::vector<Outcome>& all) {
  std::vector<std::array<double, 3>> x;
  std::vector<double> y;
  for (const Outcome& o : all) {
    x.push_back({1, std::log(o.total / s.body()), std::log(o.drop.density / bed.density())});
    y.push_back(std::log(o.depth / s.body()));
  }
  return {x, y};
}

void write_depths(const std::string& path, const Scene& s, const Bed& bed, double mu,
                  const crater::Fit<3>& fit, const std::vector<Outcome>& all) {
  silt::CsvTable table(path, {"density [kg/m3]", "free fall [m]", "total fall [m]", "depth [m]",
                              "by Uehara et al. [m]", "by the fit [m]", "by the force law [m]",
                              "stopped after [s]", "largest deceleration [g]"});
  for (const Outcome& o : all) {
    const double over = o.drop.density / bed.density(), fall = o.total / s.body();
    table.add_row({o.drop.density, o.drop.height, o.total, o.depth,
                   s.body() * crater::law_depth(mu, over, fall),
                   s.body() * std::exp(fit.value[0]) * std::pow(fall, fit.value[1]) *
                       std::pow(over, fit.value[2]),
                   o.by_law, o.stopped, o.most});
  }
}

/// The worst of all drops.
template <class Of>
double most(const std::vector<Outcome>& all, const Of& of) {
  double worst = 0;
  for (const Outcome& o : all) worst = std::max(worst, of(o));
  return worst;
}

void report(example::Summary& summary, const Scene& s, const Bed& bed, double angle,
            const crater::Fit<3>& fit, const std::vector<Outcome>& all) {
  const double mu = std::tan(angle * std::numbers::pi / 180);
  summary.input("grains", static_cast<double>(s.grains()));
  summary.input("ball_over_grain", s.diameter);
  summary.input("pot_over_ball", s.wide);
  summary.input("friction", s.friction);
  summary.result("bed_level_over_ball", bed.level / s.body());
  summary.result("bed_solid_fraction", bed.fraction);
  summary.result("angle_of_repose_deg", angle);
  double ratio = 0;  // mean of the logarithms
  for (const Outcome& o : all) {
    const double over = o.drop.density / bed.density();
    const double of_law = o.depth / s.body() / crater::law_depth(mu, over, o.total / s.body());
    ratio += std::log(of_law) / static_cast<double>(all.size());
    const std::string name =
        silt::text(o.drop.density, " kg/m3 from ", std::round(1e3 * o.drop.height), " mm: ");
    summary.result(name + "depth over ball", o.depth / s.body());
    summary.result(name + "depth over that of the law", of_law);
    summary.result(name + "stopped after [s]", o.stopped);
    summary.result(name + "largest deceleration [g]", o.most);
    summary.result(name + "d1 over ball", o.d1 / s.body());
    summary.result(name + "k times ball over m g", o.k * s.body() / g);
    summary.result(name + "friction over loss", o.friction / o.lost);
    summary.result(name + "largest overlap over radius", o.overlap);
  }
  ratio = std::exp(ratio);
  summary.result("exponent_of_height", fit.value[1]);
  summary.result("its_standard_error", fit.error[1]);
  summary.result("exponent_of_density", fit.value[2]);
  summary.result("its_standard_error_", fit.error[2]);
  summary.result("scatter_about_the_fit", fit.scatter);
  summary.result("depth_over_that_of_the_law", ratio);

  summary.check_at_most("grains_not_as_in_the_checkpoint",
                        most(all, [](const auto& o) { return static_cast<double>(o.changed); }), 0);
  summary.check_at_most("momentum_off_the_loads",
                        most(all, [](const auto& o) { return o.momentum; }), 1e-11);
  summary.check_at_most("spin_off_the_loads", most(all, [](const auto& o) { return o.spin; }),
                        1e-11);
  summary.check_at_most("energy_off_the_books",
                        most(all, [](const auto& o) { return std::abs(o.booked / o.lost - 1); }),
                        2e-3);
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  silt::make_folder(options.out);
  const Bed bed = settle(s, options);
  const double angle = repose(s, bed, options);
  std::vector<Outcome> all;
  for (const double density : s.densities)
    for (const double height : s.heights)
      all.push_back(fall(s, bed, {density, height * s.body(), bed.level},
                         density == s.densities.back() && height == s.heights.back(), options));
  const auto fit = fit_depths(s, bed, all);
  example::Summary summary;
  report(summary, s, bed, angle, fit, all);
  summary.result("wall_time_s", whole.seconds());
  summary.write(options.out + "/summary.json");
  write_depths(options.out + "/depths.csv", s, bed, std::tan(angle * std::numbers::pi / 180), fit,
               all);
  const bool drawn = example::run_script(
      SILT_CRATER_SCRIPT, {options.out, silt::text(bed.level), silt::text(s.body())});
  std::printf(
      "\nDepth as the height of fall to the power %.3f +- %.3f, the density to %.3f +- %.3f.\n",
      fit.value[1], fit.error[1], fit.value[2], fit.error[2]);
  summary.print_checks();
  std::printf("Look at: %s%s/vtk (ParaView), %s/depths.csv, %s/summary.json; %.0f s\n",
              drawn ? (options.out + "/crater.png, depth.png, ").c_str() : "", options.out.c_str(),
              options.out.c_str(), options.out.c_str(), whole.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("A ball of metal falls onto a bed of grains and stops in it",
                           example::Kind::Cases, "out/crater");
  Scene scene;
  command.add("--diameter", scene.diameter, 2, 30, "Of the ball, in grains");
  command.add("--wide", scene.wide, 2, 20, "Diameter of the pot, in balls");
  command.add("--deep", scene.deep, 1, 10, "Depth of the bed, in balls");
  command.add("--seed", scene.seed, 1, 1000000, "Of the bed: which packing");
  command.add("--friction", scene.friction, 0.05, 2, "Between grains");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--diameter")) scene.diameter = 5;
      if (!command.given("--wide")) scene.wide = 4.5;
      if (!command.given("--deep")) scene.deep = 2.2;
      scene.heights = {1, 6};
    }
    return simulate(scene, command.options);
  });
}
