// silt - BSD-3-Clause, see LICENSE
// refused: Contacts<Law>: Law is not a ContactLaw; its contract is in silt/contact/concept.hpp
#include "scene.hpp"

/// Has materials, but no force.
struct Forceless {
  struct Material {
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {};
};

#if defined(SILT_MENDED)
silt::Simulation sim{beads, contacts};
#else
using Sim = silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<Forceless>>;
constexpr auto bytes = Sim::bytes_per_contact;
#endif
