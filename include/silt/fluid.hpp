// silt - BSD-3-Clause, see LICENSE
#pragma once

/// All of silt with fluids: silt/silt.hpp, the flow solver, the coupling modes, and the forces
/// between fluid and particles. Scenes without a fluid include silt/silt.hpp, which compiles
/// faster.
#include <silt/coupling/averaging/diffusion.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/averaging/two_grid.hpp>
#include <silt/coupling/averaging/unresolved.hpp>
#include <silt/coupling/cell_space.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/coupled_mesh.hpp>
#include <silt/coupling/drag/laws.hpp>
#include <silt/coupling/formulas.hpp>
#include <silt/coupling/lift/ellipsoid_torque.hpp>
#include <silt/coupling/prescribed_flow.hpp>
#include <silt/coupling/unsteady/history_force.hpp>
#include <silt/fluid/boundary_of.hpp>
#include <silt/io/flow_observers.hpp>
#include <silt/module/heat/fluid_convection.hpp>
#include <silt/silt.hpp>

#ifdef SILT_PRECOMPILED
#include <silt/precompiled_fluid.hpp>
#endif
