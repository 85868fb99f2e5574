// silt - BSD-3-Clause, see LICENSE
#include <silt/engine/lists/pair_groups.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include <silt/core/random.hpp>

namespace pair_groups_test {

using silt::detail::PairGroups;

TEST_CASE("pair groups: no two groups of one phase have a particle in common") {
  for (const std::size_t n : {2u, 2047u, 2048u, 5000u, 40000u, 2000000u}) {
    CAPTURE(n);
    const PairGroups groups(n);
    silt::Random random(n);
    // The phase and group of each particle's pairs.
    std::vector<std::map<std::uint32_t, std::set<std::size_t>>> owners(groups.phases());
    std::set<std::size_t> used;
    for (int k = 0; k < 200000; ++k) {
      const auto a = static_cast<std::uint32_t>(random.index(n));
      // Near, far, and across the ends.
      const std::size_t reach = k % 3 == 0 ? n : std::max<std::size_t>(n / 20, 2);
      const auto b = static_cast<std::uint32_t>((a + 1 + random.index(reach)) % n);
      if (a == b) continue;
      const std::size_t g = groups.of(a, b);
      REQUIRE(g < groups.count());
      CHECK(g == groups.of(b, a));
      used.insert(g);
      for (std::size_t p = 0; p < groups.phases(); ++p) {
        const auto [from, to] = groups.phase(p);
        if (g >= from && g < to) owners[p][a].insert(g), owners[p][b].insert(g);
      }
    }
    std::size_t shared = 0;
    for (const auto& phase : owners)
      for (const auto& [particle, of] : phase) shared += of.size() != 1;
    CHECK(shared == 0);
    CHECK(used.size() == groups.count());  // every group has a use
  }
}

TEST_CASE("pair groups: likewise of pairs with ghosts, which come behind all others") {
  for (const auto& n : {std::pair{1u, 1u}, {500u, 70000u}, {40000u, 3000u}, {70000u, 900u}}) {
    const auto own = n.first, ghosts = n.second;
    CAPTURE(own);
    const PairGroups groups(own, ghosts);
    const PairGroups alone(own);
    CHECK(groups.own_phases() == alone.phases());
    silt::Random random(own);
    std::vector<std::map<std::uint32_t, std::set<std::size_t>>> owners(groups.phases());
    for (int k = 0; k < 100000; ++k) {
      const auto a = static_cast<std::uint32_t>(random.index(own)),
                 b = static_cast<std::uint32_t>(own + random.index(ghosts));
      const std::size_t g = groups.of(a, b);
      REQUIRE(g < groups.count());
      CHECK((g == groups.of(b, a) && g >= alone.count()));
      std::size_t in = 0;
      for (std::size_t p = groups.own_phases(); p < groups.phases(); ++p) {
        const auto [from, to] = groups.phase(p);
        if (g >= from && g < to) ++in, owners[p][a].insert(g), owners[p][b].insert(g);
      }
      CHECK(in == 1);
      const auto c = static_cast<std::uint32_t>(random.index(own));
      if (c != a) CHECK(groups.of(a, c) == alone.of(a, c));
    }
    std::size_t shared = 0;
    for (const auto& phase : owners)
      for (const auto& [particle, of] : phase) shared += of.size() != 1;
    CHECK(shared == 0);
  }
}

TEST_CASE("pair groups: pairs of neighbouring shares all lie in two phases") {
  const PairGroups groups(40000);
  const std::size_t shares = groups.phases();
  REQUIRE(shares == 8);
  for (std::uint32_t s = 0; s + 1 < shares; ++s) {
    const std::uint32_t seam = (s + 1) * 5000;
    const std::size_t g = groups.of(seam - 1, seam);
    const auto [from, to] = groups.phase(1 + s % 2);
    CHECK((g >= from && g < to));
  }
}

}  // namespace pair_groups_test
