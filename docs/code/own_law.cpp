// silt - BSD-3-Clause, see LICENSE
//
// A user-defined contact law, without changes in silt (docs/contact_laws.md).

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

// A spring that hardens with the overlap, a dashpot, and sliding friction without memory.
struct Hardening {
  struct Material {
    double stiffness;  // [N/m]
    double hardening;  // [1/m]
    double damping;    // [N s/m]
    double friction;   // [-]
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real k, h, c, mu;
  };
  static Coefficients<double> mix(const Material& a, const Material& b) {
    return {(a.stiffness + b.stiffness) / 2, (a.hardening + b.hardening) / 2,
            (a.damping + b.damping) / 2, (a.friction + b.friction) / 2};
  }
  template <class Real>
  static silt::Traction<Real> force(const silt::Contact<Real>& c, const Coefficients<Real>& p) {
    const Real spring = p.k * c.overlap * (Real(1) + p.h * c.overlap);
    const Real normal = silt::max(spring - p.c * c.normal_velocity, Real(0));
    const auto& v = c.tangential_velocity;
    const Real speed = silt::sqrt(dot(v, v) + Real(1e-12));
    return {normal, -silt::min(p.mu * normal / speed, p.c) * v};
  }
};
static_assert(silt::ContactLaw<Hardening>);

int main() {
  const Hardening::Material rubber{
      .stiffness = 1000, .hardening = 200, .damping = 0.05, .friction = 0.5};
  silt::Particles<silt::Sphere> balls;
  balls.add({.position = {0, 0, 0.02}, .radius = 5e-3, .density = 1100, .velocity = {0.1, 0, 0}});

  silt::Simulation sim{std::move(balls), silt::Contacts<Hardening>{rubber}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 1e-5;  // the law has no contact_time(), so that the step must be set
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber);
  sim.run(0.2);
  std::printf("x = %.4f m, height %.4f m\n", sim.position(0).x, sim.position(0).z);
  return std::isfinite(sim.position(0).z) && sim.position(0).z > 0.003 ? 0 : 1;
}
