// silt - BSD-3-Clause, see LICENSE
#pragma once

// Simulations compiled once, in a library; a change of a scene then compiles in seconds
// (docs/building.md). CMake's target silt::precompiled has those of the list below and defines
// SILT_PRECOMPILED, with which silt/silt.hpp includes this header; any other simulation still
// compiles. For your own simulation:
//
//   // my_scene.hpp, included by the scene
//   #include <silt/precompiled.hpp>
//   SILT_DECLARE_SIMULATION(silt::Particles<silt::Sphere>, silt::Contacts<MyLaw>, silt::Mixed)
//
//   // my_scene.cpp, compiled once
//   #include "my_scene.hpp"
//   SILT_INSTANTIATE_SIMULATION(silt::Particles<silt::Sphere>, silt::Contacts<MyLaw>, silt::Mixed)
//
// Policies in any order. Compile both files with the same flags: another instruction set is another
// simulation, and the linker reports it as missing.

#include <utility>

#include <silt/silt.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Type of Simulation{policies...}.
template <class... Policies>
using SimulationOf = decltype(Simulation(std::declval<Policies>()...));

}  // namespace silt::detail

// Parts of a step and of the start of a run: almost all code of a simulation. Code that depends on
// the observers of a run is compiled with the scene.
#define SILT_SIMULATION_PARTS(extern_or_not, ...)                                               \
  namespace silt::inline SILT_TARGET {                                                          \
  extern_or_not template void detail::SimulationOf<__VA_ARGS__>::prepare();                     \
  extern_or_not template void detail::SimulationOf<__VA_ARGS__>::advance(bool);                 \
  extern_or_not template void detail::SimulationOf<__VA_ARGS__>::finish_step();                 \
  extern_or_not template double detail::SimulationOf<__VA_ARGS__>::expected_speed() const;      \
  extern_or_not template void detail::SimulationOf<__VA_ARGS__>::keep_limits();                 \
  extern_or_not template void detail::SimulationOf<__VA_ARGS__>::check_walls() const;           \
  extern_or_not template std::size_t detail::SimulationOf<__VA_ARGS__>::touching_pairs() const; \
  extern_or_not template std::vector<std::size_t> detail::SimulationOf<__VA_ARGS__>::add(       \
      const detail::SimulationOf<__VA_ARGS__>::ParticlesType&);                                 \
  extern_or_not template std::size_t detail::SimulationOf<__VA_ARGS__>::add_wall(               \
      Surfaces, const detail::SimulationOf<__VA_ARGS__>::ContactsType::Material&, WallSetup);   \
  extern_or_not template double detail::SimulationOf<__VA_ARGS__>::insert(                      \
      const std::vector<PlacedSphere>&, const std::vector<std::size_t>&, const InletFlow&,      \
      Random&);                                                                                 \
  }

/// Declares that a simulation with these policies is compiled elsewhere.
#define SILT_DECLARE_SIMULATION(...) SILT_SIMULATION_PARTS(extern, __VA_ARGS__)
/// Compiles it here.
#define SILT_INSTANTIATE_SIMULATION(...) SILT_SIMULATION_PARTS(, __VA_ARGS__)

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

SILT_PRECOMPILED_SPHERES(SILT_DECLARE_SIMULATION)
SILT_PRECOMPILED_SPHERES_MORE(SILT_DECLARE_SIMULATION)
SILT_PRECOMPILED_BODIES(SILT_DECLARE_SIMULATION)
SILT_PRECOMPILED_POLYHEDRA(SILT_DECLARE_SIMULATION)
