// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>

#include <silt/core/error.hpp>
#include <silt/coupling/drag/concept.hpp>
#include <silt/coupling/drag/oriented.hpp>
#include <silt/coupling/fluid_force.hpp>

namespace silt::inline SILT_TARGET {

/// Drag in a mixture of sizes: that of the mean size around a particle, divided among the sizes.
///
///   silt::CoupledFlow{silt::Polydisperse{silt::Gidaspow{}}, silt::Kernel{}, flow}
///
///   Fhat_i = Fhat(eps, Re of <d>) (y + cubic y^3),  y = d_i/<d>,  <d> = sum V/sum (V/d)
///
/// Fhat is that of the law, d_i the particle's diameter, <d> the Sauter mean around it: both sums
/// are spread over the cells and read at the particle with the weights of the averaging mode. With
/// cubic = 0 the drags of all sizes add up to that of as much volume in spheres of <d>, at any void
/// fraction, and equal spheres have the drag of the law. Van der Hoef et al. have 0.064 in
/// Beetstra's law: Polydisperse{Beetstra{}, 0.064}; equal spheres then have 1.064
/// of it. Their factor of the whole force, of model B, is eps y + (1 - eps) y^2 + 0.064 eps y^3,
/// both forces over 3 pi mu d_i eps W. The part (1 - eps) y^2 is the pressure gradient on the
/// volume, which the drag of model A does not contain; the rest is eps times the factor above.
///
/// Source: M. A. van der Hoef, R. Beetstra, J. A. M. Kuipers, J. Fluid Mech. 528 (2005) 233; R.
///         Beetstra, M. A. van der Hoef, J. A. M. Kuipers, AIChE J. 53 (2007) 489, with erratum.
///         Recalled: the print was not read. The source of CFDEMcoupling-PFM (BeetstraDragPoly) has
///         the factor above; that of MFIX (drag_gs.f) has the factor of model B and, for model A,
///         only y.
/// Valid:  as the law; the fits were made for size ratios up to 4 (recalled).
/// Units:  SI.
/// Errors: InputError if `cubic` is negative or not finite. FollowedDrag and a PrescribedFlow,
/// which
///         has no cells, are refused at compile time.
/// Tests:  tests/coupling/polydisperse.cpp.
template <DragLaw Law>
struct Polydisperse {
  static constexpr bool needs_spin = false, needs_mean_diameter = true;

  Law law{};
  double cubic = 0;  // [-]

  double normalised(const InFluid& at, double Re) const {
    const double y = at.diameter / at.mean_diameter;
    return law.normalised(at.voidage, Re / y) * y * (1 + cubic * y * y);
  }
  void check() const {
    require(std::isfinite(cubic) && cubic >= 0, "Polydisperse.cubic = ", cubic,
            " must be 0 or positive; van der Hoef et al. have 0.064");
    if constexpr (requires { law.check(); }) law.check();
  }
};

template <class Law>
Polydisperse(Law) -> Polydisperse<Law>;
template <class Law>
Polydisperse(Law, double) -> Polydisperse<Law>;

}  // namespace silt
