// silt - BSD-3-Clause, see LICENSE
#pragma once

// Many processes, by MPI: silt::Mpi, silt::MpiComm. See docs/ranks.md.

#include <silt/parallel/mpi_comm.hpp>
