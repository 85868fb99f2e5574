// silt - BSD-3-Clause, see LICENSE
// refused: PrescribedFlow has no cells, and no mean diameter
#include <silt/fluid.hpp>

inline auto wind() {
  const auto still = [](const silt::Vec3d&, double) { return silt::Vec3d{0, 0, 0}; };
#if defined(SILT_MENDED)
  return silt::PrescribedFlow{silt::Beetstra{}, {.density = 1.2, .viscosity = 1.8e-5}, still};
#else
  return silt::PrescribedFlow{
      silt::Polydisperse{silt::Beetstra{}}, {.density = 1.2, .viscosity = 1.8e-5}, still};
#endif
}
