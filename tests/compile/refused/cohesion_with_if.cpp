// silt - BSD-3-Clause, see LICENSE
// refused: in place of if, while, ?:, std::min and std::max write silt::select(condition, a, b)
#include "scene.hpp"

/// A pull that ends at an overlap.
struct Pull {
  struct Pair {
    double pull = 0, reach = 0;  // [N], [m]
    bool operator==(const Pair&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real pull, reach;
  };
  static Coefficients<double> mix(const Pair& p) { return {p.pull, p.reach}; }
  template <class Real>
  static Real attraction(const silt::Contact<Real>& c, const Coefficients<Real>& p) {
#if defined(SILT_MENDED)
    return silt::select(c.overlap < p.reach, p.pull, Real(0));
#else
    return c.overlap < p.reach ? p.pull : Real(0);
#endif
  }
  static void check(const Pair&) {}
};

using Law = silt::Cohesive<silt::HertzMindlin, Pull>;
using Sim = silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<Law>>;
static_assert(Sim::bytes_per_contact > 0);
