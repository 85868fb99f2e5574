// silt - BSD-3-Clause, see LICENSE
//
// A user-defined contact law with a history, which the energy ledger supports
// (docs/contact_laws.md).

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

// A normal spring with a dashpot, and a tangential spring that slides at Coulomb's limit.
struct SpringAndSlider {
  struct Material {
    double stiffness;  // [N/m] normal and tangential
    double damping;    // [N s/m]
    double friction;   // [-]
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real k, c, mu;
  };
  template <class Real>
  struct History {          // Reals alone
    silt::Vec3<Real> slip;  // [m] elongation of the tangential spring
  };
  static Coefficients<double> mix(const Material& a, const Material& b) {
    return {(a.stiffness + b.stiffness) / 2, (a.damping + b.damping) / 2,
            (a.friction + b.friction) / 2};
  }
  template <class Real>
  static silt::Traction<Real> force(const silt::Contact<Real>& c, const Coefficients<Real>& p,
                                    History<Real>& h) {
    const Real normal = silt::max(p.k * c.overlap - p.c * c.normal_velocity, Real(0));
    h.slip = c.transported(h.slip) + c.time_step * c.tangential_velocity;
    const Real trial = p.k * silt::sqrt(dot(h.slip, h.slip));
    const Real share = silt::min(p.mu * normal / silt::max(trial, Real(1e-30)), Real(1));
    h.slip = share * h.slip;  // what is beyond the limit has slid
    return {normal, -p.k * h.slip};
  }
  // For the EnergyLedger: the springs' forces and the energy in them, after force().
  template <class Real>
  static silt::Stored<Real> stored(const silt::Contact<Real>& c, const Coefficients<Real>& p,
                                   const History<Real>& h) {
    return {.force = p.k * c.overlap,
            .normal = Real(0.5) * p.k * c.overlap * c.overlap,
            .spring = -p.k * h.slip,
            .tangential = Real(0.5) * p.k * dot(h.slip, h.slip)};
  }
  // For the time step: the shortest contact of two bodies of this effective mass [s].
  static double contact_time(const Coefficients<double>& p, double, double m_eff, double) {
    return M_PI * std::sqrt(m_eff / p.k);
  }
};
static_assert(silt::ContactLaw<SpringAndSlider>);

int main() {
  const SpringAndSlider::Material rubber{.stiffness = 1000, .damping = 0.02, .friction = 0.3};
  silt::Particles<silt::Sphere> balls;
  balls.add({.position = {0, 0, 5.1e-3}, .radius = 5e-3, .density = 1100, .velocity = {2, 0, -1}});

  silt::Simulation sim{std::move(balls), silt::Contacts<SpringAndSlider>{rubber},
                       silt::EnergyLedger{}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  sim.run(0.02);
  const auto books = sim.energy();
  const double start = books.initial, lost = start - sim.energy().kinetic();
  std::printf("lost %.4f of the energy: normal damping %.4f, friction %.4f, unexplained %.1e\n",
              lost / start, books.normal_damping / start, books.friction / start,
              books.residual() / start);
  // An oblique impact with sliding throughout: friction gives mu times the normal impulse.
  const double slid = (2 - sim.velocity(0).x) / (1 + sim.velocity(0).z);
  std::printf("tangential over normal impulse %.4f, friction 0.3\n", slid);
  return std::abs(slid - 0.3) < 1e-4 && std::abs(books.residual()) < 1e-3 * start ? 0 : 1;
}
