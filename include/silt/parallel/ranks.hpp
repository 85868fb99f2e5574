// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <utility>

#include <silt/parallel/decomposition/bisection.hpp>
#include <silt/parallel/decomposition/rebalance.hpp>

namespace silt::inline SILT_TARGET {

/// The policy that distributes a simulation over ranks: the communicator, the decomposition of
/// space, and when it is renewed.
///
///   silt::Simulation sim{std::move(beads), silt::Contacts<Law>{glass},
///                        silt::Ranks{MPI_COMM_WORLD, silt::Bisection{}}};  // silt/mpi.hpp
///
/// Every rank runs the same program: it creates the same particles and walls and makes the same
/// calls of run(). Each rank then owns a part of the particles; rows() and all functions that take
/// a place in memory refer to that part.
///
/// Source: none; the decomposition has its own.
/// Valid:  the combinations listed in docs/ranks.md; others are refused at compile time or at the
///         start of a run.
/// Units:  none.
/// Errors: Error on all ranks alike, with the message of the rank that failed.
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
