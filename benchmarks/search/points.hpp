// silt - BSD-3-Clause, see LICENSE
#pragma once

// Positions of the spheres of the search benchmark. All have a mean diameter of 1 m unless their
// sizes differ, and are in random order.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <vector>

#include <silt/core/position_row.hpp>
#include <silt/core/random.hpp>

namespace bench {

using Rows = std::vector<silt::PositionRow>;

inline double largest_radius(const Rows& rows) {
  double largest = 0;
  for (const auto& row : rows) largest = std::max(largest, row.r);
  return largest;
}

inline void shuffle(Rows& rows, silt::Random& random) {
  for (std::size_t k = rows.size(); k > 1; --k) std::swap(rows[k - 1], rows[random.index(k)]);
}

/// A randomised lattice as dense as a settled bed: solid fraction 0.6, radii +- 10 %.
inline Rows dense_bed(std::size_t n, silt::Random& random) {
  const double spacing = std::cbrt(std::numbers::pi / 6 / 0.6);
  const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(n)) - 1e-9));
  Rows rows;
  for (std::size_t k = 0; k < n; ++k) {
    const auto place = [&](std::size_t i) {
      return spacing * (static_cast<double>(i) + random.uniform(-0.1, 0.1));
    };
    const double x = place(k % side), y = place(k / side % side), z = place(k / side / side);
    rows.push_back({x, y, z, random.uniform(0.45, 0.55)});
  }
  shuffle(rows, random);
  return rows;
}

/// Uniform in a cube of `volume` cubic diameters per sphere.
inline Rows cloud(std::size_t n, double volume, silt::Random& random) {
  const double side = std::cbrt(static_cast<double>(n) * volume);
  Rows rows;
  for (std::size_t k = 0; k < n; ++k)
    rows.push_back({random.uniform(0, side), random.uniform(0, side), random.uniform(0, side),
                    random.uniform(0.45, 0.55)});
  return rows;
}

/// Four narrow streams from the middle of a cube of 1000 cubic diameters per sphere, densest at
/// their origin.
inline Rows jets(std::size_t n, silt::Random& random) {
  const double side = std::cbrt(1e3 * static_cast<double>(n));
  const double width = std::cbrt(static_cast<double>(n) / 4) / 4;
  const silt::Vec3d along[4] = {
      {0.9, 0.1, 0.3}, {-0.5, 0.8, 0.2}, {-0.1, -0.6, 0.7}, {0.2, 0.3, -0.9}};
  Rows rows;
  for (std::size_t k = 0; k < n; ++k) {
    const double t = 0.5 * random.uniform() * random.uniform();
    const double spread = width * (1 + 4 * t);
    const silt::Vec3d p = silt::Vec3d{0.5, 0.5, 0.5} * side + along[k % 4] * (t * side) +
                          silt::Vec3d{random.normal(), random.normal(), random.normal()} * spread;
    rows.push_back({p.x, p.y, p.z, random.uniform(0.45, 0.55)});
  }
  return rows;
}

/// Places spheres of given radii, the largest first, without overlap.
class Packing {
 public:
  Packing(std::vector<double> radii, double solid_fraction, silt::Random& random) {
    std::sort(radii.begin(), radii.end(), std::greater<>());
    double volume = 0;
    for (const double r : radii) volume += 4.0 / 3 * std::numbers::pi * r * r * r;
    side_ = std::cbrt(volume / solid_fraction);
    for (const double r : radii) place(r, random);
    shuffle(rows_, random);
  }
  Rows rows() && { return std::move(rows_); }

 private:
  void place(double r, silt::Random& random) {
    if (grids_.empty() || 2 * r < 0.5 * grids_.back().cell) grids_.push_back({2 * r, {}});
    for (;;) {
      const silt::PositionRow p{random.uniform(0, side_), random.uniform(0, side_),
                                random.uniform(0, side_), r};
      if (!is_free(p)) continue;
      Grid& finest = grids_.back();
      finest.spheres[key(finest, p.x, p.y, p.z)].push_back(p);
      rows_.push_back(p);
      return;
    }
  }
  struct Grid {
    double cell;
    std::unordered_map<std::uint64_t, Rows> spheres;
  };
  static std::uint64_t key(const Grid& g, double x, double y, double z) {
    const auto cell = [&](double c) { return static_cast<std::uint64_t>(c / g.cell + 4); };
    return cell(x) << 42 | cell(y) << 21 | cell(z);
  }
  bool is_free(const silt::PositionRow& p) const {
    for (const Grid& g : grids_) {
      const double reach = p.r + 0.5 * g.cell;
      const auto steps = [&](double c) {
        return static_cast<int>(std::floor((c + reach) / g.cell) -
                                std::floor((c - reach) / g.cell));
      };
      for (int i = 0; i <= steps(p.x); ++i)
        for (int j = 0; j <= steps(p.y); ++j)
          for (int k = 0; k <= steps(p.z); ++k) {
            const auto found = g.spheres.find(key(
                g, p.x - reach + i * g.cell, p.y - reach + j * g.cell, p.z - reach + k * g.cell));
            if (found == g.spheres.end()) continue;
            for (const auto& q : found->second) {
              const double dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, sum = p.r + q.r;
              if (dx * dx + dy * dy + dz * dz < sum * sum) return false;
            }
          }
    }
    return true;
  }

  double side_ = 0;
  std::vector<Grid> grids_;  // the coarsest first: cells as wide as their largest sphere
  Rows rows_;
};

/// A bed of coarse spheres of diameter `ratio`, solid fraction 0.35, with voids full of fines of
/// diameter 1: about n in total.
inline Rows two_sizes(std::size_t n, double ratio, silt::Random& random) {
  const double volume = std::numbers::pi / 6;
  const double fines = 0.6 * 0.65 / volume, coarse = 0.35 / (volume * ratio * ratio * ratio);
  const double side = std::cbrt(static_cast<double>(n) / (fines + coarse));
  Rows rows;
  const auto lattice = [&](double diameter, double fraction, auto&& keep) {
    const auto cells = static_cast<int>(std::ceil(side / diameter * std::cbrt(fraction / volume)));
    const double spacing = side / cells, loose = 0.5 * std::max(spacing - diameter, 0.1 * spacing);
    for (int k = 0; k < cells * cells * cells; ++k) {
      const auto place = [&](int i) { return spacing * (i + 0.5) + random.uniform(-loose, loose); };
      const double x = place(k % cells), y = place(k / cells % cells), z = place(k / cells / cells);
      keep({x, y, z, 0.5 * diameter});
    }
  };
  lattice(ratio, 0.35, [&](const silt::PositionRow& p) { rows.push_back(p); });
  const Rows large = rows;
  const auto across = static_cast<int>(std::ceil(side / ratio * std::cbrt(0.35 / volume)));
  lattice(1, 0.6, [&](const silt::PositionRow& p) {
    const auto cell = [&](double x) { return static_cast<int>(x / side * across); };
    for (int k = 0; k < 27; ++k) {  // the coarse ones in the cells around
      const int i = cell(p.x) + k % 3 - 1, j = cell(p.y) + k / 3 % 3 - 1, l = cell(p.z) + k / 9 - 1;
      if (std::min({i, j, l}) < 0 || std::max({i, j, l}) >= across) continue;
      const auto& q = large[static_cast<std::size_t>((l * across + j) * across + i)];
      if (norm(p.centre() - q.centre()) < 0.5 + q.r) return;
    }
    rows.push_back(p);
  });
  shuffle(rows, random);
  return rows;
}

/// Fragments: diameters d from 1 to `ratio`, with a number above d proportional to d^-2.5 (D. L.
/// Turcotte, J. Geophys. Res. 91 (1986) 1921).
inline Rows fragments(std::size_t n, double ratio, silt::Random& random) {
  std::vector<double> radii;
  const double last = std::pow(ratio, -2.5);
  for (std::size_t k = 0; k < n;
       ++k)  // evenly over the distribution, so that the largest are there
    radii.push_back(
        0.5 * std::pow(1 - (1 - last) * (static_cast<double>(k) + 0.5) / static_cast<double>(n),
                       -1 / 2.5));
  return Packing(std::move(radii), 0.33, random).rows();
}

}  // namespace bench
