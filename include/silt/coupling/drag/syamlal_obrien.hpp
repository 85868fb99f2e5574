// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>

#include <silt/core/error.hpp>
#include <silt/coupling/drag/di_felice.hpp>
#include <silt/fluid/properties.hpp>

namespace silt::inline SILT_TARGET {

/// Measured minimum fluidisation of a bed. For SyamlalOBrien::calibrated().
struct MinimumFluidisation {
  double velocity;          // [m/s] superficial
  double voidage;           // [-]
  double diameter;          // [m]
  double particle_density;  // [kg/m3]
  FluidProperties fluid;
  double gravity = 9.81;  // [m/s2]

  /// Fhat [-] of the drag that carries the bed: with (1) of DragLaw, W = U/eps and buoyancy, Fhat =
  /// (rho_p - rho) g d^2/(18 mu W).
  double normalised_drag() const {
    return (particle_density - fluid.density) * gravity * diameter * diameter * voidage /
           (18 * fluid.viscosity * velocity);
  }
  void check() const {
    require_positive("MinimumFluidisation.velocity", velocity, "m/s");
    require_in("MinimumFluidisation.voidage", voidage, "-", 0.2, 0.85);
    require_positive("MinimumFluidisation.diameter", diameter, "m");
    require_positive("MinimumFluidisation.gravity", gravity, "m/s2");
    require_positive("MinimumFluidisation.fluid.density", fluid.density, "kg/m3");
    require_positive("MinimumFluidisation.fluid.viscosity", fluid.viscosity, "Pa s");
    require(std::isfinite(particle_density) && particle_density > fluid.density,
            "MinimumFluidisation.particle_density = ", particle_density,
            " [kg/m3] must be above that of the fluid, ", fluid.density);
  }
};

/// Drag from the ratio V_r of the terminal velocity of a suspension to that of a single sphere:
///   Fhat = C_D(x) x/(24 V_r),  x = Re_i/V_r,  C_D = (0.63 + 4.8/sqrt(x))^2 (Dalla Valle)
///   V_r = [A - 0.06 Re_i + sqrt((0.06 Re_i)^2 + 0.12 Re_i (2 B - A) + A^2)]/2
///   A = eps^4.14,  B = c1 eps^1.28 where eps <= 0.85, eps^d1 above
/// Re_i = rho |W| d/mu with the interstitial slip: Re/eps. c1 = 0.8 and d1 = 2.65 are Garside and
/// Al-Dibouni's fit of settling; `calibrated` finds others. They have no effect for Re_i -> 0. With
/// the default values Fhat jumps by 0.1 % at eps = 0.85; calibrated ones are continuous. In dense
/// beds Fhat first decreases with Re (by 30 % up to Re = 1 at eps = 0.4), as V_r increases from A
/// to B.
/// Source: M. Syamlal, T. J. O'Brien, Int. J. Multiphase Flow 14 (1988) 473; J. Garside, M. R.
///         Al-Dibouni, Ind. Eng. Chem. Process Des. Dev. 16 (1977) 206. Recalled: the prints were
///         not read; compared with the source of MFIX (drag_gs.f, DRAG_SYAM_OBRIEN), which has the
///         same formulas, c1 and d1. The fit of c1 and d1 to the minimum fluidisation velocity is
///         from there; its closed form is silt's.
/// Valid:  eps from 0.2 to 1; settling suspensions. Packed beds: only calibrated.
/// Tests:  tests/coupling/syamlal_obrien.cpp.
struct SyamlalOBrien {
  double c1 = 0.8;   // [-]
  double d1 = 2.65;  // [-]

  void check() const {
    require_positive("SyamlalOBrien.c1", c1, "-");
    require(std::isfinite(d1), "SyamlalOBrien.d1 = ", d1, " [-] must be finite");
  }
  template <class Real>
  Real velocity_ratio(const Real& eps, const Real& Re_i) const {
    using detail::lanes_of;
    const Real A = power(eps, Real(lanes_of<Real>(4.14)));
    const Real B = select(eps <= lanes_of<Real>(0.85),
                          lanes_of<Real>(c1) * power(eps, Real(lanes_of<Real>(1.28))),
                          power(eps, Real(lanes_of<Real>(d1))));
    const Real r = lanes_of<Real>(0.06) * Re_i;
    // root - r without cancellation.
    const Real more = Real(2) * r * (Real(2) * B - A) + A * A;
    const Real root = sqrt(max(r * r + more, Real(0)));
    return max(lanes_of<Real>(0.5) * (A + more / (root + r)), lanes_of<Real>(1e-6));
  }
  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    const Real Re_i = Re / eps, V_r = velocity_ratio(eps, Re_i);
    return detail::dalla_valle(Real(Re_i / V_r)) / V_r;
  }

  /// The law whose drag carries a bed at exactly its measured velocity. With F = Fhat of the bed:
  ///   (0.63 sqrt(Re_i) s + 4.8) s = sqrt(24 F),  V_r = 1/s^2,
  ///   B = V_r + V_r (V_r - A)/(0.06 Re_i),  c1 = B/eps^1.28,  d1 = 1.28 + log c1/log 0.85
  /// Errors: InputError if no c1 > 0 is a solution, and if c1 has almost no effect (Re_i below
  ///         0.01).
  static SyamlalOBrien calibrated(const MinimumFluidisation& bed) {
    bed.check();
    const double eps = bed.voidage,
                 Re_i = bed.fluid.density * bed.velocity / eps * bed.diameter / bed.fluid.viscosity;
    require(Re_i > 0.01, "SyamlalOBrien::calibrated: Re = ", Re_i,
            " [-] of the slip is below 0.01, where c1 and d1 have no effect; use a law for packed "
            "beds, as Gidaspow");
    const double a = 0.63 * std::sqrt(Re_i), wanted = std::sqrt(24 * bed.normalised_drag());
    const double s = 2 * wanted / (4.8 + std::sqrt(4.8 * 4.8 + 4 * a * wanted));
    const double V_r = 1 / (s * s), A = std::pow(eps, 4.14);
    const double B = V_r + V_r * (V_r - A) / (0.06 * Re_i);
    require(B > 0, "SyamlalOBrien::calibrated: a bed of void fraction ", eps,
            " that is fluidised at ", bed.velocity,
            " m/s has more drag (Fhat = ", bed.normalised_drag(),
            ") than any c1 gives; check its voidage, diameter and velocity");
    const double c1 = B / std::pow(eps, 1.28);
    return {c1, 1.28 + std::log(c1) / std::log(0.85)};
  }
};

static_assert(DragLaw<SyamlalOBrien>);

}  // namespace silt
