// silt - BSD-3-Clause, see LICENSE

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include <silt/coupling/averaging/diffusion.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/averaging/two_grid.hpp>
#include <silt/coupling/averaging/unresolved.hpp>
#include <silt/coupling/cell_space.hpp>

#include "near.hpp"

namespace cell_space_test {

using silt::GridSpace;
using silt::PointWeights;
using silt::Vec3d;

namespace {

/// Rings of a cylinder along z, of radius 0.1 m and length 1 m.
struct Rings {
  std::vector<double> radii{0, 0.03, 0.06, 0.08, 0.1};
  std::size_t cells() const { return radii.size() - 1; }
  double volume(std::size_t c) const {
    return std::numbers::pi * (radii[c + 1] * radii[c + 1] - radii[c] * radii[c]);
  }
  std::size_t locate(const Vec3d& x) const {
    const double r = std::hypot(x.x, x.y);
    if (r >= radii.back() || x.z < 0 || x.z > 1) return silt::no_cell;
    return static_cast<std::size_t>(std::upper_bound(radii.begin(), radii.end(), r) -
                                    radii.begin() - 1);
  }
};

static_assert(silt::CellMesh<Rings> && !silt::CellSpace<Rings>);
static_assert(silt::CellSpace<PointWeights<Rings>>);
static_assert(silt::CellSpace<GridSpace<silt::Unresolved>>);
static_assert(silt::CellSpace<GridSpace<silt::Kernel>>);
static_assert(silt::CellSpace<GridSpace<silt::TwoGrid>>);
static_assert(silt::CellSpace<GridSpace<silt::Diffusion>>);

/// In a ring; across two; at the rim, partly beyond; beyond.
const std::vector<Vec3d> places{{0.01, 0, 0.5}, {0, 0.06, 0.5}, {0.07, 0.069, 0.2}, {0.2, 0, 0.5}};
const std::vector<double> radii(4, 0.01);

template <class Space>
double adjoint_error(Space& space) {
  const std::vector<double> q{1, 2, -3, 5};
  std::vector<double> f(space.cells()), of_cells(space.cells()), g(q.size());
  for (std::size_t c = 0; c < f.size(); ++c) f[c] = 1 + 0.3 * static_cast<double>(c % 7);
  space.spread(q, of_cells);
  space.gather(f, g);
  double left = 0, right = 0;
  for (std::size_t c = 0; c < f.size(); ++c) left += of_cells[c] * f[c];
  for (std::size_t p = 0; p < q.size(); ++p) right += q[p] * g[p];
  return std::abs(left / right - 1);
}

}  // namespace

TEST_CASE("cell_space: points of a particle on rings keep its volume, and gather is the adjoint") {
  // Catches volume lost at the rim, weights of a particle beyond the mesh, and momentum that is
  // not kept.
  PointWeights space{Rings{}};
  space.place({places, radii});
  std::vector<double> of_cells(4), of_particles(4);
  for (std::size_t p = 0; p < 4; ++p) {
    std::vector<double> one(4, 0.0);
    one[p] = 1;
    space.spread(one, of_cells);
    double sum = 0;
    for (const double w : of_cells) sum += w;
    CHECK(near_relative(sum, p < 3 ? 1 : 0, 1e-14));
    if (p == 0) CHECK(near_relative(of_cells[0], 1, 1e-14));
    if (p == 1) CHECK((of_cells[1] > 0.4 && of_cells[2] > 0.3));
  }
  CHECK(adjoint_error(space) < 1e-14);
  const std::vector<double> ones(4, 1.0);
  space.gather(ones, of_particles);
  CHECK((near_relative(of_particles[1], 1, 1e-14) && of_particles[3] == 0));
}

TEST_CASE("cell_space: bodies are spread by their own points") {
  // Catches a body that is taken as the sphere of its volume: it would reach one ring alone.
  PointWeights space{Rings{}};
  const std::vector<silt::AveragedForm> forms{
      silt::averaged_form(silt::SuperEllipsoid{6, 1, 1}, 200)};
  const std::vector<silt::Quaternion> along_x(1);
  const std::vector<Vec3d> centre{{0.015, 0, 0.5}};
  const std::vector<double> radius{0.01};
  space.place({centre, radius, along_x, {}, forms});
  std::vector<double> of_cells(4);
  space.spread(std::vector<double>{1.0}, of_cells);
  CHECK(of_cells[1] > 0.1);
  CHECK(near_relative(of_cells[0] + of_cells[1], 1, 1e-12));
}

TEST_CASE("cell_space: a Grid's cells in flat order are those of the mode itself") {
  // Catches a row or a plane in another order, and ghosts counted as cells.
  const silt::Grid grid({{0, 0, 0}, {0.3, 0.2, 0.4}}, {3, 2, 4});
  GridSpace space(silt::Unresolved{}, grid, 0.05);
  const std::vector<Vec3d> at{{0.05, 0.05, 0.05}, {0.29, 0.11, 0.35}, {0.15, 0.1, 0.2}, {1, 1, 1}};
  const std::vector<double> r(4, 0.025);
  space.place({at, r});
  std::vector<double> of_cells(space.cells());
  space.spread(std::vector<double>{1, 0, 0, 0}, of_cells);
  CHECK(near_relative(of_cells[space.locate(at[0])], 1, 1e-12));
  space.spread(std::vector<double>{0, 1, 0, 0}, of_cells);
  CHECK(near_relative(of_cells[2 + 3 * (1 + 2 * 3)],
                      *std::max_element(of_cells.begin(), of_cells.end()), 0));
  CHECK(space.locate(at[1]) == 2 + 3 * (1 + 2 * 3));
  CHECK(space.locate(at[3]) == silt::no_cell);
  CHECK(adjoint_error(space) < 1e-14);
}

TEST_CASE("cell_space: numbers that cannot be are refused") {
  CHECK_THROWS_AS(PointWeights(Rings{}, 0), silt::InputError);
  PointWeights space{Rings{}};
  space.place({places, radii});
  std::vector<double> few(3), cells(4);
  CHECK_THROWS_AS(space.spread(few, cells), silt::InputError);
  CHECK_THROWS_AS(space.gather(few, cells), silt::InputError);
}

}  // namespace cell_space_test
