// silt - BSD-3-Clause, see LICENSE
// One impact: restitution, modulus, speed, size; and several moduli and sizes in one scene.

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/impact.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/motion/gear.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace impacts_rows {

using namespace silt;
using enum DampingEnd;
using Kept = BasicHertzMindlin<ZeroOverlap>;

template <class Law>
Contacts<Law> hertz(double modulus, double e) {
  return Contacts<Law>{
      {.youngs_modulus = modulus, .poisson_ratio = 0.3, .restitution = e, .friction = 0}};
}

/// One impact with Hertz' law, the worst of `phases` starts, against its closed forms.
template <class Precision, DampingEnd End>
Measures impact(double modulus, double e, Hit hit, int phases = 8) {
  const auto contacts = hertz<BasicHertzMindlin<End>>(modulus, e);
  const double zeta = damping_ratio(e, End);
  const HertzImpact exact{effective_modulus(modulus, 0.3, modulus, 0.3), hit.R_eff(), hit.m_eff(),
                          hit.speed, zeta};
  const double contact = hertz_contact_time(exact.E_eff, exact.R_eff, exact.m_eff, exact.speed);
  const double overlap = hertz_max_overlap(exact) / hit.smaller();
  hit.duration = 4 * contact;
  Measures worst{{"restitution", 0, 0}, {"largest overlap", 0, 0}, {"momentum", 0, 1e-12}};
  if constexpr (std::is_same_v<Precision, Mixed>) worst[2].bound = 1e-6;
  for (int k = 0; k < phases; ++k) {
    hit.gap = 0.01 * (1 + 0.37 * k);
    const auto found = rebound<Precision>(contacts, hit);
    const double bound = rebound_bound(zeta, contact / found.time_step);
    worst[0] = {"restitution", std::max(worst[0].error, std::abs(found.restitution - e)),
                e * bound};
    worst[1] = {"largest overlap", std::max(worst[1].error, std::abs(found.overlap / overlap - 1)),
                bound};
    worst[2].error = std::max(worst[2].error, found.impulse);
  }
  return worst;
}

Measures linear_impact(double stiffness, double e, Hit hit) {
  const Contacts<LinearSpring> contacts{{.stiffness = stiffness, .restitution = e}};
  const double zeta = damping_ratio(e, ZeroForce);
  const double contact = linear_contact_time(stiffness, hit.m_eff(), 0);
  const double overlap =
      linear_max_overlap(stiffness, hit.m_eff(), hit.speed, zeta) / hit.smaller();
  hit.duration = 4 * contact;
  Measures worst{{"restitution", 0, 0}, {"largest overlap", 0, 0}};
  for (int k = 0; k < 8; ++k) {
    hit.gap = 0.01 * (1 + 0.37 * k);
    const auto found = rebound<Double>(contacts, hit);
    const double bound = rebound_bound(zeta, contact / found.time_step);
    worst[0] = {"restitution", std::max(worst[0].error, std::abs(found.restitution - e)),
                e * bound};
    worst[1] = {"largest overlap", std::max(worst[1].error, std::abs(found.overlap / overlap - 1)),
                bound};
  }
  return worst;
}

/// Two equal spheres with an integrator, at silt's choice of the time step, or at the limit of the
/// guard, 2.5 times that.
template <class Integrator, class Law>
Measures by_integrator(const Contacts<Law>& contacts, double e, bool at_limit) {
  Hit hit{.partner = 1e-3};
  const double contact =
      Law::contact_time(contacts.coefficients(0, 0), hit.R_eff(), hit.m_eff(), hit.speed);
  hit.duration = 12 * contact;
  const double chosen = rebound<Integrator>(contacts, hit).time_step;
  if (at_limit) hit.time_step = 0.999 * 20 / 8 * chosen;
  Measures worst{{"restitution", 0, 0}, {"energy gained", 0, 0}};
  for (int k = 0; k < 16; ++k) {
    hit.gap = 0.01 + k / 16.0 * chosen * hit.speed / hit.radius;
    const auto found = rebound<Integrator>(contacts, hit);
    // Errors of the others (impact.hpp), and 0.02 where strong dashpots determine the step.
    const double n = contact / found.time_step;
    const double bound = e * rebound_bound(damping_ratio(e, ZeroForce), n);
    worst[0] = {"restitution", std::max(worst[0].error, std::abs(found.restitution - e)),
                at_limit ? std::max(bound, 0.06) : std::max(bound, 0.02)};
    worst[1].error = std::max(worst[1].error, found.restitution * found.restitution - 1);
    worst[1].bound = 3.8 / (n * n);  // of an elastic spring: twice that of the speed
  }
  return worst;
}

template <class Integrator>
void rows_of_integrator(Table& table, const std::string& name) {
  const auto restitutions =
      table.quick ? std::vector<double>{0.05} : std::vector<double>{1, 0.5, 0.1, 0.05, 0.01};
  for (const double e : restitutions)
    for (const bool at_limit : {false, true}) {
      const auto where = text(name, ", e = ", e, at_limit ? ", at the limit, " : ", as chosen, ");
      table.row(where + "Hertz", Setting::Tame, [=] {
        return by_integrator<Integrator>(hertz<HertzMindlin>(1e7, e), e, at_limit);
      });
      table.row(where + "linear spring", Setting::Tame, [=] {
        const Contacts<LinearSpring> spring{{.stiffness = 1e4, .restitution = e}};
        return by_integrator<Integrator>(spring, e, at_limit);
      });
    }
}

/// Two large spheres of a light foam collide, near a small one of steel that is heavier all the
/// same: whose contacts are the shortest?
Measures light_and_heavy() {
  const double large = 5e-3, foam = 5, e = 0.5, speed = 1, modulus = 1e6;
  const auto contacts = hertz<HertzMindlin>(modulus, e);
  const double m = mass_of(large, foam) / 2;
  const double contact =
      hertz_contact_time(effective_modulus(modulus, 0.3, modulus, 0.3), large / 2, m, speed);
  double worst = 0, n = 0;
  for (int phase = 0; phase < 8; ++phase) {
    Particles<Sphere> spheres;
    const double gap = 0.01 * (1 + 0.37 * phase) * large;
    spheres.add({.position = {0, 0, large + gap},
                 .radius = large,
                 .density = foam,
                 .velocity = {0, 0, -speed}});
    spheres.add({.position = {0, 0, -large}, .radius = large, .density = foam});
    spheres.add({.position = {0.1, 0, 0}, .radius = 5e-4, .density = 7800});
    Simulation sim{std::move(spheres), contacts};
    sim.threads = 1;
    sim.run(0);
    sim.time_step = 0.999 * *sim.time_step_limit(speed);
    sim.run(gap / speed + 4 * contact);
    n = contact / sim.step_length();
    const double parting = sim.velocity(sim.find(0)).z - sim.velocity(sim.find(1)).z;
    worst = std::max(worst, std::abs(parting / speed - e));
  }
  const double zeta = damping_ratio(e, ZeroForce);
  return {{"restitution", worst, e * rebound_bound(zeta, n)},
          {"steps short of 8 a contact", std::max(1 - n / 8, 0.0), 0}};
}

}  // namespace impacts_rows

void impacts(Table& table) {
  using namespace impacts_rows;
  table.scene("Restitution from 0.05 to 1, at the time step that silt chooses",
              "rebound and largest overlap as the closed forms, within 2 pi zeta/n + 1.9/n^2 of "
              "them\n          (n steps a contact), in the worst of 8 phases");
  const auto restitutions = table.quick ? std::vector<double>{0.05, 0.5, 1}
                                        : std::vector<double>{0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 1};
  for (const double e : restitutions) {
    for (const double partner : {0.0, 1e-3}) {
      const std::string with = text("e = ", e, partner > 0 ? ", pair, " : ", plane, ");
      const Hit hit{.partner = partner};
      table.row(with + "Hertz, cut at zero force", Setting::Tame,
                [&] { return impact<Double, ZeroForce>(1e7, e, hit); });
      table.row(with + "Hertz, attraction kept", Setting::Tame,
                [&] { return impact<Double, ZeroOverlap>(1e7, e, hit); });
      table.row(with + "linear spring", Setting::Tame, [&] { return linear_impact(1e4, e, hit); });
    }
    table.row(text("e = ", e, ", pair, Hertz, mixed precision"), Setting::Tame,
              [&] { return impact<Mixed, ZeroForce>(1e7, e, {.partner = 1e-3}); });
  }

  table.scene("Integrators by restitution, at the time step that silt chooses and at the limit",
              "rebound as the closed form within that or 0.02 (at the limit 0.06), in the worst of "
              "16 phases;\n          no energy is gained but the elastic ones' 3.8/n^2");
  rows_of_integrator<SymplecticEuler>(table, "symplectic Euler");
  rows_of_integrator<Gear>(table, "Gear");

  table.scene("Impacts from 0.01 to 300 m/s, e = 0.5",
              "as above; the guard may stop what presses a sphere in by more than 30 % of its "
              "radius");
  for (const double modulus : {1e7, 7e10, 2e11})
    for (const double speed : {0.01, 1.0, 30.0, 100.0, 300.0}) {
      const Hit hit{.density = modulus > 1e11 ? 7800.0 : 2500.0, .speed = speed};
      const double E = effective_modulus(modulus, 0.3, modulus, 0.3);
      const HertzImpact exact{E, hit.R_eff(), hit.m_eff(), speed, damping_ratio(0.5, ZeroForce)};
      const bool fits = hertz_max_overlap(exact) / hit.radius < 0.28;
      table.row(text("E = ", modulus, " Pa, ", speed, " m/s"),
                fits ? Setting::Tame : Setting::Extreme,
                [&] { return impact<Double, ZeroForce>(modulus, 0.5, hit); });
      if (modulus == 2e11)
        table.row(text("E = ", modulus, " Pa, ", speed, " m/s, mixed precision"),
                  fits ? Setting::Tame : Setting::Extreme,
                  [&] { return impact<Mixed, ZeroForce>(modulus, 0.5, hit); });
    }

  table.scene("Size ratios to 1:100, mass ratios to 1:1e6", "as above, on either side at rest");
  for (const double ratio : {1.0, 10.0, 100.0})
    for (const bool small_flies : {true, false}) {
      const double other = 1e-4 * ratio;
      const Hit hit{.radius = small_flies ? 1e-4 : other, .partner = small_flies ? other : 1e-4};
      const std::string name = text("1:", ratio, ", mass 1:", ratio * ratio * ratio, ", ",
                                    small_flies ? "the small one flies" : "the large one flies");
      table.row(name, Setting::Tame, [&] { return impact<Double, ZeroForce>(1e8, 0.5, hit); });
      table.row(name + ", mixed", Setting::Tame,
                [&] { return impact<Mixed, ZeroForce>(1e8, 0.5, hit); });
    }

  table.scene("A large light sphere and a small heavy one, at the limit of the time step",
              "two large ones rebound as the closed forms: the limit must be theirs");
  table.row("10 mm of 5 kg/m3, 1 mm of 7800 kg/m3", Setting::Tame,
            [] { return light_and_heavy(); });
}

}  // namespace stability
