// silt - BSD-3-Clause, see LICENSE
// refused: in place of if, while, ?:, std::min and std::max write silt::select(condition, a, b)
#include "scene.hpp"

/// std::max compares and branches.
struct Clipped {
  struct Material {
    double stiffness;  // [N/m]
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real k;
  };
  static Coefficients<double> mix(const Material& a, const Material&) { return {a.stiffness}; }
  template <class Real>
  static Real force(const silt::Contact<Real>& c, const Coefficients<Real>& p) {
    const Real f = p.k * (c.overlap - c.normal_velocity);
#if defined(SILT_MENDED)
    return silt::max(f, Real(0));
#else
    return std::max(f, Real(0));
#endif
  }
};

using Sim = silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<Clipped>>;
static_assert(Sim::bytes_per_contact > 0);
