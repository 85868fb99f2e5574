// silt - BSD-3-Clause, see LICENSE
#pragma once

// A simulation of your own, compiled once in a file of its own; a change of the scene then compiles
// without it (docs/building.md):
//
//   // my_scene.hpp, included by the scene
//   #include <silt/core/dyn_array.hpp>
#include <silt/declare_simulation.hpp>
//   SILT_DECLARE_SIMULATION(silt::Particles<silt::Sphere>, silt::Contacts<MyLaw>, silt::Mixed)
//
//   // my_scene.cpp, compiled once
//   #include "my_scene.hpp"
//   SILT_INSTANTIATE_SIMULATION(silt::Particles<silt::Sphere>, silt::Contacts<MyLaw>, silt::Mixed)
//
// Policies in any order. Compile both files with the same flags: another instruction set is another
// simulation, and the linker reports it as missing. Tests: tests/engine/declared_simulation.cpp.

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <silt/silt.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Type of Simulation{policies...}.
template <class... Policies>
using SimulationOf = decltype(Simulation(std::declval<Policies>()...));
/// Type of vtk_series(folder, schedule).
using PlainVtkSeries = decltype(vtk_series(std::string(), std::declval<Schedule>()));

}  // namespace silt::detail

// Parts of a step, of the start of a run, of its warnings and of the files of vtk_series(folder,
// schedule): almost all code of a simulation. Code that depends on the observers of a run is
// compiled with the scene.
#define SILT_SIMULATION_PARTS(extern_or_not, ...)                                                  \
  namespace silt::inline SILT_TARGET {                                                             \
  extern_or_not template void detail::SimulationOf<__VA_ARGS__>::prepare();                        \
  extern_or_not template void detail::SimulationOf<__VA_ARGS__>::advance(bool);                    \
  extern_or_not template void detail::SimulationOf<__VA_ARGS__>::finish_step();                    \
  extern_or_not template bool detail::SimulationOf<__VA_ARGS__>::follow_time_step(bool);           \
  extern_or_not template double detail::SimulationOf<__VA_ARGS__>::expected_speed() const;         \
  extern_or_not template double detail::SimulationOf<__VA_ARGS__>::carried_speed(                  \
      const Box&) const;                                                                           \
  extern_or_not template void detail::SimulationOf<__VA_ARGS__>::keep_limits();                    \
  extern_or_not template void detail::SimulationOf<__VA_ARGS__>::check_walls() const;              \
  extern_or_not template detail::SimulationOf<__VA_ARGS__>::Engine::Engine();                      \
  extern_or_not template detail::SimulationOf<__VA_ARGS__>::Engine::~Engine();                     \
  extern_or_not template std::size_t detail::SimulationOf<__VA_ARGS__>::Engine::touching_pairs(    \
      const detail::SimulationOf<__VA_ARGS__>::Domain&) const;                                     \
  extern_or_not template std::vector<std::size_t> detail::SimulationOf<__VA_ARGS__>::add(          \
      const detail::SimulationOf<__VA_ARGS__>::ParticlesType&);                                    \
  extern_or_not template std::size_t detail::SimulationOf<__VA_ARGS__>::add_wall(                  \
      Surfaces, const detail::SimulationOf<__VA_ARGS__>::ContactsType::Material&, WallSetup);      \
  extern_or_not template double detail::SimulationOf<__VA_ARGS__>::insert(                         \
      const DynArray<PlacedSphere>&, const DynArray<std::size_t>&, const InletFlow&, Random&);     \
  extern_or_not template DynArray<std::string> scene_warnings(                                     \
      const detail::SimulationOf<__VA_ARGS__>&);                                                   \
  extern_or_not template DynArray<std::string> overlap_warnings(                                   \
      const detail::SimulationOf<__VA_ARGS__>&);                                                   \
  extern_or_not template DynArray<std::string> inlet_warnings(                                     \
      const detail::SimulationOf<__VA_ARGS__>&);                                                   \
  extern_or_not template DynArray<std::string> servo_warnings(                                     \
      const detail::SimulationOf<__VA_ARGS__>&);                                                   \
  extern_or_not template WallTriangles wall_triangles(const detail::SimulationOf<__VA_ARGS__>&,    \
                                                      const Box&);                                 \
  extern_or_not template Box detail::region_of_scene(const detail::SimulationOf<__VA_ARGS__>&,     \
                                                     const Box&, double);                          \
  extern_or_not template Box detail::wall_region(const detail::SimulationOf<__VA_ARGS__>&);        \
  extern_or_not template void detail::NameAccess<detail::SimulationOf<__VA_ARGS__>>::check_pairs() \
      const;                                                                                       \
  extern_or_not template void detail::check_given(                                                 \
      const detail::SimulationOf<__VA_ARGS__>::Engine&, const Vec3d&, std::int64_t, double);       \
  extern_or_not template void detail::PlainVtkSeries::begin(                                       \
      const detail::SimulationOf<__VA_ARGS__>&, double);                                           \
  extern_or_not template void detail::PlainVtkSeries::operator()(                                  \
      const detail::SimulationOf<__VA_ARGS__>&);                                                   \
  }

/// Declares that a simulation with these policies is compiled elsewhere.
#define SILT_DECLARE_SIMULATION(...) SILT_SIMULATION_PARTS(extern, __VA_ARGS__)
/// Compiles it here.
#define SILT_INSTANTIATE_SIMULATION(...) SILT_SIMULATION_PARTS(, __VA_ARGS__)
