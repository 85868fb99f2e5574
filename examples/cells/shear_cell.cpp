// silt - BSD-3-Clause, see LICENSE
//
// A shear cell: spheres in a periodic box are sheared at a constant rate under constant normal
// stress, at several inertial numbers I = rate d sqrt(density/stress). Plots: effective friction
// mu(I) and solid fraction over I.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/files/csv_table.hpp>

#include "cells/scene.hpp"
#include "support/example.hpp"

namespace {

struct Steady {
  double inertial = 0, fraction = 0, stress = 0;  // [-]
  double friction = 0, error = 0;                 // [-] and of its mean
  double profile = 0, error_of_profile = 0;       // [-] slope of the velocity over the rate
};
/// Mean of blocks that are assumed independent, and its standard error.
void mean_of(const std::vector<double>& blocks, double& mean, double& error) {
  const auto n = static_cast<double>(blocks.size());
  mean = error = 0;
  for (const double b : blocks) mean += b / n;
  for (const double b : blocks) error += std::pow(b - mean, 2) / (n * (n - 1));
  error = std::sqrt(error);
}
/// mu(I) of P. Jop, Y. Forterre, O. Pouliquen, Nature 441 (2006) 727, with these constants;
/// recalled.
double law(double inertial, double mu_s, double mu_2, double I_0) {
  return mu_s + (mu_2 - mu_s) / (1 + I_0 / inertial);
}

/// Shears by `strain` to forget the initial state, then by the same strain to measure.
template <class Sim>
Steady shear(Sim& sim, const cells::Sample& s, double inertial, double least_strain) {
  // Fast shear gets 60 inertial times, in which the servo finds the volume.
  const double strain = std::max(least_strain, 60 * inertial);
  const double rate = inertial / s.inertial_time();
  const silt::BoxDrive normal{.stress = s.pressure, .most_rate = 0.05 / s.inertial_time()};
  sim.deform({.y = normal, .xy = {.rate = rate}});
  sim.run(strain / rate, silt::progress());
  Steady out;
  out.inertial = inertial;
  std::vector<double> ratios, slopes;  // means of the stress ratio and of the profile's slope
  constexpr int samples = 1000, parts = 10;
  double shear = 0, stress = 0;
  int count = 0;
  double slope = 0, weight = 0;
  sim.run(strain / rate,
          silt::at(silt::every(strain / rate / samples),
                   [&](const auto& now) {
                     const auto& box = now.domain();
                     shear += box.stress().xy, stress += box.stress().y;
                     out.fraction += cells::solid_fraction(now) / samples;
                     out.stress += box.stress().y / s.pressure / samples;
                     // Least squares of the velocity over the height, with periodic images mapped
                     // into the box.
                     for (std::size_t k = 0; k < now.rows(); ++k) {
                       const auto at = now.position(k), p = box.wrapped(at);
                       const auto v = now.velocity(k) + box.flow_at(p) - box.flow_at(at);
                       const double y = p.y - box.centre().y;
                       slope += v.x * y, weight += y * y;
                     }
                     if (++count % (samples / parts) != 0) return;
                     ratios.push_back(shear / stress), shear = stress = 0;
                     slopes.push_back(slope / weight / rate), slope = weight = 0;
                   }),
          silt::progress());
  mean_of(ratios, out.friction, out.error);
  mean_of(slopes, out.profile, out.error_of_profile);
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("Simple shear of spheres at constant normal stress: mu(I)",
                           example::Kind::Cases, "out/shear_cell");
  cells::Sample s;
  double strain = 2;
  command.add("--spheres", s.spheres, 200, 1e6, "Number of spheres");
  command.add("--friction", s.friction, 0.01, 10, "Friction between particles [-]");
  command.add("--pressure", s.pressure, 1, 1e9, "Normal stress [Pa]");
  command.add("--strain", strain, 0.1, 100,
              "Shear strain before the measurement, and during it [-]");
  return command.run(argc, argv, [&] {
    const auto& options = command.options;
    std::vector<double> numbers{0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3};
    if (options.quick && !command.given("--spheres")) s.spheres = 512;
    if (options.quick) numbers = {0.3, 0.1, 0.03, 0.01};
    silt::make_folder(options.out);
    const example::Stopwatch watch;
    example::Summary summary;
    summary.input("spheres", s.spheres), summary.input("friction", s.friction);
    summary.input("normal stress [Pa]", s.pressure), summary.input("strain", strain);
    auto sim = cells::make_cell(s, options.threads);
    cells::make_rough(sim);
    cells::compress(sim, s);
    silt::CsvTable table(options.out + "/shear_cell.csv",
                         {"I", "mu", "error of mu", "solid fraction", "law"});
    std::vector<Steady> all;
    for (const double inertial : numbers) {
      std::printf("I = %g\n", inertial);
      all.push_back(shear(sim, s, inertial, strain));
      const Steady& a = all.back();
      table.add_row(
          {a.inertial, a.friction, a.error, a.fraction, law(a.inertial, 0.38, 0.64, 0.28)});
      const std::string of = silt::text("I = ", inertial, ": ");
      summary.result(of + "mu", a.friction), summary.result(of + "solid fraction", a.fraction);
      summary.check_within(of + "normal stress over the one wanted", a.stress, 1, 0.02,
                           "servo, in the mean");
      // 0 or 2 if the velocities of periodic images are wrong. Slow shear is not uniform over a
      // strain of 2: at I = 0.003 and 0.001 the value is 0.87 and 1.10, for 200 samples and for
      // 1000.
      summary.check_within(of + "slope of the velocity's profile over the rate", a.profile, 1,
                           0.03 + 4 * a.error_of_profile,
                           "0.03 and four standard errors of ten blocks");
      if (a.inertial > 0.009)
        summary.check_at_most(of + "standard error of this slope", a.error_of_profile, 0.06);
    }
    silt::write_particles(options.out + "/spheres.vtp", sim);
    summary.result("seconds", watch.seconds());
    // Slow shear: 0.36 to 0.41 in simulations of spheres with friction of 0.5; recalled (S.
    // Chialvo, J. Sun, S. Sundaresan, Phys. Rev. E 85 (2012) 021305: 0.382 for I -> 0; at I = 0.01
    // some hundredths more).
    for (const Steady& a : all)
      if (a.inertial <= 0.011)
        summary.check_within(silt::text("I = ", a.inertial, ": mu of slow shear"), a.friction,
                             0.385 + 1.1 * a.inertial, options.quick ? 0.06 : 0.04,
                             "published values, recalled; fluctuations");
    bool rises = true, dilates = true;
    for (std::size_t k = 0; k + 1 < all.size(); ++k)
      rises &= all[k].friction > all[k + 1].friction - 3 * (all[k].error + all[k + 1].error),
          dilates &= all[k].fraction < all[k + 1].fraction + 2e-3;
    summary.check_at_least("mu rises with I", rises, 1);
    summary.check_at_least("the solid fraction falls with I", dilates, 1);
    // da Cruz et al., Phys. Rev. E 72 (2005) 021309, and GDR MiDi, Eur. Phys. J. E 14 (2004) 341:
    // mu increases by 0.1 to 0.3 up to I = 0.3; recalled.
    summary.check_within("mu at I = 0.3 less that at 0.01", all[0].friction - all[3].friction, 0.18,
                         0.1, "band of published curves; recalled");
    summary.write(options.out + "/summary.json");
    summary.print_checks();
    example::run_script(SILT_CELLS_SCRIPT, {"shear_cell", options.out});
    return summary.all_hold() ? 0 : 1;
  });
}
