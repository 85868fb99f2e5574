// silt - BSD-3-Clause, see LICENSE
// Two translation units of one program are compiled for different instruction sets: each must run
// its own kernels, and both must find the same physics.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <typeinfo>

#include <silt/core/error.hpp>

#include "unit.hpp"

namespace {

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

}  // namespace

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
  CHECK(largest_difference(plain.positions, std::vector<double>(3 * 27, 0)) > 1e-3);
  CHECK(largest_difference(plain.positions, avx2.positions) < 1e-12);
#ifdef SILT_LONG_TESTS
  // In float 1e-7 of a force, of which 2e-11 m are left.
  CHECK(largest_difference(plain.mixed, avx2.mixed) < 1e-9);
  CHECK(largest_difference(plain.mixed, plain.positions) < 1e-9);
  CHECK(plain.mixed != plain.positions);
#endif
  CHECK(plain_unit().positions == plain.positions);
}

TEST_CASE("two_units: an error of any unit has a plain name, and is caught by the others") {
  const auto name = [](void (*fails)()) -> std::string {
    try {
      fails();
    } catch (const silt::SimulationError& error) {
      CHECK(error.particles.size() == 2);
      CHECK(std::abs(error.position.z) < 2e-3);
      return typeid(error).name();
    }
    return {};
  };
  // A program that catches nothing shows it as silt::SimulationError.
  CHECK(name(plain_unit_fails) == "N4silt15SimulationErrorE");
#if defined(__GNUC__) && defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return;
#endif
  CHECK(name(avx2_unit_fails) == "N4silt15SimulationErrorE");
}
