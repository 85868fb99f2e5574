// silt - BSD-3-Clause, see LICENSE
// Which levels HashedGrid sorts spheres into.
#include <search/support.hpp>

namespace levels_test {

using namespace search_test;

namespace {

/// `count` spheres of each radius, in a bed of that many.
Rows of_radii(std::initializer_list<std::pair<std::size_t, double>> kinds) {
  Random random(1);
  Rows rows;
  for (const auto& [count, r] : kinds) {
    const auto more = random_rows(count, unit, r, r, random);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  return rows;
}

std::vector<double> cutoffs(const silt::Levels& levels, const Rows& rows, double reach) {
  silt::HashedGrid grid(levels);
  found_by(grid, rows, reach, OpenDomain{});
  return grid.cutoffs();
}

}  // namespace

TEST_CASE("levels: spheres of one size, or nearly so, lie in one grid") {
  CHECK(cutoffs({}, of_radii({{500, 0.05}}), 0.01) == std::vector{2 * 0.05 + 0.01});
  CHECK(cutoffs({}, of_radii({{500, 0.05}, {500, 0.04}}), 0.01).size() == 1);
  CHECK(cutoffs({}, {}, 0.01).size() == 1);
}

TEST_CASE("levels: two sizes far apart lie in two grids with cells that fit each") {
  CHECK(cutoffs({}, of_radii({{200, 0.05}, {5000, 0.005}}), 0.001) ==
        std::vector{2 * 0.05 + 0.001, 2 * 0.005 + 0.001});
  // Three sizes that take up as much space each; and so few of the middle one that they do not pay.
  using silt::detail::cheapest_levels;
  CHECK(cheapest_levels({{20000000, 0.001}, {20000, 0.01}, {20, 0.1}}, 0, 16) ==
        std::vector{0.1, 0.01, 0.001});
  CHECK(cheapest_levels({{20000000, 0.001}, {20000, 0.01}, {20, 0.1}}, 0, 2).size() == 2);
  CHECK(cheapest_levels({{20000000, 0.001}, {2, 0.01}, {20, 0.1}}, 0, 16) ==
        std::vector{0.1, 0.001});
  CHECK(cutoffs(silt::one_level, of_radii({{200, 0.05}, {5000, 0.005}}), 0.001).size() == 1);
}

TEST_CASE("levels: a given ratio makes the cells, down to the smallest sphere or the last level") {
  const auto rows = of_radii({{5, 0.5}, {5, 0.1}, {50, 0.01}});
  CHECK(cutoffs(silt::sub_grid(0.2), rows, 0) == std::vector{1.0, 0.2});
  CHECK(cutoffs(silt::sub_grid(1), rows, 0) == std::vector{1.0});
  CHECK(cutoffs(silt::sub_grid(0.01), rows, 0) == std::vector{1.0});  // no sphere is so small
  const auto halves = cutoffs({.ratio = 0.5, .most = 16}, rows, 0);
  REQUIRE(halves.size() == 6);
  for (std::size_t k = 0; k < halves.size(); ++k) CHECK(halves[k] == std::ldexp(1.0, -int(k)));
}

TEST_CASE("levels: as many sizes as there may be levels, and more, still give the pairs") {
  Random random(2);
  const auto rows = random_rows(1500, unit, 1e-6, 0.2, random, true);
  silt::BruteForce oracle;
  const auto expected = sorted(found_by(oracle, rows, 0, OpenDomain{}));
  CHECK(expected.size() > 1000);
  for (const std::size_t most : {1, 2, 3, 64})
    for (const auto& ratio : {std::optional<double>{}, std::optional{0.9}, std::optional{0.01}}) {
      silt::HashedGrid grid(silt::Levels{ratio, most});
      CHECK(sorted(found_by(grid, rows, 0, OpenDomain{})) == expected);
      CHECK(grid.cutoffs().size() <= most);
    }
}

TEST_CASE("levels: a ratio or number that cannot be is refused with a sentence") {
  const auto refusal = [](const silt::Levels& levels) -> std::string {
    try {
      silt::HashedGrid grid(levels);
    } catch (const silt::InputError& error) {
      return error.what();
    }
    return {};
  };
  for (const double ratio : {0.0, -0.2, 1.5, double{NAN}})
    CHECK(refusal(silt::sub_grid(ratio)).find("[-] must be in (0, 1]") != std::string::npos);
  for (const std::size_t most : {0, 65})
    CHECK(refusal({.ratio = {}, .most = most}).find("must be in [1, 64]") != std::string::npos);
  CHECK(refusal({}).empty());
}

}  // namespace levels_test
