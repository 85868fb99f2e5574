// silt - BSD-3-Clause, see LICENSE
#pragma once

// Simulations compiled once, in a library; a change of a scene then compiles in seconds
// (docs/building.md). CMake's target silt::precompiled has those of the list below and defines
// SILT_PRECOMPILED, with which silt/silt.hpp includes this header; any other simulation still
// compiles. silt/declare_simulation.hpp does the same for a simulation of your own.

#include <silt/core/dyn_array.hpp>
#include <silt/declare_simulation.hpp>

// Simulations in silt::precompiled: FOR_EACH(policies...).
#define SILT_PRECOMPILED_SPHERES(FOR_EACH)                                            \
  FOR_EACH(silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin>)         \
  FOR_EACH(silt::Particles<silt::Sphere>, silt::Contacts<silt::LinearSpringFriction>) \
  FOR_EACH(silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin, silt::RollingEpsd>)
#define SILT_PRECOMPILED_SPHERES_MORE(FOR_EACH)                                            \
  FOR_EACH(silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin>, silt::Mixed) \
  FOR_EACH(silt::Particles<silt::Sphere>,                                                  \
           silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials>)                     \
  FOR_EACH(silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin>, silt::PeriodicBox)
#define SILT_PRECOMPILED_BODIES(FOR_EACH)                                          \
  FOR_EACH(silt::Particles<silt::MultiSphere>, silt::Contacts<silt::HertzMindlin>) \
  FOR_EACH(silt::Particles<silt::SuperEllipsoid>, silt::Contacts<silt::HertzMindlin>)
#define SILT_PRECOMPILED_POLYHEDRA(FOR_EACH) \
  FOR_EACH(silt::Particles<silt::Polyhedron>, silt::Contacts<silt::HertzMindlin>)

// What scenes compile beside a simulation: filling regions, and fields of VTK files.
#define SILT_PRECOMPILED_FILL(extern_or_not, ...)                                \
  namespace silt::inline SILT_TARGET {                                           \
  extern_or_not template FillResult pack(const __VA_ARGS__&, const FillRequest&, \
                                         std::span<const PlacedSphere>);         \
  }
#define SILT_PRECOMPILED_FIELD(extern_or_not, ...)                                        \
  namespace silt::inline SILT_TARGET {                                                    \
  extern_or_not template VtkFields& VtkFields::add(std::string_view, const __VA_ARGS__&); \
  }
#define SILT_PRECOMPILED_PIECES(extern_or_not)                   \
  SILT_PRECOMPILED_FILL(extern_or_not, Box)                      \
  SILT_PRECOMPILED_FIELD(extern_or_not, DynArray<float>)         \
  SILT_PRECOMPILED_FIELD(extern_or_not, DynArray<double>)        \
  SILT_PRECOMPILED_FIELD(extern_or_not, DynArray<std::uint64_t>) \
  SILT_PRECOMPILED_FIELD(extern_or_not, DynArray<std::array<float, 3>>)

SILT_PRECOMPILED_PIECES(extern)
SILT_PRECOMPILED_SPHERES(SILT_DECLARE_SIMULATION)
SILT_PRECOMPILED_SPHERES_MORE(SILT_DECLARE_SIMULATION)
SILT_PRECOMPILED_BODIES(SILT_DECLARE_SIMULATION)
SILT_PRECOMPILED_POLYHEDRA(SILT_DECLARE_SIMULATION)
