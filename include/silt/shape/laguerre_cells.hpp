// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <numeric>
#include <vector>

#include <silt/core/dyn_array.hpp>
#include <silt/core/random.hpp>
#include <silt/shape/power_cells.hpp>
#include <silt/shape/volume_weights.hpp>

/// Divides a convex polyhedron into convex cells of given volumes, which fill it.
///
/// The cells are those of a power diagram (power_cells.hpp). Sites are random, the largest share
/// first. Among some random points it takes the first whose ball, with a volume proportional to the
/// share, fits between the balls already placed and the faces, or else the one that comes closest.
/// Then the volumes are fitted (volume_weights.hpp) and sites move to the centroids of their cells,
/// `rounding` times, which makes the cells rounder. Finally the volumes are fitted to rounding.
///
/// Sources: F. Aurenhammer, F. Hoffmann, B. Aronov, Algorithmica 20 (1998) 61-76: for all sites
///          there are weights that give the volumes; sites at the centroids: S. P. Lloyd, IEEE
///          Trans. Inf. Theory 28 (1982) 129-137, in the order of F. de Goes et al., ACM Trans.
///          Graph. 31 (2012) 171, sec. 4. Accuracy: volumes to 1e-13 of the body's. Shared corners
///          have the same numbers in all cells. Sites are drawn again if an edge would be shorter
///          than 1e-7 of a cell's diagonal, or if a cell's convex hull would lose a corner or a
///          face. If ten draws do not avoid this (the body itself has such features), the merging
///          of the hull is accepted: corners within 1e-9 of the cell's diagonal, faces within 1e-8.
///          The sum of volumes then errs by up to 1e-8 d times the area of the cells.
/// Valid:   2 to 4000 cells (the cost is cubic in their number), shares of at least 1e-9. Only
///          sharp bodies: dilated ones cannot fill a body without overlap.
/// Units:   [m], [m3].
/// Errors:  InputError for shares that are too small or do not sum to 1, for dilated bodies, and if
///          forty draws of sites give no cells of these volumes.
/// Tests:   tests/shape/laguerre_cells.cpp

namespace silt::inline SILT_TARGET {

/// Options of laguerre_cells().
struct LaguerreOptions {
  int rounding = 2;  // [-] times that sites move to the centroids of their cells
};

namespace detail {

/// Random points with uniform density in a polyhedron.
class PointsInside {
 public:
  explicit PointsInside(const Polyhedron& body) : triangles_(body.triangles()) {
    for (const auto& v : body.vertices()) middle_ += v;
    middle_ *= 1 / static_cast<double>(body.vertices().size());
    double sum = 0;
    for (const auto& [a, b, c] : triangles_)
      up_to_.push_back(sum += dot(a - middle_, cross(b - middle_, c - middle_)));
  }
  /// Chooses a tetrahedron by its volume, and in it a point by folding the cube (C. Rocchini, P.
  /// Cignoni, J. Graphics Tools 5 (2000) 9-12).
  Vec3d draw(Random& random) const {
    const auto at =
        std::lower_bound(up_to_.begin(), up_to_.end(), random.uniform() * up_to_.back());
    const auto& [a, b, c] = triangles_[static_cast<std::size_t>(at - up_to_.begin())];
    double s = random.uniform(), t = random.uniform(), u = random.uniform();
    if (s + t > 1) s = 1 - s, t = 1 - t;
    if (const double old = u; t + u > 1)
      u = 1 - s - t, t = 1 - old;
    else if (s + t + u > 1)
      u = s + t + u - 1, s = 1 - t - old;
    return middle_ + s * (a - middle_) + t * (b - middle_) + u * (c - middle_);
  }

 private:
  DynArray<std::array<Vec3d, 3>> triangles_;
  DynArray<double> up_to_;  // six times the cumulative volume of the tetrahedra from the middle
  Vec3d middle_{0, 0, 0};
};

/// Sites for `volume`s [m3], weighted by the squares of radii of balls that do not overlap. The
/// part of a site's ball inside the body is in its cell, hence no cell is empty.
inline PowerSites draw_sites(const Polyhedron& body, const PointsInside& inside,
                             const DynArray<double>& volume, Random& random) {
  constexpr double filled = 0.3;  // share of the body filled by balls
  constexpr int tries = 20;
  DynArray<std::size_t> order(volume.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](auto i, auto j) { return volume[i] > volume[j]; });
  PowerSites sites{DynArray<Vec3d>(volume.size()), DynArray<double>(volume.size())};
  DynArray<double> radius(volume.size());
  double shrink = 1;
  for (std::size_t n = 0; n < order.size(); ++n) {
    const std::size_t i = order[n];
    radius[i] = std::cbrt(filled * 3 / (4 * std::numbers::pi) * volume[i]);
    double best = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < tries && best < 0; ++k) {
      const Vec3d x = inside.draw(random);
      double room = std::numeric_limits<double>::infinity();  // beside all others
      for (const auto& face : body.faces())
        room = std::min(room, face.offset - dot(face.normal, x));
      for (std::size_t m = 0; m < n; ++m)
        room = std::min(room, norm(sites.at[order[m]] - x) - radius[order[m]]);
      if (room - radius[i] > best) best = room - radius[i], sites.at[i] = x;
    }
    for (std::size_t m = 0; m < n; ++m)
      shrink =
          std::min(shrink, norm(sites.at[order[m]] - sites.at[i]) / (radius[i] + radius[order[m]]));
  }
  for (std::size_t i = 0; i < volume.size(); ++i)
    sites.weight[i] = shrink * shrink * radius[i] * radius[i];
  return sites;
}

/// Cells of one draw of sites. None if their volumes are not found, a cell is flat to rounding, or
/// a cell is not clean (CellForms) as required.
inline std::optional<std::vector<Polyhedron>> draw_cells(
    const Polyhedron& body, const PointsInside& inside, const DynArray<double>& volume,
    Random& random, const LaguerreOptions& options, bool must_be_clean) {
  constexpr double rough = 0.03;  // [-] sufficient error of volumes for moving sites
  VolumeWeights fit(body, volume);
  PowerSites sites = draw_sites(body, inside, volume, random);
  for (int k = 0; k < options.rounding; ++k) {
    if (!fit.fit(sites, rough)) return {};
    for (std::size_t i = 0; i < volume.size(); ++i) sites.at[i] = fit.cells().cells()[i].centroid;
  }
  if (!fit.fit(sites)) return {};
  CellForms forms(volume.size());
  std::vector<Polyhedron> out;
  try {
    for (std::size_t i = 0; i < volume.size(); ++i) {
      auto form = forms.form(*fit.cells().cut(sites, i), i, must_be_clean);
      if (!form) return {};
      out.push_back(*std::move(form));
    }
  } catch (const InputError&) {  // flat to rounding
    return {};
  }
  return out;
}

inline DynArray<double> volumes_of_shares(const Polyhedron& body, std::span<const double> shares) {
  constexpr double least = 1e-9;
  require(body.radius() == 0, "laguerre_cells: the body is dilated by ", body.radius(),
          " [m]; only sharp polyhedra are filled by convex cells without overlap: give a "
          "Polyhedron of radius 0");
  require(!shares.empty() && shares.size() <= Polyhedron::most_faces,
          "laguerre_cells: ", shares.size(), " shares given; from 1 to ", Polyhedron::most_faces,
          " are possible");
  double sum = 0;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    require(shares[k] >= least && shares[k] <= 1 + 1e-9, "laguerre_cells: share ", k,
            " (counted from 0) is ", shares[k], " [-]; it must be from ", least, " to 1");
    sum += shares[k];
  }
  require(std::abs(sum - 1) <= 1e-9, "laguerre_cells: the ", shares.size(), " shares are ", sum,
          " [-] in sum; they must be 1 (to 1e-9): divide them by their sum");
  DynArray<double> volume(shares.begin(), shares.end());
  for (double& v : volume) v *= body.core_volume() / sum;
  return volume;
}

}  // namespace detail

/// Cells with these shares [-] of the body's volume, in the same order, with corners in the frame
/// of the body. The same state of `random` gives the same cells.
inline std::vector<Polyhedron> laguerre_cells(const Polyhedron& body,
                                              std::span<const double> shares, Random& random,
                                              const LaguerreOptions& options = {}) {
  constexpr int most_draws = 40, clean_draws = 10;
  const auto volume = detail::volumes_of_shares(body, shares);
  if (volume.size() == 1) return {body};
  const detail::PointsInside inside(body);
  std::optional<std::vector<Polyhedron>> cells;
  for (int draw = 0; draw < most_draws && !cells; ++draw)
    cells = detail::draw_cells(body, inside, volume, random, options, draw < clean_draws);
  require(cells.has_value(), "laguerre_cells: ", most_draws, " draws of sites gave no ",
          volume.size(), " cells of the required volumes in a body of ", body.faces().size(),
          " faces and ", body.core_volume(),
          " [m3]; give fewer or less different shares, or a less flat body");
  return *std::move(cells);
}

}  // namespace silt
