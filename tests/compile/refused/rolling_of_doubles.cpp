// silt - BSD-3-Clause, see LICENSE
// refused: the rolling model works on one double, but not on a pack of lanes
#include "scene.hpp"

/// A couple of one contact alone.
struct OneByOne {
  static constexpr bool is_rolling_model = true;
  struct Pair {
    double friction = 0;  // [-]
  };
  template <class Real>
  struct Coefficients {
    Real friction;
  };
  static Coefficients<double> mix(const Pair& p) { return {p.friction}; }
#if defined(SILT_MENDED)
  template <class Real>
#else
  using Real = double;
#endif
  static silt::Vec3<Real> torque(const silt::RollingContact<Real>& c, const Coefficients<Real>& p) {
    return c.against(c.angular_velocity, p.friction * c.normal_force * c.R_eff);
  }
  static void check(const Pair&) {}
};

using Sim =
    silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin, OneByOne>>;
static_assert(Sim::bytes_per_contact > 0);
