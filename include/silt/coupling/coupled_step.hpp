// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>

#include <silt/coupling/averaging/averaged_particles.hpp>
#include <silt/fluid/flow_step.hpp>

namespace silt::inline SILT_TARGET {

/// Results of a coupling step.
struct CoupledStep {
  FlowStep flow;
  AveragingReport averaging;
  double solids = 0;        // [m3] the particles' volume
  double clipped = 0;       // [m3] of it, clipped at the minimum void fraction
  double volume_error = 0;  // [-] solids in cells over the particles' volume, minus 1
  /// [N] sum of the forces on particles and on the fluid: 0 to rounding.
  Vec3d momentum_error{};
  double exchanged = 0;   // [N] magnitudes of the forces on particles with a reaction on the fluid,
                          // summed
  Vec3d owed{0, 0, 0};    // [N s] momentum taken by particles earlier, given by the fluid now
  double heat = 0;        // [J] from the fluid to particles
  double heat_terms = 0;  // [J] b T dt of all particles; heat is a small difference of such terms
  double heat_error = 0;  // [J] sum of the heat on both sides: 0 to rounding
};

/// Closure errors of fluid and particles: largest of all steps since the program started.
struct FluidClosure {
  double volume = 0;      // [-] solids in cells over the particles' volume, minus 1
  double continuity = 0;  // [-] of a cell's volume, root mean square: FlowStep::unbalanced
  double momentum = 0;    // [-] forces on particles and fluid: |sum| over the exchange
  double clipped = 0;     // [-] share of the solids clipped at the minimum void fraction
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
