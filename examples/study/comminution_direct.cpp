// silt - BSD-3-Clause, see LICENSE
//
// Cost of the mill with a search at each step.

#include <cstdint>
#include <span>
#include <vector>

#include "study/comminution.hpp"

namespace comminution_study {

namespace {

/// Linked cells over the whole bounding box of the grains, including empty ones: each grain checks
/// its own cell and all 26 around it.
class FullMesh {
 public:
  template <class Domain>
  void find(const silt::SphereSet& spheres, double reach, const Domain& domain, const silt::Team&,
            std::vector<silt::IndexPair>& pairs) {
    pairs.clear();
    const auto& rows = spheres.rows;
    if (rows.empty()) return;
    silt::Box box;
    for (const auto& row : rows) box.include(row.centre());
    const double width = 2 * spheres.largest_radius + reach;  // [m] of a cell
    const auto along = [&](double x, double low) { return static_cast<int>((x - low) / width); };
    const silt::Vec3d e = box.extent();
    const int nx = along(e.x, 0) + 1, ny = along(e.y, 0) + 1, nz = along(e.z, 0) + 1;
    first_.assign(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny * nz), none);
    next_.resize(rows.size());
    const auto cell = [&](int i, int j, int k) {
      return static_cast<std::size_t>(i) +
             static_cast<std::size_t>(nx) * static_cast<std::size_t>(j + ny * k);
    };
    for (std::uint32_t a = 0; a < rows.size(); ++a) {
      auto& head = first_[cell(along(rows[a].x, box.min.x), along(rows[a].y, box.min.y),
                               along(rows[a].z, box.min.z))];
      next_[a] = head, head = a;
    }
    for (std::uint32_t a = 0; a < rows.size(); ++a) {
      const int i = along(rows[a].x, box.min.x), j = along(rows[a].y, box.min.y),
                k = along(rows[a].z, box.min.z);
      for (int c = std::max(k - 1, 0); c <= std::min(k + 1, nz - 1); ++c)
        for (int b = std::max(j - 1, 0); b <= std::min(j + 1, ny - 1); ++b)
          for (int x = std::max(i - 1, 0); x <= std::min(i + 1, nx - 1); ++x)
            for (std::uint32_t other = first_[cell(x, b, c)]; other != none; other = next_[other])
              if (a < other && silt::detail::within_reach(rows[a], rows[other], reach, domain))
                pairs.push_back({a, other});
    }
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> first_, next_;
};

}  // namespace

double direct_cost(const State& from, const Scene& base, const Way& way, double seconds,
                   Search search) {
  using jet_mill::Law;
  if (way.followed) return cost_of<Law, true>(from, base, way, seconds, FullMesh{});
  switch (search) {
    case Search::FullMesh:
      return cost_of<Law, false>(from, base, way, seconds, FullMesh{});
    case Search::HalfStencil:
      return cost_of<Law, false>(from, base, way, seconds, silt::Nbs{});
    case Search::HashedGrid:
      return cost_of<Law, false>(from, base, way, seconds, silt::HashedGrid{silt::one_level});
    case Search::SubGrid:
      return cost_of<Law, false>(from, base, way, seconds, silt::HashedGrid{silt::sub_grid(0.2)});
  }
  return 0;
}

}  // namespace comminution_study
