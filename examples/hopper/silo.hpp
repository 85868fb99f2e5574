// silt - BSD-3-Clause, see LICENSE
#pragma once

#include "support/example.hpp"

namespace silo {

/// A round silo above a cone: wall pressure at rest and during discharge (silo.cpp); returns the
/// exit status.
///   wall_friction: of grains on the wall [-]
int load_walls(double wall_friction, const example::Options& options);

}  // namespace silo
