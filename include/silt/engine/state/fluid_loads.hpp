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
enum class FromFluid { Nothing, Force, ForceAndTorque, FollowedForce, FollowedForceAndTorque };
constexpr bool turns(FromFluid what) {
  return what == FromFluid::ForceAndTorque || what == FromFluid::FollowedForceAndTorque;
}
/// With drag that is found anew in each particle step (FollowedDrag).
constexpr bool follows(FromFluid what) {
  return what == FromFluid::FollowedForce || what == FromFluid::FollowedForceAndTorque;
}

/// A vector as a row of lanes, and a fourth number that goes with it.
struct alignas(32) VectorRow {
  double x = 0, y = 0, z = 0, fourth = 0;
  Vec3d vector() const { return {x, y, z}; }
  static VectorRow of(const Vec3d& v) { return {v.x, v.y, v.z, 0}; }
};

/// Loads of a fluid on particles, one row each, which act until the fluid is asked again; and what
/// the coupling must know of that moment then. A particle that is new has none, and an unforced
/// velocity that is not a number.
template <FromFluid What>
struct FluidLoads {
  static constexpr bool any = What != FromFluid::Nothing;
  static constexpr bool turns = detail::turns(What), follows = detail::follows(What);
  static constexpr std::size_t bytes = any ? (2 + turns + 5 * follows) * sizeof(VectorRow) : 0;

  AlignedVector<VectorRow> force;   // [N]
  AlignedVector<VectorRow> torque;  // [N m]
  /// [m/s] What the velocity would be now if only drag had acted since the fluid was asked: what it
  /// differs by is the work of all else.
  AlignedVector<VectorRow> unforced;
  // Of drag that follows the velocity; the fourth number of each in brackets.
  AlignedVector<VectorRow> held;       // [N] forces besides drag (drag coefficient [kg/s])
  AlignedVector<VectorRow> flow;       // [m/s] the fluid's velocity (voidage [-])
  AlignedVector<VectorRow> reference;  // [m/s] slip (voidage [-]) that the coefficient is of
  AlignedVector<VectorRow>
      given;  // [N s] by the fluid's step, with what it owed (diameter [m]; 0: none)
  AlignedVector<VectorRow> taken;  // [N s] since then, less what the step is for
  Vec3d left{0, 0, 0};             // [N s] taken by those that have left since it was last read

  void add() {
    if constexpr (any) {
      constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
      force.push_back({}), unforced.push_back({unknown, 0, 0, 0});
      if constexpr (turns) torque.push_back({});
      if constexpr (follows) {
        held.push_back({}), flow.push_back({}), given.push_back({}), taken.push_back({});
        reference.push_back({unknown, 0, 0, 0});
      }
    }
  }
  void remove(std::size_t k) {
    if constexpr (any) force[k] = {};
    if constexpr (turns) torque[k] = {};
    if constexpr (follows) {
      left += taken[k].vector();
      held[k] = flow[k] = given[k] = taken[k] = {};
    }
  }
  void resize(std::size_t n) {
    if constexpr (any) force.resize(n), unforced.resize(n);
    if constexpr (turns) torque.resize(n);
    if constexpr (follows)
      for (auto* column : {&held, &flow, &reference, &given, &taken}) column->resize(n);
  }
  /// Calls visit(name, column) for each of them.
  template <class Visit>
  void for_each(const Visit& visit) const {
    if constexpr (any) visit("fluid.force", force), visit("fluid.unforced", unforced);
    if constexpr (turns) visit("fluid.torque", torque);
    if constexpr (follows) {
      visit("fluid.held", held), visit("fluid.flow", flow), visit("fluid.reference", reference);
      visit("fluid.given", given), visit("fluid.taken", taken);
    }
  }
  template <class Visit>
  void for_each(const Visit& visit) {
    if constexpr (any) visit("fluid.force", force), visit("fluid.unforced", unforced);
    if constexpr (turns) visit("fluid.torque", torque);
    if constexpr (follows) {
      visit("fluid.held", held), visit("fluid.flow", flow), visit("fluid.reference", reference);
      visit("fluid.given", given), visit("fluid.taken", taken);
    }
  }
};

}  // namespace silt::detail
