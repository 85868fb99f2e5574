// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/lanes.hpp>

namespace silt::inline SILT_TARGET {

/// Rarely used functions, built from + - * / and sqrt: one text for doubles and packs, on every
/// instruction set. (Those of xsimd 8 do not compile for AVX-512 without optimisation. The names
/// differ from xsimd's, which would be found first.) Errors of double below; of float some 1e-7.
/// Tests: tests/core/functions.cpp.

/// Cube root of x in [1e-24, 1e24], relative error 1e-15; 0 of 0 and below.
/// x^(1/4) x^(1/16) x^(1/64) has the relative error x^(-1/192); Halley's method cubes the error
/// three times.
template <class Real>
inline Real cube_root(const Real& x) {
  const Real a = max(x, smallest<Real>());
  Real part = sqrt(sqrt(a)), root = part;
  for (int k = 0; k < 2; ++k) part = sqrt(sqrt(part)), root = root * part;
  for (int k = 0; k < 3; ++k) {
    const Real cube = root * root * root;
    root = root * (cube + Real(2) * a) / (Real(2) * cube + a);
  }
  return select(x > Real(0), root, Real(0));
}

/// Cosine of x in [-pi, pi], absolute error 1e-15: Taylor's series of x/4, doubled twice.
template <class Real>
inline Real cosine(const Real& x) {
  const Real x2 = Real(1.0 / 16) * x * x;
  Real sum(1);
  for (int n = 16; n > 0; n -= 2) sum = Real(1) - sum * x2 * Real(1.0 / (n * (n - 1)));
  for (int k = 0; k < 2; ++k) sum = Real(2) * sum * sum - Real(1);
  return sum;
}

/// tanh of x, relative error 1e-15: Lambert's continued fraction of x/32, doubled five times.
template <class Real>
inline Real hyperbolic_tangent(const Real& x) {
  const Real y = Real(1.0 / 32) * max(min(x, Real(20)), Real(-20)), y2 = y * y;
  Real below(15);
  for (int n = 13; n > 0; n -= 2) below = Real(n) + y2 / below;
  Real t = y / below;
  for (int k = 0; k < 5; ++k) t = Real(2) * t / (Real(1) + t * t);
  return t;
}

/// atan of x in (-pi/2, pi/2), relative error 1e-15: halved three times, then its series.
template <class Real>
inline Real arc_tangent(const Real& x) {
  Real t = max(min(x, Real(1e18)), Real(-1e18));  // no overflow of squares, also for float
  for (int k = 0; k < 3; ++k) t = t / (Real(1) + sqrt(Real(1) + t * t));  // |t| < 0.199
  const Real t2 = t * t;
  Real sum(0);
  for (int n = 23; n > 0; n -= 2) sum = Real(ScalarOf<Real>(1.0 / n)) - sum * t2;
  return Real(8) * t * sum;
}

}  // namespace silt
