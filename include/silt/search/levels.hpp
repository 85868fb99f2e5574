// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/search/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Grids of a search for spheres of different sizes, coarsest first.
///
///   Levels{}                 as many as reduce the time, with cells that match the sizes
///   one_level                one grid for all
///   sub_grid(0.2)            one additional grid for small spheres, with cells 0.2 times as wide
///   Levels{.ratio = 0.5, .most = 8}    cells half as wide as those of the level before
///
/// A sphere belongs to the finest grid whose cells are at least as wide as its cutoff, 2 r + reach.
/// Errors: InputError for a ratio outside (0, 1] or most = 0.
/// Source: sub-grid: T. Brosh, H. Kalman, A. Levy, Particuology 12 (2014) 113, whose best ratio is
/// 1/5; levels for all sizes: V. Ogarko, S. Luding, Comput. Phys. Commun. 183 (2012) 931.
struct Levels {
  std::optional<double> ratio = {};  // [-] of cell widths; left out: chosen from the sizes
  std::size_t most = 16;             // [-] levels

  void check() const {
    if (ratio)
      require(*ratio > 0 && *ratio <= 1, "Levels.ratio = ", *ratio, " [-] must be in (0, 1]");
    require(most >= 1 && most <= 64, "Levels.most = ", most, " must be in [1, 64]");
  }
};
/// One grid for all sizes.
inline constexpr Levels one_level{.ratio = {}, .most = 1};
/// One additional grid for small spheres, with cells `ratio` [-] times as wide as the others.
constexpr Levels sub_grid(double ratio) { return {.ratio = ratio, .most = 2}; }

namespace detail {

/// Numbers of spheres by cutoff, eight classes per octave, smallest first.
class CutoffHistogram {
 public:
  struct Class {
    std::size_t count = 0;
    double largest = 0;  // [m] cutoff
  };

  CutoffHistogram(const SphereSet& spheres, double reach, double smallest, const Team& team)
      : base_(octaves(smallest)) {
    const std::size_t size =
        std::min(octaves(2 * spheres.largest_radius + reach) - base_ + 1, most);
    const std::size_t parts = static_cast<std::size_t>(std::min(team.threads(), 8)),
                      n = spheres.rows.size();
    DynArray<Class> of(parts * size);
    team.for_parts(parts, [&](std::size_t part) {
      for (std::size_t k = n * part / parts; k < n * (part + 1) / parts; ++k) {
        const double cutoff = 2 * spheres.rows[k].r + reach;
        Class& c = of[part * size + std::min(octaves(cutoff) - base_, size - 1)];
        ++c.count, c.largest = std::max(c.largest, cutoff);
      }
    });
    for (std::size_t k = 0; k < size; ++k) {
      Class sum;
      for (std::size_t part = 0; part < parts; ++part) {
        const Class& c = of[part * size + k];
        sum.count += c.count, sum.largest = std::max(sum.largest, c.largest);
      }
      if (sum.count > 0) classes_.push_back(sum);
    }
  }
  const DynArray<Class>& classes() const { return classes_; }

 private:
  static constexpr std::size_t most = 512;
  /// Eighths of an octave: exponent and the first three binary digits.
  static std::size_t octaves(double cutoff) { return std::bit_cast<std::uint64_t>(cutoff) >> 49; }

  std::size_t base_;
  DynArray<Class> classes_;
};

// Time of a search [ns], fitted to benchmarks/search; affects only the speed.
inline constexpr double own_level_cost = 30;  // per sphere with few spheres around it

struct AcrossLevels {
  double coarse_look, fines_look;  // [ns]
};
/// Time to find the pairs between two levels: if coarse spheres test all rows of fine spheres in
/// reach, and if fine spheres test the coarse cells around them.
inline AcrossLevels across_levels(double coarse, double coarse_cutoff, double fines,
                                  double fine_cutoff) {
  constexpr double a_row = 22, a_fine = 100;
  const double layers = (coarse_cutoff + fine_cutoff) / fine_cutoff + 1;
  return {coarse * layers * layers * a_row, fines * a_fine};
}

/// Divides size classes into at most `most` levels with about the least search time; returns the
/// largest cutoff of each, coarsest first.
///
/// In a bed of volume V a sphere tests some 10 n v/V others of a level of n spheres and cells of
/// volume v. Dynamic programming: the best partitions of the smaller classes are extended by one
/// level.
inline DynArray<double> cheapest_levels(const DynArray<CutoffHistogram::Class>& classes,
                                        double reach, std::size_t most) {
  constexpr double least = 20, base = 10, look = 5;  // [ns] per sphere; 10 others take one `look`
  constexpr double volume_a_cube = 1.1;              // of a bed: of the cube around a sphere
  const std::size_t n = classes.size();
  double volume = 0;                 // [m3]
  DynArray<double> finer(n + 1, 0);  // spheres of smaller classes
  for (std::size_t k = 0; k < n; ++k) {
    const double d = classes[k].largest - reach, count = static_cast<double>(classes[k].count);
    volume += volume_a_cube * count * d * d * d;
    finer[k + 1] = finer[k] + count;
  }
  volume = std::max(volume, std::numeric_limits<double>::min());
  // best(l, k): classes 0 ... k-1 in at most l + 1 levels; the last of these begins at `cut`.
  struct Best {
    double cost = std::numeric_limits<double>::infinity();
    std::size_t cut = 0;
  };
  most = std::min(most, n);
  DynArray<Best> all(most * (n + 1));
  const auto best = [&](std::size_t l, std::size_t k) -> Best& { return all[l * (n + 1) + k]; };
  const double level_cost = 2000 + finer[n];  // [ns] minimum gain of another level
  const auto own_cost = [&](std::size_t from, std::size_t to) {
    const double spheres = finer[to] - finer[from], e = classes[to - 1].largest;
    const double around = std::min(spheres * e * e * e / volume, spheres / 10);
    return level_cost + spheres * std::max(least, base + look * around);
  };
  const auto across = [&](std::size_t from, std::size_t to, std::size_t l) {
    double sum = 0;
    for (std::size_t end = from; end > 0; end = best(l, end).cut, l -= l > 0) {
      const auto cost =
          across_levels(finer[to] - finer[from], classes[to - 1].largest,
                        finer[end] - finer[best(l, end).cut], classes[end - 1].largest);
      sum += std::min(cost.coarse_look, cost.fines_look);
    }
    return sum;
  };
  for (std::size_t l = 0; l < most; ++l)
    for (std::size_t k = 1; k <= n; ++k) {
      best(l, k) = {own_cost(0, k), 0};
      for (std::size_t c = 1; l > 0 && c < k; ++c)
        if (const double sum = best(l - 1, c).cost + own_cost(c, k) + across(c, k, l - 1);
            sum < best(l, k).cost)
          best(l, k) = {sum, c};
    }
  DynArray<double> cutoffs;
  for (std::size_t k = n, l = most - 1; k > 0; k = best(l, k).cut, l -= l > 0)
    cutoffs.push_back(classes[k - 1].largest);
  return cutoffs;
}

/// Cutoffs [m] of the levels, coarsest first.
inline DynArray<double> choose_levels(const SphereSet& spheres, double reach, const Levels& levels,
                                      const Team& team) {
  const double largest = 2 * spheres.largest_radius + reach;  // [m]
  DynArray<double> cutoffs{largest};
  if (levels.most == 1 || spheres.rows.empty()) return cutoffs;
  std::array<double, Team::most_ranges> smallest_of;
  smallest_of.fill(largest);
  team.for_ranges(spheres.rows.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k)
      smallest_of[r] = std::min(smallest_of[r], 2 * spheres.rows[k].r + reach);
  });
  const double smallest =
      std::max(*std::min_element(smallest_of.begin(), smallest_of.end()), 1e-9 * largest);
  if (levels.ratio) {
    for (double next = largest * *levels.ratio;
         cutoffs.size() < levels.most && next >= smallest && *levels.ratio < 1;
         next *= *levels.ratio)
      cutoffs.push_back(next);
    return cutoffs;
  }
  if (smallest > 0.7 * largest) return cutoffs;
  const CutoffHistogram sizes(spheres, reach, smallest, team);
  cutoffs = cheapest_levels(sizes.classes(), reach, levels.most);
  cutoffs[0] = largest;
  return cutoffs;
}

}  // namespace detail
}  // namespace silt
