// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Drag that follows each particle's velocity from step to step, while the fluid's values are held
/// over a fluid step; one of the further policies of a CoupledFlow:
///
///   silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, flow, silt::FollowedDrag{}}
///
/// In each particle step a particle feels K(W) W, W = u - v(t), integrated by its exponential
/// (MomentumExchange) with the contacts of that very step, however stiff. The fluid has been given
/// what it predicted at its step; the difference to what the particles then took is paid to it in
/// its next one (CoupledStep::owed).
///
/// `cell`: u, pressure and stress are read from cells of that size where the particle is now;
/// 0: held for each particle as its mode of averaging has gathered them.
/// `tolerance`: K is renewed only where |W - W'| > tolerance |W'| or the voidage has changed by
/// more than tolerance since it was (W' then); 0: in each step. K ~ |W|^n, 0 <= n <= 1, is then off
/// by up to n tolerance.
///
/// Source: the exponential pair of MomentumExchange; cells and tolerance: T. Brosh, H. Kalman,
///         A. Levy, Particuology 12 (2014) 113, who name them without formulas.
/// Errors: InputError for negative numbers, and for cells too small; not with VirtualMass (it does
///         not compile).
/// Tests:  tests/coupling/followed_drag.cpp.
struct FollowedDrag {
  static constexpr bool follows_velocity = true;
  double cell = 0;       // [m]
  double tolerance = 0;  // [-]

  void check() const {
    require_not_negative("FollowedDrag.cell", cell, "m");
    require_not_negative("FollowedDrag.tolerance", tolerance, "-");
  }
  /// Refuses cells that no memory holds.
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
