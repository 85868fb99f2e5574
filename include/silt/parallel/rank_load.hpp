// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// How long a rank has been busy with others, since the process began [s]. Waiting is included: a
/// rank with little work waits long for one with much.
struct RankSeconds {
  double ghosts = 0;     // copies of positions and velocities: packed, sent, waited for, unpacked
  double agreement = 0;  // what all ranks agree on at each step: speeds, errors, the next search
  double searches = 0;   // at searches: decompositions, particles that migrate, new ghosts
};

/// What a rank has and does.
struct RankLoad {
  std::uint64_t particles = 0, ghosts = 0;  // [-] its own; others', that they may touch
  std::uint64_t contacts = 0;               // [-] pairs that touch, each on one rank
  double work = 0;             // [-] one a particle and one a listed pair; with a ghost half a one
  std::uint64_t migrated = 0;  // [-] particles that came from other ranks, since the start
  std::uint64_t messages = 0, bytes = 0;       // [-], [bytes] sent since the start
  std::uint64_t searches = 0, partitions = 0;  // [-] since the start
  RankSeconds seconds;                         // of this process
};

}  // namespace silt
