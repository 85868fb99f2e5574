// silt - BSD-3-Clause, see LICENSE
#include <cstdint>
#include <set>
#include <vector>

#include <doctest/doctest.h>

#include <silt/core/storage.hpp>

namespace storage_test {

using Rows = silt::AlignedVector<double>;

std::uintptr_t place(const Rows& rows) { return reinterpret_cast<std::uintptr_t>(rows.data()); }

TEST_CASE("arrays begin on cache lines and keep what they hold as they grow into huge pages") {
  // Catches an array of which another address is given back than was taken (it crashes, or a
  // sanitizer says so), and rows that straddle two lines.
  Rows rows;
  for (std::size_t n = 1000; n < 3000000; n *= 3) {
    rows.resize(n, static_cast<double>(n));
    CHECK(place(rows) % 64 == 0);
    CHECK(rows.front() == 1000);
    CHECK(rows.back() == static_cast<double>(n));
  }
  Rows copy = rows;
  rows = Rows();
  CHECK(copy.front() == 1000);
}

TEST_CASE("large arrays do not all begin at the same place of a page") {
  // Catches arrays that meet in the same sets of a cache: pages alone would put all at 0.
  std::vector<Rows> many(6);
  std::set<std::uintptr_t> places;
  for (auto& rows : many) {
    rows.resize(1 << 20);
    places.insert(place(rows) % 4096);
  }
  CHECK(places.size() == many.size());
}

}  // namespace storage_test
