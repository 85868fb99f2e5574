// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include <silt/silt.hpp>

namespace mixer {

/// Lacey's mixing index of two kinds of grains (recalled: J. Appl. Chem. 4 (1954) 257):
///
///   M = (S0^2 - S^2)/(S0^2 - SR^2),   S0^2 = p (1 - p)                                       (1)
///
/// p is the number fraction of the first kind, S^2 the variance of its fraction over samples.
/// Samples are cubes of `side` [m], each weighted with its number of grains n_i. SR^2 is the mean
/// of S^2 if N grains are distributed at random over k samples; for n_i much less than N it is p (1
/// - p)/n, n = N/k:
///
///   S^2 = sum n_i (p_i - p)^2/N,   SR^2 = p (1 - p) (k - 1)/(N - 1)                          (2)
///
/// M is 0 if no sample contains both kinds, and 1 on average over random mixtures.
class Lacey {
 public:
  /// Cubes with a corner at `corner` [m].
  Lacey(double side, const silt::Vec3d& corner) : side_(side), corner_(corner) {}

  void add(const silt::Vec3d& place, bool is_first) {
    const silt::Vec3d at = (1 / side_) * (place - corner_);
    auto& cell = cells_[{std::floor(at.x), std::floor(at.y), std::floor(at.z)}];
    ++cell.all, cell.first += is_first, ++all_, first_ += is_first;
  }
  double index() const {
    const double p = first_ / all_, apart = p * (1 - p);
    const double random = apart * (samples() - 1) / (all_ - 1);
    double variance = 0;
    for (const auto& [place, cell] : cells_)
      variance += cell.all * std::pow(cell.first / cell.all - p, 2) / all_;
    return (apart - variance) / (apart - random);
  }
  double samples() const { return static_cast<double>(cells_.size()); }
  double grains_a_sample() const { return all_ / samples(); }

 private:
  struct Cell {
    double all = 0, first = 0;
  };
  double side_;
  silt::Vec3d corner_;
  double all_ = 0, first_ = 0;
  std::map<std::array<double, 3>, Cell> cells_;
};

/// Mean index of `tries` random mixtures of these grains, and its standard error.
inline std::array<double, 2> index_of_random(const std::vector<silt::Vec3d>& places,
                                             std::vector<bool> kinds, double side,
                                             const silt::Vec3d& corner, int tries) {
  silt::Random random(3);
  double sum = 0, squares = 0;
  for (int n = 0; n < tries; ++n) {
    for (std::size_t k = kinds.size() - 1; k > 0; --k) {
      const std::size_t other = random.index(k + 1);
      const bool kind = kinds[k];
      kinds[k] = kinds[other], kinds[other] = kind;
    }
    Lacey lacey(side, corner);
    for (std::size_t k = 0; k < kinds.size(); ++k) lacey.add(places[k], kinds[k]);
    sum += lacey.index(), squares += lacey.index() * lacey.index();
  }
  const double mean = sum / tries;
  return {mean, std::sqrt((squares / tries - mean * mean) / (tries - 1))};
}

}  // namespace mixer
