// silt - BSD-3-Clause, see LICENSE
// refused: in place of if, while, ?:, std::min and std::max write silt::select(condition, a, b)
// on every instruction set
#include "scene.hpp"

/// Branches on a force: with AVX-512, one lane decided for all.
struct NoPull {
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
    Real f = p.k * (c.overlap - c.normal_velocity);
#if defined(SILT_MENDED)
    f = silt::select(f < 0, Real(0), f);
#else
    if (f < 0) f = 0;
#endif
    return f;
  }
};

using Sim = silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<NoPull>>;
static_assert(Sim::bytes_per_contact > 0);
