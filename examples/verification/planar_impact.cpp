// silt - BSD-3-Clause, see LICENSE
#include "verification/planar_impact.hpp"

namespace verification {

double planar_surface_speed_after(const Impact& impact, double surface_speed, int steps) {
  const double E = impact.E_eff(), R = impact.R_eff(), m = impact.m_eff();
  const double k = impact.stiffness_ratio(), mu = impact.friction;
  const double zeta = silt::damping_ratio(impact.restitution, silt::DampingEnd::ZeroForce);
  const double damping = 2 * std::sqrt(5.0 / 6) * zeta, h = impact.contact_time() / steps;
  double overlap = 0, approach = impact.normal_speed(), slip = surface_speed, spring = 0;
  while (true) {
    const double last = overlap;
    overlap += approach * h;
    if (overlap <= 0) return slip;
    const double Sn = 2 * E * std::sqrt(R * overlap), St = k * Sn;
    const double Fn =
        std::max(2.0 / 3 * Sn * overlap + damping * std::sqrt(Sn * m) * approach, 0.0);
    if (overlap < last) spring *= std::sqrt(overlap / last);
    const double ct = damping * std::sqrt(St * m);  // [N s/m]
    const double total = std::clamp(spring + (St * h + ct) * slip, -mu * Fn, mu * Fn);
    spring += St * h / (St * h + ct) * (total - spring);  // the spring's own velocity: u of (2)
    slip -= 3.5 / m * total * h;
    approach -= Fn / m * h;
  }
}

}  // namespace verification
