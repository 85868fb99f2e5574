// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <silt/core/vec3.hpp>
#include <silt/parallel/comm.hpp>

namespace silt::inline SILT_TARGET {

/// The policy that spreads a simulation over ranks: who they are, and how the space is shared.
///
///   silt::Simulation sim{std::move(beads), silt::Contacts<Law>{glass}, silt::Ranks{comm,
///   silt::Bisection{}}};
///
/// Every rank runs the same program: it makes the same particles, walls and calls of run(). A
/// decomposition has partition(comm, points, weights), the rank of each point (collective).
template <Communicator Comm, class Decomposition>
struct Ranks {
  static constexpr bool is_ranks = true;
  Comm comm;
  Decomposition decomposition;

  Ranks(Comm ranks, Decomposition how = {})
      : comm(std::move(ranks)), decomposition(std::move(how)) {}
};

}  // namespace silt
