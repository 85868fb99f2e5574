// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <silt/eigen.hpp>

#include "study/decomposition.hpp"

namespace decomposition_study {

/// Time of a step on one rank:
///
///   t = c_pair pairs + c_owner owners + c_ghost ghosts + c_search (owners + ghosts)/steps
///       + latency (messages + ceil(log2 ranks)) + bytes/bandwidth
///
/// The slowest rank determines the time of all. `steps`: between two searches. The logarithm is the
/// collective agreement at the end of each step. The model adds the time of messages in full,
/// although silt computes its inner pairs meanwhile.
struct Costs {
  double pair = 0, owner = 0, search = 0, ghost = 0;  // [s]
  double scatter = 0;  // [-] rms of what the fit leaves of a step's time, over the mean

  double of(double pairs, double owners, double ghosts, double steps) const {
    return pair * pairs + owner * owners + ghost * ghosts + search * (owners + ghosts) / steps;
  }
};

struct Network {
  std::string name;
  double latency, bandwidth;  // [s], [bytes/s]; 0 and infinite: none
};

/// The three costs of one process by least squares. A second fit leaves out steps that deviate by
/// more than twice the scatter: other programs used the caches then.
inline Costs fit(const std::vector<Timed>& all) {
  const auto solve = [](const std::vector<Timed>& some) {
    Eigen::MatrixXd x(static_cast<Eigen::Index>(some.size()), 3);
    Eigen::VectorXd seconds(x.rows());
    double mean = 0;
    for (Eigen::Index k = 0; k < x.rows(); ++k) {
      const Timed& t = some[static_cast<std::size_t>(k)];
      x.row(k) << t.pairs, t.owners, t.owners / t.steps;
      seconds[k] = t.seconds, mean += t.seconds / static_cast<double>(some.size());
    }
    const silt::LinearFit fit = silt::fit_linear(x, seconds);
    return Costs{fit.value[0], fit.value[1], fit.value[2], 0, fit.scatter / mean};
  };
  const Costs rough = solve(all);
  double mean = 0;
  for (const Timed& t : all) mean += t.seconds / static_cast<double>(all.size());
  std::vector<Timed> calm;
  for (const Timed& t : all)
    if (std::abs(t.seconds - rough.of(t.pairs, t.owners, 0, t.steps)) < 2 * rough.scatter * mean)
      calm.push_back(t);
  return solve(calm.size() > 3 ? calm : all);
}

/// Rounds of messages of a collective agreement.
inline double rounds_of(double ranks) { return std::ceil(std::log2(ranks)); }

/// [s] of a step of the slowest rank.
inline double step_time(const Costs& costs, const Network& net, const std::vector<RankCount>& ranks,
                        double steps, double bytes_of_ghost) {
  const double rounds = rounds_of(static_cast<double>(ranks.size()));
  double slowest = 0;
  for (const RankCount& r : ranks)
    slowest = std::max(slowest, costs.of(r.pairs, r.particles, r.ghosts, steps) +
                                    net.latency * (r.messages + rounds) +
                                    bytes_of_ghost * std::max(r.sent, r.ghosts) / net.bandwidth);
  return slowest;
}

/// An inner rank in a settled bed, a cube of `owners` particles: 26 neighbours, and a ghost layer
/// `layer` particles thick on all sides.
struct WeakRank {
  double owners, pairs_of_one, layer, imbalance, steps;

  double side() const { return std::cbrt(owners); }
  double ghosts() const { return std::pow(side() + 2 * layer, 3) - owners; }
  /// [s] of a step; a single rank has neither ghosts nor messages.
  double step_time(const Costs& costs, const Network& net, double ranks, double bytes) const {
    if (ranks == 1) return costs.of(pairs_of_one * owners, owners, 0, steps);
    // For each particle in a plane, half of its own pairs cross it: their mean |cos|. Each is
    // computed on both sides.
    const double across = 6 * side() * side() * pairs_of_one / 2;
    return imbalance * costs.of(pairs_of_one * owners + across / 2, owners, ghosts(), steps) +
           net.latency * (26 + rounds_of(ranks)) + bytes * ghosts() / net.bandwidth;
  }
};

}  // namespace decomposition_study
