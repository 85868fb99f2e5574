// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/coupling/averaging/averaged_particles.hpp>
#include <silt/fluid/flow_step.hpp>

namespace silt::inline SILT_TARGET {

/// What a coupling step did.
struct CoupledStep {
  FlowStep flow;
  AveragingReport averaging;
  double solids = 0;        // [m3] the particles' volume
  double clipped = 0;       // [m3] of it, what the least voidage leaves no room for
  double volume_error = 0;  // [-] solids in cells over the particles' volume, less 1
  /// [N] Forces on particles and on the fluid: their sum, 0 but for rounding.
  Vec3d momentum_error{};
  double exchanged =
      0;                // [N] magnitudes of the forces on particles that the fluid has back, summed
  Vec3d owed{0, 0, 0};  // [N s] that particles had taken beyond what the fluid gave: given now
  double heat = 0;      // [J] that the fluid has given to particles
  double heat_terms = 0;  // [J] b T dt of all particles: what heat is the small difference of
  double heat_error = 0;  // [J] heat on both sides: the sum, 0 but for rounding
};

/// How well the books of fluid and particles close: the largest of all steps since a program began.
struct FluidClosure {
  double volume = 0;      // [-] solids in cells over the particles' volume, less 1
  double continuity = 0;  // [-] of a cell's volume, root of the mean square: FlowStep::unbalanced
  double momentum = 0;    // [-] forces on particles and fluid: |sum| over what they exchange
  double clipped = 0;     // [-] of the solids: what the least voidage leaves no room for
  double heat = 0;        // [-] heat on both sides: |sum| over CoupledStep::heat_terms

  void add(const CoupledStep& done) {
    volume = std::max(volume, std::abs(done.volume_error));
    continuity = std::max(continuity, done.flow.unbalanced);
    if (done.exchanged > 0)
      momentum = std::max(momentum, norm(done.momentum_error) / done.exchanged);
    if (done.heat_terms > 0) heat = std::max(heat, std::abs(done.heat_error) / done.heat_terms);
    if (done.solids > 0) clipped = std::max(clipped, done.clipped / done.solids);
  }
};

}  // namespace silt
