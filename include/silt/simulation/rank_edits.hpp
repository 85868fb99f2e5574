// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/position_row.hpp>
#include <silt/engine/contact/contact_energy.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Changes of single particles on this rank that the other ranks do not know yet
/// (ParticleEdits::share_edits).
struct RankEdits {
  /// A contact with another rank's particle that ended because the own one was removed.
  struct Ended {
    ParticleId own, other;
    ContactEnergy<double> work;  // [J]
    double normal;               // [J]
  };
  DynArray<ParticleId> found, removed, reshaped;
  DynArray<std::pair<ParticleId, const char*>> missed;  // no such id; function called
  DynArray<Ended> ended;
  // Ids of new parts until all ranks have agreed on others; those of a simulation begin at 0.
  ParticleId next_part = ParticleId{1} << 62;
  bool rows = false;  // ghost data of rows that are sent at searches have changed, or sizes
};

}  // namespace silt::inline SILT_TARGET::detail
