// silt - BSD-3-Clause, see LICENSE
//
// Restitution of unequal partners if the dashpot of a pair is computed from values of each partner
// alone: four rules used by codes (silt/study/unequal_damping.hpp), each as a law in a real
// Simulation, against the pair's own dashpot, which silt uses. In the plots lines are the closed
// forms of the rules, points the measurements in the Simulation.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/simulation.hpp>
#include <silt/study/unequal_damping.hpp>

#include "study/studies.hpp"

namespace damping_rule_study {

namespace {

using silt::DashpotRule;

constexpr double wanted = 0.5;                       // [-] restitution
constexpr double small = 1e-3, density = 2500;       // [m], [kg/m3]
constexpr double speed = 1;                          // [m/s]
constexpr int steps_a_contact = 1000;                // [-]
constexpr auto end = silt::DampingEnd::ZeroOverlap;  // as codes that use such rules
using Hertz = silt::BasicHertzMindlin<end>;

/// Hertz' law with the dashpot multiplied by a wrong factor.
struct WrongDashpot {
  struct Material {
    Hertz::Material of_hertz;
    double factor;  // [-] dashpot over the pair's own
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  using Coefficients = Hertz::Coefficients<Real>;
  template <class Real>
  using History = Hertz::History<Real>;

  static Coefficients<double> mix(const Material& a, const Material& b) {
    auto p = Hertz::mix(a.of_hertz, b.of_hertz, Hertz::like(a.of_hertz));
    p.normal_damping *= a.factor;
    return p;
  }
  template <class Real>
  static silt::Traction<Real> force(const silt::Contact<Real>& c, const Coefficients<Real>& p,
                                    History<Real>& h) {
    return Hertz::force(c, p, h);
  }
  static double contact_time(const Coefficients<double>& p, double R_eff, double m_eff, double v) {
    return Hertz::contact_time(p, R_eff, m_eff, v);
  }
};
static_assert(silt::ContactLaw<WrongDashpot>);

struct Rule {
  const char* name;
  std::optional<DashpotRule> rule;  // none: the pair's own dashpot

  double factor(double ratio) const {
    return rule ? silt::dashpot_over_right(*rule, std::pow(ratio, 3)) : 1;
  }
  double closed_form(double ratio) const {
    return rule ? silt::restitution_with(*rule, wanted, std::pow(ratio, 3), end) : wanted;
  }
};
const Rule rules[] = {{"pair's own", std::nullopt},
                      {"in series", DashpotRule::DashpotsInSeries},
                      {"harmonic mean mass", DashpotRule::HarmonicMeanMass},
                      {"mean dashpot", DashpotRule::MeanDashpot},
                      {"mean mass", DashpotRule::MeanMass}};

constexpr Hertz::Material hertz{
    .youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = wanted};

/// Contact time [s] of an elastic impact of spheres of 1 mm and `ratio` mm.
double contact_time(double ratio) {
  const auto mass = [](double r) { return density * silt::Sphere::volume(r); };
  const double large = ratio * small;
  return Hertz::contact_time(Hertz::mix(hertz, hertz, Hertz::like(hertz)),
                             silt::effective_radius(small, large),
                             silt::effective_mass(mass(small), mass(large)), speed);
}

/// A sphere of 1 mm hits one of `ratio` mm at rest.
auto impact(const Rule& rule, double ratio) {
  const double large = ratio * small, contact = contact_time(ratio);
  silt::Particles<silt::Sphere> two;
  two.add({.position = {0, 0, 0}, .radius = large, .density = density});
  two.add({.position = {large + small + 0.1 * contact * speed, 0, 0},
           .radius = small,
           .density = density,
           .velocity = {-speed, 0, 0}});
  silt::Simulation sim{std::move(two), silt::Contacts<WrongDashpot>{
                                           WrongDashpot::Material{hertz, rule.factor(ratio)}}};
  sim.threads = 1;
  sim.time_step = contact / steps_a_contact;
  return sim;
}

/// Long enough for pairs that never separate to come to rest: they creep back to zero overlap.
double duration(double ratio) { return 30 * contact_time(ratio); }  // [s]

double restitution(const Rule& rule, double ratio) {
  auto sim = impact(rule, ratio);
  sim.run(duration(ratio));
  return (sim.velocity(sim.find(1)).x - sim.velocity(sim.find(0)).x) / speed;
}

silt::Study study(const std::vector<double>& sizes) {
  silt::Study study(
      "Dashpot rules for unequal spheres: worst error of e = 0.5 at size ratios to 100");
  for (const auto& rule : rules)
    study.variant(rule.name, [=](silt::StudyRun& run) {
      auto sim = impact(rule, 2);
      run.time([&] { sim.run(duration(2)); });
      run.error("worst error of e", [&] {
        double worst = 0;
        for (const double ratio : sizes)
          worst = std::max(worst, std::abs(restitution(rule, ratio) - wanted));
        return worst;
      });
      for (const double ratio : {1, 2, 5, 10})
        run.note(silt::text("e at ratio ", ratio), restitution(rule, ratio));
    });
  study.accept("worst error of e", 0.01);
  return study;
}

/// Closed forms as lines and the Simulation as points; returns the largest difference.
double compare(const std::string& folder, const std::vector<double>& sizes) {
  const std::string path = folder + "/restitution.csv";
  std::vector<std::string> columns{"size ratio [-]"};
  std::string lines, points;
  for (const auto& rule : rules) {
    columns.push_back(rule.name), columns.push_back(silt::text(rule.name, "; simulated"));
    lines += silt::text(lines.empty() ? "" : ",", rule.name);
    points += silt::text(points.empty() ? "" : ",", rule.name, "; simulated");
  }
  silt::CsvTable table(path, columns);
  double off = 0;
  for (const double ratio : sizes) {
    std::vector<double> row{ratio};
    for (const auto& rule : rules) {
      row.push_back(rule.closed_form(ratio)), row.push_back(restitution(rule, ratio));
      off = std::max(off, std::abs(row.back() - row[row.size() - 2]));
    }
    table.add_row(row);
  }
  if (example::draw({"curves", path, "--x", "size ratio", "--y", lines, "--marks", points,
                     "--marks-label", "simulated", "--y-label", "restitution [-]", "--log", "x",
                     "--title", "What dashpot rules make of a restitution of 0.5", "--out",
                     folder + "/restitution.png"}))
    std::printf("Look at %s/restitution.png.\n", folder.c_str());
  return off;
}

void run(const studies::Setting& setting, example::Summary& summary) {
  const std::vector<double> sizes =
      setting.quick ? std::vector<double>{1, 2, 5, 10, 100}
                    : std::vector<double>{1, 1.5, 2, 3, 4, 5, 7, 10, 15, 20, 30, 50, 70, 100};
  silt::Study cost = study(sizes);
  studies::run_and_report(cost, setting, "cost");
  studies::add_recommendation(summary, "rule", cost);
  const double off = compare(setting.out, sizes);
  summary.result("largest_difference_to_closed_forms", off);
  // e for a nominal 0.5, computed by another program written for this purpose, which integrates the
  // impacts. Fails if closed forms and Simulation have the same error.
  const struct {
    std::size_t rule;
    double ratio, e;
  } computed[] = {{1, 1, .616}, {1, 10, .511}, {2, 5, .366}, {3, 2, .217}, {4, 2, .175}, {4, 5, 0}};
  double off_table = 0;
  for (const auto& p : computed)
    off_table = std::max(off_table, std::abs(restitution(rules[p.rule], p.ratio) - p.e));
  // 1000 steps per contact: the dashpot's force starts at some instant within a step, with an error
  // of at most 2 pi zeta'/1000 of e (tests/physics/impact.cpp), with zeta' = 0.5 the strongest that
  // separates with e > 0.16; the table has three digits.
  const double tolerance = 2 * M_PI * 0.5 / steps_a_contact + 0.0005;
  summary.check_at_most("off_closed_forms", off, tolerance);
  summary.check_at_most("off_computed_elsewhere", off_table, tolerance);
  summary.check_at_most("pairs_own_worst_error",
                        cost.results().rows[0].error("worst error of e")->value, tolerance);
  summary.check_at_least("others_worst_error",
                         cost.results().rows[1].error("worst error of e")->value, 0.1);
}

const studies::Registered here{"damping-rule",
                               "restitution of unequal spheres, dashpots by five rules", run};

}  // namespace

}  // namespace damping_rule_study
