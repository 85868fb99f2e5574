// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>

#include <silt/core/storage.hpp>
#include <silt/core/vec3.hpp>
#include <silt/engine/state/columns.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The loads that a fluid applies to particles.
enum class FromFluid { Nothing, Force, ForceAndTorque, FollowedForce, FollowedForceAndTorque };
constexpr bool turns(FromFluid what) {
  return what == FromFluid::ForceAndTorque || what == FromFluid::FollowedForceAndTorque;
}
/// Whether drag is recomputed in each particle step (FollowedDrag).
constexpr bool follows(FromFluid what) {
  return what == FromFluid::FollowedForce || what == FromFluid::FollowedForceAndTorque;
}

/// A vector as a row of four lanes; the fourth number belongs to it.
struct alignas(32) VectorRow {
  double x = 0, y = 0, z = 0, fourth = 0;
  Vec3d vector() const { return {x, y, z}; }
  static VectorRow of(const Vec3d& v) { return {v.x, v.y, v.z, 0}; }
};

/// Loads of a fluid on particles, one row each, applied until the fluid is evaluated again, and the
/// data that the coupling then needs from this evaluation. A new particle has no load, and NaN as x
/// of its unforced velocity.
template <FromFluid What>
struct FluidLoads {
  static constexpr bool any = What != FromFluid::Nothing;
  static constexpr bool turns = detail::turns(What), follows = detail::follows(What);

  AlignedVector<VectorRow> force;   // [N]
  AlignedVector<VectorRow> torque;  // [N m]
  /// [m/s] The velocity the particle would now have if only drag had acted since the last
  /// evaluation; the difference to its velocity is due to all other forces.
  AlignedVector<VectorRow> unforced;
  /// [m3] Volume that the particle had in the fluid at its last evaluation; 0: it was not there.
  /// Fragments have their own volume, in the place of the particle that was there.
  AlignedVector<double> displaced;
  // For drag that is recomputed in each step. The fourth number of each row is given in brackets.
  AlignedVector<VectorRow> held;       // [N] forces besides drag (drag coefficient [kg/s])
  AlignedVector<VectorRow> flow;       // [m/s] the fluid's velocity (voidage [-])
  AlignedVector<VectorRow> reference;  // [m/s] slip (voidage [-]) of the coefficient
  AlignedVector<VectorRow>
      given;  // [N s] for the fluid step, remainder included (diameter [m]; 0: none)
  AlignedVector<VectorRow> taken;  // [N s] since then, less the planned part
  Vec3d left{0, 0, 0};             // [N s] taken by particles that left since the last read

  bool is_new(std::size_t k) const { return std::isnan(unforced[k].x); }

  static constexpr auto columns() {
    constexpr VectorRow unknown{std::numeric_limits<double>::quiet_NaN(), 0, 0, 0};
    return std::tuple_cat(
        columns_if<any>([=] {
          return std::tuple{
              column<VectorRow>(
                  "fluid.force", [](auto& t) -> auto& { return t.force; }),
              column<VectorRow>(
                  "fluid.unforced", [](auto& t) -> auto& { return t.unforced; }, unknown),
              column<double>(
                  "fluid.displaced", [](auto& t) -> auto& { return t.displaced; })};
        }),
        columns_if<turns>([] {
          return std::tuple{column<VectorRow>(
              "fluid.torque", [](auto& t) -> auto& { return t.torque; })};
        }),
        columns_if<follows>([=] {
          return std::tuple{
              column<VectorRow>(
                  "fluid.held", [](auto& t) -> auto& { return t.held; }),
              column<VectorRow>(
                  "fluid.flow", [](auto& t) -> auto& { return t.flow; }),
              column<VectorRow>(
                  "fluid.reference", [](auto& t) -> auto& { return t.reference; }, unknown),
              column<VectorRow>(
                  "fluid.given", [](auto& t) -> auto& { return t.given; }),
              column<VectorRow>(
                  "fluid.taken", [](auto& t) -> auto& { return t.taken; })};
        }));
  }
  /// Called before row k is parked.
  void leave([[maybe_unused]] std::size_t k) {
    if constexpr (follows) left += taken[k].vector();
  }
};

}  // namespace silt::detail
