// silt - BSD-3-Clause, see LICENSE
#pragma once

#include "verification/strike.hpp"

namespace verification {

/// v_s' [m/s] after an oblique impact: the equations of HertzMindlin (the force as memory, contact
/// ended at zero force) for two rigid bodies that move in a plane, written out here once more and
/// integrated with steps that leave 1e-4 of v_s. It knows no lever arm shortened by the overlap, no
/// turning normal, no lanes, lists or lag of the velocities: what the engine has to get right.
///
///   m* d'' = -F_n,  F_n = max(4/3 E* sqrt(R*) d^(3/2) + c_n d', 0)
///   2/7 m* v_s' = -F_t,  F_t = spring + c_t u, |F_t| <= mu F_n, spring' = S_t u              (2)
///   u = v_s while it sticks; while it slides what makes F_t the limit
///   S_n = 2 E* sqrt(R* d), S_t = 8 G* sqrt(R* d), c = 2 sqrt(5/6) zeta sqrt(S m*)
///   and as the overlap shrinks the spring shrinks with S_t
double planar_surface_speed_after(const Impact& impact, double surface_speed, int steps = 20000);

}  // namespace verification
