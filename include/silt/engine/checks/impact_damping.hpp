// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/contact/concept.hpp>
#include <silt/motion/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A head-on impact of two particles, or of a particle and a wall.
struct Meeting {
  double radius_i, radius_j;   // [m]; radius_j 0: a wall
  double R_eff, m_eff, speed;  // [m], [kg], [m/s]
  double slip_mobility;        // [-] as in Contact
};

/// Damping rates of a contact [1/s]: normal c/m*, tangential c_t over the mass that slips; the
/// largest values during the approach.
struct DampingRates {
  double normal = 0, shear = 0;
};

/// From differences of the law's own force, along the impact up to its largest overlap. The impact
/// is integrated by a method that is stable for any dashpot, with steps of 4 % of the contact time.
/// `contact_time` [s] is that without damping.
template <class Law>
DampingRates damping_rates(const typename Law::template Coefficients<double>& p, const Meeting& m,
                           double contact_time) {
  Contact<double> c{};
  c.normal = {0, 0, 1}, c.R_eff = m.R_eff, c.m_eff = m.m_eff, c.inverse_m_eff = 1 / m.m_eff;
  c.radius_i = m.radius_i, c.radius_j = m.radius_j, c.slip_mobility = m.slip_mobility;
  c.time_step = 1e-9 * contact_time;  // short enough that tangential springs do not move
  bool intervened = false;
  const auto force = [&](double overlap, double speed, double slip) {
    c.overlap = overlap, c.normal_velocity = -speed, c.tangential_velocity = {slip, 0, 0};
    typename HistoryOf<Law, double>::type h{};
    [[maybe_unused]] const auto before = h;
    const auto f = law_force<Law, double>(c, p, h);
    if constexpr (has_safeguard<Law>) intervened = intervened || Law::safeguarded(before, h);
    if constexpr (is_frictional<Law>)
      return Traction<double>{f.normal, f.tangential};
    else
      return Traction<double>{f, {0, 0, 0}};
  };
  DampingRates most;
  const double h = 0.04 * contact_time;
  double overlap = 0, speed = m.speed;
  for (int step = 0; step < 100 && speed > 0.02 * m.speed; ++step) {
    overlap += 0.5 * h * speed;
    const double spring = force(overlap, 0, 0).normal;
    const double rate = (force(overlap, speed, 0).normal - spring) / (speed * m.m_eff);
    const double slow = 1e-9 * m.speed;  // too slow to slide
    const double shear = -force(overlap, 0, slow).tangential.x * m.slip_mobility / (slow * m.m_eff);
    if (intervened || !std::isfinite(rate) || !std::isfinite(shear)) break;
    most = {std::max(most.normal, rate), std::max(most.shear, shear)};
    speed = (speed - h * spring / m.m_eff) / (1 + h * std::max(rate, 0.0));
    overlap += 0.5 * h * speed;
  }
  return most;
}

/// The time [s] that the step is a fraction of: the contact time, or less if the dashpots are so
/// strong that the integrator needs shorter steps. At an eighth of the returned time, rate times
/// step is the integrator's limit.
template <class Law, class Integrator>
double time_to_resolve(const typename Law::template Coefficients<double>& p, const Meeting& m,
                       double contact_time) {
  if (!std::isfinite(contact_time) || !(contact_time > 0)) return contact_time;
  constexpr DampingLimit limit = damping_limit<Integrator>;
  const DampingRates rates = damping_rates<Law>(p, m, contact_time);
  const double most = std::max(rates.normal / limit.normal, rates.shear / limit.shear);  // [1/s]
  return std::min(contact_time, 8 / std::max(most, 1e-300));
}

}  // namespace silt::detail
