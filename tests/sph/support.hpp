// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/sph/sph.hpp>

namespace sph_test {

using silt::Vec3d;
using silt::detail::ClusterLists;
using silt::detail::SphColumns;
using silt::detail::SphRow;

/// Particles of all kinds in packs, with their lists.
struct Packed {
  ClusterLists lists;
  SphColumns columns;

  void arrange(double reach, const silt::Team& team = {}) {
    columns.arrange(lists.sort(
                        columns.rows,
                        [this](std::size_t k) {
                          return columns.label[k] == ClusterLists::none
                                     ? static_cast<int>(ClusterLists::Gone)
                                     : static_cast<int>(columns.kind[k]);
                        },
                        team),
                    team);
    columns.growth.resize(columns.size());
    lists.find(columns.rows, reach, team);
  }
  bool is_there(std::size_t k) const { return columns.label[k] != ClusterLists::none; }
};

/// The way from b to a, to the nearest image.
inline Vec3d way(const SphRow& a, const SphRow& b, const silt::detail::Repeats& repeats) {
  Vec3d d = a.position() - b.position();
  double* const of[3] = {&d.x, &d.y, &d.z};
  for (int k = 0; k < 3; ++k)
    if (const double l = repeats.along(k); l > 0) *of[k] -= l * std::round(*of[k] / l);
  return d;
}

/// A lattice with places off by up to `off` spacings, in a box of whole spacings.
inline std::vector<Vec3d> lattice(int nx, int ny, int nz, double spacing, double off,
                                  std::uint64_t seed = 1) {
  silt::Random random(seed);
  const auto at = [&](int i) { return (i + 0.5 + off * random.uniform(-1, 1)) * spacing; };
  std::vector<Vec3d> all;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) {
        const double x = at(i), y = at(j), z = at(k);
        all.push_back({x, ny == 1 ? 0 : y, z});
      }
  return all;
}

}  // namespace sph_test
