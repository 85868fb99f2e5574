// silt - BSD-3-Clause, see LICENSE
#include <silt/engine/pair_groups.hpp>

#include <doctest/doctest.h>

#include <map>
#include <set>

#include <silt/core/random.hpp>

using silt::detail::PairGroups;

TEST_CASE("pair groups: no two groups of one phase have a particle in common") {
  for (const std::size_t n : {2u, 2047u, 2048u, 5000u, 40000u}) {
    CAPTURE(n);
    const PairGroups groups(n);
    silt::Random random(n);
    std::map<int, std::map<std::uint32_t, std::set<std::size_t>>> owners;  // by phase and particle
    std::size_t in_rest = 0;
    for (int k = 0; k < 200000; ++k) {
      const auto a = static_cast<std::uint32_t>(random.index(n));
      // Near, far, and across the ends.
      const std::size_t reach = k % 3 == 0 ? n : std::max<std::size_t>(n / 20, 2);
      const auto b = static_cast<std::uint32_t>((a + 1 + random.index(reach)) % n);
      if (a == b) continue;
      const std::size_t g = groups.of(a, b);
      REQUIRE(g < groups.count());
      CHECK(g == groups.of(b, a));
      in_rest += g == groups.rest();
      for (int p = 0; p < PairGroups::phases; ++p) {
        const auto [from, to] = groups.phase(p);
        if (g < from || g >= to) continue;
        owners[p][a].insert(g), owners[p][b].insert(g);
      }
    }
    for (const auto& [phase, particles] : owners)
      for (const auto& [particle, of] : particles) CHECK(of.size() == 1);
    CHECK((in_rest > 0) == (n >= 4096));  // with one or two shares all pairs find a place
  }
}
