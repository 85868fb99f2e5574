// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <silt/simulation.hpp>

/// Head-on impacts of a sphere on another or on a plane, and their allowed errors.
namespace stability {

inline double mass_of(double radius, double density) {
  return density * silt::Sphere::volume(radius);
}

/// A sphere of `radius` hits a plane, or a sphere of the radius `partner` at rest.
struct Hit {
  double radius = 1e-3;    // [m]
  double partner = 0;      // [m] 0: a plane
  double density = 2500;   // [kg/m3]
  double speed = 1;        // [m/s]
  double gap = 0.01;       // [-] of the radius, at the start
  double time_step = 0;    // [s] 0: what silt chooses
  bool unguarded = false;  // all limits lifted
  double lifted_to = 0;    // [-] guard.max_time_step, if not the default
  double duration = 1e-3;  // [s] from first touch on: the contact must be over

  double R_eff() const { return partner > 0 ? silt::effective_radius(radius, partner) : radius; }
  double m_eff() const {
    const double m = mass_of(radius, density);
    return partner > 0 ? silt::effective_mass(m, mass_of(partner, density)) : m;
  }
  double smaller() const { return partner > 0 ? std::min(radius, partner) : radius; }
};

struct Rebound {
  double restitution;  // [-] speed of parting over that of approach
  double overlap;      // [-] largest, over the smaller radius
  double time_step;    // [s]
  double impulse;      // [-] change of the total momentum over that at the start; pairs: 0
};

template <class Precision, class ContactsType>
Rebound rebound(const ContactsType& contacts, const Hit& hit) {
  silt::Particles<silt::Sphere> spheres;
  spheres.add({.position = {0, 0, hit.radius * (1 + hit.gap)},
               .radius = hit.radius,
               .density = hit.density,
               .velocity = {0, 0, -hit.speed}});
  if (hit.partner > 0)
    spheres.add({.position = {0, 0, -hit.partner}, .radius = hit.partner, .density = hit.density});
  silt::Simulation sim{std::move(spheres), contacts, Precision{}};
  if (hit.partner == 0) sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
  sim.threads = 1;
  if (hit.time_step > 0) sim.time_step = hit.time_step;
  if (hit.lifted_to > 0) sim.guard.max_time_step = hit.lifted_to;
  if (hit.unguarded)
    sim.guard.max_time_step = sim.guard.max_rate = sim.guard.max_travel = sim.guard.max_overlap =
        1e9;
  const double start = sim.mass(0) * sim.velocity(0).z;
  sim.run(hit.gap * hit.radius / hit.speed + hit.duration);
  double parting = sim.velocity(sim.find(0)).z, momentum = 0;
  if (hit.partner > 0) {
    for (std::uint32_t k = 0; k < 2; ++k) momentum += sim.mass(k) * sim.velocity(k).z;
    parting -= sim.velocity(sim.find(1)).z;
    momentum = std::abs(momentum / start - 1);
  }
  return {parting / hit.speed, sim.peak_overlap(), sim.step_length(), momentum};
}

/// Allowed error of a rebound with n steps per contact, relative to the restitution: the dashpot's
/// force is up to one step early or late, 2 zeta w0 dt = 2 pi zeta/n, and leapfrog's own error for
/// a half sine is at most 1.5 (w0 dt)^2/8. (As tests/physics/impact.cpp.)
inline double rebound_bound(double zeta, double n) {
  return 2 * std::numbers::pi * zeta / n + 1.9 / (n * n);
}

}  // namespace stability
