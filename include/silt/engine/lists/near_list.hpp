// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/lists/box_images.hpp>
#include <silt/module/concept.hpp>
#include <silt/search/hashed_grid.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The particles among which a list is made: those of this process, and behind them, with several
/// ranks, those of others that its own may be near to.
struct NearParticles {
  DynArray<Seen> seen;  // id: no_particle where a place is empty
  std::size_t own = 0;
};

/// The pairs of particles (spheres, or whole bodies) within a given cut-off of each other, or soon
/// to be: a Verlet list with one skin for all. It is renewed when two particles may have approached
/// by the skin, or when memory places hold other particles than before (births, sorting, restarts).
/// Particles that have left stay in it until then and are skipped by the user of the list.
///
/// Each pair is listed once, the lower place first, in ascending order; pairs of other ranks alone
/// are left out. Pairs beyond the cut-off
/// add nothing to a sum; results therefore depend neither on the skin nor on when the list was
/// renewed, and a checkpoint need not store it.
///
/// In a DeformingBox, whose images move relative to each other, the list is renewed at each use.
/// Tests: tests/engine/near_pairs.cpp (against brute force at every step).
template <class Domain>
class NearList {
 public:
  struct Reach {
    double length = 0;         // [m]
    bool of_surfaces = false;  // between surfaces; else between centres
    bool operator==(const Reach&) const = default;
  };

  /// Brings the list up to date. `name`: of the module, for messages.
  void renew(const NearParticles& of, const Domain& domain, const Team& team, const Reach& reach,
             const char* name) {
    if (holds(of, domain, team, reach)) return void(++looks_);
    choose_skin(of.seen, domain, reach, name);
    take_places(of, domain, reach);
    find(domain, team);
    sort(team);
    looks_ = 0;
  }
  std::size_t pairs() const { return second_.size(); }
  double skin() const { return skin_; }
  /// Whether the particles of a pair at this distance [m] are within the cut-off.
  bool within(double distance2, double radius_a, double radius_b) const {
    const double cutoff = reach_.length + (reach_.of_surfaces ? radius_a + radius_b : 0);
    return distance2 < cutoff * cutoff;
  }

  /// Calls visit(pair, first, second) for each pair; pairs are shared between threads.
  template <class Visit>
  void for_each(const Team& team, const Visit& visit) const {
    team.for_ranges(own_, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k)
        for (std::size_t p = first_[k]; p < first_[k + 1]; ++p) visit(p, k, second_[p]);
    });
  }
  /// Calls add(place, pair, sign) for each own particle and all its pairs, in ascending order of
  /// the partners. sign is 1 if the particle is the first of the pair, -1 if it is the second.
  template <class Add>
  void gather(const Team& team, const Add& add) const {
    team.for_ranges(own_, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        for (std::size_t p = into_first_[k]; p < into_first_[k + 1]; ++p) add(k, into_[p], -1);
        for (std::size_t p = first_[k]; p < first_[k + 1]; ++p) add(k, p, 1);
      }
    });
  }
  std::size_t bytes() const {
    return (second_.capacity() + into_.capacity()) * sizeof(std::uint32_t) +
           (first_.capacity() + into_first_.capacity()) * sizeof(std::size_t) +
           from_.capacity() * sizeof(PositionRow) + found_.capacity() * sizeof(IndexPair);
  }

 private:
  static Vec3d way(const Vec3d& d, [[maybe_unused]] const Domain& domain) {
    if constexpr (Domain::periodic)
      return domain.shortest(d);
    else
      return d;
  }
  /// Two particles have approached by no more than the sum of their displacements, and of their
  /// growth where the cut-off is between surfaces.
  bool holds(const NearParticles& of, const Domain& domain, const Team& team,
             const Reach& reach) const {
    if (deforms<Domain> || of.seen.size() != ids_.size() || of.own != own_ || !(reach == reach_))
      return false;
    std::array<double, Team::most_ranges> most{};
    team.for_ranges(ids_.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        const Seen& p = of.seen[k];
        if (p.id == no_particle) continue;
        double moved = norm(way(p.position - from_[k].centre(), domain));
        if (reach.of_surfaces) moved += std::max(p.radius - from_[k].r, 0.0);
        if (p.id != ids_[k]) moved = INFINITY;
        most[r] = std::max(most[r], moved);
      }
    });
    return 2 * *std::max_element(most.begin(), most.end()) < skin_;
  }

  /// A tenth of the cut-off at first; increased if the list lasted for only a few steps, decreased
  /// if it lasted long. Results do not depend on it.
  void choose_skin(std::span<const Seen> seen, const Domain& domain, const Reach& reach,
                   const char* name) {
    double largest = 0;
    for (const Seen& p : seen)
      if (p.id != no_particle) largest = std::max(largest, p.radius);
    const double cutoff = reach.length + (reach.of_surfaces ? 2 * largest : 0);
    if (!(reach == reach_)) share_ = 0.1;
    if (looks_ > 0 && looks_ < 20) share_ = std::min(1.5 * share_, 0.5);
    if (looks_ > 200) share_ = std::max(share_ / 1.5, 0.02);
    reach_ = reach;
    skin_ = deforms<Domain> ? 0 : share_ * cutoff;
    if constexpr (Domain::periodic)
      for (int d = 0; d < 3; ++d) {
        if (!domain.repeats(d)) continue;
        require(domain.length(d) >= 2 * cutoff, Domain::policy_name, ": its length ",
                domain.length(d), " [m] must be at least ", 2 * cutoff,
                " m, twice the reach of the module ", name,
                ", so that no pair is near by two images; make the box longer or the reach "
                "shorter");
        skin_ = std::min(skin_, domain.length(d) / 2 - cutoff);
      }
  }

  void take_places(const NearParticles& of, const Domain& domain, const Reach& reach) {
    const std::size_t n = of.seen.size();
    ids_.resize(n), from_.resize(n);
    rows_.clear(), places_.clear();
    largest_ = 0, own_ = of.own;
    for (std::size_t k = 0; k < n; ++k) {
      const Seen& p = of.seen[k];
      ids_[k] = p.id;
      if (p.id == no_particle) continue;
      const Vec3d at = p.position;
      from_[k] = {at.x, at.y, at.z, p.radius};
      Vec3d inside = at;
      if constexpr (Domain::periodic) inside = domain.wrapped(at);
      // Rounding of the wrapped position must not lose a pair.
      const double grown =
          (1 + 1e-9) * (reach.length + skin_) / 2 + (reach.of_surfaces ? p.radius : 0);
      rows_.push_back({inside.x, inside.y, inside.z, grown});
      places_.push_back(static_cast<std::uint32_t>(k));
      largest_ = std::max(largest_, grown);
    }
  }
  void find(const Domain& domain, const Team& team) {
    found_.clear();
    if (rows_.size() < 2) return;
    const std::span<const PositionRow> rows(rows_.data(), rows_.size());
    if constexpr (deforms<Domain>)
      images_.find(grid_, rows, largest_, domain, team, found_);
    else
      grid_.find(SphereSet{rows, largest_}, 0.0, domain, team, found_);
  }
  /// Sorts by the first place, then by the second; stores for each place the pairs whose second
  /// particle it is.
  void sort(const Team& team) {
    const std::size_t n = ids_.size();
    first_.assign(n + 1, 0), into_first_.assign(n + 1, 0);
    for (IndexPair& p : found_) {
      const std::uint32_t a = places_[p.a], b = places_[p.b];
      p = {std::min(a, b), std::max(a, b)};
    }
    if (own_ < n) erase_if(found_, [this](const IndexPair& p) { return p.a >= own_; });
    for (const IndexPair& p : found_) ++first_[p.a + 1], ++into_first_[p.b + 1];
    for (std::size_t k = 0; k < n; ++k)
      first_[k + 1] += first_[k], into_first_[k + 1] += into_first_[k];
    second_.resize(found_.size()), into_.resize(found_.size());
    next_.assign(first_.begin(), first_.end());
    for (const IndexPair& p : found_) second_[next_[p.a]++] = p.b;
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k)
        std::sort(second_.begin() + static_cast<std::ptrdiff_t>(first_[k]),
                  second_.begin() + static_cast<std::ptrdiff_t>(first_[k + 1]));
    });
    next_.assign(into_first_.begin(), into_first_.end());
    for (std::size_t p = 0; p < second_.size(); ++p)
      into_[next_[second_[p]]++] = static_cast<std::uint32_t>(p);
    if (found_.size() > 1000000) found_ = {};  // unused until the next search
  }

  Reach reach_;
  double skin_ = 0, share_ = 0.1, largest_ = 0;  // [m], [-] of the cut-off, [m] of grown spheres
  std::size_t looks_ = 0;                        // since the list was made
  std::size_t own_ = 0;                          // particles that are not ghosts
  DynArray<ParticleId> ids_;                     // at each place, when the list was made
  DynArray<PositionRow> from_;                   // positions at that time
  DynArray<std::size_t> first_, into_first_, next_;
  DynArray<std::uint32_t> second_, into_;
  DynArray<PositionRow> rows_;  // of the particles present, wrapped and grown
  DynArray<std::uint32_t> places_;
  std::vector<IndexPair> found_;
  HashedGrid grid_;
  BoxImages images_;
};

}  // namespace silt::detail
