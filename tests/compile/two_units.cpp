// silt - BSD-3-Clause, see LICENSE
// Two translation units of one program are compiled for different instruction sets: each must run
// its own kernels, and both must find the same physics.
#include <doctest/doctest.h>

#include <cmath>

#include "unit.hpp"

TEST_CASE(
    "two_units: units with other instruction sets live in one program, each with its own types") {
#if defined(__GNUC__) && defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) {
    MESSAGE("skipped: this processor has no AVX2");
    return;
  }
#endif
  const UnitResult plain = plain_unit(), avx2 = avx2_unit();
  CHECK(plain.lanes == 2);
  CHECK(avx2.lanes == 4);
  // One name for two layouts of code is undefined: the linker would keep either.
  CHECK(plain.simulation != avx2.simulation);
  // Fused multiply-adds round otherwise, 1e-16 of a force; collisions make at most 1e-6 of it here.
  double most = 0, moved = 0;  // [m]
  for (std::size_t k = 0; k < plain.positions.size(); ++k) {
    most = std::max(most, std::abs(plain.positions[k] - avx2.positions[k]));
    moved = std::max(moved, std::abs(plain.positions[k]));
  }
  CHECK(moved > 1e-3);
  CHECK(most < 1e-12);
  CHECK(plain_unit().positions == plain.positions);
}
