// silt - BSD-3-Clause, see LICENSE
#pragma once

// Many processes, by MPI: silt::Mpi, silt::MpiComm. See docs/ranks.md.

#include <silt/parallel/mpi_comm.hpp>
#include <silt/parallel/ranks.hpp>

namespace silt::inline SILT_TARGET {

/// Ranks{MPI_COMM_WORLD, ...}
Ranks(MPI_Comm) -> Ranks<MpiComm>;
template <class Parts>
Ranks(MPI_Comm, Parts) -> Ranks<MpiComm, Parts>;
template <class Parts>
Ranks(MPI_Comm, Parts, Rebalance) -> Ranks<MpiComm, Parts>;

}  // namespace silt
