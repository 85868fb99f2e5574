// silt - BSD-3-Clause, see LICENSE
#include "coupling/averaging_support.hpp"

namespace averaging_diffusion_test {

using namespace averaging_test;
using silt::LineDiffusion;

namespace {

/// Residual of (s + k L) after = s before along one direction, largest of all cells; s: 1, or what
/// is open of a cell.
double residual(const CellField& before, const CellField& after, int d, double k, const CellField* open) {
  const Grid& g = before.grid();
  const auto cell = [](int m, int n) { return (m + n) % n; };
  double worst = 0;
  for (int z = 0; z < g.nz(); ++z)
    for (int y = 0; y < g.ny(); ++y)
      for (int x = 0; x < g.nx(); ++x) {
        const double share = open && (*open)(x, y, z) > 0 ? (*open)(x, y, z) : 1;
        double sum = share * after(x, y, z);
        for (const int side : {-1, 1}) {
          int at[3] = {x, y, z};
          const int n = g.cells()[static_cast<std::size_t>(d)];
          const int other = at[d] + side;
          if ((other < 0 || other >= n) && !g.periodic(d)) continue;
          at[d] = cell(other, n);
          if (open && ((*open)(x, y, z) == 0 || (*open)(at[0], at[1], at[2]) == 0)) continue;
          sum += k * (after(x, y, z) - after(at[0], at[1], at[2]));
        }
        worst = std::max(worst, std::abs(sum - share * before(x, y, z)));
      }
  return worst;
}

CellField times(CellField a, const CellField& b) {
  for (int k = 0; k < b.grid().nz(); ++k)
    for (int j = 0; j < b.grid().ny(); ++j)
      for (int i = 0; i < b.grid().nx(); ++i) a(i, j, k) *= b(i, j, k);
  return a;
}

}  // namespace

TEST_CASE("diffusion: lines are solved, with walls, wraps, blocked and cut cells") {
  // One direction alone: the others are one cell thick.
  for (int d = 0; d < 3; ++d)
    for (const bool wraps : {false, true})
      for (const int n : {2, 3, 9, 17})
        for (const bool blocked : {false, true}) {  // and cut
          std::array<int, 3> cells{1, 1, 1};
          cells[static_cast<std::size_t>(d)] = n;
          const Grid grid({{0, 0, 0}, {1, 1, 1}}, cells, {wraps, wraps, wraps});
          const double h = 1.0 / n, k = 7;
          LineDiffusion diffusion(grid, k * h * h);
          CellField open(grid, 1);
          const auto share = [&](int m) -> double& {
            return open(d == 0 ? m : 0, d == 1 ? m : 0, d == 2 ? m : 0);
          };
          if (blocked) share(n - 1) = 0.1, share(0) = 0.6;
          if (blocked && n > 3) share(4) = 0, share(3) = 0.3;
          if (blocked) diffusion.open(open);
          const CellField before = random_field(grid, 3);
          CellField after = before;
          CellField* const fields[]{&after};
          diffusion.step(fields, {});
          CHECK(residual(before, after, d, k, blocked ? &open : nullptr) <= 2e-14);
          CHECK(std::abs(dot(after, open) - dot(before, open)) <= 1e-14 * n);
          CellField same(grid, 2.5);
          CellField* const uniform[]{&same};
          diffusion.step(uniform, {});
          for (int m = 0; m < n; ++m)
            CHECK(near_relative(same(d == 0 ? m : 0, d == 1 ? m : 0, d == 2 ? m : 0), 2.5, 1e-13));
        }
}

TEST_CASE(
    "diffusion: the adjoint step is the adjoint, in three directions with all that there is") {
  for (const Room& room : rooms()) {
    CAPTURE(room.name);
    LineDiffusion diffusion(room.grid, 2);
    const CellField open = room.blocked ? room.open() : CellField(room.grid, 1);
    if (room.blocked) diffusion.open(open);
    const CellField a = random_field(room.grid, 1), b = random_field(room.grid, 2);
    const CellField a_open = times(a, open), b_open = times(b, open);  // sum s f g is the product
    CellField forward = a, back = b;
    CellField *const f[]{&forward}, *const g[]{&back};
    diffusion.step(f, {}), diffusion.adjoint_step(g, {});
    const double size = std::sqrt(dot(a, a) * dot(b, b));
    CHECK(std::abs(dot(forward, b_open) - dot(a_open, back)) <= 1e-13 * size);
    if (room.blocked) {  // and the order matters
      CellField other = b;
      CellField* const o[]{&other};
      diffusion.step(o, {});
      CHECK(std::abs(dot(forward, b_open) - dot(a_open, other)) > 1e-8 * size);
    }
  }
}

TEST_CASE("diffusion: a point becomes a Gaussian of width b, its variance exact") {
  const Grid grid({{0, 0, 0}, {48, 48, 48}}, {48, 48, 48});
  const double b = 6;
  Cloud one;
  one.position = {grid.centre(24, 24, 24)};
  one.radius = {0.5};
  const auto seen = [&](int steps) {
    Diffusion::Averaging op({b, steps}, grid, 1);
    op.place(one.seen());
    return spread(op, {{1}})[0];
  };
  const auto variance = [&](const CellField& f) {
    double sum = 0;
    for (int k = 0; k < 48; ++k)
      for (int j = 0; j < 48; ++j)
        for (int i = 0; i < 48; ++i) sum += f(i, j, k) * (i - 24) * (i - 24);
    return sum;
  };
  // Implicit steps add 2 D dt each to the variance; some 1e-4 reaches the walls with few of them.
  CHECK(near_relative(variance(seen(3)), b * b / 2, 1e-2));
  CHECK(near_relative(variance(seen(60)), b * b / 2, 1e-5));
  // Height of the Gaussian (pi b^2)^(-3/2), more by excess/8 a direction: of n implicit steps on a
  // lattice of 1 with variance v = b^2/2 the excess is 1/v + 3/n. The next terms are its square.
  const double v = b * b / 2, gaussian = std::pow(2 * std::numbers::pi * v, -1.5);
  for (const int n : {30, 60, 240})
    CHECK(near_relative(seen(n)(24, 24, 24), gaussian * std::pow(1 + (1 / v + 3.0 / n) / 8, 3),
                        0.005));
}

}  // namespace averaging_diffusion_test
