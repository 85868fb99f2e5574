// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <numbers>

#include <silt/core/error.hpp>
#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET {

/// Axes of the policies of an Sph; each policy has its axis as `static constexpr SphAxis sph_axis`.
enum class SphAxis { Kernel, Viscosity, Diffusion, Shifting, Time, Walls, Grains, Volume };

/// SPH kernel, the weight of the neighbours of a particle: W(r) = a w(q), q = r/h, 0 for q >= 2.
///
///   static double normalisation(int dimensions, double h)   a [1/m2 or 1/m3]
///   static Real weight(Real q)                               w [-]
///   static Real slope(Real q)                                w'(q)/q [-], finite at q = 0
///
/// where grad W = a/h^2 slope(q) r. slope() is 0 for q >= 2, without a branch.
/// Tests: tests/sph/kernels.cpp.
/// Valid:  2D and 3D.
/// Units:  q and w [-], h [m].
/// Errors: InputError for numbers of dimensions other than 2 and 3.
template <class K>
concept SphKernel = requires(double q) {
  { K::normalisation(3, q) } -> std::same_as<double>;
  { K::weight(q) } -> std::same_as<double>;
  { K::slope(q) } -> std::same_as<double>;
  requires K::sph_axis == SphAxis::Kernel;
};

namespace detail {
inline void check_dimensions(int dimensions) {
  require(dimensions == 2 || dimensions == 3, "SPH: ", dimensions,
          " dimensions; it must be 2 or 3");
}
/// [-] int r^2 W dV over h^2, by Simpson's rule: 5/9 in 2D and 4/5 in 3D for WendlandC2.
template <class Kernel>
double sph_second_moment(int dimensions) {
  constexpr int n = 400;
  double sum = 0;
  for (int k = 1; k < n; ++k) {
    const double q = 2.0 * k / n, around = dimensions == 2 ? q : 2 * q * q;
    sum += (k % 2 ? 4 : 2) * around * q * q * Kernel::weight(q);
  }
  return Kernel::normalisation(dimensions, 1.0) * 2 * std::numbers::pi * sum * 2 / (3 * n);
}
}  // namespace detail

/// Wendland C2 kernel, w = (1 - q/2)^4 (1 + 2 q). No pairing of particles for any number of
/// neighbours.
/// Source: H. Wendland, Adv. Comput. Math. 4 (1995) 389, C2.
struct WendlandC2 {
  static constexpr SphAxis sph_axis = SphAxis::Kernel;
  static constexpr const char* policy_name = "WendlandC2";
  static double normalisation(int dimensions, double h) {
    detail::check_dimensions(dimensions);
    return dimensions == 2 ? 7 / (4 * std::numbers::pi * h * h)
                           : 21 / (16 * std::numbers::pi * h * h * h);
  }
  template <class Real>
  static SILT_INLINE Real weight(const Real& q) {
    const Real t = max(Real(1) - Real(0.5) * q, Real(0)), t2 = t * t;
    return t2 * t2 * (Real(1) + Real(2) * q);
  }
  template <class Real>
  static SILT_INLINE Real slope(const Real& q) {
    const Real t = max(Real(1) - Real(0.5) * q, Real(0));
    return Real(-5) * t * t * t;
  }
};

/// Cubic spline kernel, w = 1 - 3/2 q^2 + 3/4 q^3 for q <= 1, then (2 - q)^3/4.
/// Source: J. J. Monaghan, J. C. Lattanzio, Astron. Astrophys. 149 (1985) 135.
struct CubicSpline {
  static constexpr SphAxis sph_axis = SphAxis::Kernel;
  static constexpr const char* policy_name = "CubicSpline";
  static double normalisation(int dimensions, double h) {
    detail::check_dimensions(dimensions);
    return dimensions == 2 ? 10 / (7 * std::numbers::pi * h * h)
                           : 1 / (std::numbers::pi * h * h * h);
  }
  template <class Real>
  static SILT_INLINE Real weight(const Real& q) {
    const Real far = max(Real(2) - q, Real(0)), near = max(Real(1) - q, Real(0));
    return Real(0.25) * far * far * far - near * near * near;
  }
  template <class Real>
  static SILT_INLINE Real slope(const Real& q) {
    const Real far = max(Real(2) - q, Real(0));
    return select(q < Real(1), Real(2.25) * q - Real(3), Real(-0.75) * far * far / max(q, Real(1)));
  }
};

}  // namespace silt
