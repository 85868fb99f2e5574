// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <string>

#include <silt/fluid/grid.hpp>

namespace grid_test {

namespace {

using silt::Box;
using silt::CellField;
using silt::Grid;

std::string refusal(const Box& box, const std::array<int, 3>& cells) {
  try {
    const Grid grid(box, cells);
  } catch (const silt::InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("grid: spacings, centres and sizes of a box with other cells in each direction") {
  const Grid grid({{-1, 0, 2}, {1, 3, 4}}, {4, 3, 8});
  CHECK(grid.h().x == 0.5);
  CHECK(grid.h().y == 1);
  CHECK(grid.h().z == 0.25);
  CHECK(grid.size() == 96);
  CHECK(grid.cell_volume() * 96 == doctest::Approx(grid.box().volume()).epsilon(1e-15));
  CHECK(grid.centre(0, 0, 0).x == -0.75);
  CHECK(grid.centre(3, 2, 7).y == 2.5);
  CHECK(grid.centre(3, 2, 7).z == 3.875);
  CHECK(grid == Grid({{-1, 0, 2}, {1, 3, 4}}, {4, 3, 8}));
  CHECK_FALSE(grid == Grid({{-1, 0, 2}, {1, 3, 4}}, {4, 3, 8}, {true, false, false}));
}

TEST_CASE("grid: every value of a field, ghosts included, has its own place; rows are aligned") {
  for (const int nx : {1, 2, 7, 8, 15, 16, 17}) {
    const Grid grid({{0, 0, 0}, {1, 1, 1}}, {nx, 2, 3});
    CellField field(grid, -1);
    constexpr int g = Grid::ghost;
    double next = 0;
    for (int k = -g; k < 3 + g; ++k)
      for (int j = -g; j < 2 + g; ++j)
        for (int i = -g; i < nx + g; ++i) {
          REQUIRE(grid.index(i, j, k) < grid.storage());
          REQUIRE(field(i, j, k) == -1);
          field(i, j, k) = next++;
        }
    CHECK(next == (nx + 4) * 6 * 7);
    for (int k = -g; k < 3 + g; ++k)
      for (int j = -g; j < 2 + g; ++j) {
        CHECK(reinterpret_cast<std::uintptr_t>(field.row(j, k)) % 64 == 0);
        CHECK(field.row(j, k) + nx - 1 == &field(nx - 1, j, k));
      }
  }
}

TEST_CASE("grid: ghosts of periodic directions are the cells of the other side, corners too") {
  const std::array<int, 3> n{5, 1, 3};
  for (int which = 0; which < 8; ++which) {
    const std::array<bool, 3> periodic{(which & 1) != 0, (which & 2) != 0, (which & 4) != 0};
    const Grid grid({{0, 0, 0}, {1, 1, 1}}, n, periodic);
    CellField field(grid, -1);
    const auto value = [](int i, int j, int k) { return i + 10.0 * j + 100.0 * k; };
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) field(i, j, k) = value(i, j, k);
    field.wrap_ghosts();
    for (int k = -2; k < n[2] + 2; ++k)
      for (int j = -2; j < n[1] + 2; ++j)
        for (int i = -2; i < n[0] + 2; ++i) {
          int at[3] = {i, j, k};
          bool beyond = false;
          for (std::size_t d = 0; d < 3; ++d) {
            const int inside = (at[d] + 2 * n[d]) % n[d];
            beyond |= !periodic[d] && inside != at[d];
            at[d] = inside;
          }
          REQUIRE(field(i, j, k) == (beyond ? -1 : value(at[0], at[1], at[2])));
        }
  }
}

TEST_CASE("grid: nonsense is refused") {
  const double infinite = std::numeric_limits<double>::infinity();
  const Box unit{{0, 0, 0}, {1, 1, 1}};
  CHECK(refusal(unit, {1, 1, 1}).empty());
  CHECK(refusal(unit, {4, 0, 4}).find("number of cells in y = 0") != std::string::npos);
  CHECK(refusal(unit, {4, 4, -3}).find("number of cells in z = -3") != std::string::npos);
  CHECK(refusal(unit, {4, 4, 100000}).find("must be in [1, 65536]") != std::string::npos);
  CHECK(refusal(unit, {2000, 2000, 2000}).find("more than 2e9") != std::string::npos);
  CHECK(refusal(Box{}, {4, 4, 4}).find("give a finite box") != std::string::npos);
  CHECK(refusal({{0, 0, 0}, {1, 0, 1}}, {4, 4, 4}).find("cells of 0 [m]") != std::string::npos);
  CHECK(refusal({{0, 0, 1}, {1, 1, 0}}, {4, 4, 4}).find("cut into 4 cells in z") !=
        std::string::npos);
  CHECK(refusal({{0, 0, 0}, {1, infinite, 1}}, {4, 4, 4}).find("give a finite box") !=
        std::string::npos);
  CHECK(refusal({{0, 0, 0}, {std::nan(""), 1, 1}}, {4, 4, 4}).find("give a finite box") !=
        std::string::npos);
}

}  // namespace grid_test
