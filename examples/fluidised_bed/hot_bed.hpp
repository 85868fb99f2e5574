// silt - BSD-3-Clause, see LICENSE
#pragma once

#include "fluidised_bed/scene.hpp"
#include "support/example.hpp"

namespace fluidised {

/// Hot gas through the cold bed (hot_bed.cpp); returns the exit status.
int blow_hot(const Scene& s, const example::Options& options);

}  // namespace fluidised
