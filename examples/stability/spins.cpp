// silt - BSD-3-Clause, see LICENSE
// Fast rotating bodies of all shapes, and particles that enter their reach.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stability/bodies.hpp"
#include "stability/table.hpp"

namespace stability {

namespace spins_rows {

using namespace silt;

constexpr double size = 1e-3, density = 2500;  // [m] radius of the volume's sphere, [kg/m3]

/// State of a rotating body and a bead that drifts into its reach, after two turns.
struct End {
  double energy = 0, momentum = 0;  // [-] changes
  Vec3d velocity;                   // [m/s] of the bead
  bool met = false;
};

/// `tips` [m/s] speed at the bounding sphere; `share` of the chosen step.
End sweep(const Form& form, double tips, double modulus, int phase, double share) {
  Particles<Grains> bodies;
  bodies.add_form(form.shape), bodies.add_form(Sphere{});
  const double reach = reach_of(bodies.forms()[0], size), bead = 0.3 * size;
  const auto turned =
      rotation_about(normalised(Vec3d{0.3 + phase, 1.0, 0.7 * phase - 1.0}), 0.4 + 1.7 * phase);
  // About an axis perpendicular to the longest dimension: the tips sweep by; per turn the bead
  // drifts in by its radius.
  const Vec3d axis = rotate(turned, normalised(Vec3d{0.2, 1, 0.1})),
              away = rotate(turned, normalised(Vec3d{1, -0.2, 0.5}));
  const double turn = 2 * std::numbers::pi * reach / tips;  // [s]
  const Vec3d drift = (bead / turn) * away;
  bodies.add({.position = {0, 0, 0},
              .orientation = turned,
              .radius = reach,
              .density = density,
              .angular_velocity = (tips / reach) * axis});
  bodies.add({.form = 1,
              .position = 1.01 * (reach + bead) * away,
              .radius = bead,
              .density = density,
              .velocity = -drift});
  Simulation sim{std::move(bodies), law(modulus, 1, 0)};
  sim.threads = 1;
  sim.run(0);
  if (share < 1) sim.time_step = share * sim.step_length();
  const double before = energy_of(sim);
  sim.run(2 * turn);
  const std::size_t body = sim.find(0), ball = sim.find(1);  // the search may change their order
  End end;
  end.velocity = sim.velocity(ball);
  end.met = norm(end.velocity + drift) > 1e-9 * norm(drift);
  end.energy = std::abs(energy_of(sim) / before - 1);
  end.momentum =
      norm(sim.mass(body) * sim.velocity(body) + sim.mass(ball) * (end.velocity + drift)) /
      (sim.mass(ball) * std::max(norm(end.velocity), norm(drift)));
  return end;
}

/// Energy and momentum are constant, and no bead is missed that is hit with a step an eighth as
/// long.
Measures swept(const Form& form, double tips, double modulus, int phases) {
  double energy = 0, momentum = 0, unseen = 0;
  for (int k = 0; k < phases; ++k) {
    const End end = sweep(form, tips, modulus, k, 1);
    energy = std::max(energy, end.energy), momentum = std::max(momentum, end.momentum);
    if (!end.met && sweep(form, tips, modulus, k, 0.125).met) unseen += 1;
  }
  return {{"energy", energy, (form.sharp ? 40 : 4) / 400.0},
          {"momentum", momentum, 1e-9},
          {"bead passed unseen", unseen, 0}};
}

}  // namespace spins_rows

void spins(Table& table) {
  using namespace spins_rows;
  table.scene("Bodies of all shapes that spin: tips of 1 to 1000 m/s sweep over a bead, e = 1",
              "energy within 1 % (flat super-ellipsoids: 10 %), momentum; no bead passed unseen");
  for (const auto& f : all_forms(table.quick))
    for (const double tips : {1.0, 30.0, 1000.0})
      for (const double modulus : {1e7, 1e11})
        if (!(table.quick && modulus > 1e8))
          table.row(text(f.name, ", ", tips, " m/s, E = ", modulus, " Pa"),
                    tips < 10 || (modulus > 1e8 && !f.slender) ? Setting::Tame : Setting::Extreme,
                    [&] { return swept(f, tips, modulus, table.quick ? 1 : 3); });
}

}  // namespace stability
