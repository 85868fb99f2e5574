// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <utility>

#include <silt/parallel/decomposition/bisection.hpp>
#include <silt/parallel/decomposition/rebalance.hpp>

namespace silt::inline SILT_TARGET {

/// The policy that spreads a simulation over ranks: who they are, how they share the space, and
/// when they share it anew.
///
///   silt::Simulation sim{std::move(beads), silt::Contacts<Law>{glass},
///                        silt::Ranks{MPI_COMM_WORLD, silt::Bisection{}}};  // silt/mpi.hpp
///
/// Every rank runs the same program: it makes the same particles, walls and calls of run(). Each
/// has a part of the particles then, of which rows() and all that takes a place in memory speak.
///
/// Source: none; the decomposition has its own.
/// Valid:  what docs/ranks.md lists; the rest is refused at compile time, or as the run starts.
/// Units:  none.
/// Errors: Error on all ranks alike, with the sentence of the rank that failed.
/// Tests:  tests/parallel/policies.cpp, tests/parallel/spheres.cpp, tests/mpi/ranks.cpp.
template <Communicator Comm, Decomposition<Comm> Parts = Bisection>
struct Ranks {
  static constexpr bool is_ranks = true;
  Comm comm;
  Parts parts;
  Rebalance rebalance;

  template <class C>
  requires std::constructible_from<Comm, const C&>
  explicit Ranks(const C& ranks, Parts how = {}, Rebalance when = {})
      : comm(ranks), parts(std::move(how)), rebalance(when) {}
};
template <Communicator C>
Ranks(const C&) -> Ranks<C>;
template <Communicator C, class Parts>
Ranks(const C&, Parts) -> Ranks<C, Parts>;
template <Communicator C, class Parts>
Ranks(const C&, Parts, Rebalance) -> Ranks<C, Parts>;

}  // namespace silt
