// silt - BSD-3-Clause, see LICENSE
//
// Integrators on impacts: error against cost over the time step, elastic and damped, a sphere of 4
// mm on a flat wall of the same material at 7 m/s. Impacts do not show an integrator's order for
// smooth forces: Hertz' force has no third derivative at first touch, and the dashpot's force
// starts like d^(1/4). Errors are the worst over many instants of first touch within a step; a
// single one is not representative (study time-step).

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/eigen.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/motion/gear.hpp>
#include <silt/motion/leapfrog.hpp>

#include "study/studies.hpp"
#include "study/two_flats.hpp"

namespace integrator_study {

namespace {

namespace flats = studies::two_flats;

constexpr double shear_modulus = 1e7;  // [Pa]
constexpr double speed = 7;            // [m/s]
constexpr double damped = 0.5;         // [-] restitution
constexpr int phases = 32;             // [-]

/// Steps per elastic contact.
double step_of(double steps) { return flats::contact_time(shear_modulus, speed) / steps; }

/// Worst relative error of the rebound speed.
template <class Integrator>
double rebound_error(double steps, double restitution) {
  double worst = 0;
  for (int phase = 0; phase < phases; ++phase) {
    auto sim = flats::make<Integrator>(shear_modulus, restitution, speed,
                                       speed * step_of(steps) * phase / phases);
    sim.time_step = step_of(steps);
    sim.guard.max_time_step = sim.guard.max_rate = 1e9;  // Gear's limit is 20 damped steps
    // Until it has separated, and before it hits the other wall: damped contacts last up to a tenth
    // longer, and the way back up is slower.
    sim.run(0.6 * flats::free_path / speed + 1.2 * flats::contact_time(shear_modulus, speed) +
            step_of(steps));
    worst = std::max(worst, std::abs(sim.velocity(0).z / speed / restitution - 1));
  }
  return worst;
}

/// Slope of the logarithms by least squares: error ~ steps^-order.
double order(const std::vector<double>& steps, const std::vector<double>& errors) {
  std::vector<double> x, y;
  for (std::size_t k = 0; k < steps.size(); ++k)
    x.push_back(std::log(steps[k])), y.push_back(std::log(errors[k]));
  return -silt::fit_straight_line(x, y).slope;
}

struct Curve {
  std::string name;
  std::vector<double> elastic, damped;  // [%]
};

template <class Integrator>
void add(silt::Study& study, std::vector<Curve>& curves, const std::string& name,
         const std::vector<double>& steps) {
  curves.push_back({name, {}, {}});
  for (const double n : steps) {
    const double elastic = 100 * rebound_error<Integrator>(n, 1);
    const double with_dashpot = 100 * rebound_error<Integrator>(n, damped);
    curves.back().elastic.push_back(elastic), curves.back().damped.push_back(with_dashpot);
    study.variant(silt::text(name, " ", n), [=](silt::StudyRun& run) {
      auto sim = flats::make<Integrator>(shear_modulus, 1, speed);
      sim.time_step = step_of(n);
      run.time([&] { sim.run(flats::duration(shear_modulus, speed, 100)); });
      run.error("elastic rebound", elastic, "%");
      run.error("damped rebound", with_dashpot, "%");
    });
  }
}

void draw(const std::string& folder, const std::vector<double>& steps,
          const std::vector<Curve>& curves) {
  std::vector<std::string> columns{"steps a contact [-]"};
  std::string lines;
  for (const auto& c : curves) {
    if (c.name == "Euler") continue;  // it would lie on leapfrog
    for (const char* kind : {"elastic", "damped"}) {
      columns.push_back(silt::text(c.name, "; ", kind, " [%]"));
      lines += silt::text(lines.empty() ? "" : ",", c.name, "; ", kind);
    }
  }
  silt::CsvTable table(folder + "/errors.csv", columns);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    std::vector<double> row{steps[k]};
    for (const auto& c : curves)
      if (c.name != "Euler") row.push_back(c.elastic[k]), row.push_back(c.damped[k]);
    table.add_row(row);
  }
  if (example::draw({"curves", folder + "/errors.csv", "--x", "steps a contact", "--y", lines,
                     "--log", "xy", "--y-label", "worst error of the rebound [%]", "--title",
                     "Impact on a wall (symplectic Euler: as leapfrog)", "--out",
                     folder + "/errors.png"}))
    std::printf("Look at %s/errors.png.\n", folder.c_str());
}

/// Largest change of the speed in the two-flat test of 500 collisions [%].
template <class Integrator>
double two_flat_error(double C) {
  return 100 * flats::speed_error<Integrator>(shear_modulus, flats::time_step(shear_modulus, C),
                                              speed, 500);
}

void run(const studies::Setting& setting, example::Summary& summary) {
  const std::vector<double> steps = setting.quick
                                        ? std::vector<double>{10, 20, 40, 80}
                                        : std::vector<double>{10, 14, 20, 28, 40, 56, 80, 112, 160};
  silt::Study study("Integrators on impacts: steps a contact");
  std::vector<Curve> curves;
  add<silt::Leapfrog>(study, curves, "leapfrog", steps);
  add<silt::SymplecticEuler>(study, curves, "Euler", steps);
  add<silt::Gear>(study, curves, "Gear", steps);
  study.accept("elastic rebound", 0.1), study.accept("damped rebound", 1);
  studies::run_and_report(study, setting, "impacts");
  draw(setting.out, steps, curves);
  studies::add_recommendation(summary, "integrator", study);
  for (const auto& c : curves) {
    const double elastic = order(steps, c.elastic), with_dashpot = order(steps, c.damped);
    std::printf("measured orders of %s: %.2f elastic, %.2f damped\n", c.name.c_str(), elastic,
                with_dashpot);
    summary.result("order_elastic_" + c.name, elastic);
    summary.result("order_damped_" + c.name, with_dashpot);
    // First touch can lie anywhere in a step: the resulting error is a fraction of a step's
    // impulse, for the spring dt (v dt)^(3/2), for the dashpot dt (v dt)^(1/4). Worst of 32
    // instants, over a factor of 8 to 16 in steps.
    summary.check_at_most("order_elastic_off_5/2_" + c.name, std::abs(elastic - 2.5), 0.25);
    summary.check_at_most("order_damped_off_5/4_" + c.name, std::abs(with_dashpot - 1.25), 0.25);
  }
  double apart = 0;  // symplectic Euler goes through the places of leapfrog
  for (std::size_t k = 0; k < steps.size(); ++k)
    apart = std::max({apart, std::abs(curves[0].elastic[k] - curves[1].elastic[k]),
                      std::abs(curves[0].damped[k] - curves[1].damped[k])});
  summary.check_at_most("euler_off_leapfrog_percent", apart, 1e-6);
  for (const double C : {0.9, 1.0, 1.5}) {
    const double leapfrog = two_flat_error<silt::Leapfrog>(C), gear = two_flat_error<silt::Gear>(C);
    std::printf("two-flat test, C = %g: leapfrog %.3g %%, Gear %.3g %%\n", C, leapfrog, gear);
    summary.result(silt::text("two_flat_percent_leapfrog_C_", C), leapfrog);
    summary.result(silt::text("two_flat_percent_Gear_C_", C), gear);
    summary.check_at_least(silt::text("two_flat_Gear_over_leapfrog_C_", C), gear / leapfrog, 1);
  }
}

const studies::Registered here{"integrator", "integrators on elastic and damped impacts", run};

}  // namespace

}  // namespace integrator_study
