// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace silt::detail {

/// Cuts pairs into groups, so that groups of one phase have no particle in common and threads can
/// add loads to the particles' sums without meeting.
///
/// Particles are cut into shares of consecutive places; neighbours lie close together if particles
/// are sorted. Phases: pairs within one share (a group a share); pairs across the seams between
/// shares 2k and 2k+1 (a group a seam); across the other seams, the last joining the ends; and the
/// rest, whose loads get rows of their own. Groups follow from the number of particles alone, so
/// that sums are bit-identical for every number of threads.
class PairGroups {
 public:
  static constexpr std::size_t most_shares = 16;

  explicit PairGroups(std::size_t particles = 0)
      : shares_(particles < 2048 ? 1 : std::min(most_shares, particles / 1024 / 2 * 2)),
        shares_a_particle_(static_cast<double>(shares_) /
                           static_cast<double>(std::max<std::size_t>(particles, 1))) {}

  struct Phase {
    std::size_t from, to;  // groups
  };
  std::size_t count() const { return 2 * shares_ + 1; }
  Phase phase(int k) const {
    const std::size_t bounds[4] = {0, shares_, shares_ + shares_ / 2, 2 * shares_};
    return {bounds[k], bounds[k + 1]};
  }
  static constexpr int phases = 3;
  std::size_t rest() const { return 2 * shares_; }

  std::size_t of(std::uint32_t a, std::uint32_t b) const {
    const std::size_t s = share(a), t = share(b);
    if (s == t) return s;
    const std::size_t low = std::min(s, t), high = std::max(s, t);
    if (high - low == 1) return seam(low);
    return low == 0 && high == shares_ - 1 ? seam(high) : rest();
  }

 private:
  std::size_t share(std::uint32_t particle) const {
    return std::min(static_cast<std::size_t>(particle * shares_a_particle_), shares_ - 1);
  }
  /// The group between share s and the next.
  std::size_t seam(std::size_t s) const { return shares_ + s / 2 + (s % 2 == 0 ? 0 : shares_ / 2); }

  std::size_t shares_;
  double shares_a_particle_;
};

}  // namespace silt::detail
