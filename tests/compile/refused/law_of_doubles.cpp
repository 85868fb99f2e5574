// silt - BSD-3-Clause, see LICENSE
// refused: the contact law works on one double, but not on a pack of lanes
#include "scene.hpp"

struct Plain {
  struct Material {
    double stiffness;  // [N/m]
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real k;
  };
  static Coefficients<double> mix(const Material& a, const Material& b) {
    return {(a.stiffness + b.stiffness) / 2};
  }
#if defined(SILT_MENDED)
  template <class Real>
  static Real force(const silt::Contact<Real>& c, const Coefficients<Real>& p){
#else
  static double force(const silt::Contact<double>& c, const Coefficients<double>& p) {
#endif
      return p.k * c.overlap;
}
}
;

void run(silt::Particles<silt::Sphere> spheres) {
  silt::Simulation sim{std::move(spheres), silt::Contacts<Plain>{Plain::Material{1000}}};
  sim.run(1);
}
