// silt - BSD-3-Clause, see LICENSE
//
// A clamped, oscillating fibre of bonded spheres: error of its first natural frequency and of its
// decay against the closed form, over the number of spheres, the time step and the bonds' damping.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/simulation.hpp>

#include "study/studies.hpp"

namespace bonds_study {

namespace {

using silt::Vec3d;
constexpr double pi = std::numbers::pi;
constexpr double length = 40e-3, diameter = 1e-3;  // [m] of the fibre, whatever it is made of
constexpr double modulus = 1e8, density = 1000;    // [Pa], [kg/m3]
constexpr double area = pi * diameter * diameter / 4;
constexpr double inertia = area * diameter * diameter / 16;  // [m4] of the cross section

/// Displacement of the first mode at x from the clamp, 1 at the tip.
constexpr double root = 1.8751041;
const double share = (std::cosh(root) + std::cos(root)) / (std::sinh(root) + std::sin(root));
double mode(double x) {
  const double z = root * x / length;
  return (std::cosh(z) - std::cos(z) - share * (std::sinh(z) - std::sin(z))) / 2;
}
/// Angular frequency [1/s] of the first mode by Euler-Bernoulli theory, reduced by the effect of
/// shear: half of the shear energy over the bending energy, 0.02 % here (Rayleigh's quotient).
double frequency() {
  const double per_length = root / length;
  double bending = 0, shear = 0;
  for (int k = 0; k < 2000; ++k) {
    const double z = root * (k + 0.5) / 2000;
    const double two = std::cosh(z) + std::cos(z) - share * (std::sinh(z) + std::sin(z));
    const double three = std::sinh(z) - std::sin(z) - share * (std::cosh(z) + std::cos(z));
    bending += two * two, shear += three * three * per_length * per_length;
  }
  const double flexible =
      silt::ParallelBond{.youngs_modulus = modulus}.stiffness_ratio * inertia / area;
  return per_length * per_length * std::sqrt(modulus * inertia / (density * area)) *
         (1 - 0.5 * flexible * shear / bending);
}
double slope(double x) {
  const double h = 1e-5 * length;
  return (mode(x + h) - mode(x - h)) / (2 * h);
}

/// A fibre of n spheres: their spacing is the length over n, the bonds have the fibre's thickness,
/// and each sphere has the mass of its segment. A fixed sphere is the clamp; the tip sphere has
/// half the mass. The fibre passes through its rest position with the velocities of the first mode.
auto fibre(int n, double damping) {
  const double pitch = length / n, radius = pitch / 2;
  const silt::HertzMindlin::Material like{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
  silt::Simulation sim{
      silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{like},
      silt::Bonds{silt::ParallelBond{
          .youngs_modulus = modulus, .radius_ratio = diameter / 2 / radius, .damping = damping}},
      silt::EnergyLedger{}};
  sim.threads = 1;
  auto all = silt::fibre(
      {0, 0, 0}, {length, 0, 0}, static_cast<std::size_t>(n) + 1,
      {.radius = radius, .density = density * area * pitch / silt::sphere_volume(radius)});
  all.spheres[0].fixed = true, all.spheres.back().density /= 2;
  add_bonded(sim, all);
  const double speed = 1e-3 * length * frequency();  // the tip swings by 1e-3 of the length
  for (std::size_t k = 1; k < sim.rows(); ++k) {
    const double x = sim.position(k).x;
    sim.set_velocity(sim.id(k), {0, 0, speed * mode(x)});
    sim.set_angular_velocity(sim.id(k), {0, -speed * slope(std::min(x, length * (1 - 2e-5))), 0});
  }
  return sim;
}
template <class Sim>
double tip(const Sim& sim) {
  return sim.position(sim.find(static_cast<silt::ParticleId>(sim.rows() - 1))).z;
}
/// [s] next time at which the tip passes through its rest position.
template <class Sim>
double next_pass(Sim& sim, double about) {
  sim.run(0.9 * about);
  for (double before = tip(sim);;) {
    const double at = sim.time();
    sim.run(std::max(sim.step_length(), 0.005 * about));
    const double now = tip(sim);
    if (before * now <= 0) return at + (sim.time() - at) * before / (before - now);
    before = now;
  }
}

struct Choice {
  int n = 20;
  double step = 1;  // [-] over the one that silt chooses
  double damping = 0.1;
};
/// [-] fraction of the oscillation energy that bonds dissipate per cycle, if the mode is damped
/// like one bond: by damping w sqrt(I/k_b) of critical, with I and k_b of a pair.
double closed_loss(const Choice& c) {
  const double pitch = length / c.n, m = density * area * pitch / 2;
  const double I = 0.4 * m * pitch * pitch / 4, k = modulus * inertia / pitch;
  return 1 - std::exp(-4 * pi * c.damping * frequency() * std::sqrt(I / k));
}

silt::Study::Variant swing(const Choice& c) {
  return [c](silt::StudyRun& run) {
    auto sim = fibre(c.n, c.damping);
    sim.run(0);
    const double chosen = sim.step_length();
    if (c.step != 1) sim.time_step = c.step * chosen;
    const double half = pi / frequency(), start = sim.energy().kinetic();
    double first = 0, second = 0, left = 0;
    run.time([&] {
      first = next_pass(sim, half), left = sim.energy().kinetic() + sim.energy().bonds;
      second = next_pass(sim, half);
    });
    const auto e = sim.energy();
    run.error("error of frequency", 100 * (half / (second - first) - 1), "%");
    run.note("energy lost a cycle", 200 * (1 - left / start), "%");
    run.note("by one bond's damping", 100 * closed_loss(c), "%");
    run.note("ledger's residual", 100 * std::abs(e.residual()) / start, "%");
    run.note("dt", 1e6 * sim.step_length(), "us");
    run.note("steps a cycle", 2 * half / sim.step_length());
  };
}

bool draw(const std::string& folder, const std::vector<int>& counts, const silt::Study& study) {
  const std::string path = folder + "/error_over_spheres.csv";
  silt::CsvTable table(path, {"spheres a length [-]", "first frequency [%]", "second order [%]",
                              "cost of a cycle [s]"});
  const auto& rows = study.results().rows;
  const double first = std::abs(rows[0].error("error of frequency")->value);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const double ratio = static_cast<double>(counts[0]) / counts[k];
    table.add_row({static_cast<double>(counts[k]),
                   std::abs(rows[k].error("error of frequency")->value), first * ratio * ratio,
                   rows[k].cost()});
  }
  return example::draw({"curves", path, "--x", "spheres a length", "--y",
                        "first frequency,second order", "--log", "xy", "--y-label", "error [%]",
                        "--title", "A clamped fibre's first frequency over spheres a length",
                        "--out", folder + "/error_over_spheres.png"});
}

void run(const studies::Setting& setting, example::Summary& summary) {
  const std::vector<int> counts =
      setting.quick ? std::vector<int>{5, 10, 20} : std::vector<int>{5, 10, 20, 40};
  silt::Study spheres("A clamped fibre of 40 diameters swings: spheres a length");
  for (const int n : counts) spheres.variant(silt::text(n, " spheres"), swing({.n = n}));
  spheres.accept("error of frequency", 0.5);
  studies::run_and_report(spheres, setting, "spheres");

  const int n = 10;
  silt::Study steps(silt::text("The same of ", n, " spheres: time step over the one chosen"));
  for (const double step : {0.25, 0.5, 1.0, 2.0, 3.0, 3.8, 6.0})
    steps.variant(silt::text("step x ", step), swing({.n = n, .step = step}));
  steps.accept("error of frequency", 1);
  studies::run_and_report(steps, setting, "step");

  silt::Study damping(silt::text("The same of ", n, " spheres: damping of the bonds"));
  for (const double d : {0.0, 0.01, 0.1, 0.3, 1.0, 3.0})
    damping.variant(silt::text("damping ", d), swing({.n = n, .damping = d}));
  damping.accept("error of frequency", 1);
  studies::run_and_report(damping, setting, "damping");

  if (draw(setting.out, counts, spheres))
    std::printf("Look at %s/error_over_spheres.png.\n", setting.out.c_str());
  studies::add_recommendation(summary, "spheres", spheres);

  // Second order in 1/n. The longest allowed step and the dashpots change the frequency of a slow
  // oscillation by far less than the number of spheres does; a longer step is refused.
  const auto error = [](const silt::Study& of, std::size_t k) {
    return std::abs(of.results().rows[k].error("error of frequency")->value);
  };
  for (std::size_t k = 1; k < counts.size(); ++k)
    summary.check_at_most(silt::text("off_order_2_from_", counts[k - 1], "_to_", counts[k]),
                          std::abs(std::log2(error(spheres, k - 1) / error(spheres, k)) - 2), 0.1);
  const auto& tried = steps.results().rows;
  for (std::size_t k = 0; k + 1 < tried.size(); ++k)
    summary.check_at_most(silt::text("frequency_off_by_the_step_percent_", tried[k].name),
                          std::abs(error(steps, k) - error(steps, 0)), 0.02);
  summary.check_at_most("step_x_6_is_refused", tried.back().failed() ? 0 : 1, 0);
  for (std::size_t k = 0; k < damping.results().rows.size(); ++k)
    summary.check_at_most(
        silt::text("frequency_off_by_damping_percent_", damping.results().rows[k].name),
        std::abs(error(damping, k) - error(damping, 0)), 0.1);
}

const studies::Registered here{
    "bonds", "a fibre of bonded spheres: spheres a length, time step, damping", run};

}  // namespace

}  // namespace bonds_study
