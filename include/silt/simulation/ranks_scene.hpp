// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>

#include <silt/core/box.hpp>
#include <silt/core/position_row.hpp>
#include <silt/engine/checks/time_step.hpp>
#include <silt/simulation/rank_edits.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Size of a scene, and largest speeds in it.
struct SceneSize {
  Box region;                                // [m] of centres
  double speed = 0, radius = 0;              // [m/s] of surfaces, [m] the largest
  double acceleration = 0, module_rate = 0;  // [m/s2], [1/s] by modules, the largest values
};

/// What each of several ranks knows about the particles of all.
struct RanksScene {
  SceneSize size;
  Meetings meetings;
  double checked_overlap = 0;  // [-] over all ranks, at the last check of free walls
  RankEdits edits;
  double bond_rate = 0, bond_step = INFINITY;  // [1/s], [s] BondStage::Rate
  ParticleId bonded = no_particle;
};

}  // namespace silt::inline SILT_TARGET::detail
