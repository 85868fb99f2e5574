// silt - BSD-3-Clause, see LICENSE
// Moduli from 1e5 to 2e11 Pa and sizes 1:100 in one scene, with one time step for all.

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/impact.hpp>

#include "stability/impact.hpp"
#include "stability/table.hpp"

namespace stability {

namespace several_rows {

using namespace silt;

constexpr double density = 2500, speed = 0.05, e = 0.5;  // [kg/m3], [m/s], [-]

/// Pairs of spheres of all combinations of moduli, side by side, each with its own impact; the
/// stiffest sets the time step. The softest contact lasts 300 times longer.
template <class Precision>
Measures moduli(const std::vector<double>& moduli, double radius, double small) {
  std::vector<HertzMindlin::Material> materials;
  for (const double E : moduli) materials.push_back({E, 0.3, e, 0});
  Contacts<HertzMindlin, SeveralMaterials> contacts{materials[0]};
  for (const auto& a : materials)
    for (const auto& b : materials) contacts.set_pair(a, b, {e, 0});
  Particles<Sphere> spheres;
  std::vector<double> expected;
  double longest = 0, shortest = 1;
  const double zeta = damping_ratio(e, DampingEnd::ZeroForce);
  for (std::size_t a = 0; a < moduli.size(); ++a)
    for (std::size_t b = 0; b < moduli.size(); ++b) {
      const double x = 3 * radius * static_cast<double>(spheres.size());
      spheres.add({.position = {x, 0, 0}, .radius = radius, .density = density, .material = a});
      spheres.add({.position = {x, 0, radius + 1.01 * small},
                   .radius = small,
                   .density = density,
                   .velocity = {0, 0, -speed},
                   .material = b});
      const double m = effective_mass(mass_of(radius, density), mass_of(small, density));
      const double R = effective_radius(radius, small);
      const double E = effective_modulus(moduli[a], 0.3, moduli[b], 0.3);
      longest = std::max(longest, hertz_contact_time(E, R, m, speed));
      shortest = std::min(shortest, hertz_contact_time(E, R, m, speed));
      expected.push_back(hertz_max_overlap({E, R, m, speed, zeta}) / small);
    }
  Simulation sim{std::move(spheres), contacts, Precision{}};
  sim.threads = 1;
  sim.run(0.02 * small / speed + 3 * longest);
  const double bound = rebound_bound(zeta, shortest / sim.step_length());
  double worst = 0, momentum = 0;
  for (std::uint32_t k = 0; k < sim.size(); k += 2) {
    const auto i = sim.find(k), j = sim.find(k + 1);
    const double parting = sim.velocity(j).z - sim.velocity(i).z;
    worst = std::max(worst, std::abs(parting / speed - e));
    const double sum = sim.mass(i) * sim.velocity(i).z + sim.mass(j) * sim.velocity(j).z;
    momentum = std::max(momentum, std::abs(-sum / (sim.mass(j) * speed) - 1));
  }
  const double deepest = *std::max_element(expected.begin(), expected.end());
  return {{"restitution", worst, e * bound},
          {"largest overlap", std::abs(sim.peak_overlap() / deepest - 1), bound},
          {"momentum", momentum, std::is_same_v<Precision, Mixed> ? 1e-5 : 1e-11}};
}

/// Glass grains of 2 mm and a steel ball of 20 mm between steel walls: the impact of glass on the
/// wall is the shortest possible contact.
Measures far_apart(bool at_limit) {
  const HertzMindlin::Material glass{1e9, 0.25, e, 0}, steel{2e11, 0.3, e, 0};
  const double radius = 1e-3, fast = 5;
  const double contact = hertz_contact_time(effective_modulus(1e9, 0.25, 2e11, 0.3), radius,
                                            mass_of(radius, density), fast);
  Measures worst{{"steps short of 20 a contact", 0, 1e-9}, {"restitution", 0, 0}};
  const double n = at_limit ? 8 / 0.999 : 20;
  worst[1].bound = e * rebound_bound(damping_ratio(e, DampingEnd::ZeroForce), n);
  for (int phase = 0; phase < 8; ++phase) {
    Contacts<HertzMindlin, SeveralMaterials> contacts{{glass, steel}};
    contacts.set_pair(glass, steel, {e, 0});
    Particles<Sphere> spheres;
    const double gap = 0.01 * (1 + 0.37 * phase) * radius;
    spheres.add({.position = {0, 0, radius + gap},
                 .radius = radius,
                 .density = density,
                 .velocity = {0, 0, -fast}});
    spheres.add({.position = {0.1, 0, 0.02}, .radius = 1e-2, .density = 7800, .material = 1});
    Simulation sim{std::move(spheres), contacts, Double{}};
    sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, steel);
    sim.threads = 1;
    sim.run(0);
    worst[0].error = std::max(worst[0].error, std::abs(contact / sim.step_length() / 20 - 1));
    if (at_limit) sim.time_step = 0.999 * *sim.time_step_limit(fast);
    sim.run(gap / fast + 3 * contact);
    worst[1].error = std::max(worst[1].error, std::abs(sim.velocity(sim.find(0)).z / fast - e));
  }
  return worst;
}

}  // namespace several_rows

void several(Table& table) {
  using namespace several_rows;
  table.scene(
      "Moduli from 1e5 to 2e11 Pa in one scene, every one against every other, e = 0.5",
      "restitution and momentum of every pair, largest overlap of all, as the closed forms");
  const std::vector<double> all{1e5, 1e7, 1e9, 2e11};
  table.row("spheres of 2 mm", Setting::Tame, [&] { return moduli<Double>(all, 1e-3, 1e-3); });
  table.row("spheres of 2 mm, mixed precision", Setting::Tame,
            [&] { return moduli<Mixed>(all, 1e-3, 1e-3); });
  table.row("size ratio 1:100 as well", Setting::Tame,
            [&] { return moduli<Double>(all, 1e-2, 1e-4); });
  table.row("size ratio 1:100 as well, mixed precision", Setting::Tame,
            [&] { return moduli<Mixed>(all, 1e-2, 1e-4); });
  table.scene("Glass of 2 mm, a ball of steel of 20 mm, walls of steel, e = 0.5",
              "the chosen step is a 20th of the shortest contact that can happen, restitution as "
              "the closed form");
  table.row("the step that silt chooses", Setting::Tame, [] { return far_apart(false); });
  table.row("at the limit", Setting::Tame, [] { return far_apart(true); });
}

}  // namespace stability
