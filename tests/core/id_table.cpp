// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <unordered_map>

#include <silt/core/id_table.hpp>
#include <silt/core/random.hpp>

namespace id_table_test {

namespace {

template <class Table>
void check_against_map(std::uint64_t spread) {
  silt::Random random(5);
  Table table;
  std::unordered_map<silt::ParticleId, std::uint32_t> map;
  const auto draw = [&] {
    return static_cast<silt::ParticleId>(random.uniform() * static_cast<double>(spread));
  };
  for (int round = 0; round < 3; ++round) {
    CHECK(table.find(7) == silt::no_place);
    for (std::uint32_t k = 0; k < 5000; ++k) {
      const auto id = draw();
      table.at(id) = k, map[id] = k;
    }
    std::size_t wrong = 0;
    for (const auto& [id, place] : map) wrong += table.find(id) != place;
    for (int k = 0; k < 5000; ++k) {
      const auto id = draw();
      const auto found = map.find(id);
      wrong += table.find(id) != (found == map.end() ? silt::no_place : found->second);
    }
    CHECK(wrong == 0);
    table.clear(), map.clear();
  }
}

TEST_CASE("id table: finds what was put in, and nothing else") {
  check_against_map<silt::detail::IdTable>(20000);
  for (const std::uint64_t spread : {20000u, 4000000000u})
    check_against_map<silt::detail::IdHash>(spread);
  check_against_map<silt::detail::IdHash>(std::uint64_t{1} << 60);
}

// A rank that has every 64th particle needs room for its own; the table of pages has it for all.
TEST_CASE("id table: bytes of ids that are few of many") {
  silt::detail::IdTable pages;
  silt::detail::IdHash hash;
  for (std::uint32_t k = 0; k < 100000; ++k) pages.at(64ull * k) = hash.at(64ull * k) = k;
  MESSAGE(pages.bytes() << " " << hash.bytes());
  CHECK(pages.bytes() > 25.6e6);
  CHECK(hash.bytes() < 32 * 100000);
  // Cleared it keeps its room, unless that is far too large.
  hash.clear();
  for (std::uint32_t k = 0; k < 1000; ++k) hash.at(k) = k;
  CHECK(hash.bytes() > 16 * 100000);
  hash.clear();
  for (std::uint32_t k = 0; k < 1000; ++k) hash.at(k) = k;
  CHECK(hash.bytes() < 32 * 1000);
}

}  // namespace

}  // namespace id_table_test
