// silt - BSD-3-Clause, see LICENSE
//
// Lanes of a mask as bits. Wrong result caught: those of a mask of floats read as of doubles.

#include <doctest/doctest.h>

#include <cstdint>

#include <silt/core/lanes.hpp>

namespace {
template <class T>
void check_bits() {
  using Real = xsimd::batch<T>;
  alignas(64) T values[Real::size];
  for (std::uint64_t bits = 0; bits < (std::uint64_t{1} << Real::size);
       bits += Real::size > 8 ? 37 : 1) {
    for (std::size_t k = 0; k < Real::size; ++k) values[k] = static_cast<T>((bits >> k) & 1);
    const auto mask = Real::load_aligned(values) > Real(0);
    REQUIRE(silt::lane_bits(mask) == bits);
  }
}
}  // namespace

TEST_CASE("lanes: the bits of a mask, of doubles and of floats") {
  check_bits<double>();
  check_bits<float>();
}
