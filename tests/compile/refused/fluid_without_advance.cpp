// silt - BSD-3-Clause, see LICENSE
// refused: a fluid given to Simulation has no advance(const CoupledParticles&, double dt,
#include <silt/fluid.hpp>

#include "scene.hpp"

struct Wind {
  static constexpr bool active = true;
  silt::FluidClock clock;
  void prepare(const silt::FluidScene&) {}
  int steps_wanted(const silt::FluidPace&, const silt::Team&) const { return 1; }
#if defined(SILT_MENDED)
  void advance(const silt::CoupledParticles&, double dt, std::span<silt::Vec3d>, const silt::Team&,
               std::span<silt::Vec3d>) {
    clock.count(dt);
  }
#endif
  template <class Visit>
  void for_each_state(const Visit& visit) {
    clock.for_each_state(visit);
  }
};
silt::Simulation sim{beads, contacts, Wind{}};
