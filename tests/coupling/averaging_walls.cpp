// silt - BSD-3-Clause, see LICENSE
#include "coupling/averaging_support.hpp"

#include <algorithm>
#include <cmath>

namespace averaging_walls_test {

using namespace averaging_test;

namespace {

/// A wall along y, and the fluid's side of it.
struct Wall {
  double x, z;  // direction of the fluid [-]
  double from;  // [m] along it
  bool open(const Vec3d& at) const { return x * at.x + z * at.z > from; }
};

/// Calls use(place) for n^3 places in a cell.
template <class Use>
void for_places(const Grid& g, int i, int j, int k, int n, const Use& use) {
  const auto at = [n](int m) { return (m + 0.5) / n - 0.5; };
  for (int c = 0; c < n; ++c)
    for (int b = 0; b < n; ++b)
      for (int a = 0; a < n; ++a)
        use(g.centre(i, j, k) + Vec3d{at(a) * g.h().x, at(b) * g.h().y, at(c) * g.h().z});
}

template <class Use>
void for_cells(const Grid& g, const Use& use) {
  for (int k = 0; k < g.nz(); ++k)
    for (int j = 0; j < g.ny(); ++j)
      for (int i = 0; i < g.nx(); ++i) use(i, j, k);
}

/// The fluid's share of cells; of less than a tenth: none.
CellField shares(const Grid& g, const Wall& wall) {
  constexpr int n = 16;
  CellField open(g);
  for_cells(g, [&](int i, int j, int k) {
    int in = 0;
    for_places(g, i, j, k, n, [&](const Vec3d& x) { in += wall.open(x); });
    const double share = static_cast<double>(in) / (n * n * n);
    open(i, j, k) = share < 0.1 ? 0 : share;
  });
  return open;
}

}  // namespace

TEST_CASE("averaging: beside walls askew to the cells a uniform cloud stays uniform") {
  // Particles of diameter 1 (each place stands for a part of one).
  for (const double h : {1.0, 2.0}) {
    const Grid grid({{0, 0, 0}, {12 * h, 4 * h, 12 * h}}, {12, 4, 12}, {false, true, false});
    for (const Wall& wall : {Wall{1, 0, 4 * h}, Wall{1, 0, 4.5 * h}, Wall{0.8, 0.6, 5 * h},
                             Wall{0.70710678, 0.70710678, 6 * h}}) {
      const CellField open = shares(grid, wall);
      Cloud cloud;
      for_cells(grid, [&](int i, int j, int k) {
        for_places(grid, i, j, k, 4, [&](const Vec3d& x) {
          if (open(i, j, k) > 0 && wall.open(x)) cloud.position.push_back(x);
        });
      });
      cloud.radius.assign(cloud.position.size(), 0.5);
      const std::vector<double> amount(cloud.position.size(), 1.0 / 64);
      for_modes(false, [&](const char* name, const auto& mode) {
        CAPTURE(name);
        typename std::decay_t<decltype(mode)>::Averaging op(mode, grid, 1);
        op.open(open);
        op.place(cloud.seen());
        const CellField got = spread(op, {amount})[0];
        double cut = 0, whole = 0, sum2 = 0, n = 0;
        for_cells(grid, [&](int i, int j, int k) {
          if (open(i, j, k) < 0.3) return;  // a flow joins those with the next
          const double error = got(i, j, k) / open(i, j, k) - 1;
          double& most = open(i, j, k) == 1 ? whole : cut;
          most = std::max(most, std::abs(error)), sum2 += error * error, ++n;
        });
        // The samples of cut cells are eighths that are open in part, not places in the fluid: what
        // falls on cells within a particle alone sees the difference more. Measured: 4.7 %, 14 %,
        // 4.4 %, and for those modes 8.4 %, 27 %, 7.7 %. Weights that sum to 1 for each particle
        // alone leave 10 to 47 % in whole cells and 7 to 13 % rms (Diffusion: 2 and 1 %).
        const std::string of = name;
        const bool near = of == "satellites" || of == "exact" || of == "two grids, exact";
        CHECK(whole <= (near ? 0.09 : 0.05));
        CHECK(cut <= (near ? 0.3 : 0.16));
        CHECK(std::sqrt(sum2 / n) <= (near ? 0.08 : 0.045));
      });
    }
  }
}

}  // namespace averaging_walls_test
