// silt - BSD-3-Clause, see LICENSE
// Every search against BruteForce, the oracle: all decide with the same comparison, so that the
// sets of pairs must be equal, without any tolerance.
#include <search/support.hpp>

namespace searches_test {

using namespace search_test;

#define SILT_SEARCHES \
  silt::CellGrid, silt::Nbs, silt::HashedGrid, OneLevel, SubGrid, Halves, silt::AutoSearch

TEST_CASE_TEMPLATE("searches: pairs equal brute force for random spheres, any reach, sizes to 1:20",
                   Search, SILT_SEARCHES) {
  Random random(1);
  for (const double ratio : {1.0, 2.0, 20.0})
    for (const double reach : {0.0, 0.01, 0.2, 3.0}) {
      CAPTURE(ratio);
      CAPTURE(reach);
      CHECK(compare<Search>(random_rows(600, unit, 0.06 / ratio, 0.06, random), reach) > 100);
    }
}

TEST_CASE_TEMPLATE("searches: pairs equal brute force for sizes to 1:1000, as many in every octave",
                   Search, SILT_SEARCHES) {
  Random random(9);
  for (const double ratio : {3.0, 10.0, 100.0, 1000.0})
    for (const double largest : {0.06, 0.3, 2.0})
      for (const double reach : {0.0, 0.003}) {
        CAPTURE(ratio);
        CAPTURE(largest);
        CAPTURE(reach);
        const auto rows = random_rows(500, unit, largest / ratio, largest, random, true);
        CHECK(compare<Search>(rows, reach) > 5);
      }
}

TEST_CASE_TEMPLATE("searches: a few large spheres among many fines, and one fine among large ones",
                   Search, SILT_SEARCHES) {
  Random random(10);
  for (const std::size_t large : {1, 5, 499}) {
    CAPTURE(large);
    auto rows = random_rows(500 - large, unit, 0.004, 0.005, random);
    const auto more = random_rows(large, unit, 0.1, 0.15, random);
    rows.insert(rows.begin() + 1, more.begin(), more.end());
    CHECK(compare<Search>(rows, 0.001) > 5);
  }
}

TEST_CASE_TEMPLATE("searches: pairs equal brute force for clusters in a nearly empty domain",
                   Search, SILT_SEARCHES) {
  Random random(2);
  Rows rows;
  for (int cluster = 0; cluster < 6; ++cluster) {
    const Vec3d c{random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-50, 50)};
    const auto near = random_rows(80, {c, c + Vec3d{0.05, 0.05, 0.05}}, 0.001, 0.01, random);
    rows.insert(rows.end(), near.begin(), near.end());
  }
  CHECK(compare<Search>(rows, 0.002) > 1000);
  // Two spheres at opposite ends and a pair in between: almost all cells are empty.
  CHECK(compare<Search>(
            {{-1e3, 0, 0, 0.01}, {1e3, 1e3, 1e3, 0.01}, {5, 5, 5, 0.01}, {5.01, 5, 5, 0.01}}, 0) ==
        1);
}

TEST_CASE_TEMPLATE("searches: centres on the edges of cells lose no pair and double none", Search,
                   SILT_SEARCHES) {
  // Lattices whose spacing is the cutoff to within rounding: centres fall on cell edges to either
  // side, and pairs are as far apart as one cell is wide.
  for (const double spacing : {0.1, 0.125, 1.0 / 3, 0.3})
    for (const double factor : {0.5, 0.999999, 1.0, 1.0 + 1e-15, 1.000001, 1.5})
      for (const bool fines : {false, true}) {
        CAPTURE(spacing);
        CAPTURE(factor);
        CAPTURE(fines);
        Rows rows;
        const double r = 0.4 * spacing * factor, reach = 0.2 * spacing * factor;  // cutoff: spacing
        for (int k = 0; k < 7; ++k)
          for (int j = 0; j < 7; ++j)
            for (int i = 0; i < 7; ++i) rows.push_back({i * spacing, j * spacing, k * spacing, r});
        for (int k = 0; fines && k < 7; ++k)  // as far from their neighbours as they reach
          for (int i = 0; i < 7; ++i)
            rows.push_back({i * spacing, 0.5 * r + r + reach, k * spacing, 0.1 * r});
        compare<Search>(rows, reach);
      }
  // Rows of spheres that touch to within rounding, one cell each.
  Random random(8);
  for (int trial = 0; trial < 500; ++trial) {
    const double spacing = random.uniform(0.01, 1), start = random.uniform(-3, 3);
    Rows rows;
    for (std::uint64_t k = 0, n = 3 + random.index(30); k < n; ++k)
      rows.push_back({start + static_cast<double>(k) * spacing, 0, 0, 0.5 * spacing});
    compare<Search>(rows, 0);
  }
}

TEST_CASE_TEMPLATE("searches: coincident centres, one cell, one sphere, points and none", Search,
                   SILT_SEARCHES) {
  Random random(3);
  CHECK(compare<Search>({}, 0.1) == 0);
  CHECK(compare<Search>({}, 0) == 0);
  CHECK(compare<Search>({}, 0, PeriodicBox{unit, {true, true, true}}) == 0);
  CHECK(compare<Search>({{1, 2, 3, 0.5}}, 0.1) == 0);
  CHECK(compare<Search>({{0.1, 0.2, 0.3, 0.5}}, 0.1, PeriodicBox{unit, {true, true, true}}) == 0);
  CHECK(compare<Search>(Rows(40, PositionRow{1, -2, 3, 0.5}), 0) == 40 * 39 / 2);
  CHECK(compare<Search>(random_rows(50, unit, 2, 2, random), 0) == 50 * 49 / 2);
  CHECK(compare<Search>(random_rows(50, unit, 0, 0, random), 0) == 0);
  CHECK(compare<Search>(random_rows(50, unit, 0, 0, random), 0.3) > 50);
  CHECK(compare<Search>(random_rows(50, unit, 0, 0.2, random, false), 0) > 5);
  Rows line;  // no extent in two directions
  for (int k = 0; k < 50; ++k) line.push_back({0.1 * k, 7, -7, 0.06});
  CHECK(compare<Search>(line, 0) == 49);
  Rows sheet;  // none in one
  for (int k = 0; k < 400; ++k) sheet.push_back({7, 0.1 * (k % 20), 0.1 * (k / 20), 0.051});
  CHECK(compare<Search>(sheet, 0) == 2 * 20 * 19);
}

TEST_CASE_TEMPLATE("searches: coordinates of up to 1e8 m change no pair set", Search,
                   SILT_SEARCHES) {
  Random random(4);
  for (const Vec3d offset : {Vec3d{1e6, -1e6, 1e6}, Vec3d{-1e6, 0, 3e6}, Vec3d{1e8, 1e8, -1e8}}) {
    const Box box{offset, offset + Vec3d{1, 1, 1}};
    CHECK(compare<Search>(random_rows(500, box, 0.01, 0.06, random), 0.01) > 100);
    CHECK(compare<Search>(random_rows(500, box, 0.002, 0.2, random, true), 0) > 100);
    // Touching to within what rounding leaves of a coordinate, 1.5e-8 m at 1e8 m.
    Rows line;
    for (int k = 0; k < 100; ++k)
      line.push_back({offset.x + 0.1 * k, offset.y, offset.z, 0.05 + random.uniform(-2e-8, 2e-8)});
    compare<Search>(line, 0);
  }
  // Two heaps 2e8 m apart.
  auto rows = random_rows(200, {{-1e8, 0, 0}, {-1e8 + 1, 1, 1}}, 0.03, 0.06, random);
  const auto more = random_rows(200, {{1e8, 0, 0}, {1e8 + 1, 1, 1}}, 0.03, 0.06, random);
  rows.insert(rows.end(), more.begin(), more.end());
  CHECK(compare<Search>(rows, 0.01) > 100);
}

TEST_CASE_TEMPLATE("searches: pairs equal brute force in boxes that repeat in any directions",
                   Search, SILT_SEARCHES) {
  Random random(5);
  for (int directions = 1; directions < 8; ++directions)
    // In cells of the cutoff 0.2 m the box is 1, 2, 3, 4 and 9 cells wide.
    for (const double length : {0.39, 0.41, 0.61, 0.85, 1.81})
      for (const double smallest : {0.02, 0.002}) {
        CAPTURE(directions);
        CAPTURE(length);
        CAPTURE(smallest);
        const PeriodicBox domain{
            {{-0.3, 0.2, 1}, {-0.3 + length, 0.2 + length, 1 + length}},
            {(directions & 1) != 0, (directions & 2) != 0, (directions & 4) != 0}};
        auto rows = random_rows(length < 0.7 ? 60 : 400, domain.box(), smallest, 0.065, random,
                                smallest < 0.01);
        // Some exactly on the faces, and one in the middle of two opposite ones each.
        for (int d = 0; d < 3; ++d)
          for (int side = 0; side < 2; ++side) {
            double p[3] = {random.uniform(-0.3, -0.3 + length), random.uniform(0.2, 0.2 + length),
                           random.uniform(1, 1 + length)};
            p[d] = d == 0 ? domain.box().min.x : d == 1 ? domain.box().min.y : domain.box().min.z;
            p[d] += side * length * (1 - 1e-16);
            rows.push_back({p[0], p[1], p[2], 0.06});
          }
        CHECK(compare<Search>(rows, smallest < 0.01 ? 0.02 : 0.07, domain) > 5);
      }
}

TEST_CASE_TEMPLATE("searches: a repeating box joins what lies across its faces", Search,
                   SILT_SEARCHES) {
  const PeriodicBox domain{unit, {true, false, true}};
  CHECK(compare<Search>(Rows{{0.01, 0.5, 0.5, 0.02}, {0.98, 0.5, 0.5, 0.02}}, 0, domain) == 1);
  CHECK(compare<Search>(Rows{{0.5, 0.01, 0.5, 0.02}, {0.5, 0.98, 0.5, 0.02}}, 0, domain) == 0);
  CHECK(compare<Search>(Rows{{0.01, 0.5, 0.99, 0.02}, {0.99, 0.5, 0.01, 0.02}}, 0, domain) == 1);
  CHECK(compare<Search>(Rows{{0.01, 0.5, 0.99, 0.002}, {0.9, 0.5, 0.95, 0.12}}, 0, domain) == 1);
}

TEST_CASE_TEMPLATE("searches: the list, its order included, does not depend on threads", Search,
                   SILT_SEARCHES) {
  Random random(6);
  const PeriodicBox domain{unit, {true, true, true}};
  const auto as_list = [](const Found& found) {
    Pairs pairs;
    for (const auto& [a, b] : found) pairs.emplace_back(a, b);
    return pairs;
  };
  for (const bool by_octave : {false, true}) {
    const auto rows = random_rows(6000, unit, by_octave ? 0.0005 : 0.005, 0.03, random, by_octave);
    Search search;
    const auto one = as_list(found_by(search, rows, 0.01, domain, 1));
    CHECK(one.size() > 1500);
    for (const int threads : {2, 3, 7}) {
      CAPTURE(threads);
      CHECK(as_list(found_by(search, rows, 0.01, domain, threads)) == one);
    }
  }
}

TEST_CASE_TEMPLATE("searches: a sphere that is not finite is refused with a sentence that names it",
                   Search, SILT_SEARCHES, silt::BruteForce) {
  Random random(11);
  const auto good = random_rows(700, unit, 0.01, 0.05, random);
  Search search;
  for (const double bad : {double{NAN}, double{INFINITY}, -double{INFINITY}})
    for (const std::size_t which : {0, 350, 699})
      for (const int field : {0, 1, 2, 3}) {
        CAPTURE(bad);
        CAPTURE(which);
        CAPTURE(field);
        auto rows = good;
        (&rows[which].x)[field] = bad;
        std::string sentence;
        try {
          Found found;
          search.find({rows, 0.05}, 0.01, OpenDomain{}, silt::Team(2), found);
        } catch (const silt::InputError& error) {
          sentence = error.what();
        }
        CHECK(sentence.find("sphere " + std::to_string(which) + " at (") != std::string::npos);
        CHECK(sentence.find("no finite position or size") != std::string::npos);
      }
  // It can be used again.
  silt::BruteForce oracle;
  CHECK(sorted(found_by(search, good, 0, OpenDomain{})) ==
        sorted(found_by(oracle, good, 0, OpenDomain{})));
}

TEST_CASE_TEMPLATE("searches: order() names every sphere once, neighbours side by side", Search,
                   silt::CellGrid, silt::Nbs, silt::HashedGrid, silt::AutoSearch) {
  Random random(7);
  const auto rows = random_rows(2000, unit, 0.03, 0.03, random);
  Search search;
  std::vector<std::uint32_t> order;
  search.order({rows, 0.03}, 0.0, OpenDomain{}, silt::Team(2), order);
  auto names = order;
  std::sort(names.begin(), names.end());
  REQUIRE(names.size() == rows.size());
  for (std::uint32_t k = 0; k < names.size(); ++k) CHECK(names[k] == k);
  // In random order neighbours are 0.66 m apart in the mean. Here most share a row of cells of 0.06
  // m, eight or sixteen to a row, and only the step from row to row is long.
  double sum = 0;  // [m]
  for (std::size_t k = 1; k < order.size(); ++k)
    sum += norm(rows[order[k]].centre() - rows[order[k - 1]].centre());
  CHECK(sum / static_cast<double>(order.size()) < 0.40);
}

TEST_CASE("searches: a copy of a search works apart from it") {
  Random random(9);
  const auto rows = random_rows(300, unit, 0.05, 0.05, random);
  silt::CellGrid grid;
  const auto expected = sorted(found_by(grid, rows, 0, OpenDomain{}));
  REQUIRE(expected.size() > 20);
  silt::CellGrid copy = grid;
  CHECK(sorted(found_by(copy, rows, 0, OpenDomain{})) == expected);
  CHECK(sorted(found_by(grid, rows, 0, OpenDomain{})) == expected);
  copy = grid;
  CHECK(sorted(found_by(copy, rows, 0, OpenDomain{})) == expected);
}

}  // namespace searches_test
