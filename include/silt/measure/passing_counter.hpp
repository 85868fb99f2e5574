// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <silt/boundary/passages.hpp>
#include <silt/core/id_table.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Number and mass of the particles that have passed a surface in one direction.
struct Passed {
  std::uint64_t number = 0;  // [-]
  double mass = 0;           // [kg]
};

/// Which passages a PassingCounter counts.
struct PassingOptions {
  bool once = false;  // only the first passage of each particle
  /// Whether the particle at place k counts, asked when it passes; empty: all count.
  std::function<bool(std::size_t)> which = {};
};

/// Counts the particles that pass a surface and go on: a plane, or a mesh (disc, rectangle, a
/// file). It is an observer, which looks at the particles every ten steps and at the end of a run:
///
///   silt::PassingCounter orifice(silt::disc({0, 0, 0}, {0, 0, -1}, 0.02));
///   sim.run(1, orifice);
///   orifice.forwards().mass;   // [kg] along the normal; backwards(), net_mass(), mass_rate()
///
/// A particle passes where the straight line between its centres of mass at two successive looks
/// meets the surface (detail::PassedSurface). The counts are the same on all ranks; they do not
/// depend on the number of threads, nor, but for rounding of the motion, of ranks.
///
/// Valid:  a surface at rest. Between two looks the path counts as straight, and as shorter than
///         half of a PeriodicBox. What is born between two looks, as fragments are, is followed
///         from the second one on; a particle that is removed between two looks has not passed
///         since the first. Fixed particles do not count. What passes in runs without the counter
///         is not counted.
/// Units:  [-], [kg], [s].
/// Errors: InputError for an unfit surface.
/// Tests:  tests/io/passing_series.cpp, passing_kinds.cpp, tests/parallel/passing_series.cpp
class PassingCounter {
 public:
  static constexpr bool reads_contacts = false;
  static constexpr int steps_between_looks = 10;

  explicit PassingCounter(const Surfaces& surface, PassingOptions options = {})
      : PassingCounter("PassingCounter", surface, std::move(options)) {}

  const Passed& forwards() const { return forwards_; }
  const Passed& backwards() const { return backwards_; }
  double net_number() const {  // [-] forwards less backwards
    return static_cast<double>(forwards_.number) - static_cast<double>(backwards_.number);
  }
  double net_mass() const { return forwards_.mass - backwards_.mass; }  // [kg]
  double watched() const { return watched_; }                           // [s] in which it counted
  /// Net mass over the time watched [kg/s]; 0 before any time has passed.
  double mass_rate() const { return watched_ > 0 ? net_mass() / watched_ : 0; }
  /// Counts from zero on, for example when a flow has become steady. `once` is not forgotten.
  void clear() { forwards_ = backwards_ = {}, watched_ = 0; }

  /// Counts what has passed since the last look; the first one notes where the particles are. For
  /// looks of your own, between runs or in an observer (collective).
  template <class Sim>
  void look(const Sim& sim) {
    follow(sim, started_);
  }

  template <class Sim>
  void begin(const Sim& sim, double) {
    follow(sim, started_ && is_now(sim, seen_at_));
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return sim.step() % steps_between_looks == 0;
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    look(sim);
  }
  template <class Sim>
  void end(const Sim& sim) {
    look(sim);
  }

 private:
  friend class PassingSeries;
  struct Seen {
    ParticleId id = no_particle;
    Vec3d at{0, 0, 0};         // [m]
    std::uint64_t passed = 0;  // whether it has been counted
  };
  struct Counted {
    ParticleId id;
    double mass;  // [kg]
    std::int64_t forwards, backwards;
  };

  PassingCounter(const char* of, const Surfaces& surface, PassingOptions options)
      : surface_(of, surface), options_(std::move(options)) {}

  template <class Sim>
  static bool is_now(const Sim& sim, double time) {
    return std::abs(sim.time() - time) < 0.5 * sim.step_length();
  }

  /// Finds each particle where the last look saw it, here or on another rank; counts if `counts`.
  template <class Sim>
  void follow(const Sim& sim, bool counts) {
    static_assert(!detail::deforms<typename Sim::Domain>,
                  "PassingCounter and passing_series need a domain at rest: particles in a "
                  "DeformingBox move with it past any surface; take PeriodicBox or none");
    if (!started_) surface_.check(sim.domain());
    auto& now = now_;
    now.assign(sim.rows(), {});
    std::vector<std::size_t> came;  // places that had no particle of this rank
    std::vector<Counted> counted;
    const auto meet = [&](Seen& before, std::size_t k) {
      now[k].passed = before.passed;
      if (counts) count(sim, before.at, now[k], k, counted);
      before.id = no_particle;
    };
    bool sorted = false;  // whether places_ has those of last time
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (!sim.is_present(k)) continue;
      now[k].id = sim.id(k), now[k].at = sim.position(k);
      std::size_t place = k;
      if (k >= seen_.size() || seen_[k].id != now[k].id) {
        if (!std::exchange(sorted, true)) note_places(seen_);
        place = places_.find(now[k].id);
      }
      place == no_place ? came.push_back(k) : meet(seen_[place], k);
    }
    if constexpr (Sim::has_ranks) {
      if (sim.ranks() > 1) {
        std::erase_if(seen_, [](const Seen& s) { return s.id == no_particle; });
        auto gone = of_all_ranks(sim, seen_);
        note_places(gone);
        for (const std::size_t k : came)
          if (const auto at = places_.find(now[k].id); at != no_place) meet(gone[at], k);
        counted = of_all_ranks(sim, counted);
      }
    }
    seen_.swap(now);
    // In the order of ids: the sum does not depend on that of the memory.
    std::sort(counted.begin(), counted.end(), [](auto& a, auto& b) { return a.id < b.id; });
    for (const Counted& c : counted) {
      forwards_.number += static_cast<std::uint64_t>(c.forwards);
      backwards_.number += static_cast<std::uint64_t>(c.backwards);
      forwards_.mass += static_cast<double>(c.forwards) * c.mass;
      backwards_.mass += static_cast<double>(c.backwards) * c.mass;
    }
    if (counts) watched_ += sim.time() - seen_at_;
    started_ = true, seen_at_ = sim.time();
  }
  void note_places(const std::vector<Seen>& seen) {
    places_.clear();
    for (std::size_t k = 0; k < seen.size(); ++k)
      if (seen[k].id != no_particle) places_.at(seen[k].id) = static_cast<std::uint32_t>(k);
  }
  template <class Sim, class T>
  static std::vector<T> of_all_ranks(const Sim& sim, const std::vector<T>& own) {
    const auto& ranks = sim.engine().ranks;
    ranks.meet("a look at a passed surface");
    return gather(ranks.comm(), std::span<const T>(own)).values;
  }
  template <class Sim>
  void count(const Sim& sim, const Vec3d& from, Seen& now, std::size_t k,
             std::vector<Counted>& counted) {
    const detail::Passages passages = surface_.between(from, now.at, sim.domain());
    if (!passages.any()) return;
    const double mass = sim.mass(k);
    if (!std::isfinite(mass) || (options_.which && !options_.which(k))) return;
    Counted one{now.id, mass, passages.forwards, passages.backwards};
    if (options_.once) {
      if (std::exchange(now.passed, 1) != 0) return;
      one.forwards = passages.first_forwards, one.backwards = !passages.first_forwards;
    }
    counted.push_back(one);
  }

  detail::PassedSurface surface_;
  PassingOptions options_;
  Passed forwards_, backwards_;
  double watched_ = 0, seen_at_ = 0;  // [s]
  bool started_ = false;
  std::vector<Seen> seen_, now_;  // by place, at the last look and at this one
  detail::IdHash places_;
};

}  // namespace silt
