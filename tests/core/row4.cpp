// silt - BSD-3-Clause, see LICENSE
#include <silt/core/row4.hpp>

#include <doctest/doctest.h>

namespace row4_test {

namespace {

/// Numbers every element of W rows, turns them into columns and back.
template <class Arch, class Scalar>
void check_turns() {
  constexpr std::size_t W = silt::Lanes<Arch, Scalar>::width;
  using Real = typename silt::Lanes<Arch, Scalar>::Real;
  using Row = silt::Row4<Arch, Scalar>;
  CAPTURE(W);
  Row rows[W];
  for (std::size_t lane = 0; lane < W; ++lane) {
    const Scalar first = 10 * static_cast<Scalar>(lane);
    rows[lane] = Row::of(first, first + 1, first + 2, first + 3);
  }
  Real columns[4];
  silt::rows_to_columns<Arch>(rows, columns);
  for (std::size_t c = 0; c < 4; ++c) {
    alignas(64) Scalar lanes[W];
    silt::store(lanes, columns[c]);
    for (std::size_t lane = 0; lane < W; ++lane)
      CHECK(lanes[lane] == static_cast<Scalar>(10 * lane + c));
  }
  Row back[W];
  silt::columns_to_rows<Arch>(columns, back);
  for (std::size_t lane = 0; lane < W; ++lane) {
    alignas(64) Scalar element[4];
    back[lane].store(element);
    for (std::size_t c = 0; c < 4; ++c) CHECK(element[c] == static_cast<Scalar>(10 * lane + c));
  }
}
template <class Arch>
void check_turns() {
  check_turns<Arch, double>(), check_turns<Arch, float>();
}

template <class Arch>
void check_arithmetic() {
  using Row = silt::Row4<Arch>;
  alignas(64) double out[4];
  (Row::of(1, 2, 3, 4) * Row::all(3) + Row::of(5, 6, 7, 8) - Row::of(8, 12, 16, 20)).store(out);
  for (const double x : out) CHECK(x == 0);
}

}  // namespace

TEST_CASE("row4: rows turn into columns and back on every width that this build has") {
  check_turns<silt::OneLane>();
  check_turns<silt::DefaultArch>();
#if defined(__SSE2__)
  check_turns<xsimd::sse2>();
#endif
#if defined(__AVX__)
  check_turns<xsimd::avx>();
#endif
}

TEST_CASE("row4: arithmetic goes element by element") {
  check_arithmetic<silt::OneLane>();
  check_arithmetic<silt::DefaultArch>();
}

}  // namespace row4_test
