// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Simulation for several ranks; included by silt/ranks.hpp.

#include <silt/engine/ranks/near_others.hpp>
#include <silt/engine/ranks/rank_bonds.hpp>
#include <silt/engine/ranks/rank_change.hpp>
#include <silt/engine/ranks/rank_stage.hpp>
#include <silt/simulation.hpp>
