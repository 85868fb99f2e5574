// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <utility>
#include <vector>

#include <silt/core/position_row.hpp>
#include <silt/engine/contact/contact_energy.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What users have changed of single particles on this rank, until all ranks know of it
/// (ParticleEdits::share_edits).
struct RankEdits {
  /// A contact with another rank's particle that has ended as the own one was removed.
  struct Ended {
    ParticleId own, other;
    ContactEnergy<double> work;  // [J]
    double normal;               // [J]
  };
  std::vector<ParticleId> found, removed;
  std::vector<std::pair<ParticleId, const char*>> missed;  // and the function that was called
  std::vector<Ended> ended;
  bool rows = false;  // what ghosts have of rows at a search has changed, or their sizes
};

}  // namespace silt::inline SILT_TARGET::detail
