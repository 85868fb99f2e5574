// silt - BSD-3-Clause, see LICENSE
// refused: in place of std:: functions write silt::sqrt, silt::abs, silt::min, silt::max,
// silt::select
#include "scene.hpp"

/// Takes a double of what may be a pack.
struct HertzLike {
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
#if defined(SILT_MENDED)
    return p.k * c.overlap * silt::sqrt(c.R_eff * c.overlap);
#else
    return p.k * c.overlap * std::sqrt(c.R_eff * c.overlap);
#endif
  }
};

using Sim = silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<HertzLike>>;
static_assert(Sim::bytes_per_contact > 0);
