// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured: the bed before the orifice opens, and the discharge.

#include <cmath>
#include <cstddef>
#include <vector>

#include <silt/eigen.hpp>

#include "hopper/scene.hpp"

namespace hopper {

/// Grains below a height.
template <class Sim>
struct Below {
  double mass = 0;  // [kg]
  std::size_t count = 0;

  Below(const Sim& sim, double height) {
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (sim.position(k).z < height) mass += sim.mass(k), ++count;
    }
  }
};

/// Solid fraction of the bed between two heights, away from the walls.
template <class Sim>
double solid_fraction(const Sim& sim, const silt::Box& inside) {
  double solid = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (inside.contains(sim.position(k))) solid += silt::Sphere::volume(sim.radius(k));
  return solid / inside.volume();
}

/// The bed before the orifice opens.
struct Rest {
  double fraction = 0;  // [-] of solid, away from walls and surface
  double energy = 0;    // [-] kinetic, over weight times diameter
};
///   total: mass of all grains [kg]
template <class Sim>
Rest look_at_rest(const Scene& s, const Sim& sim, double total) {
  const double top = s.funnel_top() + 0.55 * s.bulk_height();
  return {solid_fraction(sim, {{0.015, 0.015, s.funnel_top() + 0.005},
                               {s.width - 0.015, s.width - 0.015, top}}),
          sim.kinetic_energy() / (total * 9.81 * 2 * s.r_max)};
}

/// Contact forces at rest: the sum of wall contacts against the wall forces. These equal the weight
/// except for residual bouncing of the bed, 3 % with --quick.
struct Press {
  double coordination = 0, without_rattlers = 0;  // [-]
  double contacts_off = 0, weight_off = 0;        // [-] over the weight
};
///   total: mass of all grains [kg]
template <class Sim>
Press look_at_contacts(const Sim& sim, double total) {
  const double weight = 9.81 * total;
  const auto z = silt::coordination(sim);
  silt::Vec3d on_walls{0, 0, 0}, by_contacts{0, 0, 0};
  for (std::size_t w = 0; w < sim.walls(); ++w) on_walls += sim.wall(w).force;
  sim.for_each_contact([&](const silt::ContactSeen& c) {
    if (c.wall != silt::no_wall) by_contacts -= c.force;
  });
  return {z.mean, z.without_rattlers, silt::norm(on_walls - by_contacts) / weight,
          std::abs(-on_walls.z / weight - 1)};
}

/// The mass below over time, and what has come out in the end.
struct Discharge {
  std::vector<double> time, mass;  // [s] since opening, [kg] below the orifice
  double most_contacts = 0;

  /// Slope between 20 and 70 per cent of `total` [kg/s].
  double rate(double total) const {
    std::vector<double> t, m;
    for (std::size_t k = 0; k < time.size(); ++k)
      if (mass[k] >= 0.2 * total && mass[k] <= 0.7 * total)
        t.push_back(time[k]), m.push_back(mass[k]);
    return t.size() > 1 ? silt::fit_straight_line(t, m).slope : 0;
  }
  /// Time at which a fraction of `total` has passed [s].
  double time_of(double share, double total) const {
    for (std::size_t k = 0; k < time.size(); ++k)
      if (mass[k] >= share * total) return time[k];
    return std::nan("");
  }
};

/// The largest overlap [-] over the radius in the hardest impact, the fall from the top of the room
/// into the funnel: bounded by Hertz without losses. Softer springs than the material's give larger
/// overlaps, up to the guard's limit.
inline double overlap_of_fall(const Scene& s) {
  const double fastest = std::sqrt(2 * 9.81 * s.room());
  const auto grain = s.material();
  return silt::hertz_max_overlap(
             {silt::effective_modulus(grain.youngs_modulus, grain.poisson_ratio,
                                      grain.youngs_modulus, grain.poisson_ratio),
              s.r_max, s.density * silt::Sphere::volume(s.r_max), fastest}) /
         s.r_max;
}

}  // namespace hopper
