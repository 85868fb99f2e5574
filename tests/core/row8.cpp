// silt - BSD-3-Clause, see LICENSE
#include <silt/core/row8.hpp>

#include <doctest/doctest.h>

namespace row8_test {

namespace {

/// Numbers every element of W rows of eight, turns them into columns and back.
template <class Arch, class Scalar>
void check_turns() {
  if constexpr (silt::has_row8<Arch, Scalar>) {
    constexpr std::size_t W = silt::Lanes<Arch, Scalar>::width;
    using Real = typename silt::Lanes<Arch, Scalar>::Real;
    using Row = silt::Row8<Arch, Scalar>;
    CAPTURE(W);
    Row rows[W];
    for (std::size_t lane = 0; lane < W; ++lane) {
      alignas(64) Scalar element[8];
      for (std::size_t c = 0; c < 8; ++c) element[c] = static_cast<Scalar>(10 * lane + c);
      rows[lane] = Row::load(element);
    }
    Real columns[2][4];
    silt::rows_to_columns<Arch>(rows, columns[0], columns[1]);
    for (std::size_t c = 0; c < 8; ++c) {
      alignas(64) Scalar lanes[W];
      silt::store(lanes, columns[c / 4][c % 4]);
      for (std::size_t lane = 0; lane < W; ++lane)
        CHECK(lanes[lane] == static_cast<Scalar>(10 * lane + c));
    }
    Row back[W];
    silt::columns_to_rows<Arch, Scalar>(columns[0], columns[1], back);
    for (std::size_t lane = 0; lane < W; ++lane) {
      alignas(64) Scalar element[8];
      back[lane].store(element);
      for (std::size_t c = 0; c < 8; ++c) CHECK(element[c] == static_cast<Scalar>(10 * lane + c));
    }
  }
}

template <class Arch, class Scalar>
void check_arithmetic() {
  if constexpr (silt::has_row8<Arch, Scalar>) {
    using Row = silt::Row8<Arch, Scalar>;
    alignas(64) Scalar out[8];
    (Row::of(1, 2, 3, 4) * Row::of(2, 3, 4, 5) + Row::of(-2, -6, -12, -20)).store(out);
    for (const Scalar x : out) CHECK(x == 0);
  }
}

}  // namespace

TEST_CASE("row8: rows turn into columns and back on every width that this build has") {
  check_turns<silt::DefaultArch, double>();
  check_turns<silt::DefaultArch, float>();
#if defined(__AVX__)
  check_turns<xsimd::avx, float>();
  static_assert(silt::has_row8<xsimd::avx, float>);
#endif
}

TEST_CASE("row8: arithmetic goes element by element") {
  check_arithmetic<silt::DefaultArch, double>();
  check_arithmetic<silt::DefaultArch, float>();
}

}  // namespace row8_test
