// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Time that a rank has spent on communication since the process began [s], waiting included: a
/// rank with little work waits long for one with much.
struct RankSeconds {
  double ghosts = 0;     // copies of positions and velocities: packed, sent, waited for, unpacked
  double agreement = 0;  // of all ranks in each step: speeds, errors, the next search
  double searches = 0;   // decompositions, migration of particles, new ghosts
};

/// The load of a rank.
struct RankLoad {
  std::uint64_t particles = 0, ghosts = 0;  // [-] owned; copies of others'
  std::uint64_t contacts = 0;               // [-] touching pairs, each counted on one rank
  double work = 0;             // [-] 1 per particle and per listed pair, 0.5 per pair with a ghost
  std::uint64_t migrated = 0;  // [-] particles received from other ranks since the start
  std::uint64_t messages = 0, bytes = 0;       // [-], [bytes] sent since the start
  std::uint64_t searches = 0, partitions = 0;  // [-] since the start
  RankSeconds seconds;                         // of this process
};

}  // namespace silt
