// silt - BSD-3-Clause, see LICENSE
// refused: in place of if, while, ?:, std::min and std::max write silt::select(condition, a, b)
#include "scene.hpp"

/// Nothing below a speed.
struct Stuck {
  static constexpr bool is_rolling_model = true;
  struct Pair {
    double friction = 0;  // [-]
  };
  template <class Real>
  struct Coefficients {
    Real friction;
  };
  static Coefficients<double> mix(const Pair& p) { return {p.friction}; }
  template <class Real>
  static silt::Vec3<Real> torque(const silt::RollingContact<Real>& c, const Coefficients<Real>& p) {
    const silt::Vec3<Real> M = c.against(c.angular_velocity, p.friction * c.normal_force * c.R_eff);
    const Real speed2 = dot(c.angular_velocity, c.angular_velocity), zero(0);
#if defined(SILT_MENDED)
    return silt::select(speed2 < 1e-6, {zero, zero, zero}, M);
#else
    if (speed2 < 1e-6) return {zero, zero, zero};
    return M;
#endif
  }
  static void check(const Pair&) {}
};

using Sim =
    silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin, Stuck>>;
static_assert(Sim::bytes_per_contact > 0);
