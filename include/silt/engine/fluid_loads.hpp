// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What a fluid gives particles.
enum class FromFluid { Nothing, Force, ForceAndTorque };

/// A vector as a row of lanes.
struct alignas(32) VectorRow {
  double x = 0, y = 0, z = 0, unused = 0;
  Vec3d vector() const { return {x, y, z}; }
  static VectorRow of(const Vec3d& v) { return {v.x, v.y, v.z, 0}; }
};

/// Loads of a fluid on particles, one row each, which act until the fluid is asked again; and what
/// the coupling must know of that moment then. A particle that is new has none, and an unforced
/// velocity that is not a number.
template <FromFluid What>
struct FluidLoads {
  static constexpr bool any = What != FromFluid::Nothing;
  static constexpr bool turns = What == FromFluid::ForceAndTorque;
  static constexpr std::size_t bytes = any ? (2 + turns) * sizeof(VectorRow) : 0;

  AlignedVector<VectorRow> force;   // [N]
  AlignedVector<VectorRow> torque;  // [N m]
  /// [m/s] What the velocity would be now if only drag had acted since the fluid was asked: what it
  /// differs by is the work of all else.
  AlignedVector<VectorRow> unforced;

  void add() {
    if constexpr (any) {
      constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
      force.push_back({}), unforced.push_back({unknown, 0, 0, 0});
      if constexpr (turns) torque.push_back({});
    }
  }
  void remove(std::size_t k) {
    if constexpr (any) force[k] = {};
    if constexpr (turns) torque[k] = {};
  }
  void resize(std::size_t n) {
    if constexpr (any) force.resize(n), unforced.resize(n);
    if constexpr (turns) torque.resize(n);
  }
  /// Calls visit(name, column) for each of them.
  template <class Visit>
  void for_each(const Visit& visit) const {
    if constexpr (any) visit("fluid.force", force), visit("fluid.unforced", unforced);
    if constexpr (turns) visit("fluid.torque", torque);
  }
  template <class Visit>
  void for_each(const Visit& visit) {
    if constexpr (any) visit("fluid.force", force), visit("fluid.unforced", unforced);
    if constexpr (turns) visit("fluid.torque", torque);
  }
};

}  // namespace silt::detail
