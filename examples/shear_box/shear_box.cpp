// silt - BSD-3-Clause, see LICENSE
//
// Direct shear test of soil mechanics. A box is split at mid-height: its lower half moves sideways,
// a lid under a dead weight presses on the sample. A dense and a loose sample of spheres, each at
// three normal stresses: shear stress and lid height over displacement, Mohr-Coulomb lines, and
// dilatancy against Taylor's rule.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/eigen.hpp>
#include <silt/files/csv_table.hpp>

#include "shear_box/scene.hpp"
#include "support/example.hpp"

namespace {

using shear_box::Scene;
using silt::Vec3d;

double degrees(double slope) { return std::atan(slope) * 180 / M_PI; }

/// Means over an interval of the displacement of the lower half.
struct Point {
  double way = 0, rise = 0;     // [m] of the lower half; of the lid, at the end
  double below = 0, above = 0;  // [N] shear force, of the lower half; of ring and lid
  double normal = 0, lid = 0;   // [N] that the lower half bears; of the lid
  double ratio() const { return below / normal; }
};

struct Test {
  std::string name;       // of the sample
  double stress = 0;      // [Pa] on the lid
  double void_ratio = 0;  // [-] before the shear
  double contacts = 0;    // [-] a grain, before the shear
  double overlap = 0;     // [-] mean of grains that touch, of the mean diameter
  std::vector<Point> curve;
  std::size_t residual_from = 0;  // points
  // Over the residual interval:
  double work = 0, lid_work = 0;     // [J] of the shear force, and of the lid, on the grains
  double dissipated = 0, held = 0;   // [J] by the ledger; held: more than before
  double momentum = 0, impulse = 0;  // [N s] what grains gained, what shear forces differ by
  double shear_impulse = 0;          // [N s] of the lower half
  double mass = 0;                   // [kg] of the grains
  double band = 0;                   // [m] thickness of what is sheared
  std::size_t lost = 0, grains = 0;

  std::string title() const { return name + ", " + silt::text(stress / 1000) + " kPa"; }
  std::string file() const { return name + "_" + silt::text(stress / 1000) + "kPa"; }
  template <class Of>
  double mean(std::size_t from, std::size_t to, const Of& of) const {
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += of(curve[k]);
    return sum / static_cast<double>(to - from);
  }
  template <class Of>
  double residual(const Of& of) const {
    return mean(residual_from, curve.size(), of);
  }
  static constexpr std::size_t half_window = 3;
  /// The centre of the seven consecutive points with the largest mean ratio.
  std::size_t peak_at() const {
    std::size_t best = half_window;
    const auto of = [](const Point& p) { return p.ratio(); };
    for (std::size_t k = half_window; k + half_window < curve.size(); ++k)
      if (mean(k - half_window, k + half_window + 1, of) >
          mean(best - half_window, best + half_window + 1, of))
        best = k;
    return best;
  }
  template <class Of>
  double at_peak(const Of& of) const {
    return mean(peak_at() - half_window, peak_at() + half_window + 1, of);
  }
  /// Rise of the lid over displacement [-], the slope around a point: the tangent of the dilatancy
  /// angle.
  double dilatancy(std::size_t from, std::size_t to) const {
    std::vector<double> x, y;
    for (std::size_t k = from; k < to; ++k) x.push_back(curve[k].way), y.push_back(curve[k].rise);
    return silt::fit_straight_line(x, y).slope;
  }
  double dilatancy_at_peak() const {
    return dilatancy(peak_at() - half_window, peak_at() + half_window + 1);
  }
};

/// Sums over the grains of a box.
template <class Sim>
double solid_volume(const Sim& sim) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) sum += silt::Sphere::volume(sim.radius(k));
  return sum;
}
/// Height [m] between floor and lid.
template <class Sim>
double height(const Sim& sim) {
  const auto& plane = std::get<silt::Plane>(sim.wall("lid").surfaces.front());
  return plane.point.z + sim.wall("lid").pose.translation.z -
         std::get<silt::Plane>(sim.wall("floor").surfaces.front()).point.z;
}
/// Mean overlap of touching grains [m]. Between runs.
template <class Sim>
double mean_overlap(const Sim& sim) {
  double sum = 0, count = 0;
  sim.for_each_contact([&](const silt::ContactSeen& c) {
    if (c.wall == silt::no_wall) sum += c.overlap, ++count;
  });
  return sum / count;
}

/// Shear band thickness [m]: the distance in which the mean displacement falls from 9 to 1 tenth of
/// that of the lower half, over 0.8, its value for a linear profile.
template <class Sim>
double sheared_band(const Sim& sim, const Scene& s, const std::vector<Vec3d>& before, double way) {
  const double layer = 0.5 * s.diameter;
  std::vector<double> sum(static_cast<std::size_t>(4 * s.height), 0.0), count = sum;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d& from = before[sim.id(k)];
    const auto at = static_cast<std::size_t>(std::max(from.z + s.split(), 0.0) / layer);
    if (at < sum.size()) sum[at] += (sim.position(k).x - from.x) / way, ++count[at];
  }
  std::vector<double> z, u;  // [m], [-]
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (count[k] > 10)
      z.push_back((static_cast<double>(k) + 0.5) * layer), u.push_back(sum[k] / count[k]);
  const auto falls_below = [&](double level) {
    for (std::size_t k = 1; k < u.size(); ++k)
      if (u[k] < level)
        return z[k - 1] +
               (z[k] - z[k - 1]) * std::clamp((u[k - 1] - level) / (u[k - 1] - u[k]), 0.0, 1.0);
    return z.back();
  };
  return (falls_below(0.1) - falls_below(0.9)) / 0.8;
}

/// Records the loads of all walls as means over the intervals of a shear test.
template <class Sim>
class Shear {
 public:
  Shear(Sim& sim, Test& test) : sim_(sim), test_(test), start_(height(sim)) {
    for (const char* name : {"lower half", "floor", "upper half", "lid"})
      loads_.emplace_back(sim, name);
  }
  double way() const { return sim_.wall("floor").pose.translation.x; }
  void piece(double duration) {
    sim_.run(duration);
    std::array<Vec3d, 4> f;
    for (std::size_t k = 0; k < 4; ++k) f[k] = loads_[k].read(sim_).force;
    test_.curve.push_back({way(), height(sim_) - start_, -f[0].x - f[1].x, f[2].x + f[3].x,
                           -f[0].z - f[1].z, f[3].z});
  }

 private:
  Sim& sim_;
  Test& test_;
  std::vector<silt::MeanLoad> loads_;
  double start_;  // [m]
};

template <class Sim>
Vec3d momentum(const Sim& sim) {
  return sim.total_mass() * sim.mean_velocity();
}
/// [N s] impulse of the grains on walls along the motion, since the start; of the lower half only.
template <class Sim>
std::array<double, 2> impulses(const Sim& sim) {
  const double below = sim.wall("lower half").impulse.x + sim.wall("floor").impulse.x;
  return {below + sim.wall("upper half").impulse.x + sim.wall("lid").impulse.x, below};
}

/// The residual interval, with its balances.
template <class Sim>
void shear_on(Sim& sim, Shear<Sim>& shear, const Scene& s, Test& t, std::size_t pieces,
              double duration) {
  std::vector<Vec3d> before(sim.rows());
  for (std::size_t k = 0; k < sim.rows(); ++k) before[sim.id(k)] = sim.position(k);
  const auto books = sim.energy();
  const auto sums = impulses(sim);
  const double p = momentum(sim).x, way = shear.way(), lid = height(sim);
  const double lid_speed = sim.wall("lid").state.rate_now;
  t.residual_from = t.curve.size();
  for (std::size_t k = 0; k < pieces; ++k) shear.piece(duration);
  const auto now = sim.energy();
  const auto last = impulses(sim);
  t.momentum = momentum(sim).x - p, t.impulse = -(last[0] - sums[0]);
  t.shear_impulse = -(last[1] - sums[1]);
  t.work = t.shear_impulse * s.speed();  // the lower half has one speed by now
  // A free lid transfers to the grains the energy lost by its weight and motion.
  const double lid_now = sim.wall("lid").state.rate_now;
  t.lid_work = -t.stress * s.area() * (height(sim) - lid) -
               0.5 * s.lid_mass() * (lid_now * lid_now - lid_speed * lid_speed);
  t.dissipated = now.dissipated() - books.dissipated(), t.held = now.held() - books.held();
  t.mass = sim.total_mass();
  t.band = sheared_band(sim, s, before, shear.way() - way);
  const double end =
      s.L() + s.travel * s.diameter;  // all that the halves and their flanges enclose
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d at = sim.position(k);
    t.lost += at.x < 0 || at.x > end || at.y < 0 || at.y > s.W() || at.z < -s.split();
  }
}

void write(const std::string& out, const Scene& s, const Test& t) {
  silt::CsvTable table(out + "/" + t.file() + ".csv",
                       {"displacement [mm]", "shear over normal stress", "rise of the lid [mm]",
                        "shear stress [kPa]", "shear stress above [kPa]", "normal stress [kPa]",
                        "stress of the lid [kPa]"});
  const double kPa = 1e-3 / s.area();
  for (const Point& p : t.curve)
    table.add_row({1e3 * p.way, p.ratio(), 1e3 * p.rise, kPa * p.below, kPa * p.above,
                   kPa * p.normal, kPa * p.lid});
}

Test run(const Scene& s, bool is_dense, double stress, const example::Options& options) {
  const example::Stopwatch watch;
  Test t;
  t.name = is_dense ? "dense" : "loose", t.stress = stress;
  const std::string sample = options.out + "/" + t.name + ".silt";
  auto sim = shear_box::make_box(s, is_dense, options.threads);
  silt::load_checkpoint(sim, sample);
  sim.set_drive("lid", shear_box::press(s, stress));
  if (!shear_box::come_to_rest(sim, s, stress))
    std::printf("%s: it does not come to rest before the shear\n", t.title().c_str());
  t.grains = sim.size();
  t.void_ratio = s.area() * height(sim) / solid_volume(sim) - 1;
  t.contacts = 2.0 * static_cast<double>(sim.touching_pairs()) / static_cast<double>(sim.size());
  t.overlap = mean_overlap(sim) / s.diameter;
  shear_box::load_lid(sim, s, stress);
  std::vector<Vec3d> start(sim.rows());
  std::vector<double> moved;  // [mm]
  for (std::size_t k = 0; k < sim.rows(); ++k) start[sim.id(k)] = sim.position(k);
  const double ramp = 0.1 * s.diameter / s.speed();
  for (const char* wall : {"lower half", "floor"})
    sim.set_motion(wall, shear_box::shear_from(sim.time(), s.speed(), ramp));
  constexpr std::size_t points = 120, late = 40;
  const double piece = (s.travel * s.diameter / s.speed() + 0.5 * ramp) / points;
  Shear shear(sim, t);
  for (std::size_t k = 0; k < points - late; ++k) shear.piece(piece);
  shear_on(sim, shear, s, t, late, piece);
  write(options.out, s, t);
  if (is_dense && stress == s.stress.back()) {
    silt::write_particles(options.out + "/end.vtp", sim,
                          [&](const auto& of, auto& fields, const auto& places) {
                            moved.clear();
                            for (const auto k : places)
                              moved.push_back(1e3 * (of.position(k).x - start[of.id(k)].x));
                            fields.add("displacement [mm]", moved);
                          });
    silt::write_contacts(options.out + "/contacts.vtp", sim);
  }
  std::printf("%-14s  peak %.3f, residual %.3f, lid up by %.2f mm, %.0f s\n", t.title().c_str(),
              t.at_peak([](const Point& p) { return p.ratio(); }),
              t.residual([](const Point& p) { return p.ratio(); }), 1e3 * t.curve.back().rise,
              watch.seconds());
  std::fflush(stdout);
  return t;
}

const auto ratio = [](const Point& p) { return p.ratio(); };

/// Shear over normal stress [Pa] of tests: peak or residual.
struct Mohr {
  std::vector<double> normal, shear;
  void add(const Scene& s, const Test& t, bool peak) {
    const auto n = [](const Point& p) { return p.normal; };
    const auto f = [](const Point& p) { return p.below; };
    normal.push_back((peak ? t.at_peak(n) : t.residual(n)) / s.area());
    shear.push_back((peak ? t.at_peak(f) : t.residual(f)) / s.area());
  }
  silt::StraightLine line() const { return silt::fit_straight_line(normal, shear); }
};

void report(example::Summary& summary, const std::string& name, const silt::StraightLine& line) {
  summary.result(name + ": friction angle [deg]", degrees(line.slope));
  summary.result(name + ": its standard error [deg]", degrees(line.slope_error));
  summary.result(name + ": cohesion [kPa]", 1e-3 * line.intercept);
  summary.result(name + ": its standard error [kPa]", 1e-3 * line.intercept_error);
}

/// Checks of each single test.
void check_test(example::Summary& summary, const Scene& s, const Test& t) {
  const std::string name = t.title() + ": ";
  const auto lid = [](const Point& p) { return p.lid; };
  const double target = t.stress * s.area();
  summary.result(name + "void ratio before the shear", t.void_ratio);
  summary.result(name + "contacts a grain before the shear", t.contacts);
  summary.result(name + "peak shear over normal stress", t.at_peak(ratio));
  summary.result(name + "peak at [mm]", 1e3 * t.curve[t.peak_at()].way);
  summary.result(name + "residual shear over normal stress", t.residual(ratio));
  summary.result(name + "rise of the lid at the end [mm]", 1e3 * t.curve.back().rise);
  summary.result(name + "dilatancy at the peak [deg]", degrees(t.dilatancy_at_peak()));
  summary.result(name + "normal force on the plane over that of the lid, residual",
                 t.residual([](const Point& p) { return p.normal / p.lid; }));
  summary.result(name + "thickness of the sheared band [diameters]", t.band / s.diameter);
  summary.result(name + "volume of the sheared band [cm3]", 1e6 * t.band * s.area());
  summary.result(name + "inertial number of the band",
                 s.speed() / t.band * s.inertial_time(t.stress));
  summary.result(name + "mean overlap over mean diameter", t.overlap);
  summary.result(name + "work of the shear over dissipated energy", t.work / t.dissipated);
  summary.check_within(name + "force of the lid over its weight", t.residual(lid) / target, 1, 0.02,
                       "its inertia: what it is faster at the end than at the start");
  summary.check_at_most(name + "shear forces below and above, difference over force",
                        std::abs(t.impulse / t.shear_impulse),
                        t.mass * s.speed() / t.shear_impulse);  // momentum grains can have
  summary.check_at_most(name + "... less the momentum that the grains gained",
                        std::abs((t.impulse - t.momentum) / t.shear_impulse), 1e-5);
  summary.check_within(name + "work of shear and lid less what is held, over dissipated energy",
                       (t.work + t.lid_work - t.held) / t.dissipated, 1, 5e-4,
                       "error of the ledger, second order in the step");
  summary.check_at_most(name + "grains outside", static_cast<double>(t.lost), 0);
}

void check_samples(example::Summary& summary, const Scene& s, const std::vector<Test>& tests) {
  Mohr dense, loose, residual, residual_dense, residual_loose;
  double rise[2] = {0, 0}, peak = 0, slip = 0, up = 0;
  const double n = static_cast<double>(s.stress.size());
  for (const Test& t : tests) {
    const bool is_dense = t.name == "dense";
    (is_dense ? dense : loose).add(s, t, true);
    residual.add(s, t, false), (is_dense ? residual_dense : residual_loose).add(s, t, false);
    rise[is_dense ? 0 : 1] += t.curve.back().rise / (n * s.diameter);
    if (!is_dense) continue;
    peak += t.at_peak(ratio) / n, up += t.dilatancy_at_peak() / n;
    // Work of the shear force minus work against the lid, over normal force and displacement.
    slip += (t.at_peak(ratio) -
             t.dilatancy_at_peak() * t.at_peak([](const Point& p) { return p.lid / p.normal; })) /
            n;
    summary.check_at_least(t.title() + ": peak over residual", t.at_peak(ratio) / t.residual(ratio),
                           1.2);
  }
  const bool is_small = s.grains(true) < 3000;
  const silt::StraightLine rest = residual.line();
  report(summary, "dense, peak", dense.line()), report(summary, "loose, peak", loose.line());
  report(summary, "residual, both samples", rest);
  const double a = degrees(residual_dense.line().slope), b = degrees(residual_loose.line().slope);
  summary.result("dense, residual friction angle [deg]", a);
  summary.result("loose, residual friction angle [deg]", b);
  const double psi = degrees(up), bolton = degrees(peak) - degrees(rest.slope);
  summary.result("dense: dilatancy angle at the peak, mean [deg]", psi);
  summary.result("peak less residual angle over dilatancy angle (Bolton: 0.8, recalled)",
                 bolton / psi);
  summary.check_within("residual friction angle [deg]", degrees(rest.slope), 25, 5,
                       "20 to 30 degrees in direct shear of beads and spheres; recalled");
  summary.check_at_most("cohesion over its standard error",
                        std::abs(rest.intercept / rest.intercept_error), 4.6);
  summary.check_at_most("standard error of the cohesion over the lowest stress",
                        rest.intercept_error / s.stress.front(), is_small ? 0.25 : 0.15);
  summary.check_at_least("dense: the lid rises [diameters]", rise[0], 0.2);
  summary.check_at_most("rise with the loose sample over that with the dense one",
                        rise[1] / rise[0], 0.3);
  const double scatter = is_small ? 6 : 3;
  summary.check_within("residual friction angle, loose against dense [deg]", b, a, scatter,
                       "fluctuations of a band of few hundred grains");
  // Taylor (recalled): at the peak tan(phi) is tan(phi) at constant volume plus the tangent of the
  // dilatancy angle. The residual angle of a short box contains a contribution of its ends, which
  // the rule lacks.
  summary.check_within("dense: angle at the peak without the work of dilation [deg]", degrees(slip),
                       degrees(rest.slope), 6,
                       "the rule is rough; with that work 9 off, with its sign wrong 20");
}

void write_mohr(const std::string& out, const Scene& s, const std::vector<Test>& tests) {
  silt::CsvTable table(out + "/tests.csv",
                       {"dense", "lid [kPa]", "normal at peak [kPa]", "shear at peak [kPa]",
                        "residual normal [kPa]", "residual shear [kPa]", "dilatancy at peak"});
  for (const Test& t : tests) {
    Mohr m;
    m.add(s, t, true), m.add(s, t, false);
    table.add_row(
        {t.name == "dense" ? 1.0 : 0.0, 1e-3 * t.stress, 1e-3 * m.normal[0], 1e-3 * m.shear[0],
         1e-3 * m.normal[1], 1e-3 * m.shear[1],
         t.dilatancy_at_peak() * t.at_peak([](const Point& p) { return p.lid / p.normal; })});
  }
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command(
      "Direct shear test of a dense and a loose sample of spheres under three normal stresses",
      example::Kind::Cases, "out/shear_box");
  Scene s;
  command.add("--friction", s.friction, 0.05, 2, "Friction between particles [-]");
  command.add("--wall-friction", s.wall_friction, 0, 1, "Friction on the sides of the box [-]");
  command.add("--length", s.length, 10, 200, "Length of the box, in grain diameters");
  command.add("--width", s.width, 5, 100, "Width of the box, in grain diameters");
  command.add("--height", s.height, 6, 100, "Height of the sample, in grain diameters");
  command.add("--travel", s.travel, 1.5, 20, "Displacement of the lower half, in grain diameters");
  command.add("--inertial-number", s.inertial, 1e-5, 5e-2,
              "Inertial number at the lowest stress [-]");
  return command.run(argc, argv, [&] {
    const auto& options = command.options;
    if (options.quick) {
      if (!command.given("--length")) s.length = 16;
      if (!command.given("--width")) s.width = 8;
      if (!command.given("--height")) s.height = 8;
      if (!command.given("--travel")) s.travel = 2.5;
      if (!command.given("--inertial-number")) s.inertial = 1e-2;
      s.stiffness = 3e4;
    }
    silt::make_folder(options.out);
    const example::Stopwatch watch;
    std::vector<Test> tests;
    for (const bool is_dense : {true, false}) {
      shear_box::prepare(s, is_dense, options.threads,
                         options.out + (is_dense ? "/dense.silt" : "/loose.silt"));
      std::printf("%s sample: made after %.0f s\n", is_dense ? "dense" : "loose", watch.seconds());
      std::fflush(stdout);
      for (const double stress : s.stress) tests.push_back(run(s, is_dense, stress, options));
    }
    example::Summary summary;
    summary.input("friction", s.friction), summary.input("wall friction", s.wall_friction);
    summary.input("length [mm]", 1e3 * s.L()), summary.input("width [mm]", 1e3 * s.W());
    summary.input("height of the sample [mm]", 1e3 * s.height * s.diameter);
    summary.input("mean diameter [mm]", 1e3 * s.diameter);
    summary.input("grains, dense", static_cast<double>(s.grains(true)));
    summary.input("grains, loose", static_cast<double>(s.grains(false)));
    summary.input("speed [m/s]", s.speed()), summary.input("inertial number", s.inertial);
    summary.result("seconds", watch.seconds());
    double overlap = 0;
    for (const Test& t : tests) check_test(summary, s, t), overlap = std::max(overlap, t.overlap);
    check_samples(summary, s, tests);
    summary.check_at_most("mean overlap over mean diameter", overlap,
                          options.quick ? 2e-3 : 1.2e-3);
    summary.check_at_most("inertial number", s.inertial, 1e-2);
    summary.write(options.out + "/summary.json");
    write_mohr(options.out, s, tests);
    summary.print_checks();
    const double sheared = s.travel * s.diameter;
    example::run_script(SILT_SHEAR_BOX_SCRIPT,
                        {options.out, silt::text(s.L()), silt::text(s.W()), silt::text(s.split()),
                         silt::text(sheared), silt::text(s.height * s.diameter - s.split())});
    return summary.all_hold() ? 0 : 1;
  });
}
