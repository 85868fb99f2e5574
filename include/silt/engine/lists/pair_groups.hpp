// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <silt/core/dyn_array.hpp>
#include <silt/core/target.hpp>
#include <silt/core/threads.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Divides pairs into groups such that groups of one phase have no particle in common: threads can
/// then add to load sums without conflicts, in an order that does not depend on their number.
///
/// Particles are divided into an even number c of shares of consecutive places. Phase 0: the pairs
/// within each share. Phases 1 ... c-1: the pairs between two shares, paired as in the rounds of a
/// round-robin tournament (circle method). Shares are numbered such that neighbours meet in the
/// first two rounds; if particles are sorted in space, the other rounds are empty or small.
///
/// Rows behind the first `particles` are ghosts of other ranks. Their shares are paired with those
/// of the particles in separate phases after all others; two ghosts make no pair.
class PairGroups {
 public:
  explicit PairGroups(std::size_t particles = 0, std::size_t ghosts = 0)
      : shares_(shares_for(particles)),
        shares_a_particle_(static_cast<double>(shares_) /
                           static_cast<double>(std::max<std::size_t>(particles, 1))) {
    if (ghosts == 0) return;
    first_ghost_ = particles, ghost_shares_ = shares_for(ghosts);
    shares_a_ghost_ = static_cast<double>(ghost_shares_) / static_cast<double>(ghosts);
  }

  struct Phase {
    std::size_t from, to;  // groups
  };
  std::size_t count() const { return own_count() + ghost_phases() * ghost_shares_; }
  std::size_t phases() const { return shares_ + ghost_phases(); }
  /// Phases without ghosts come first.
  std::size_t own_phases() const { return shares_; }
  Phase phase(std::size_t k) const {
    if (k >= shares_) {
      const std::size_t first = own_count() + (k - shares_) * ghost_shares_;
      return {first, first + ghost_shares_};
    }
    if (k == 0) return {0, shares_};
    const std::size_t first = shares_ + (k - 1) * (shares_ / 2);
    return {first, first + shares_ / 2};
  }

  std::size_t of(std::uint32_t a, std::uint32_t b) const {
    if (std::max(a, b) >= first_ghost_) return with_ghost(std::min(a, b), std::max(a, b));
    const std::size_t s = share(a), t = share(b);
    return s == t ? s : meeting(s, t);
  }

 private:
  /// Few enough that the layers of particles at both ends of a share, n^(2/3) each, are a small
  /// part of it; more if all data fit into the caches anyway.
  static std::size_t shares_for(std::size_t particles) {
    const auto n = static_cast<double>(particles);
    const double wanted = std::max(std::cbrt(n) / 6, std::min(8.0, n / 1024));
    return wanted < 2 ? 1 : std::min<std::size_t>(static_cast<std::size_t>(wanted) / 2 * 2, 64);
  }

  std::size_t own_count() const { return shares_ + (shares_ - 1) * (shares_ / 2); }
  std::size_t ghost_phases() const {
    return ghost_shares_ == 0 ? 0 : std::max(shares_, ghost_shares_);
  }
  /// In ghost phase k, share s is paired with ghost share t where s + t = k modulo the number of
  /// phases.
  std::size_t with_ghost(std::uint32_t particle, std::uint32_t ghost) const {
    const auto behind = static_cast<double>(ghost - first_ghost_);
    const std::size_t t =
        std::min(static_cast<std::size_t>(behind * shares_a_ghost_), ghost_shares_ - 1);
    return own_count() + (share(particle) + t) % ghost_phases() * ghost_shares_ + t;
  }
  std::size_t share(std::uint32_t particle) const {
    return std::min(static_cast<std::size_t>(particle * shares_a_particle_), shares_ - 1);
  }

  /// Share 0 is in the middle; the others are numbered 0, 1, -1, 2, -2, ... modulo c-1. In round r
  /// shares are paired whose numbers add up to r; the middle is paired with the remaining one.
  std::size_t meeting(std::size_t s, std::size_t t) const {
    const std::size_t ring = shares_ - 1;
    const auto number = [ring](std::size_t share) {
      return share % 2 == 0 ? share / 2 : (ring - share / 2) % ring;
    };
    std::size_t round, place = 0;
    if (s == 0 || t == 0) {
      round = 2 * number(std::max(s, t)) % ring;
    } else {
      const std::size_t m = number(s), n = number(t), apart = (m + ring - n) % ring;
      round = (m + n) % ring;
      place = std::min(apart, ring - apart);
    }
    return phase(round + 1).from + place;
  }

  std::size_t shares_, ghost_shares_ = 0;
  double shares_a_particle_, shares_a_ghost_ = 0;
  std::size_t first_ghost_ = std::numeric_limits<std::size_t>::max();
};

/// Which pairs: all, those of two owned particles, or those with a ghost.
enum class PairsOf { All, Own, Ghosts };

/// The sum of the results of run(from, to) over all groups, each computed by one thread; groups
/// that share particles run one after the other.
template <class Tally, PairsOf Which = PairsOf::All, class List, class Run>
Tally sum_over_groups(const List& list, const Team& team, const Run& run) {
  const PairGroups& groups = list.groups();
  DynArray<Tally> tallies(groups.count());
  const std::size_t first = Which == PairsOf::Ghosts ? groups.own_phases() : 0,
                    end = Which == PairsOf::Own ? groups.own_phases() : groups.phases();
  for (std::size_t p = first; p < end; ++p) {
    const auto [from, to] = list.busy(groups.phase(p));
    team.for_parts(to - from, [&, start = from](std::size_t k) {
      const auto group = list.group(start + k);
      tallies[start + k] = run(group.from, group.to);
      if (p >= groups.own_phases()) tallies[start + k].halve_energy();
    });
  }
  Tally all;
  for (const auto& tally : tallies) all.add(tally);
  return all;
}

}  // namespace silt::detail
