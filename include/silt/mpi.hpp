// silt - BSD-3-Clause, see LICENSE
#pragma once

// Many processes, by MPI: silt::Ranks{MPI_COMM_WORLD, decomposition}, silt::Mpi, silt::MpiComm,
// decompositions; those of Zoltan where it is installed. See docs/ranks.md.

#include <silt/parallel/mpi_comm.hpp>
#include <silt/ranks.hpp>
#if __has_include(<zoltan.h>)
#include <silt/parallel/decomposition/hypergraph.hpp>
#include <silt/parallel/decomposition/rcb.hpp>
#endif

namespace silt::inline SILT_TARGET {

// Ranks{MPI_COMM_WORLD, ...}
Ranks(MPI_Comm)->Ranks<MpiComm>;
template <class Parts>
Ranks(MPI_Comm, Parts) -> Ranks<MpiComm, Parts>;
template <class Parts>
Ranks(MPI_Comm, Parts, Rebalance) -> Ranks<MpiComm, Parts>;

}  // namespace silt
