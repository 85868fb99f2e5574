// silt - BSD-3-Clause, see LICENSE
// Time steps from 0.01 to 10 times the limit of the guard, which is an eighth of a contact.

#include <functional>

#include <silt/contact/damped_impact.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/impact.hpp>
#include <silt/contact/linear_spring.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace time_steps_rows {

using namespace silt;
using enum DampingEnd;
using Kept = BasicHertzMindlin<ZeroOverlap>;
using Viscous = HertzDamped<KuwabaraKono>;

constexpr double limit = 8;  // steps a contact at the limit of the guard

/// A law, the exact result of its impact at 1 m/s of two spheres of 1 mm, and how to run it.
struct Candidate {
  std::string name;
  double restitution, zeta;  // [-]; zeta: for the bound
  double contact;            // [s] without damping
  std::function<Rebound(const Hit&)> run;
};

template <class Law>
Candidate candidate(const std::string& name, const typename Law::Material& material, double e,
                    double zeta) {
  const Contacts<Law> contacts{material};
  const Hit hit{.partner = 1e-3};
  const double contact =
      Law::contact_time(contacts.coefficients(0, 0), hit.R_eff(), hit.m_eff(), 1);
  return {name, e, zeta, contact, [=](const Hit& h) { return rebound<Double>(contacts, h); }};
}

std::vector<Candidate> candidates() {
  std::vector<Candidate> all;
  const double E = 1e8, k = 3e4;  // [Pa], [N/m]
  for (const double e : {1.0, 0.5, 0.1, 0.05}) {
    const double zeta = damping_ratio(e, ZeroForce);
    all.push_back(candidate<HertzMindlin>(text("Hertz, e = ", e), {E, 0.3, e, 0.0}, e, zeta));
  }
  all.push_back(candidate<Kept>("Hertz, attraction kept, e = 0.5", {E, 0.3, 0.5, 0.0}, 0.5,
                                damping_ratio(0.5, ZeroOverlap)));
  const Hit hit{.partner = 1e-3};
  const HertzImpact impact{effective_modulus(E, 0.3, E, 0.3), hit.R_eff(), hit.m_eff(), 1, 0};
  all.push_back(
      candidate<Viscous>("Hertz, Kuwabara-Kono, e = 0.5",
                         {E, 0.3, dissipation_for<KuwabaraKono>(0.5, impact, ZeroForce), 0.0}, 0.5,
                         damping_ratio(0.5, ZeroForce)));
  for (const double e : {1.0, 0.5})
    all.push_back(candidate<LinearSpring>(text("linear spring, e = ", e), {k, e}, e,
                                          damping_ratio(e, ZeroForce)));
  return all;
}

enum class Limits { Default, StepLifted, AllLifted };

/// The worst error of the rebound speed over the impact speed, from `phases` starts.
double worst_error(const Candidate& c, double share, int phases, Limits limits) {
  Hit hit{.partner = 1e-3, .time_step = share * c.contact / limit};
  hit.lifted_to = limits == Limits::StepLifted ? 1e3 : 0;
  hit.unguarded = limits == Limits::AllLifted;
  hit.duration = 4 * c.contact + 10 * hit.time_step;
  double worst = 0;
  for (int k = 0; k < phases; ++k) {
    // Far enough away for the first step, with first touch at a different phase of a step each
    // time.
    hit.gap = (3 + (k + 0.5) / phases) * hit.time_step * hit.speed / hit.radius;
    worst = std::max(worst, std::abs(c.run(hit).restitution - c.restitution));
  }
  return worst;
}

double most(const Candidate& c, double share) {
  return c.restitution * rebound_bound(c.zeta, limit / share);
}

}  // namespace time_steps_rows

std::vector<StepPoint> time_steps(Table& table) {
  using namespace time_steps_rows;
  table.scene("Time steps from 0.01 to 10 times the limit (t_c/8), one impact of two spheres",
              "the speed after over that before as the closed form, within e (2 pi zeta/n + "
              "1.9/n^2), in\n          the worst of 16 phases");
  const auto all = candidates();
  for (const auto& c : all) {
    const auto run = [&](double share, bool lifted) {
      return Measures{{"speed after impact",
                       worst_error(c, share, 16, lifted ? Limits::StepLifted : Limits::Default),
                       most(c, share)}};
    };
    const auto row = [&](double share, Setting setting, bool lifted) {
      table.row(text(c.name, ", ", share, lifted ? " with the limit lifted" : ""), setting,
                [&] { return run(share, lifted); });
    };
    for (const double share : {0.01, 0.1, 0.5, 0.999})
      if (!table.quick || share > 0.1)
        // At e = 0.05 the dashpot makes the limit shorter than an eighth of the contact.
        row(share, c.restitution < 0.1 && share > 0.9 ? Setting::Extreme : Setting::Tame, false);
    table.stops(text(c.name, ", 1.01"), "is above the limit", [&] { return run(1.01, false); });
    for (const double share : {1.01, 1.5, 2.0, 3.0, 5.0, 10.0}) row(share, Setting::Extreme, true);
  }

  std::vector<StepPoint> points;
  const int phases = table.quick ? 8 : 32;
  const double factor = table.quick ? 1.6 : 1.2;
  for (const auto& c : all)
    for (double share = table.quick ? 0.1 : 0.01; share < 10.01; share *= factor) {
      StepPoint point{c.name, share, 0, most(c, share), false};
      point.error = worst_error(c, share, phases, Limits::AllLifted);
      try {
        worst_error(c, share, phases, Limits::StepLifted);
      } catch (const Error&) {
        point.stopped = true;
      }
      points.push_back(point);
    }
  return points;
}

}  // namespace stability
