// silt - BSD-3-Clause, see LICENSE
#pragma once

#include "verification/strike.hpp"

namespace verification {

/// v_s' [m/s] after an oblique impact by the equations of HertzMindlin (force memory, contact ends
/// at zero force) for two rigid bodies in plane motion, implemented separately here and integrated
/// with steps that give 1e-4 of v_s. It has no lever arm shortened by the overlap, no rotating
/// normal, no lanes, lists or lag of the velocities: these are what the engine must get right.
///
///   m* d'' = -F_n,  F_n = max(4/3 E* sqrt(R*) d^(3/2) + c_n d', 0)
///   2/7 m* v_s' = -F_t,  F_t = spring + c_t u, |F_t| <= mu F_n, spring' = S_t u              (2)
///   u = v_s during sticking; during sliding u is such that F_t equals the limit
///   S_n = 2 E* sqrt(R* d), S_t = 8 G* sqrt(R* d), c = 2 sqrt(5/6) zeta sqrt(S m*)
///   and during unloading the spring decreases with S_t
double planar_surface_speed_after(const Impact& impact, double surface_speed, int steps = 20000);

}  // namespace verification
