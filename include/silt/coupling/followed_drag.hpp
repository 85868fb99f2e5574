// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Drag that follows each particle's velocity from step to step, with the fluid's values constant
/// over a fluid step. An optional policy of a CoupledFlow:
///
///   silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow, silt::FollowedDrag{}}
///
/// In each particle step the force K(W) W, W = u - v(t), is integrated by its exponential
/// (MomentumExchange) together with the contacts of that step; arbitrarily stiff drag is stable. In
/// its own step the fluid gets the predicted force. The difference to the force that then acted on
/// the particles is added in its next step (CoupledStep::owed).
///
/// `cell`: u, pressure and stress are read from cells of that size at the present position of the
/// particle; 0: they are constant for each particle, as gathered by the averaging mode.
/// `tolerance`: K is updated only if |W - W'| > tolerance |W'|, or the void fraction has changed by
/// more than tolerance, since its last update (W' then); 0: in each step. For K ~ |W|^n, 0 <= n <=
/// 1, the error is at most n tolerance.
///
/// Source: the exponential pair of MomentumExchange; cells and tolerance: T. Brosh, H. Kalman, A.
///         Levy, Particuology 12 (2014) 113, who mention them without formulas.
/// Errors: InputError for negative numbers, and for cells too small; does not compile with
///         VirtualMass.
/// Tests:  tests/coupling/followed_drag.cpp.
struct FollowedDrag {
  static constexpr bool follows_velocity = true, needs_spin = false;
  double cell = 0;       // [m]
  double tolerance = 0;  // [-]

  void check() const {
    require_not_negative("FollowedDrag.cell", cell, "m");
    require_not_negative("FollowedDrag.tolerance", tolerance, "-");
  }
  /// Refuses cells that would need too much memory.
  void check(const Box& box) const {
    check();
    if (cell == 0) return;
    const Vec3d n = (1 / cell) * box.extent();
    require(std::max(n.x, 1.0) * std::max(n.y, 1.0) * std::max(n.z, 1.0) < 1e8,
            "FollowedDrag.cell = ", cell, " [m] cuts the flow's box of ", box.extent(),
            " m into more than 1e8 cells; use larger ones, or 0 for values stored per particle");
  }
};

}  // namespace silt
