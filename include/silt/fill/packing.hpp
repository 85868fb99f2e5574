// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/random.hpp>
#include <silt/fill/region.hpp>
#include <silt/fill/size_distribution.hpp>

namespace silt::inline SILT_TARGET {

/// A sphere placed by pack().
struct PlacedSphere {
  Vec3d position;  // [m]
  double radius;   // [m]
};

/// Spheres that occupy space, sorted into cells for fast overlap tests. Each factor of two in size
/// has its own cells: a size ratio of 1:20 costs no more than 1:1.
class SphereGrid {
 public:
  void insert(const PlacedSphere& sphere) {
    const auto& [position, radius] = sphere;
    require(is_finite(position) && std::isfinite(radius) && radius > 0, "a sphere of radius ",
            radius, " [m] at ", position,
            " [m] cannot be an obstacle: both must be finite, the "
            "radius greater than 0");
    auto& level = level_of(sphere.radius);
    if (level.heads.size() <= level.spheres.size()) level.rehash(2 * level.heads.size() + 64);
    level.largest = std::max(level.largest, sphere.radius);
    level.spheres.push_back(sphere);
    level.next.push_back(none);
    level.link(static_cast<std::uint32_t>(level.spheres.size() - 1));
  }

  /// Whether a sphere here has at least the distance `gap` [m] between its surface and all others.
  bool is_free(const Vec3d& centre, double radius, double gap = 0) const {
    return std::all_of(levels_.begin(), levels_.end(),
                       [&](const Level& level) { return level.is_free(centre, radius + gap); });
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  using Cell = std::array<std::int64_t, 3>;

  struct Level {
    double cell = 0;     // [m]
    double largest = 0;  // radius [m]
    DynArray<PlacedSphere> spheres;
    DynArray<std::uint32_t> next;   // for each sphere: the next one with the same hash, or none
    DynArray<std::uint32_t> heads;  // for each hash: a sphere, or none

    Cell cell_of(const Vec3d& p) const {
      // The bound keeps the cast defined; it merges far cells, which only costs time.
      const auto along = [&](double x) {
        return static_cast<std::int64_t>(std::clamp(std::floor(x / cell), -1e15, 1e15));
      };
      return {along(p.x), along(p.y), along(p.z)};
    }
    std::size_t hash(const Cell& c) const {
      const auto mixed = static_cast<std::uint64_t>(c[0]) * 0x9e3779b97f4a7c15u ^
                         static_cast<std::uint64_t>(c[1]) * 0xc2b2ae3d27d4eb4fu ^
                         static_cast<std::uint64_t>(c[2]) * 0x165667b19e3779f9u;
      return ((mixed >> 32) ^ mixed) % heads.size();
    }
    void link(std::uint32_t i) {
      auto& head = heads[hash(cell_of(spheres[i].position))];
      next[i] = head;
      head = i;
    }
    void rehash(std::size_t size) {
      heads.assign(size, none);
      for (std::uint32_t i = 0; i < spheres.size(); ++i) link(i);
    }
    static bool apart(const PlacedSphere& s, const Vec3d& centre, double reach) {
      const Vec3d d = s.position - centre;
      return dot(d, d) >= (s.radius + reach) * (s.radius + reach);
    }
    bool is_free(const Vec3d& centre, double reach) const {
      const double far = reach + largest;
      const Cell lo = cell_of(centre - Vec3d{far, far, far});
      const Cell hi = cell_of(centre + Vec3d{far, far, far});
      double cells = 1;
      for (int k = 0; k < 3; ++k) cells *= static_cast<double>(hi[k] - lo[k] + 1);
      if (cells > static_cast<double>(spheres.size())) {
        return std::all_of(spheres.begin(), spheres.end(),
                           [&](const auto& s) { return apart(s, centre, reach); });
      }
      for (auto x = lo[0]; x <= hi[0]; ++x)
        for (auto y = lo[1]; y <= hi[1]; ++y)
          for (auto z = lo[2]; z <= hi[2]; ++z)
            for (auto i = heads[hash({x, y, z})]; i != none; i = next[i])
              if (!apart(spheres[i], centre, reach)) return false;
      return true;
    }
  };

  Level& level_of(double radius) {
    const double cell = std::exp2(std::ceil(std::log2(radius)) + 1);  // in [2 radius, 4 radius)
    for (auto& level : levels_)
      if (level.cell == cell) return level;
    levels_.emplace_back().cell = cell;
    return levels_.back();
  }

  DynArray<Level> levels_;
};

/// One sphere to be placed.
struct Placement {
  double radius;              // [m]
  double gap = 0;             // [m] smallest distance to the surfaces of others
  std::size_t trials = 1000;  // [-] occupied places tried before giving up
};

namespace detail {

/// Region of the centre of a sphere inside `bounds`; in a gap too narrow for it, its middle.
inline Box room_for_centres(const Box& bounds, double radius) {
  Box room = bounds.grown(-radius);
  const Vec3d middle = bounds.centre();
  if (room.min.x > room.max.x) room.min.x = room.max.x = middle.x;
  if (room.min.y > room.max.y) room.min.y = room.max.y = middle.y;
  if (room.min.z > room.max.z) room.min.z = room.max.z = middle.z;
  return room;
}

}  // namespace detail

/// Random free place for one sphere completely inside `region`, uniform among the free places.
/// Empty if `trials` places were occupied, or if almost no point of the region's bounds is far
/// enough from its surface. For an inlet: keep the spheres near the region in a SphereGrid, and
/// insert each sphere that is placed; any type with its is_free() is suitable.
template <Region R, class Occupied>
std::optional<Vec3d> try_place(const R& region, const Occupied& occupied, const Placement& sphere,
                               Random& random) {
  require_positive("Placement.radius", sphere.radius, "m");
  require_not_negative("Placement.gap", sphere.gap, "m");
  const auto& place = region_of(region);
  const Box bounds = place.bounds();
  const Box room = detail::room_for_centres(bounds, sphere.radius);
  // A slender region fills little of its bounds: points outside it do not count as trials.
  const double per_trial = std::min(1e3, 10 * bounds.volume() / place.volume());
  const double draws = static_cast<double>(sphere.trials) * per_trial;
  std::size_t trials = 0;
  for (double draw = 0; draw < draws && trials < sphere.trials; ++draw) {
    Vec3d centre;
    centre.x = random.uniform(room.min.x, room.max.x);
    centre.y = random.uniform(room.min.y, room.max.y);
    centre.z = random.uniform(room.min.z, room.max.z);
    if (!occupied.is_free(centre, sphere.radius, sphere.gap))
      ++trials;
    else if (place.fits(centre, sphere.radius))  // last, as it can be expensive
      return centre;
  }
  return std::nullopt;
}

enum class Arrangement { Random, Lattice };

/// The count of a request that leaves it out.
inline constexpr std::size_t as_many_as_fit = std::numeric_limits<std::size_t>::max();

/// Request for a filling. Give `count` or `solid_volume`, or neither for as many as fit.
///
/// Lattice: hexagonal close packing for the largest sphere drawn plus gap, with 5 % larger spacing;
///   every sphere is displaced at random within its free space. Filled from below (+z up), with
///   the sizes in random order. Of the six orientations of the lattice along the axes it uses the
///   one with most sites, which suits layers one sphere thick. Loose for wide distributions.
/// Random: random sequential addition, the largest first (in the order drawn if as many as fit are
///   requested, which preserves the size distribution), until `trials` places in a row were
///   occupied.
///
/// Solid fraction that fits into a box of 30 mean diameters (in brackets: of 10):
///   radii                   one size      uniform 0.8 to 1.2   uniform 1:5    spheres per second
///   Lattice                 0.59 (0.52)   0.35 (0.29)          0.17 (0.14)    7e6
///   Random, 10 000 trials   0.31 (0.29)   0.38 (0.37)          0.47 (0.44)    3e4 near its limit
/// One size reaches 0.64 far from walls on the lattice, and at most 0.384 by random addition.
///
/// Lattice is the default: its time is proportional to the count, it never stops before its sites
/// are used, and beds of nearly one size start close to their settled height. Spheres of exactly
/// one size keep part of its order as they settle; if this is a problem, use Random or vary the
/// sizes by some per cent.
struct FillRequest {
  SizeDistribution radius;             // [m]
  std::size_t count = as_many_as_fit;  // [-] number of spheres
  double solid_volume = 0;             // [m3] of all spheres; 0: not used
  Arrangement arrangement = Arrangement::Lattice;
  double gap = 0;              // [m] smallest distance between surfaces of spheres
  std::uint64_t seed = 1;      // same seed, same spheres
  std::size_t trials = 10000;  // [-] Random: failed trials before it stops
};

/// Result of pack().
struct FillResult {
  DynArray<PlacedSphere> spheres;
  std::size_t requested = 0;  // [-] requested spheres (drawn, for a given solid volume)
  std::string why_not_more;   // a sentence; empty if the request was met
};

namespace detail {

/// `of`: the structure that the radius is a member of.
inline void require_radius(const char* of, const SizeDistribution& radius) {
  require(radius.is_given(), of,
          ".radius is not given: spheres have no size of their own; give a radius [m], or a size "
          "distribution such as uniform(1e-3, 2e-3)");
}

/// Rows are numbered by 32 bits. A region that would take more spheres is most often given in mm.
inline void check_number(const FillRequest& request, double volume) {
  if (request.count != as_many_as_fit) return;
  const double solid = request.solid_volume > 0 ? std::min(request.solid_volume, volume) : volume;
  const double number = solid / request.radius.mean_volume();
  constexpr double most = std::numeric_limits<std::uint32_t>::max();
  require(number < most, "FillRequest: its region of ", readable(volume), " m3 has the volume of ",
          readable(number), " spheres of the given radius, more than a simulation can hold (",
          readable(most), "); are lengths in mm? Give the region in m, or a count");
}
/// A count of 0 is a mistake: often of a program that computes it, or it was meant as "no limit".
inline void require_count(const char* of, std::size_t count) {
  require(count != 0, of,
          ".count = 0 [-] must be at least 1; leave it out for as many as fit, and leave out the "
          "call for none");
  require(count == as_many_as_fit || count < (as_many_as_fit >> 1), of, ".count = ", count,
          " [-] is a negative number that was converted; it must be at least 1");
}

template <class R>
void check(const R& place, const FillRequest& request) {
  require_radius("FillRequest", request.radius);
  require_count("FillRequest", request.count);
  require_not_negative("FillRequest.gap", request.gap, "m");
  require_not_negative("FillRequest.solid_volume", request.solid_volume, "m3");
  require(request.trials > 0, "FillRequest.trials = 0 [-] must be at least 1");
  require(request.count == as_many_as_fit || request.solid_volume == 0,
          "FillRequest.count = ", request.count,
          " and FillRequest.solid_volume = ", request.solid_volume,
          " [m3] are both given; give one of them and leave out the other");
  const Box b = place.bounds();
  require(is_finite(b.min) && is_finite(b.max) && b.min.x < b.max.x && b.min.y < b.max.y &&
              b.min.z < b.max.z && std::isfinite(place.volume()) && place.volume() > 0,
          "cannot fill ", place.describe(),
          ": it must have finite bounds and enclose a volume greater than 0");
  const double least = sphere_volume(request.radius.min());
  require(request.solid_volume == 0 || request.solid_volume >= least,
          "FillRequest.solid_volume = ", request.solid_volume,
          " [m3] is less than the smallest sphere, of ", least, " m3");
}

/// Radii to place, in random order; their volume does not exceed that of the region by much,
/// whatever was requested.
inline DynArray<double> draw_radii(const FillRequest& request, double region_volume,
                                   Random& random) {
  const bool by_volume = request.solid_volume > 0;
  const double wanted = by_volume ? std::min(request.solid_volume, region_volume) : region_volume;
  DynArray<double> radii;
  for (double sum = 0; sum < wanted && radii.size() < request.count;) {
    const double radius = request.radius.sample(random), volume = sphere_volume(radius);
    // Stops on the side of the requested volume that is nearer.
    if (by_volume && !radii.empty() && sum + volume - wanted > wanted - sum) break;
    sum += volume;
    radii.push_back(radius);
  }
  return radii;
}

/// Hexagonal close packing of points at least `spacing` apart in the box `room`, stretched sideways
/// to its walls. Points have integer coordinates in units of spacing times 1/2 along a row,
/// sqrt(3)/6 from row to row (3 per row), sqrt(2/3) from layer to layer.
struct HexagonalLattice {
  std::array<int, 3> axis{};           // axes (0 x, 1 y, 2 z) of row, step and stack
  std::array<std::int64_t, 3> last{};  // largest integer coordinate along x, y, z
  std::array<double, 3> start{}, unit{};

  HexagonalLattice(const Box& room, double spacing) {
    static constexpr std::array<int, 3> orders[] = {{0, 1, 2}, {1, 0, 2}, {0, 2, 1},
                                                    {2, 0, 1}, {1, 2, 0}, {2, 1, 0}};
    const std::array<double, 3> steps{spacing / 2, spacing * std::sqrt(3.0) / 6,
                                      spacing * std::sqrt(2.0 / 3)};
    const Vec3d e = room.extent();
    const std::array<double, 3> extent{e.x, e.y, e.z}, low{room.min.x, room.min.y, room.min.z};
    double most = 0;
    for (const auto& order : orders) {
      std::array<double, 3> steps_in{};
      for (int k = 0; k < 3; ++k)
        steps_in[k] = std::min(std::floor(extent[order[k]] / steps[k] + 1e-9), 1e15);
      const double points = count(steps_in[0], steps_in[1], steps_in[2]);
      if (points <= most) continue;
      most = points;
      axis = order;
      for (int k = 0; k < 3; ++k) {
        const int d = order[k];
        last[d] = static_cast<std::int64_t>(steps_in[k]);
        const bool stretch = d != 2 && last[d] > 0;
        unit[d] = stretch ? extent[d] / steps_in[k] : steps[k];
        start[d] = low[d] + (d != 2 && last[d] == 0 ? extent[d] / 2 : 0);
      }
    }
  }

  /// Calls `visit(point)` at every point from below to above until it returns false.
  template <class Visit>
  void for_each(const Visit& visit) const {
    std::array<std::int64_t, 3> c{};
    for (c[2] = 0; c[2] <= last[2]; ++c[2])
      for (c[1] = 0; c[1] <= last[1]; ++c[1])
        for (c[0] = 0; c[0] <= last[0]; ++c[0]) {
          if (!is_point(c[axis[0]], c[axis[1]], c[axis[2]])) continue;
          const auto along = [&](int d) { return start[d] + unit[d] * static_cast<double>(c[d]); };
          if (!visit(Vec3d{along(0), along(1), along(2)})) return;
        }
  }

 private:
  /// Layers A B A B ...; a B layer is displaced by one unit of `step` and one of `row` from an A
  /// layer.
  static bool is_point(std::int64_t row, std::int64_t step, std::int64_t stack) {
    const std::int64_t shift = stack % 2;
    return (step - shift) % 3 == 0 && (row - (step - shift) / 3 - shift) % 2 == 0;
  }
  static double count(double row, double step, double stack) {
    const double even = std::floor(row / 2) + 1, odd = std::floor((row + 1) / 2);
    const double rows_a = std::floor(step / 3) + 1, rows_b = std::floor((step + 2) / 3);
    const double a = std::ceil(rows_a / 2) * even + std::floor(rows_a / 2) * odd;
    const double b = std::ceil(rows_b / 2) * odd + std::floor(rows_b / 2) * even;
    return (std::floor(stack / 2) + 1) * a + std::floor((stack + 1) / 2) * b;
  }
};

/// Random point of the ball of `radius` around the origin, uniformly distributed.
inline Vec3d point_in_ball(double radius, Random& random) {
  for (;;) {
    Vec3d p;
    p.x = random.uniform(-1, 1);
    p.y = random.uniform(-1, 1);
    p.z = random.uniform(-1, 1);
    if (dot(p, p) <= 1) return p * radius;
  }
}

template <class R>
DynArray<PlacedSphere> pack_lattice(const R& place, const FillRequest& request,
                                    std::span<const double> radii, double spacing,
                                    const SphereGrid& occupied, Random& random) {
  const double largest = *std::max_element(radii.begin(), radii.end());
  const HexagonalLattice lattice(room_for_centres(place.bounds(), largest), spacing);
  DynArray<PlacedSphere> placed;
  lattice.for_each([&](const Vec3d& site) {
    const double radius = radii[placed.size()];
    // Two neighbours that approach by this each still keep the gap (0.999: rounding).
    const double free = 0.999 * ((spacing - request.gap) / 2 - radius);
    for (int trial = 0; trial < 8; ++trial) {
      const Vec3d centre = trial == 7 ? site : site + point_in_ball(free, random);
      if (!occupied.is_free(centre, radius, request.gap) || !place.fits(centre, radius)) continue;
      placed.push_back({centre, radius});
      break;
    }
    return placed.size() < radii.size();
  });
  return placed;
}

template <class R>
DynArray<PlacedSphere> pack_random(const R& place, const FillRequest& request,
                                   std::span<const double> radii, SphereGrid& occupied,
                                   Random& random) {
  DynArray<PlacedSphere> placed;
  for (const double radius : radii) {
    const auto centre = try_place(
        place, occupied, {.radius = radius, .gap = request.gap, .trials = request.trials}, random);
    if (!centre) break;
    placed.push_back({*centre, radius});
    occupied.insert(placed.back());
  }
  return placed;
}

/// Four significant digits of x > 0, for messages.
inline double rounded(double x) {
  const double scale = std::pow(10.0, 3 - std::floor(std::log10(x)));
  return std::round(x * scale) / scale;
}

/// Message for a request that was only partly met; `next` is the first radius not placed.
template <class R>
[[gnu::cold]] std::string why_not_more(const R& place, const FillRequest& request,
                                       const FillResult& result, double next, double spacing) {
  double solid = 0;
  for (const auto& s : result.spheres) solid += sphere_volume(s.radius);
  const double fraction = std::round(1e3 * solid / place.volume()) / 1e3;
  const auto sentence =
      text(result.spheres.size(), " of ", result.requested, " spheres fitted into ",
           place.describe(), " (solid fraction ", fraction, "): ");
  const Vec3d e = place.bounds().extent();
  if (2 * next > std::min({e.x, e.y, e.z}))
    return text(sentence, "the next one, of diameter ", rounded(2 * next),
                " [m], is wider than its bounds of ", e,
                " [m]; use a larger region or smaller spheres");
  if (request.arrangement == Arrangement::Random)
    return text(sentence, request.trials, " trials in a row found no free place for the radius ",
                rounded(next),
                " [m]; ask for fewer, use a larger region, more trials, or, for "
                "nearly one size, Arrangement::Lattice, which packs more densely");
  return text(sentence, "the lattice has no more free sites, which are ", rounded(spacing),
              " [m] apart; ask for fewer, use a larger region, or, if sizes differ much, "
              "Arrangement::Random, which puts small spheres between large ones");
}

}  // namespace detail

/// Places spheres completely inside `region`, without overlap among themselves or with the existing
/// ones, `already`. Never places one that does not fit: if fewer fit than requested, `why_not_more`
/// gives the reason, and the caller decides whether that is an error.
/// Errors: InputError naming the field for invalid values.
template <Region R>
FillResult pack(const R& region, const FillRequest& request,
                std::span<const PlacedSphere> already = {}) {
  const auto& place = region_of(region);
  detail::check(place, request);
  detail::check_number(request, place.volume());
  Random random(request.seed);
  auto radii = detail::draw_radii(request, place.volume(), random);
  SphereGrid occupied;
  for (const auto& sphere : already) occupied.insert(sphere);

  const bool all_that_fit = request.count == as_many_as_fit && request.solid_volume == 0;
  const double largest = *std::max_element(radii.begin(), radii.end());
  const double spacing = 1.05 * (2 * largest + request.gap);  // [m] between lattice sites
  FillResult result;
  if (request.arrangement == Arrangement::Lattice) {
    result.spheres = detail::pack_lattice(place, request, radii, spacing, occupied, random);
  } else {
    if (!all_that_fit) std::sort(radii.begin(), radii.end(), std::greater<>());
    result.spheres = detail::pack_random(place, request, radii, occupied, random);
  }
  const std::size_t placed = result.spheres.size();
  if (request.count != as_many_as_fit) {
    result.requested = request.count;
  } else if (all_that_fit) {
    result.requested = std::max<std::size_t>(placed, 1);  // none at all also needs a message
  } else if (request.solid_volume <= place.volume()) {
    result.requested = radii.size();
  } else {  // not all were drawn
    const double expected = request.solid_volume / request.radius.mean_volume();
    result.requested = static_cast<std::size_t>(std::min(std::round(expected), 1e18));
  }
  if (placed < result.requested) {
    const double next = radii[std::min(placed, radii.size() - 1)];
    result.why_not_more = detail::why_not_more(place, request, result, next, spacing);
  }
  return result;
}

}  // namespace silt
