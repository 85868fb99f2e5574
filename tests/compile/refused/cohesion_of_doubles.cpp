// silt - BSD-3-Clause, see LICENSE
// refused: the cohesion model compiles for double, but not for a pack of lanes
#include "scene.hpp"

/// A pull of one contact alone.
struct OnePull {
  struct Pair {
    double pull = 0, reach = 0;  // [N], [m]
    bool operator==(const Pair&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real pull, reach;
  };
  static Coefficients<double> mix(const Pair& p) { return {p.pull, p.reach}; }
#if defined(SILT_MENDED)
  template <class Real>
#else
  using Real = double;
#endif
  static Real attraction(const silt::Contact<Real>& c, const Coefficients<Real>& p) {
    return p.pull * c.overlap / p.reach;
  }
  static void check(const Pair&) {}
};

using Law = silt::Cohesive<silt::HertzMindlin, OnePull>;
using Sim = silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<Law>>;
static_assert(Sim::bytes_per_contact > 0);
