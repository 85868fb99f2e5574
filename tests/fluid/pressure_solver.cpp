// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include <silt/fluid/pressure_solver.hpp>

#include "fluid/pressure_cases.hpp"
#include "near.hpp"

namespace pressure_solver_test {

namespace {

using silt::CellField;
using silt::Grid;
using silt::PressureSolution;
using silt::PressureSolver;
using silt::Team;
using silt_test::pressure_case;
using silt_test::PressureCase;
constexpr double pi = std::numbers::pi;

/// |b - A p| / |b| by the definition of A, face by face.
double residual_of(const PressureCase& a, const CellField& p) {
  const Grid& g = a.grid;
  double left = 0, whole = 0;
  a.for_cells([&](int i, int j, int k) {
    const int at[3] = {i, j, k};
    double r = a.b(i, j, k) - a.d(i, j, k) * p(i, j, k);
    const CellField* fields[3] = {&a.ax, &a.ay, &a.az};
    for (int c = 0; c < 3; ++c) {
      const int n = g.cells()[static_cast<std::size_t>(c)];
      for (const int side : {-1, 1}) {
        if (!g.periodic(c) && (at[c] + side < 0 || at[c] + side >= n)) continue;
        int to[3] = {i, j, k};
        to[c] = (at[c] + side + n) % n;
        const int* face = side < 0 ? at : to;
        r -= (*fields[c])(face[0], face[1], face[2]) * (p(i, j, k) - p(to[0], to[1], to[2]));
      }
    }
    left += r * r;
    whole += a.b(i, j, k) * a.b(i, j, k);
  });
  return std::sqrt(left / whole);
}

PressureSolution solve(const PressureCase& a, CellField& p, double relative = 1e-10, int threads = 1) {
  const Team team(threads);
  PressureSolver solver(a.grid);
  solver.set(a.ax, a.ay, a.az, a.d, team);
  return solver.solve(a.b, p, {.relative = relative}, team);
}

/// Noise in weights and right side on any grid. Right sides of floating systems have no mean.
PressureCase noisy(const Grid& grid, double contrast, double blocked, bool outlet) {
  PressureCase made(grid);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  CellField weight(grid);
  made.for_cells([&](int i, int j, int k) {
    const double w = std::pow(contrast, -uniform(random));
    weight(i, j, k) = uniform(random) < blocked ? 0.0 : w;
    made.b(i, j, k) = 2 * uniform(random) - 1;
  });
  made.join(weight);
  if (outlet)
    made.for_cells([&](int i, int j, int k) {
      const double length = grid.h().x * grid.h().y / grid.h().z;
      if (k == 0) made.d(i, j, k) = 2 * weight(i, j, k) * length;
    });
  return made;
}

template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const silt::InputError& error) {
    return error.what();
  }
  return {};
}

/// Root mean square of p less cos(2 pi x) cos(pi y) cos(pi z), the solution of -div(w grad p) = f
/// with w = 1 + 0.5 sin(2 pi x) cos(pi z); x periodic, walls at y and z of no flux, or p as given
/// below z = 0 and above z = 1 where `dirichlet`.
double error_of(int n, bool dirichlet) {
  PressureCase a(Grid({{0, 0, 0}, {1, 1, 1}}, {n, n + 1, n + 2}, {true, false, false}));
  const silt::Vec3d h = a.grid.h();
  const auto exact = [](double x, double y, double z) {
    return std::cos(2 * pi * x) * std::cos(pi * y) * std::cos(pi * z);
  };
  const auto w = [](double x, double z) {
    return 1 + 0.5 * std::sin(2 * pi * x) * std::cos(pi * z);
  };
  a.for_cells([&](int i, int j, int k) {
    const silt::Vec3d c = a.grid.centre(i, j, k);
    a.ax(i, j, k) = w(c.x - h.x / 2, c.z) * h.y * h.z / h.x;
    if (j > 0) a.ay(i, j, k) = w(c.x, c.z) * h.x * h.z / h.y;
    if (k > 0) a.az(i, j, k) = w(c.x, c.z - h.z / 2) * h.x * h.y / h.z;
    // -w lap p - grad w . grad p
    const double cy = std::cos(pi * c.y), cz = std::cos(pi * c.z), sz = std::sin(pi * c.z);
    const double cx = std::cos(2 * pi * c.x), sx = std::sin(2 * pi * c.x);
    const double f = 6 * pi * pi * w(c.x, c.z) * cx * cy * cz -
                     (pi * cx * cz) * (-2 * pi * sx * cy * cz) -
                     (-0.5 * pi * sx * sz) * (-pi * cx * cy * sz);
    a.b(i, j, k) = f * h.x * h.y * h.z;
    for (const int side : {0, 1})
      if (dirichlet && k == side * (a.grid.nz() - 1)) {
        const double conductance = 2 * w(c.x, side) * h.x * h.y / h.z;
        a.d(i, j, k) += conductance;
        a.b(i, j, k) += conductance * exact(c.x, c.y, side);
      }
  });
  CellField p(a.grid);
  const PressureSolution result = solve(a, p);
  CHECK(result.converged);
  CHECK(result.residual <= 1e-10);
  double sum = 0;
  a.for_cells([&](int i, int j, int k) {
    const silt::Vec3d c = a.grid.centre(i, j, k);
    const double e = p(i, j, k) - exact(c.x, c.y, c.z);
    sum += e * e;
  });
  return std::sqrt(sum / static_cast<double>(a.grid.size()));
}

}  // namespace

TEST_CASE("pressure_solver: manufactured solutions, second order with walls and with outlets") {
  for (const bool dirichlet : {false, true}) {
    CAPTURE(dirichlet);
    const double coarse = error_of(12, dirichlet), fine = error_of(24, dirichlet);
    CHECK(fine < 0.01);
    CHECK(std::log2(coarse / fine) > 1.9);
  }
}

TEST_CASE("pressure_solver: iterations to 1e-8 at 32^3 and 64^3, contrast 26 and 2500, a bend") {
  for (const int n : {32, 64})
    for (const char name : {'C', 'B', 'D', 'P'}) {
      const PressureCase a = pressure_case(name, n);
      CellField p(a.grid);
      const PressureSolution result = solve(a, p, 1e-8);
      CAPTURE(name);
      CAPTURE(n);
      CHECK(result.converged);
      CHECK(result.iterations <= (name == 'D' ? 35 : name == 'B' ? 20 : 10));
      CHECK(residual_of(a, p) <= 1.0001e-8);
      CHECK(result.reason.empty());
    }
}

TEST_CASE("pressure_solver: 1e-10 on odd, thin and flat grids, periodic or not, with an outlet") {
  const std::array<int, 3> sizes[] = {{17, 33, 5}, {2, 30, 90}, {30, 1, 20}, {1, 1, 40},
                                      {1, 24, 1},  {40, 3, 3},  {300, 5, 7}, {1, 1, 1}};
  for (const auto& n : sizes)
    for (const int periodic : {0, 1, 2, 4, 7}) {
      const Grid grid({{0, 0, 0}, {0.1 * n[0], 0.1 * n[1], 0.1 * n[2]}}, n,
                      {(periodic & 1) != 0, (periodic & 2) != 0, (periodic & 4) != 0});
      const PressureCase a = noisy(grid, 100, 0, true);
      CellField p(grid);
      const PressureSolution result = solve(a, p);
      CAPTURE(n[0]);
      CAPTURE(n[1]);
      CAPTURE(n[2]);
      CAPTURE(periodic);
      CHECK(result.converged);
      CHECK(result.iterations <= 35);
      CHECK(residual_of(a, p) <= 1.001e-10);
    }
}

TEST_CASE("pressure_solver: cells longer or flatter by 30 times need no more than 35 iterations") {
  const std::array<double, 3> lengths[] = {{1, 1, 30}, {30, 1, 1}, {1, 30, 30}, {1, 5, 25}};
  for (const auto& l : lengths) {
    const Grid grid({{0, 0, 0}, {l[0], l[1], l[2]}}, {24, 20, 28}, {true, false, false});
    const PressureCase a = noisy(grid, 26, 0, true);
    CellField p(grid);
    const PressureSolution result = solve(a, p, 1e-8);
    CAPTURE(l[0]);
    CAPTURE(l[1]);
    CAPTURE(l[2]);
    CHECK(result.converged);
    CHECK(result.iterations <= 35);
  }
}

TEST_CASE("pressure_solver: closed and periodic boxes: means are removed, reported and fixed") {
  for (const bool periodic : {false, true}) {
    const Grid grid({{0, 0, 0}, {1, 1, 1}}, {18, 15, 16}, {periodic, periodic, periodic});
    PressureCase a = noisy(grid, 26, 0, false);
    double mean = 0, squares = 0;
    a.for_cells([&](int i, int j, int k) { mean += a.b(i, j, k); });
    mean /= static_cast<double>(grid.size());
    a.for_cells([&](int i, int j, int k) {
      a.b(i, j, k) += 0.25 - mean;
      squares += a.b(i, j, k) * a.b(i, j, k);
    });
    CellField p(grid, 5.0);  // a start with a mean
    const PressureSolution result = solve(a, p);
    CHECK(result.converged);
    const double n = static_cast<double>(grid.size());
    CHECK(result.removed == near(0.25 * std::sqrt(n / squares)).epsilon(1e-12));
    double sum = 0, largest = 0;
    a.for_cells([&](int i, int j, int k) {
      a.b(i, j, k) -= 0.25;
      sum += p(i, j, k);
      largest = std::max(largest, std::abs(p(i, j, k)));
    });
    CHECK(residual_of(a, p) <= 1.001e-10);
    CHECK(std::abs(sum / n) <= 1e-15 * largest * std::sqrt(n));
    if (periodic) CHECK(p(-1, -2, 16) == p(17, 13, 0));
  }
}

TEST_CASE("pressure_solver: 72 % of the cells blocked at random: each pocket is solved alone") {
  for (const bool outlet : {false, true}) {
    const Grid grid({{0, 0, 0}, {1, 1, 1}}, {21, 24, 19}, {false, true, false});
    PressureCase a = noisy(grid, 26, 0.72, outlet);
    const Team team(1);
    PressureSolver solver(grid);
    solver.set(a.ax, a.ay, a.az, a.d, team);
    CHECK(solver.floating_sets() > 100);
    // A right side that belongs to a known solution, which is 0 in blocked cells.
    const CellField noise = a.b;
    CellField p(grid);
    a.b.fill(0);
    a.for_cells([&](int i, int j, int k) {
      const int y = (j + 23) % 24;
      const auto add = [&](double face, int u, int v, int w) {
        const double flux = face * (noise(i, j, k) - noise(u, v, w));
        a.b(i, j, k) += flux;
        a.b(u, v, w) -= flux;
      };
      if (i > 0) add(a.ax(i, j, k), i - 1, j, k);
      add(a.ay(i, j, k), i, y, k);
      if (k > 0) add(a.az(i, j, k), i, j, k - 1);
      a.b(i, j, k) += a.d(i, j, k) * noise(i, j, k);
    });
    const PressureSolution result = solver.solve(a.b, p, {.relative = 1e-10}, team);
    CHECK(result.converged);
    CHECK(result.removed < 1e-14);
    CHECK(residual_of(a, p) <= 1.001e-10);
    int blocked = 0;
    double wrong = 0;
    a.for_cells([&](int i, int j, int k) {
      const int y = (j + 1) % 24;
      const bool open = a.d(i, j, k) > 0 || a.ax(i, j, k) > 0 || a.ay(i, j, k) > 0 ||
                        a.az(i, j, k) > 0 || (i < 20 && a.ax(i + 1, j, k) > 0) ||
                        a.ay(i, y, k) > 0 || (k < 18 && a.az(i, j, k + 1) > 0);
      blocked += !open;
      if (!open) CHECK(p(i, j, k) == 0);
      // Differences of pressure over open faces are those of the known solution.
      if (i > 0 && a.ax(i, j, k) > 0)
        wrong = std::max(
            wrong, std::abs((p(i, j, k) - p(i - 1, j, k)) - (noise(i, j, k) - noise(i - 1, j, k))));
    });
    CHECK(blocked > 0.72 * 21 * 24 * 19);
    CHECK(wrong < 1e-7);  // 1e-10 times a condition below 1000: long winding paths
  }
}

TEST_CASE("pressure_solver: faces closed at random, periodic over odd numbers") {
  // Pairs of cells that touch only over the seam among them, which have the same colour.
  for (const std::array<bool, 3>& periodic : {std::array{true, false, false}, {true, true, true}})
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
      const Grid grid({{0, 0, 0}, {1, 1, 1}}, {9, 9, 8}, periodic);
      CellField a[3] = {CellField(grid), CellField(grid), CellField(grid)}, d(grid), b(grid), p(grid);
      std::mt19937 random(seed);
      const auto one = [&] { return random() / 4294967296.0; };
      for (int k = 0; k < 8; ++k)
        for (int j = 0; j < 9; ++j)
          for (int i = 0; i < 9; ++i) {
            const int at[3] = {i, j, k};
            for (std::size_t c = 0; c < 3; ++c)
              if (at[c] > 0 || periodic[c]) a[c](i, j, k) = one() < 0.3 ? 1 : 0;
            b(i, j, k) = one() - 0.5;
          }
      PressureSolver solver(grid);
      solver.set(a[0], a[1], a[2], d, Team{});
      const PressureSolution found = solver.solve(b, p, {.relative = 1e-6}, Team{});
      CAPTURE(seed);
      CAPTURE(found.reason);
      CHECK(found.converged);
    }
}

TEST_CASE("pressure_solver: two chambers, one with an outlet: only the other's mean is removed") {
  const Grid grid({{0, 0, 0}, {1, 1, 1}}, {16, 8, 8});
  PressureCase a = noisy(grid, 1, 0, true);
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 8; ++j) {
      a.ax(7, j, k) = 0;
      for (int i = 7; i < 16; ++i) a.d(i, j, k) = 0;
      for (int i = 0; i < 16; ++i) a.b(i, j, k) = 1;
    }
  CellField p(grid);
  const PressureSolution result = solve(a, p);
  CHECK(result.converged);
  CHECK(result.removed == near(std::sqrt(9.0 / 16)).epsilon(1e-14));
  CHECK(std::abs(p(12, 3, 3)) < 1e-9 * p(3, 4, 7));  // the tolerance of 1e-10 over both
  // Sources of 1 a cell in the column drain through z = 0: flux and pressure by hand.
  const double a_face = grid.h().x * grid.h().y / grid.h().z;
  double expected = 8 / (2 * a_face);
  for (int k = 0; k < 8; ++k) {
    CHECK(p(3, 4, k) == near(expected).epsilon(1e-9));
    expected += (7 - k) / a_face;
  }
}

TEST_CASE(
    "pressure_solver: the preconditioner is symmetric and positive, seams of odd numbers too") {
  for (const std::array<int, 3>& n : {std::array{16, 16, 16}, {17, 9, 13}, {6, 5, 11}})
    for (const int periodic : {0, 7}) {
      const Grid grid({{0, 0, 0}, {1, 1, 1}}, n, {periodic > 0, periodic > 0, periodic > 0});
      const PressureCase a = noisy(grid, 100, 0.1, true);
      const Team team(1);
      PressureSolver solver(grid);
      solver.set(a.ax, a.ay, a.az, a.d, team);
      CellField x(grid), y(grid), Mx(grid), My(grid);
      std::mt19937_64 random(11);
      std::normal_distribution<double> normal;
      a.for_cells([&](int i, int j, int k) {
        x(i, j, k) = normal(random);
        y(i, j, k) = normal(random);
      });
      solver.precondition(x, Mx, team);
      solver.precondition(y, My, team);
      double xMy = 0, yMx = 0, xMx = 0, yMy = 0;
      a.for_cells([&](int i, int j, int k) {
        xMy += x(i, j, k) * My(i, j, k);
        yMx += y(i, j, k) * Mx(i, j, k);
        xMx += x(i, j, k) * Mx(i, j, k);
        yMy += y(i, j, k) * My(i, j, k);
      });
      CAPTURE(n[0]);
      CAPTURE(periodic);
      CHECK(xMx > 0);
      CHECK(yMy > 0);
      CHECK(std::abs(xMy - yMx) <= 1e-5 * std::sqrt(xMx * yMy));
    }
}

TEST_CASE("pressure_solver: one, two and three threads give the same bits") {
  const auto same = [](const PressureCase& a) {
    CellField one(a.grid);
    const PressureSolution first = solve(a, one, 1e-8);
    CHECK(first.converged);
    for (const int threads : {2, 3}) {
      CellField more(a.grid);
      const PressureSolution other = solve(a, more, 1e-8, threads);
      CHECK(first.iterations == other.iterations);
      CHECK(first.residual == other.residual);
      bool equal = true;
      a.for_cells([&](int i, int j, int k) { equal = equal && one(i, j, k) == more(i, j, k); });
      CHECK(equal);
    }
  };
  same(pressure_case('B', 48));
  for (const int nz : {40, 35}) {
    const Grid grid({{0, 0, 0}, {1, 1, 1}}, {33, 30, nz}, {true, false, true});
    same(noisy(grid, 1000, 0.3, false));
  }
  // Rows so long that planes are done in strips.
  same(noisy(Grid({{0, 0, 0}, {4, 1, 0.5}}, {600, 64, 24}), 26, 0, true));
}

TEST_CASE("pressure_solver: starts from what is given, takes new coefficients, any unit") {
  PressureCase a = pressure_case('B', 24);
  const Team team(1);
  PressureSolver solver(a.grid);
  solver.set(a.ax, a.ay, a.az, a.d, team);
  CellField p(a.grid);
  const PressureSolution first = solver.solve(a.b, p, {.relative = 1e-8}, team);
  CHECK(solver.solve(a.b, p, {.relative = 1e-8}, team).iterations == 0);
  const CellField before = p;
  for (const double unit : {1e-18, 1e17}) {
    a.for_cells([&](int i, int j, int k) {
      for (CellField* f : {&a.ax, &a.ay, &a.az, &a.d}) (*f)(i, j, k) *= unit;
    });
    solver.set(a.ax, a.ay, a.az, a.d, team);
    p.fill(0);
    const PressureSolution again = solver.solve(a.b, p, {.relative = 1e-8}, team);
    CHECK(again.converged);
    CHECK(again.iterations == first.iterations);
    CHECK(residual_of(a, p) < 1.001e-8);
  }
  // Walls come and go.
  PressureCase b = pressure_case('P', 24);
  solver.set(b.ax, b.ay, b.az, b.d, team);
  CHECK(solver.solve(b.b, p, {.relative = 1e-8}, team).converged);
  CHECK(residual_of(b, p) < 1.001e-8);
  b.b.fill(0);
  CHECK(solver.solve(b.b, p, {}, team).converged);
  b.for_cells([&](int i, int j, int k) { REQUIRE(p(i, j, k) == 0); });
}

TEST_CASE("pressure_solver: faces at the boundary are closed whatever stands there") {
  PressureCase a = pressure_case('B', 12);
  CellField p(a.grid), q(a.grid);
  CHECK(solve(a, p).converged);
  const double nan = std::nan("");
  for (int u = 0; u < 12; ++u)
    for (int v = 0; v < 12; ++v)
      for (const int end : {0, 12}) {
        a.ax(end, u, v) = nan;
        a.ay(u, end, v) = nan;
        a.az(u, v, end) = nan;
      }
  CHECK(solve(a, q).converged);
  a.for_cells([&](int i, int j, int k) { REQUIRE(p(i, j, k) == q(i, j, k)); });
}

TEST_CASE("pressure_solver: what cannot be solved is said") {
  PressureCase a = pressure_case('B', 12);
  const Team team(1);
  PressureSolver solver(a.grid);
  CellField p(a.grid);
  CHECK(refusal([&] { solver.solve(a.b, p, {}, team); }).find("call set()") != std::string::npos);
  solver.set(a.ax, a.ay, a.az, a.d, team);
  CHECK(refusal([&] { solver.solve(p, p, {}, team); }).find("the same field") != std::string::npos);
  CHECK(refusal([&] { solver.solve(a.b, p, {.relative = 0}, team); }).find("relative = 0") !=
        std::string::npos);
  CellField other(Grid(a.grid.box(), {12, 12, 11}));
  CHECK(refusal([&] { solver.solve(other, p, {}, team); }).find("another grid") !=
        std::string::npos);

  const PressureSolution few =
      solver.solve(a.b, p, {.relative = 1e-10, .most_iterations = 3}, team);
  CHECK_FALSE(few.converged);
  CHECK(few.iterations == 3);
  CHECK(few.reason.find("most_iterations") != std::string::npos);
  CHECK(few.residual == near(residual_of(a, p)).epsilon(1e-9));
  p(3, 4, 5) = std::nan("");
  const PressureSolution start = solver.solve(a.b, p, {}, team);
  CHECK_FALSE(start.converged);
  CHECK(start.reason.find("not finite") != std::string::npos);
  p.fill(1e300);
  CHECK_FALSE(solver.solve(a.b, p, {}, team).converged);
  p.fill(0);
  CHECK(solver.solve(a.b, p, {.relative = 1e-8}, team).converged);  // nothing has stayed behind
  a.b(1, 2, 3) = std::numeric_limits<double>::infinity();
  const PressureSolution right = solver.solve(a.b, p, {}, team);
  CHECK_FALSE(right.converged);
  CHECK(right.reason.find("right-hand side") != std::string::npos);

  const auto with = [&](CellField& field, double value) {
    const double kept = field(2, 3, 4);
    field(2, 3, 4) = value;
    const std::string sentence = refusal([&] { solver.set(a.ax, a.ay, a.az, a.d, team); });
    field(2, 3, 4) = kept;
    return sentence;
  };
  CHECK(with(a.ay, -1e-3).find("ay(2, 3, 4) = -0.001") != std::string::npos);
  CHECK(with(a.d, -1).find("d(2, 3, 4) = -1") != std::string::npos);
  CHECK(with(a.ax, std::nan("")).find("ax(2, 3, 4)") != std::string::npos);
  CHECK(with(a.az, std::numeric_limits<double>::infinity()).find("az(2, 3, 4)") !=
        std::string::npos);
}

}  // namespace pressure_solver_test
