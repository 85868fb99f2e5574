// silt - BSD-3-Clause, see LICENSE
#pragma once

// Simulations on many ranks: silt::Ranks{communicator, decomposition}. silt/mpi.hpp has this, and
// MPI; alone it is for ranks that are threads (silt/parallel/thread_comm.hpp). See docs/ranks.md.

#include <silt/parallel/decomposition/bisection.hpp>
#include <silt/parallel/decomposition/rebalance.hpp>
#include <silt/parallel/decomposition/slabs.hpp>
#include <silt/parallel/ranks.hpp>
#include <silt/simulation/with_ranks.hpp>
