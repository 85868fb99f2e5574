// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <string>
#include <tuple>
#include <type_traits>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/io/checkpoint_archive.hpp>
#include <silt/module/heat/temperature.hpp>
#include <silt/module/wall_values.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Thermal conditions of walls in checkpoints: those changed by Simulation::set_wall_heat(), as
/// wall, kind, whether it is constant, and its value at the checkpoint's time. A file without such
/// changes has no such column. Functions of time are not stored: the program must have set the same
/// one.
/// Tests:   tests/engine/wall_heat.cpp.
template <class M>
concept KnowsWallHeat = requires(const M& m) {
  { m.walls } -> std::convertible_to<const WallValues<WallHeat>&>;
};
/// Calls visit(module) for the module that has them.
template <class Modules, class Visit>
void with_wall_heat(Modules& modules, const Visit& visit) {
  const auto one = [&](auto& m) {
    if constexpr (KnowsWallHeat<std::remove_cvref_t<decltype(m)>>) visit(m);
  };
  std::apply([&](auto&... all) { (one(all), ...); }, modules);
}

inline constexpr const char* wall_heat_column = "modules.wall_heat";

inline void save_wall_heat(CheckpointSaver& a, const WallValues<WallHeat>& walls, double time) {
  DynArray<double> numbers;
  walls.for_each_changed([&](std::size_t w, const WallHeat& heat) {
    const bool insulated = heat.kind() == WallHeat::Kind::Insulated;
    numbers.insert(numbers.end(), {static_cast<double>(w), static_cast<double>(heat.kind()),
                                   insulated || heat.is_constant() ? 1.0 : 0.0,
                                   insulated ? 0.0 : *heat.value(heat.kind(), time)});
  });
  if (!numbers.empty()) a.copied(wall_heat_column, std::move(numbers));
}

/// Conditions of the program with the changes of the file. FileError, InputError: see above.
template <class Sim>
WallValues<WallHeat> load_wall_heat(const CheckpointLoader& a, const Sim& sim,
                                    WallValues<WallHeat> walls, double time) {
  if (!a.has(wall_heat_column)) return walls;
  using Kind = WallHeat::Kind;
  const auto numbers = a.template column<double>(wall_heat_column);
  a.need(numbers.size() % 4 == 0, wall_heat_column, " has ", numbers.size(),
         " numbers, not 4 each");
  for (std::size_t k = 0; k < numbers.size(); k += 4) {
    const double value = numbers[k + 3];
    a.need(count_number.holds(numbers[k]) && numbers[k] < static_cast<double>(sim.walls()) &&
               (numbers[k + 1] == 0 || numbers[k + 1] == 1 || numbers[k + 1] == 2) &&
               flag_number.holds(numbers[k + 2]) && (numbers[k + 1] != 1 || value >= 0),
           wall_heat_column, ": wall ", numbers[k], ", kind ", numbers[k + 1], ", value ", value,
           " cannot be");
    const auto w = static_cast<std::size_t>(numbers[k]);
    const auto kind = static_cast<Kind>(static_cast<int>(numbers[k + 1]));
    if (numbers[k + 2] == 1) {
      walls.set(sim, w, kind == Kind::Insulated ? WallHeat() : WallHeat(kind, value),
                "HeatConduction.walls");
      continue;
    }
    walls.resolve(sim, "HeatConduction.walls");
    const WallHeat* const own = walls.of(w);
    require(own != nullptr && own->value(kind, time) == value, "checkpoint: ", sim.wall_name(w),
            kind == Kind::HeldAt ? " is held at " : " is heated by ", value,
            kind == Kind::HeldAt ? " K" : " W",
            " by a function of time given to set_wall_heat, which a file cannot contain; "
            "call set_wall_heat with it before load_checkpoint");
  }
  return walls;
}

}  // namespace silt::detail
