// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <map>
#include <utility>

#include "support.hpp"

namespace sph_cluster_lists_test {

using namespace sph_test;

namespace {
/// Particles of three kinds at random places, from -0.3 to 1.3 of a box that may repeat.
Packed scattered(int dimensions, bool repeats, std::size_t width, std::uint64_t seed) {
  Packed p;
  p.lists.width = width, p.lists.spacing = 0.05, p.lists.dimensions = dimensions;
  if (repeats) p.lists.repeats = {{0, 0, 0}, {1, dimensions == 2 ? 0.0 : 1.0, 1}};
  silt::Random random(seed);
  const double low = repeats ? 0 : -0.3, high = repeats ? 1 : 1.3;
  for (std::uint32_t k = 0; k < 2000; ++k) {
    SphRow r{};
    r.place({random.uniform(low, high), dimensions == 2 ? 0 : random.uniform(low, high),
             random.uniform(low, high)});
    p.columns.add(r,
                  k % 7 == 0    ? ClusterLists::Wall
                  : k % 11 == 0 ? ClusterLists::Probe
                                : ClusterLists::Liquid,
                  k);
  }
  return p;
}
}  // namespace

TEST_CASE("SPH lists: every pair within reach is listed once, under its own image") {
  for (const int dimensions : {2, 3})
    for (const bool repeats : {false, true})
      for (const std::size_t width : {std::size_t{1}, std::size_t{4}, std::size_t{8}}) {
        CAPTURE(dimensions);
        CAPTURE(repeats);
        CAPTURE(width);
        const double reach = 0.14;
        Packed p = scattered(dimensions, repeats, width, width);
        p.arrange(reach);
        const auto& rows = p.columns.rows;
        std::size_t listed = 0, wanted = 0, wrong = 0;
        for (std::size_t pack = 0; pack < p.lists.packs(); ++pack) {
          std::map<std::pair<std::size_t, std::uint32_t>, int> seen;
          for (const auto of : {p.lists.liquid(pack), p.lists.walls(pack)})
            for (const auto e : of) ++seen[{e.row(), e.image()}];
          for (const auto& [place, times] : seen) wrong += times != 1;
          listed += seen.size();
          for (std::size_t a = pack * width; a < (pack + 1) * width; ++a) {
            if (!p.is_there(a)) continue;
            for (std::size_t b = 0; b < rows.size(); ++b) {
              if (!p.is_there(b)) continue;
              const int ka = p.columns.kind[a], kb = p.columns.kind[b];
              const bool meet = kb == ClusterLists::Liquid ||
                                (ka == ClusterLists::Liquid && kb == ClusterLists::Wall);
              const Vec3d d = way(rows[a], rows[b], p.lists.repeats);
              if (!meet || !(norm(d) < reach)) continue;
              ++wanted;
              bool found = false;
              for (std::uint32_t image = 0; image < 27; ++image)
                if (seen.count({b, image}) > 0 && norm(rows[a].position() - rows[b].position() -
                                                       p.lists.shift(image) - d) < 1e-12)
                  found = true;
              wrong += !found;
            }
          }
        }
        CHECK(wrong == 0);
        CHECK(wanted > 10000);
        // Of one that is alone there is no more than what is near; packs list some beyond.
        if (width == 1) CHECK(listed == wanted);
      }
}

TEST_CASE("SPH lists: the order is the same for every number of threads") {
  Packed one = scattered(3, true, 8, 3), three = one;
  one.arrange(0.14, 1), three.arrange(0.14, 3);
  CHECK(one.columns.label == three.columns.label);
  for (std::size_t pack = 0; pack < one.lists.packs(); ++pack) {
    const auto a = one.lists.liquid(pack), b = three.lists.liquid(pack);
    REQUIRE(a.size() == b.size());
    for (std::size_t k = 0; k < a.size(); ++k) CHECK(a[k].packed == b[k].packed);
  }
}

}  // namespace sph_cluster_lists_test
