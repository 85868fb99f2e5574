// silt - BSD-3-Clause, see LICENSE
//
// The direct shear test of soil mechanics. A box is cut in two at mid-height: its lower half moves
// sideways, a lid under a dead weight presses on the sample. A dense and a loose sample of spheres,
// each under three normal stresses: shear stress and height of the lid over the displacement, the
// lines of Mohr and Coulomb, and dilatancy against Taylor's rule.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/files/csv_table.hpp>

#include "shear_box/scene.hpp"
#include "support/example.hpp"

namespace {

using shear_box::Scene;
using silt::Vec3d;

double degrees(double slope) { return std::atan(slope) * 180 / M_PI; }

/// A straight line y = intercept + slope x by least squares, and its standard errors.
struct Line {
  double slope = 0, intercept = 0, slope_error = 0, intercept_error = 0;
  Line(const std::vector<double>& x, const std::vector<double>& y) {
    const auto n = static_cast<double>(x.size());
    double sx = 0, sy = 0, sxx = 0, sxy = 0, left = 0;
    for (std::size_t k = 0; k < x.size(); ++k) sx += x[k] / n, sy += y[k] / n;
    for (std::size_t k = 0; k < x.size(); ++k)
      sxx += (x[k] - sx) * (x[k] - sx), sxy += (x[k] - sx) * (y[k] - sy);
    slope = sxy / sxx, intercept = sy - slope * sx;
    for (std::size_t k = 0; k < x.size(); ++k)
      left += std::pow(y[k] - intercept - slope * x[k], 2);
    const double scatter = n > 2 ? left / (n - 2) : 0;
    slope_error = std::sqrt(scatter / sxx);
    intercept_error = std::sqrt(scatter * (1 / n + sx * sx / sxx));
  }
};

/// Means over a piece of the way of the lower half.
struct Point {
  double way = 0, rise = 0;              // [m] of the lower half; of the lid, at the end
  double below = 0, above = 0;           // [N] shear force, of the lower half; of ring and lid
  double normal = 0, lid = 0;            // [N] that the lower half bears; of the lid
  double ratio() const { return below / normal; }
};

struct Test {
  std::string name;          // of the sample
  double stress = 0;         // [Pa] on the lid
  double void_ratio = 0;     // [-] before the shear
  double contacts = 0;       // [-] a grain, before the shear
  double overlap = 0;        // [-] mean of grains that touch, of the mean diameter
  std::vector<Point> curve;
  std::size_t residual_from = 0;  // points
  // Over the residual stretch:
  double work = 0, lid_work = 0;            // [J] of the shear force, and of the lid on the grains
  double dissipated = 0, held = 0, left = 0;  // [J], [J] more than before, residual of the ledger
  double momentum = 0, impulse = 0;         // [N s] what grains gained, what shear forces differ by
  double shear_impulse = 0;                 // [N s] of the lower half
  double band = 0;                          // [m] thickness of what is sheared
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
  /// The point around which the mean of seven ratios is largest.
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
  /// Rise of the lid over the way [-], the slope around a point: the tangent of dilatancy.
  double dilatancy(std::size_t from, std::size_t to) const {
    std::vector<double> x, y;
    for (std::size_t k = from; k < to; ++k) x.push_back(curve[k].way), y.push_back(curve[k].rise);
    return Line(x, y).slope;
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
/// Mean overlap of grains that touch [m]. Between runs.
template <class Sim>
double mean_overlap(const Sim& sim) {
  double sum = 0, count = 0;
  sim.for_each_contact([&](const silt::ContactSeen& c) {
    if (c.wall == silt::no_wall) sum += c.overlap, ++count;
  });
  return sum / count;
}

/// Thickness [m] in which the mean displacement falls from 9 to 1 tenth of that of the lower half,
/// over 0.8, as it would be if it fell evenly.
template <class Sim>
double sheared_band(const Sim& sim, const Scene& s, const std::vector<Vec3d>& before, double way) {
  const double layer = 0.5 * s.diameter;
  std::vector<double> sum(static_cast<std::size_t>(2.2 * s.height), 0.0), count = sum;
  sum.resize(4 * sum.size()), count.resize(sum.size());
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d& from = before[sim.id(k)];
    const auto at = static_cast<std::size_t>(std::max(from.z + s.split(), 0.0) / layer);
    if (at < sum.size()) sum[at] += (sim.position(k).x - from.x) / way, ++count[at];
  }
  std::vector<double> z, u;
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (count[k] > 10) z.push_back((static_cast<double>(k) + 0.5) * layer), u.push_back(sum[k] / count[k]);
  const auto falls_below = [&](double level) {
    for (std::size_t k = 1; k < u.size(); ++k)
      if (u[k] < level)
        return z[k - 1] + (z[k] - z[k - 1]) * std::clamp((u[k - 1] - level) / (u[k - 1] - u[k]), 0.0, 1.0);
    return z.back();
  };
  return (falls_below(0.1) - falls_below(0.9)) / 0.8;
}

/// Reads the loads of all walls as means over the pieces of a shear.
template <class Sim>
class Shear {
 public:
  Shear(Sim& sim, Test& test) : sim_(sim), test_(test), start_(height(sim)), way_(way()) {
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
  double start_, way_;
};

template <class Sim>
Vec3d momentum(const Sim& sim) {
  return sim.total_mass() * sim.mean_velocity();
}
/// [N s] of the grains on walls along the motion, since the start; of the lower half alone.
template <class Sim>
std::array<double, 2> impulses(const Sim& sim) {
  const double below = sim.wall("lower half").impulse.x + sim.wall("floor").impulse.x;
  return {below + sim.wall("upper half").impulse.x + sim.wall("lid").impulse.x, below};
}

/// The residual stretch, with its books.
template <class Sim>
void shear_on(Sim& sim, Shear<Sim>& shear, const Scene& s, Test& t, std::size_t pieces,
              double duration) {
  std::vector<Vec3d> before(sim.rows());
  for (std::size_t k = 0; k < sim.rows(); ++k) before[sim.id(k)] = sim.position(k);
  const auto books = sim.energy();
  const auto sums = impulses(sim);
  const double p = momentum(sim).x, way = shear.way();
  t.residual_from = t.curve.size();
  for (std::size_t k = 0; k < pieces; ++k) shear.piece(duration);
  const auto now = sim.energy();
  const auto last = impulses(sim);
  t.momentum = momentum(sim).x - p, t.impulse = -(last[0] - sums[0]);
  t.shear_impulse = -(last[1] - sums[1]);
  t.work = t.shear_impulse * s.speed();  // the lower half has one speed by now
  t.lid_work = now.walls - books.walls - t.work;
  t.dissipated = now.dissipated() - books.dissipated();
  t.held = now.held() - books.held(), t.left = now.residual() - books.residual();
  t.band = sheared_band(sim, s, before, shear.way() - way);
  const double end = s.L() + s.travel * s.diameter;  // all that the halves and their flanges enclose
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
    silt::write_walls(options.out + "/walls.vtp", sim,
                      {{-2 * s.diameter, 0, -s.split()},
                       {s.L() + (s.travel + 2) * s.diameter, s.W(), 0.6 * s.height * s.diameter}});
    silt::write_contacts(options.out + "/contacts.vtp", sim);
    const double start = s.travel * s.diameter;
    (void)start;
    silt::write_particles(options.out + "/end.vtp", sim);
  }
  std::printf("%-14s  peak %.3f, residual %.3f, lid up by %.2f mm, %.0f s\n", t.title().c_str(),
              t.at_peak([](const Point& p) { return p.ratio(); }),
              t.residual([](const Point& p) { return p.ratio(); }), 1e3 * t.curve.back().rise,
              watch.seconds());
  std::fflush(stdout);
  return t;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command(
      "Direct shear test of a dense and a loose sample of spheres under three normal stresses",
      example::Kind::Cases, "out/shear_box");
  Scene s;
  command.add("--friction", s.friction, 0.05, 2, "between particles [-]");
  command.add("--wall-friction", s.wall_friction, 0, 1, "on the sides of the box [-]");
  command.add("--length", s.length, 10, 200, "of the box, in grain diameters");
  command.add("--width", s.width, 5, 100, "of the box, in grain diameters");
  command.add("--height", s.height, 6, 100, "of the sample, in grain diameters");
  command.add("--travel", s.travel, 1.5, 20, "of the lower half, in grain diameters");
  command.add("--inertial-number", s.inertial, 1e-5, 1e-2, "at the lowest stress [-]");
  return command.run(argc, argv, [&] {
    const auto& options = command.options;
    if (options.quick) {
      if (!command.given("--length")) s.length = 16;
      if (!command.given("--width")) s.width = 8;
      if (!command.given("--height")) s.height = 8;
      if (!command.given("--travel")) s.travel = 2.5;
      if (!command.given("--inertial-number")) s.inertial = 5e-3;
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
    return 0;
  });
}
