// silt - BSD-3-Clause, see LICENSE
#pragma once

// Many processes, by MPI: silt::Mpi, silt::MpiComm, decompositions; those of Zoltan where it is
// installed. See docs/ranks.md.

#include <silt/parallel/decomposition/bisection.hpp>
#include <silt/parallel/decomposition/rebalance.hpp>
#include <silt/parallel/decomposition/slabs.hpp>
#include <silt/parallel/mpi_comm.hpp>
#if __has_include(<zoltan.h>)
#include <silt/parallel/decomposition/hypergraph.hpp>
#include <silt/parallel/decomposition/rcb.hpp>
#endif
