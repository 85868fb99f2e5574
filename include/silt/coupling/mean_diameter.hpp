// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/coupling/fluid_at_particles.hpp>
#include <silt/coupling/particles_in_fluid.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Sauter mean diameters [m] around particles, sum V/sum (V/d). average(of, out): spreads a value
/// of each particle over cells, and reads the sums at the particles. A particle that is outside the
/// cells keeps its own.
template <class Average>
void find_mean_diameters(const CoupledParticles& of, ParticleColumn& mean, const Average& average) {
  const std::size_t n = of.volume.size();
  ParticleColumn area(n), over(n);
  for (std::size_t p = 0; p < n; ++p) area[p] = of.volume[p] / (2 * of.shape.radius[p]);
  mean.resize(n);
  average(of.volume, mean), average(area, over);
  for (std::size_t p = 0; p < n; ++p)
    mean[p] = mean[p] > 0 && over[p] > 0 ? mean[p] / over[p] : 2 * of.shape.radius[p];
}

}  // namespace silt::detail
