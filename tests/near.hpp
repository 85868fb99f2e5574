// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>

#include <cmath>

/// doctest's Approx, compared by the value alone: by itself it allows epsilon times 1 + |value|, so
/// that no mass, energy or overlap of a grain in SI units fails, however wrong.
inline doctest::Approx near(double value) { return doctest::Approx(value).scale(0); }

/// |a/b - 1| <= tolerance.
inline bool near_relative(double a, double b, double tolerance) {
  return std::abs(a - b) <= tolerance * std::abs(b);
}
