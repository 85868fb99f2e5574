// silt - BSD-3-Clause, see LICENSE
//
// Triaxial compression: spheres in a periodic box are compressed isotropically, once without
// friction (a dense sample) and once with friction (a loose one). Then one axis is shortened at a
// constant rate at constant lateral stress. Plots, as usual in soil mechanics: stress ratio and
// volumetric strain over axial strain, and the alignment of the contacts with the shortened axis
// (fabric).

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/files/csv_table.hpp>

#include "cells/scene.hpp"
#include "support/example.hpp"

namespace {

struct Point {
  double strain, q_over_p, volume, lateral, fraction;  // [-] compression > 0; lateral: error
  double fabric;                                       // [-] its anisotropy
};
struct Test {
  std::string name;
  double fraction = 0, contacts = 0, unrest = 0;  // after the compression
  double contacts_late = 0;                       // at the end
  double fabric = 0, noise = 0;  // after the compression, and what it would be of random directions
  std::vector<Point> curve;

  double peak() const {
    double most = 0;
    for (std::size_t k = 2; k + 2 < curve.size(); ++k) {
      double mean = 0;
      for (std::size_t j = k - 2; j <= k + 2; ++j) mean += curve[j].q_over_p / 5;
      most = std::max(most, mean);
    }
    return most;
  }
  double turned() const {  // [-] the largest anisotropy
    double most = 0;
    for (const Point& p : curve) most = std::max(most, p.fabric);
    return most;
  }
  /// Mean of the last quarter.
  template <class Of>
  double late(const Of& of) const {
    double sum = 0;
    const std::size_t from = curve.size() * 3 / 4;
    for (std::size_t k = from; k < curve.size(); ++k) sum += of(curve[k]);
    return sum / static_cast<double>(curve.size() - from);
  }
};
/// [deg] sin(phi) = 3 (q/p)/(6 + q/p) in triaxial compression.
double angle(double q_over_p) { return std::asin(3 * q_over_p / (6 + q_over_p)) * 180 / M_PI; }

/// Fzz - (Fxx + Fyy)/2 of the fabric F, the mean of n n^T over the contacts [-]: 0 if no direction
/// is preferred, 1 if all contacts are along z.
template <class Sim>
double anisotropy(const Sim& sim) {
  const auto fabric = silt::fabric(sim);
  return fabric.zz - 0.5 * (fabric.xx + fabric.yy);
}

Test run(const cells::Sample& s, bool dense, double inertial, double most_strain,
         const example::Options& options) {
  Test test;
  test.name = dense ? "dense" : "loose";
  std::printf("%s sample\n", test.name.c_str());
  auto sim = cells::make_cell(s, options.threads);
  if (!dense) cells::make_rough(sim);
  cells::compress(sim, s);
  // One contact of random direction has a standard deviation of 3/2 sqrt(4/45) = 1/sqrt(5).
  test.fabric = anisotropy(sim);
  test.noise = 1 / std::sqrt(5.0 * static_cast<double>(sim.touching_pairs()));
  cells::make_rough(sim);
  test.fraction = cells::solid_fraction(sim), test.contacts = cells::coordination(sim);
  test.unrest = cells::unrest(sim);
  const silt::BoxDrive lateral{.stress = s.pressure, .most_rate = 0.02 / s.inertial_time()};
  const double rate = inertial / s.inertial_time();
  sim.deform({.x = lateral, .y = lateral, .z = {.rate = -rate}});
  const silt::Upper3 from = sim.domain().strain();
  // Each point is the mean of samples in its strain interval.
  constexpr int points = 100, samples = 20;
  Point sum{};
  int count = 0;
  const double duration = most_strain / rate;
  sim.run(
      duration,
      silt::at(silt::every(duration / (points * samples)),
               [&](const auto& now) {
                 const auto& box = now.domain();
                 const auto& p = box.stress();
                 const silt::Upper3 e = box.strain() - from;
                 const double side = 0.5 * (p.x + p.y), mean = (p.z + 2 * side) / 3;
                 sum.strain -= e.zz, sum.volume -= e.xx + e.yy + e.zz;
                 sum.q_over_p += (p.z - side) / mean;
                 sum.lateral += std::abs(side / s.pressure - 1);
                 sum.fraction += cells::solid_fraction(now), sum.fabric += anisotropy(now);
                 if (++count < samples) return;
                 const double all = samples;
                 test.curve.push_back({sum.strain / all, sum.q_over_p / all, sum.volume / all,
                                       sum.lateral / all, sum.fraction / all, sum.fabric / all});
                 sum = {}, count = 0;
               }),
      silt::progress());
  test.contacts_late = cells::coordination(sim);
  silt::write_particles(options.out + "/" + test.name + ".vtp", sim);
  return test;
}

void write(const std::string& out, const Test& t) {
  silt::CsvTable table(out + "/" + t.name + ".csv",
                       {"axial strain", "q/p", "volumetric strain", "error of the lateral stress",
                        "solid fraction", "anisotropy of the fabric"});
  for (const Point& p : t.curve)
    table.add_row({p.strain, p.q_over_p, p.volume, p.lateral, p.fraction, p.fabric});
}

void check(example::Summary& summary, const Test& dense, const Test& loose, bool quick) {
  for (const Test* t : {&dense, &loose}) {
    const double late = t->late([](const Point& p) { return p.q_over_p; });
    summary.result(t->name + ": solid fraction after the compression", t->fraction);
    summary.result(t->name + ": contacts a particle after it", t->contacts);
    summary.result(t->name + ": contacts a particle at the end", t->contacts_late);
    summary.result(t->name + ": peak friction angle [deg]", angle(t->peak()));
    summary.result(t->name + ": critical friction angle [deg]", angle(late));
    summary.result(t->name + ": anisotropy of the fabric after the compression", t->fabric);
    summary.result(t->name + ": largest anisotropy of the fabric", t->turned());
    summary.result(t->name + ": critical anisotropy of the fabric",
                   t->late([](const Point& p) { return p.fabric; }));
    summary.check_within(t->name + ": anisotropy after the compression", t->fabric, 0, 4 * t->noise,
                         "four standard deviations of contacts of random directions");
    summary.check_at_least(t->name + ": largest anisotropy over the scatter of random directions",
                           t->turned() / t->noise, 5);
    summary.check_at_most(t->name + ": mean error of the lateral stress",
                          t->late([](const Point& p) { return p.lateral; }), 0.02);
  }
  const auto ratio = [](const Point& p) { return p.q_over_p; };
  const auto fraction = [](const Point& p) { return p.fraction; };
  const double a = dense.late(ratio), b = loose.late(ratio);
  // Frictionless packings of hard spheres jam at 0.64, with 6 contacts per sphere without rattlers.
  summary.check_within("dense: solid fraction after the compression", dense.fraction, 0.645, 0.012,
                       "random close packing of spheres of nearly one size; recalled");
  // Recalled, from simulations of spheres with friction 0.5: Thornton, Geotechnique 50 (2000) 43;
  // Huang, Hanley, O'Sullivan and Kwok, Int. J. Numer. Anal. Methods 38 (2014) 1276.
  summary.check_within("dense: critical friction angle [deg]", angle(a), 22, 4,
                       "18 to 26 degrees in simulations of spheres; recalled");
  summary.check_at_least("dense: peak over critical stress ratio", dense.peak() / a, 1.15);
  summary.check_at_least("dense: dilates", -dense.curve.back().volume, 0.02);
  summary.check_at_least("peak of the dense sample over that of the loose one",
                         dense.peak() / loose.peak(), 1.15);
  // One critical state, independent of the initial sample.
  summary.check_within("loose and dense: critical stress ratio", b, a, (quick ? 0.15 : 0.08) * a,
                       "fluctuations of a thousand spheres");
  const auto fabric = [](const Point& p) { return p.fabric; };
  summary.check_within("loose and dense: critical anisotropy of the fabric", loose.late(fabric),
                       dense.late(fabric), quick ? 0.03 : 0.02,
                       "fluctuations of a thousand spheres");
  summary.check_within("loose and dense: critical solid fraction", loose.late(fraction),
                       dense.late(fraction), 0.012, "fluctuations of a thousand spheres");
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command(
      "Triaxial compression of a dense and a loose sample of spheres at constant lateral stress",
      example::Kind::Cases, "out/triaxial");
  cells::Sample s;
  double inertial = 5e-4, strain = 0.4;
  command.add("--spheres", s.spheres, 200, 1e6, "Number of spheres");
  command.add("--friction", s.friction, 0.01, 10, "Friction between particles [-]");
  command.add("--pressure", s.pressure, 1, 1e9, "Lateral stress [Pa]");
  command.add("--inertial-number", inertial, 1e-6, 1e-2,
              "Inertial number of the axial strain rate [-]");
  command.add("--strain", strain, 0.05, 1, "Axial strain at the end [-]");
  return command.run(argc, argv, [&] {
    const auto& options = command.options;
    if (options.quick && !command.given("--spheres")) s.spheres = 512;
    if (options.quick && !command.given("--inertial-number")) inertial = 1e-3;
    if (options.quick && !command.given("--strain")) strain = 0.3;
    silt::make_folder(options.out);
    const example::Stopwatch watch;
    example::Summary summary;
    summary.input("spheres", s.spheres), summary.input("friction", s.friction);
    summary.input("pressure [Pa]", s.pressure), summary.input("inertial number", inertial);
    const Test dense = run(s, true, inertial, strain, options);
    const Test loose = run(s, false, inertial, strain, options);
    write(options.out, dense), write(options.out, loose);
    summary.result("seconds", watch.seconds());
    check(summary, dense, loose, options.quick);
    summary.check_at_most("inertial number", inertial, 1e-3);
    summary.write(options.out + "/summary.json");
    summary.print_checks();
    example::run_script(SILT_CELLS_SCRIPT, {"triaxial", options.out});
    return summary.all_hold() ? 0 : 1;
  });
}
