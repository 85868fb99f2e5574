// silt - BSD-3-Clause, see LICENSE
// The choice between searches: what it reports, when it is made anew, and that it changes no
// result.
#include <search/support.hpp>

#include <chrono>
#include <thread>

#include <silt/search/fastest_of.hpp>

namespace fastest_of_test {

using namespace search_test;

namespace {

/// Finds what CellGrid finds, some time later.
struct Slow {
  int searches = 0;
  std::size_t largest = 0;  // spheres
  template <class Domain>
  void find(const silt::SphereSet& spheres, double reach, const Domain& domain,
            const silt::Team& team, Found& pairs) {
    ++searches, largest = std::max(largest, spheres.rows.size());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    silt::CellGrid().find(spheres, reach, domain, team, pairs);
  }
};

Pairs as_list(const Found& found) {
  Pairs pairs;
  for (const auto& [a, b] : found) pairs.emplace_back(a, b);
  return pairs;
}

}  // namespace

TEST_CASE("fastest_of: it goes on with the fastest and says so") {
  Random random(1);
  silt::FastestOf<Slow, silt::CellGrid> search;
  CHECK(search.report() == "no search has been tried yet");
  const auto rows = random_rows(5000, unit, 0.02, 0.02, random);
  found_by(search, rows, 0, OpenDomain{});
  CHECK(search.chosen() == "CellGrid");
  CHECK(search.choice().finder == 1);
  CHECK(search.choice().spheres == 5000);
  REQUIRE(search.trials().size() == 2);
  CHECK(search.trials()[0].name == "Slow");
  CHECK(search.trials()[0].given_up);  // on the first sample
  CHECK(search.trials()[0].spheres == 1000);
  CHECK(search.trials()[0].time >= 0.02);
  CHECK_FALSE(search.trials()[1].given_up);
  CHECK(search.trials()[1].spheres == 5000);
  CHECK(search.report().starts_with("CellGrid for 5000 spheres: Slow 2"));
  CHECK(search.report().find("(given up at 1000)") != std::string::npos);
}

TEST_CASE("fastest_of: it tries anew when spheres have become twice or half as many") {
  Random random(2);
  silt::FastestOf<silt::CellGrid, silt::Nbs> search;
  const auto tried_at = [&](std::size_t n) {
    found_by(search, random_rows(n, unit, 0.02, 0.02, random), 0, OpenDomain{});
    return search.choice().spheres;
  };
  CHECK(tried_at(100) == 100);
  CHECK(tried_at(199) == 100);
  CHECK(tried_at(200) == 200);
  CHECK(tried_at(101) == 200);
  CHECK(tried_at(100) == 100);
  CHECK(tried_at(0) == 1);
  CHECK(tried_at(1) == 1);
  CHECK(tried_at(5) == 5);
}

TEST_CASE("fastest_of: the list, its order included, does not depend on the choice") {
  Random random(3);
  const PeriodicBox domain{unit, {true, false, true}};
  for (const bool by_octave : {false, true}) {
    const auto rows = random_rows(3000, unit, 0.003, 0.03, random, by_octave);
    silt::AutoSearch search;
    const auto expected = as_list(found_by(search, rows, 0.002, domain));
    CHECK(std::is_sorted(expected.begin(), expected.end()));
    silt::BruteForce oracle;
    CHECK(expected == sorted(found_by(oracle, rows, 0.002, domain)));
    std::vector<std::uint32_t> order, other;
    search.order({rows, 0.03}, 0.002, domain, 1, order);
    for (std::uint64_t finder = 0; finder < 4; ++finder) {
      search.keep({finder, rows.size()});  // no trial then
      CHECK(as_list(found_by(search, rows, 0.002, domain, 2)) == expected);
      CHECK(search.choice().finder == finder);
      search.order({rows, 0.03}, 0.002, domain, 2, other);
      CHECK(other == order);
    }
  }
}

TEST_CASE("fastest_of: a search that does not suit the spheres is given up on a small sample") {
  // One level for 1:50: a cell of the coarsest holds thousands of fines.
  Random random(4);
  auto rows = random_rows(60000, unit, 0.002, 0.002, random);
  rows.push_back({0.5, 0.5, 0.5, 0.1});
  silt::FastestOf<silt::HashedGrid, OneLevel> search;
  found_by(search, rows, 0, OpenDomain{});
  CHECK(search.chosen() == "HashedGrid");
  CHECK(search.trials()[1].given_up);
  CHECK(search.trials()[1].spheres < 60000);
}

TEST_CASE("fastest_of: a choice that there is not is refused") {
  silt::FastestOf<silt::CellGrid, silt::Nbs> search;
  CHECK_THROWS_AS(search.keep({2, 10}), silt::InputError);
}

}  // namespace fastest_of_test
