// silt - BSD-3-Clause, see LICENSE
//
// The programs of docs/search.md.

#include <cstdio>
#include <string>

#include <silt/search/fastest_of.hpp>
#include <silt/silt.hpp>
#include <silt/simulation/contact_check.hpp>

/// A user-defined search: every pair nearer than `reach`, once.
struct MySearch {
  template <class Domain>
  void find(const silt::SphereSet& spheres, double reach, const Domain& domain, const silt::Team&,
            std::vector<silt::IndexPair>& pairs) {
    pairs.clear();
    const auto& rows = spheres.rows;
    for (std::uint32_t a = 0; a < rows.size(); ++a)
      for (std::uint32_t b = a + 1; b < rows.size(); ++b) {
        silt::Vec3d d = rows[a].centre() - rows[b].centre();
        if constexpr (Domain::periodic) d = domain.shortest(d);
        if (norm(d) < rows[a].r + rows[b].r + reach) pairs.push_back({a, b});
      }
  }
};

const silt::HertzMindlin::Material glass{.youngs_modulus = 1e7, .poisson_ratio = 0.25};

template <class Search>
auto falling(const Search& search) {
  silt::Particles<silt::Sphere> beads;
  beads.fill({{0, 0, 0}, {0.02, 0.02, 0.02}}, {.radius = silt::uniform(0.5e-3, 1e-3),
                                               .density = 2500,
                                               .count = 300,
                                               .arrangement = silt::Arrangement::Random});
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass}, search};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.03}), glass);
  return sim;
}

int main() {
  // Policies of Simulation, from the usual to the special.
  auto usual = falling(silt::VerletList<>{});
  auto cells = falling(silt::VerletList<silt::CellGrid>{});
  auto direct = falling(silt::HashedGrid{});
  auto tried = falling(silt::VerletList<silt::AutoSearch>{});
  auto own = falling(silt::VerletList<MySearch>{});

  silt::VerletList<silt::HashedGrid> with_sub_grid{.finder = silt::sub_grid(0.2)};
  auto as_in_the_paper = falling(with_sub_grid);

  // The choice of AutoSearch, and its reason.
  tried.run(0.001);
  std::puts(tried.search().finder.report().c_str());

  // Is a contact missed?
  silt::ContactCheck check;
  own.run(0.02, check);
  usual.run(0.001), cells.run(0.001), direct.run(0.001), as_in_the_paper.run(0.001);
  return check.contacts() > 0 ? 0 : 1;
}
