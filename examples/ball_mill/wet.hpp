// silt - BSD-3-Clause, see LICENSE
#pragma once

#include "ball_mill/slurry.hpp"
#include "support/example.hpp"

namespace ball_mill {

/// The wet mill (wet.cpp): its own checks and picture; returns the program's exit status.
int run_wet(const Scene& s, const Slurry& slurry, double seconds, const example::Options& options);

}  // namespace ball_mill
