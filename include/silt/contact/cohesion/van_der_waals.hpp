// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/contact/cohesion/cohesive.hpp>

namespace silt::inline SILT_TARGET {

/// Van der Waals attraction of two close spheres, or of a sphere and a plane.
///
///   F = A R*/6 (1/h^2 - 1/h_c^2), h = max(gap, h_0); 0 beyond the cutoff h_c                  (1)
///
/// In contact F keeps its value at h_0, the closest distance of the surface atoms. The second term
/// shifts the force to 0 at the cutoff, which avoids a jump.
///
/// Source: H. C. Hamaker, Physica 4 (1937) 1058, for h << R*; B. V. Derjaguin, Kolloid-Z. 69 (1934)
///         155 (R* of unequal spheres).
/// Valid:  gap well below the radius: for equal spheres the first term of (1) is 1.02 times
///         Hamaker's full sum at h = R/100, 1.22 times at R/10. No retardation (h < 100 nm or so).
///         A step must be short against closest/speed; the time step chosen by silt is.
/// Units:  SI. Shapes: Real = double or batch, lane = pair. History: none.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/contact/cohesion.cpp, tests/physics/cohesion.cpp.
struct VanDerWaals {
  struct Pair {
    double hamaker = 0;     // [J] A >= 0; for two unlike materials often sqrt(A1 A2)
    double closest = 1e-9;  // [m] h_0 > 0; 0.165e-9 ... 0.4e-9 between smooth bodies, more if rough
    double cutoff = 1e-6;   // [m] h_c > h_0
    bool operator==(const Pair&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real strength;   // [J] A/6
    Real closest;    // [m]
    Real cutoff;     // [m]
    Real at_cutoff;  // [1/m2] 1/h_c^2
  };

  static Coefficients<double> mix(const Pair& p) {
    return {p.hamaker / 6, p.closest, p.cutoff, 1 / (p.cutoff * p.cutoff)};
  }
  template <class Real>
  static SILT_INLINE Real attraction(const Contact<Real>& c, const Coefficients<Real>& p) {
    const Real nearness = Real(1) / max(-c.overlap, p.closest);
    return p.strength * c.R_eff * max(nearness * nearness - p.at_cutoff, Real(0));  // (1)
  }
  template <class Real>
  static SILT_INLINE Real range(const Coefficients<Real>& p, const Real&) {
    return p.cutoff;
  }
  /// The force falls to one ninth over a distance of twice `closest`.
  static double passing_time(const Coefficients<double>& p, double speed) {
    return 2 * p.closest / speed;
  }
  static void check(const Pair& p) {
    require_not_negative("VanDerWaals.hamaker", p.hamaker, "J");
    require_positive("VanDerWaals.closest", p.closest, "m");
    require(std::isfinite(p.cutoff) && p.cutoff > p.closest, "VanDerWaals.cutoff = ", p.cutoff,
            " [m] must be finite and greater than closest = ", p.closest, " m");
  }
};

static_assert(CohesionModel<VanDerWaals>);

}  // namespace silt
