// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// k-epsilon turbulence model: energy k [m2/s2] and dissipation rate epsilon [m2/s3]:
///
///   d(m k)/dt + div(F k) = div(m (nu + nu_t/sigma_k) grad k) + m (P - epsilon)                 (1)
///   d(m epsilon)/dt + div(F epsilon) = div(m (nu + nu_t/sigma_epsilon) grad epsilon)
///                                      + m (C1 P - C2 epsilon) epsilon/k                       (2)
///   nu_t = C_mu k^2/epsilon,  P = nu_t |S|^2,  |S| = sqrt(2 S:S)                               (3)
///
/// with the fluid's share of space m and its fluxes F as in the momentum equations (FlowSolver).
/// Particles do not change the turbulence.
///
/// Walls: their shear is that of WallLaw at the true distance, as for MixingLength. In cells at
/// walls k follows (1), without flux to the wall, and
///
///   P = u*^4/nu g (1 - g),  g = du+/dy+ of WallLaw;  epsilon = C_mu^(3/4) k^(3/2)/(kappa y) (4)
///
/// where k = u*^2/sqrt(C_mu) is the equilibrium in the logarithmic layer. Inflow: k = 3/2
/// (intensity U)^2, epsilon = C_mu^(3/4) k^(3/2)/length, with U the mean velocity of the side,
/// weighted with itself. Outflow: zero gradient. Initial values that are not set are computed in
/// the same way with the largest velocity.
///
/// Source: B. E. Launder, D. B. Spalding, Comput. Methods Appl. Mech. Eng. 3 (1974) 269: equations,
///         constants, wall cells. silt's own: g, which allows first cells in the viscous layer;
///         eddies of mu_t no longer than `width`; no work of div u in P. Inflow length of 0.07
///         widths: fully developed pipes, common practice (H. K. Versteeg, W. Malalasekera, An
///         Introduction to Computational Fluid Dynamics, 2nd ed., 2007, ch. 3).
/// Numerics: upwind with minmod slopes, then diffusion, then sources with implicit sinks (S. V.
///           Patankar, Numerical Heat Transfer and Fluid Flow, 1980, ch. 7.2): k and epsilon stay
///           above 0 for any inflow. First order in time; an equilibrium does not depend on the
///           step.
/// Valid:  Re high enough for a logarithmic layer; overpredicts k at stagnation points. kappa of
///         its constants is 0.43, that of WallLaw 0.4.
/// Tests:  tests/fluid/k_epsilon.cpp
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
struct KEpsilon {
  double width = 0;         // [m] diameter of the pipe, distance of the plates
  double intensity = 0.05;  // [-] of inflow: root of 2/3 k over the mean velocity
  double length = 0;        // [m] of its eddies; 0: 0.07 width
  double C_mu = 0.09, C1 = 1.44, C2 = 1.92, sigma_k = 1, sigma_epsilon = 1.3;

  void check() const {
    require_positive("KEpsilon.width", width, "m");
    require(std::isfinite(length) && length >= 0, "KEpsilon.length = ", length,
            " m must be positive, or 0 for 0.07 width");
    require(intensity > 0 && intensity <= 1, "KEpsilon.intensity = ", intensity,
            " must be in (0, 1]; pipes have some 0.05");
    require_positive("KEpsilon.C_mu", C_mu, "-");
    require(std::isfinite(C1) && C1 > 1 && std::isfinite(C2) && C2 > C1, "KEpsilon.C1 = ", C1,
            " must be above 1, and C2 = ", C2, " above C1");
    require(sigma_k >= 1 && sigma_epsilon >= 1 && std::isfinite(sigma_k * sigma_epsilon),
            "KEpsilon.sigma_k = ", sigma_k, " and sigma_epsilon = ", sigma_epsilon,
            " must be at least 1: steps are stable for these");
  }
  double energy(double velocity) const { return 1.5 * std::pow(intensity * velocity, 2); }
  double dissipation(double k, double of) const {  // `of`: length [m]
    return std::pow(C_mu, 0.75) * k * std::sqrt(k) / of;
  }
  double inflow_length() const { return length > 0 ? length : 0.07 * width; }
  /// Initial k [m2/s2]; for a fluid at rest: eddy viscosity equal to viscosity, which shear can
  /// amplify.
  double start_energy(double velocity, double nu) const {
    const double still = nu / (std::pow(C_mu, 0.25) * inflow_length());
    return std::fmax(energy(velocity), still * still);
  }
  /// nu_t [m2/s].
  double eddy(double k, double epsilon) const {
    return std::fmin(C_mu * k * k / epsilon, std::pow(C_mu, 0.25) * std::sqrt(k) * width);
  }
};

}  // namespace silt
