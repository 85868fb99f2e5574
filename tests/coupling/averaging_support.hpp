// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>

#include <array>
#include <span>
#include <string>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/coupling/averaging/diffusion.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/averaging/two_grid.hpp>
#include <silt/coupling/averaging/unresolved.hpp>

#include "near.hpp"

/// What the tests of averaging share: clouds, and spread and gather of whole sets of columns.
namespace averaging_test {

using silt::AveragedParticles;
using silt::Box;
using silt::Diffusion;
using silt::CellField;
using silt::Grid;
using silt::Kernel;
using silt::Team;
using silt::TwoGrid;
using silt::Unresolved;
using silt::Vec3d;

using Columns = std::vector<std::vector<double>>;

struct Cloud {
  std::vector<Vec3d> position;
  std::vector<double> radius;
  std::vector<silt::Quaternion> orientation = {};
  std::vector<std::uint32_t> form = {};
  std::vector<silt::AveragedForm> forms = {};

  AveragedParticles seen() const { return {position, radius, orientation, form, forms}; }
  std::vector<double> volumes() const {
    std::vector<double> v;
    for (const double r : radius) v.push_back(silt::Sphere::volume(r));
    return v;
  }
};

/// Uniformly distributed in a box, diameters from d/2 to d.
inline Cloud random_cloud(const Box& box, std::size_t n, double d, std::uint64_t seed) {
  silt::Random random(seed);
  Cloud cloud;
  for (std::size_t p = 0; p < n; ++p) {
    cloud.position.push_back({random.uniform(box.min.x, box.max.x),
                              random.uniform(box.min.y, box.max.y),
                              random.uniform(box.min.z, box.max.z)});
    cloud.radius.push_back(0.5 * d * random.uniform(0.5, 1));
  }
  return cloud;
}

inline CellField random_field(const Grid& grid, std::uint64_t seed) {
  silt::Random random(seed);
  CellField f(grid);
  for (int k = 0; k < grid.nz(); ++k)
    for (int j = 0; j < grid.ny(); ++j)
      for (int i = 0; i < grid.nx(); ++i) f(i, j, k) = random.uniform(-1, 1);
  return f;
}

template <class Operator>
std::vector<CellField> spread(Operator& op, const Columns& q, const Team& team = {}) {
  std::vector<CellField> fields(q.size(), CellField(op.grid(), 7));
  std::vector<CellField*> to;
  for (CellField& f : fields) to.push_back(&f);
  const std::vector<std::span<const double>> from(q.begin(), q.end());
  op.spread(from, to, team);
  return fields;
}
template <class Operator>
Columns gather(Operator& op, const std::vector<CellField>& fields, std::size_t n,
               const Team& team = {}) {
  Columns values(fields.size(), std::vector<double>(n, 7));
  std::vector<const CellField*> from;
  for (const CellField& f : fields) from.push_back(&f);
  const std::vector<std::span<double>> to(values.begin(), values.end());
  op.gather(from, to, team);
  return values;
}

inline double dot(const CellField& a, const CellField& b) {
  double sum = 0;
  for (int k = 0; k < a.grid().nz(); ++k)
    for (int j = 0; j < a.grid().ny(); ++j)
      for (int i = 0; i < a.grid().nx(); ++i) sum += a(i, j, k) * b(i, j, k);
  return sum;
}
inline double sum_of(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return sum;
}

/// Calls use(name, mode) for every mode for spheres; `bodies`: for those that take bodies.
template <class Use>
void for_modes(bool bodies, const Use& use) {
  using Share = Unresolved::Share;
  use("centre", Unresolved{Share::Centre});
  use("satellites", Unresolved{Share::Satellites, 29});
  use("kernel, compact", Kernel{});
  use("kernel, Gaussian", Kernel{Kernel::Form::Gaussian});
  use("two grids, linear", TwoGrid{});
  use("two grids, constant", TwoGrid{3, TwoGrid::Transfer::Constant});
  use("diffusion", Diffusion{});
  if (bodies) return;
  use("exact", Unresolved{});
  use("two grids, exact", TwoGrid{2, TwoGrid::Transfer::Linear, TwoGrid::Share::Exact});
  use("diffusion, exact", Diffusion{4, 2, Diffusion::Share::Exact});
}

/// Boxes of cells with their ends and blocked cells, for spheres of diameter 1.
struct Room {
  const char* name;
  Grid grid;
  bool blocked;
  bool cut = false;

  /// A slanted wall and a pillar; `cut`: of the wall's cells a part is open.
  CellField open() const {
    CellField cells(grid, 1);
    for (int k = 0; k < grid.nz(); ++k)
      for (int j = 0; j < grid.ny(); ++j)
        for (int i = 0; i < grid.nx(); ++i)
          if (i > grid.nx() / 2 && j == grid.ny() / 2)
            cells(i, j, k) = 0;
          else if (cut)
            cells(i, j, k) = std::clamp((3 * i + 2 * k - grid.nx()) / 3.0 + 0.15, 0.0, 1.0);
          else if (3 * i + 2 * k < grid.nx())
            cells(i, j, k) = 0;
    return cells;
  }
};
inline std::vector<Room> rooms() {
  const std::array<bool, 3> walls{}, wraps{true, true, true}, mixed{true, false, false};
  return {{"walls, h = d/2", {{{0, 0, 0}, {6, 5, 4}}, {12, 10, 8}, walls}, false},
          {"periodic, h = d/2", {{{-3, 0, 1}, {4, 5, 5}}, {14, 10, 8}, wraps}, false},
          {"flat cells, periodic in x", {{{0, 0, 0}, {9, 3, 5}}, {9, 6, 2}, mixed}, false},
          {"one cell thick, h = 3 d", {{{0, 0, 0}, {12, 3, 9}}, {4, 1, 3}, wraps}, false},
          {"smaller than kernels", {{{0, 0, 0}, {2, 2, 2}}, {5, 4, 3}, mixed}, false},
          {"blocked cells, walls", {{{0, 0, 0}, {6, 5, 4}}, {12, 11, 8}, walls}, true},
          {"blocked cells, periodic", {{{0, 0, 0}, {7, 5, 6}}, {9, 5, 7}, wraps}, true},
          {"cut cells, walls", {{{0, 0, 0}, {6, 5, 4}}, {12, 11, 8}, walls}, true, true},
          {"cut cells, periodic", {{{0, 0, 0}, {7, 5, 6}}, {9, 5, 7}, wraps}, true, true}};
}

template <class Operator>
void furnish(Operator& op, const Room& room) {
  if (room.blocked) op.open(room.open());
}

/// The sentence of what is refused, or nothing.
template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const silt::InputError& error) {
    return error.what();
  }
  return {};
}
inline bool says(const std::string& sentence, const char* part) {
  return sentence.find(part) != std::string::npos;
}

}  // namespace averaging_test
