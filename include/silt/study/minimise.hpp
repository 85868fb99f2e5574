// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <silt/core/eigen.hpp>

/// Simplex search and quasi-random points, used to search surrogates.
namespace silt::inline SILT_TARGET::detail {

/// Smallest value of `f` found by the Nelder-Mead simplex from `start` in a box. The simplex moves
/// in angles t, x = middle + half sin(t), and thus never leaves the box. Ends after `most` calls,
/// or when the simplex is smaller than `least` [share of the box] in all directions and a new one
/// around it finds nothing lower. Source: Nelder, Mead, The Computer Journal 7 (1965) 308, with the
/// usual factors 1, 2, 1/2, 1/2.
template <class Function>
std::pair<Eigen::VectorXd, double> minimise_in_box(const Function& f, const Eigen::VectorXd& start,
                                                   const Eigen::VectorXd& low,
                                                   const Eigen::VectorXd& high, double size,
                                                   std::size_t most, double least = 1e-4) {
  const auto d = static_cast<std::size_t>(start.size());
  const Eigen::ArrayXd middle = 0.5 * (low + high).array(), half = 0.5 * (high - low).array();
  const auto place = [&](const Eigen::VectorXd& t) {
    return Eigen::VectorXd((middle + half * t.array().sin()).max(low.array()).min(high.array()));
  };
  struct Corner {
    Eigen::VectorXd t;
    double value;
  };
  std::vector<Corner> all;
  std::size_t calls = 0;
  const auto corner = [&](const Eigen::VectorXd& t) {
    const double value = f(place(t));
    ++calls;
    return Corner{t, std::isnan(value) ? std::numeric_limits<double>::infinity() : value};
  };
  const auto begin_around = [&](Corner first) {
    all.assign(1, std::move(first));
    for (Eigen::Index i = 0; i < start.size(); ++i) {
      Eigen::VectorXd t = all[0].t;
      t[i] += std::sin(t[i]) < 0 ? 2 * size : -2 * size;
      all.push_back(corner(t));
    }
  };
  begin_around(corner(((start.array() - middle) / half).max(-1.0).min(1.0).asin().matrix()));
  const auto order = [&] {
    std::stable_sort(all.begin(), all.end(),
                     [](const Corner& a, const Corner& b) { return a.value < b.value; });
  };
  double before = std::numeric_limits<double>::infinity();
  for (order(); calls < most; order()) {
    double extent = 0;
    for (const auto& c : all)
      extent = std::max(extent, 0.5 * (c.t - all[0].t).cwiseAbs().maxCoeff());
    if (extent < least) {
      if (!(all[0].value < before)) break;
      before = all[0].value;
      begin_around(all[0]);
      continue;
    }
    Eigen::VectorXd centre = Eigen::VectorXd::Zero(start.size());
    for (std::size_t k = 0; k < d; ++k) centre += all[k].t / static_cast<double>(d);
    const auto along = [&](double factor) { return corner(centre + factor * (all[d].t - centre)); };
    Corner mirrored = along(-1);
    if (mirrored.value < all[0].value) {
      Corner farther = along(-2);
      all[d] = farther.value < mirrored.value ? std::move(farther) : std::move(mirrored);
    } else if (mirrored.value < all[d - 1].value) {
      all[d] = std::move(mirrored);
    } else {
      Corner nearer = mirrored.value < all[d].value ? along(-0.5) : along(0.5);
      if (nearer.value < std::min(mirrored.value, all[d].value)) {
        all[d] = std::move(nearer);
      } else {
        for (std::size_t k = 1; k <= d; ++k)
          all[k] = corner(all[0].t + 0.5 * (all[k].t - all[0].t));
      }
    }
  }
  return {place(all[0].t), all[0].value};
}

/// Position of point `n` of an additive quasi-random sequence in the unit cube of `dimensions`.
/// Source: Roberts, "The unreasonable effectiveness of quasirandom sequences" (2018), recalled.
inline Eigen::VectorXd evenly_spread(std::size_t n, std::size_t dimensions, double shift = 0.5) {
  double phi = 2;  // the root of phi^(d + 1) = phi + 1
  for (int k = 0; k < 60; ++k) phi = std::pow(1 + phi, 1.0 / static_cast<double>(dimensions + 1));
  Eigen::VectorXd x(static_cast<Eigen::Index>(dimensions));
  double step = 1;
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    step /= phi;
    const double at = shift + step * static_cast<double>(n + 1);
    x[k] = at - std::floor(at);
  }
  return x;
}

}  // namespace silt::detail
