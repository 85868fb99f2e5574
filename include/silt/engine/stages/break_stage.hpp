// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

#include <silt/breakage/breakage.hpp>
#include <silt/breakage/impact_energies.hpp>
#include <silt/breakage/size_table.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/random.hpp>
#include <silt/engine/contact/impacts.hpp>
#include <silt/engine/stages/living_sizes.hpp>
#include <silt/engine/state/composition.hpp>
#include <silt/fill/size_distribution.hpp>

namespace silt::inline SILT_TARGET::detail {

/// [N] peak force of the law's spring in an impact at full stiffness (unsoftened); NaN if the law
/// does not provide it.
template <class Law>
double elastic_force([[maybe_unused]] const typename Law::template Coefficients<double>& p,
                     [[maybe_unused]] double R_eff, [[maybe_unused]] double m_eff,
                     [[maybe_unused]] double speed) {
  if constexpr (requires { Law::physical_force(p, R_eff, m_eff, speed); })
    return Law::physical_force(p, R_eff, m_eff, speed);
  else if constexpr (requires { Law::impact_force(p, R_eff, m_eff, speed); })
    return Law::impact_force(p, R_eff, m_eff, speed);
  else
    return std::numeric_limits<double>::quiet_NaN();
}

/// A particle that will break before the next step.
struct DueBreak {
  ParticleId id;
  double load, speed;
  BreakCause cause;
};

/// Compares impacts with particle strengths; stores which particles are due to break, and the mass
/// tables. Results do not depend on the number of threads.
template <class Policy>
class BreakStage {
 public:
  DynArray<DueBreak> due;           // sorted by id; saved in checkpoints
  DynArray<BreakEvent> events;      // of this step
  ParticleId newborn_from = 0;      // first id of the fragments of this step
  SizeTables dust, left;            // fragments below the size limit, and particles that left
  CompensatedSum fed;               // [kg]
  BreakCounts broken{};             // since the start
  DynArray<BreakCounts> broken_of;  // the same per material, if there are several
  ImpactEnergies impacts;           // since the start, for breakage by impact speed only
  double parted = 0;                // [J] released by shrinking offsets
  double weak_from = 0;             // [N] lower bound of the strengths, for breakage by force
  LivingSizes sizes;                // the smallest living particles, which set the time step
  LargestLoad largest;              // not saved in checkpoints
  bool some_due = true;  // with several ranks: on any rank; true until the ranks have exchanged it
  bool some_born = false;  // the same, for this step

  /// Draws the strengths of the new particles, from place `from` on; for fragments also
  /// rests_until(id) [s], the time up to which they cannot break.
  template <class Engine, class RestsUntil>
  void start(Engine& e, const Policy& policy, std::size_t from, const RestsUntil& rests_until) {
    auto& fields = e.modules().template of<Policy>();
    for (std::size_t k = from; k < e.owners(); ++k) {
      const auto p = e.owner(k);
      fields[k] = {.generation = fields[k].generation};
      if (!p.is_there() || p.inverse_mass() == 0 || !policy.rules.breaks(p.material())) continue;
      const double rank = random_of(policy, p.id(), of_strength).open_uniform();
      const double d = equal_volume_diameter(e.volume_of(k));
      const double strength = policy.strength.strength(d, p.mass(), rank);
      if (!(strength > 0)) policy.strength.check();
      require(strength > 0, "Breakage: strength() gives ", strength, " for a particle of diameter ",
              d, " m at rank ", rank, "; it must be greater than 0");
      fields[k].strength = strength;
      fields[k].rests_until = rests_until(p.id());
      weak_from = std::min(weak_from, fields[k].strength);
    }
  }
  /// Streams of random numbers of one particle.
  enum Draw : std::uint64_t { of_strength = 0, of_fragments = 1 };
  static Random random_of(const Policy& policy, ParticleId id, Draw what) {
    const std::uint64_t of_seed = Random(policy.rules.seed).bits();
    return Random(of_seed + 0x9e3779b97f4a7c15u * (2 * id + what));
  }

  /// Called after the contacts of a step, at `time` [s].
  template <class Engine>
  void weigh(Engine& e, const Policy& policy, double time) {
    struct Half {  // one particle's side of an impact
      ParticleId id, other;
      std::size_t wall, place;
      const NotedImpact* note;
      auto key() const { return std::tuple(id, other, wall, note->force, note->speed); }
    };
    DynArray<Half> all;
    std::size_t known = e.owners();
    if constexpr (Engine::of_ranks) known = e.particles.size();  // includes ghosts
    for (const NotedImpact& note : e.impacts.all) {
      const std::size_t a = e.owner_of(note.first);
      const std::size_t b = note.second == NotedImpact::no_row ? a : e.owner_of(note.second);
      if (a >= known || b >= known) continue;  // padding of packs
      const auto p = e.owner(a), q = e.owner(b);
      if (!p.is_there() || !q.is_there()) continue;
      const bool at_wall = note.wall != NotedImpact::no_row;
      // An impact between particles of two ranks is counted by the owner of the lower id; each rank
      // evaluates its own particle.
      const bool counts = (p.id() < q.id() ? a : b) < e.owners();
      if (note.speed > 0 && counts) impacts.add(note.m_eff, note.speed, at_wall);
      if (a < e.owners())
        all.push_back({p.id(), at_wall ? no_particle : q.id(), at_wall ? note.wall : 0, a, &note});
      if (!at_wall && b < e.owners()) all.push_back({q.id(), p.id(), 0, b, &note});
    }
    std::sort(all.begin(), all.end(),
              [](const Half& a, const Half& b) { return a.key() < b.key(); });
    for (const Half& one : all) weigh_one(e, policy, *one.note, one.place, time);
    e.impacts.all.clear();
    parted += std::exchange(e.parted, 0);
  }

  /// A particle breaks once, under its largest load.
  void add_due(const DueBreak& one) {
    const auto at = std::lower_bound(due.begin(), due.end(), one.id,
                                     [](const DueBreak& d, ParticleId id) { return d.id < id; });
    if (at == due.end() || at->id != one.id)
      due.insert(at, one);
    else if (at->load < one.load)
      *at = one;
  }

  template <bool SeveralMaterials>
  void count(BreakCause cause, std::size_t material) {
    ++broken[static_cast<std::size_t>(cause)];
    if constexpr (SeveralMaterials) {
      if (broken_of.size() <= material) broken_of.resize(material + 1);
      ++broken_of[material][static_cast<std::size_t>(cause)];
    }
  }

  /// For breakage by force: the smallest strength of all particles.
  template <class Engine>
  void measure(const Engine& e) {
    if constexpr (!Policy::by_force) return;
    weak_from = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < e.owners(); ++k)
      if (const double own = e.modules().template of<Policy>()[k].strength;
          own > 0 && e.owner(k).is_there())
        weak_from = std::min(weak_from, own);
  }

 private:
  template <class Engine>
  void weigh_one(Engine& e, const Policy& policy, const NotedImpact& note, std::size_t k,
                 double time) {
    auto& own = e.modules().template of<Policy>()[k];
    if (!(own.strength > 0) || time < own.rests_until) return;
    if (note.force == 0 && note.speed == 0) return;  // the contact began while the two moved apart
    const auto p = e.owner(k);
    const bool at_wall = note.wall != NotedImpact::no_row;
    Impact impact{};
    impact.diameter = equal_volume_diameter(e.volume_of(k)), impact.mass = p.mass();
    impact.speed = note.speed, impact.m_eff = note.m_eff, impact.R_eff = note.R_eff;
    impact.at_wall = at_wall;
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    impact.elastic_force =
        note.force > 0 ? unknown
                       : elastic_force<typename Engine::Contacts::Law>(
                             e.coefficients.law[note.kind], note.R_eff, note.m_eff, note.speed);
    impact.contact_force = note.force > 0 ? note.force : unknown;
    const double load = policy.equivalence.load(impact);
    const auto wanted = [&](bool holds, const char* function, double gives) {
      if (!holds) [[unlikely]]
        throw SimulationError(
            readable("t = ", time, " s: ", function, " gives ", gives, " for particle ", p.id(),
                     " of diameter ", impact.diameter, " m, strength ", own.strength, ", hit at ",
                     note.speed, " m/s; mend that function"),
            0, {p.id()}, p.centre());
    };
    wanted(load >= 0 && std::isfinite(load), "the equivalence's load()", load);
    ++largest.weighed;
    if (load > largest.share * own.strength)
      largest.share = load / own.strength, largest.load = load, largest.strength = own.strength,
      largest.diameter = impact.diameter, largest.speed = note.speed;
    if (load >= own.strength) {
      add_due({p.id(), load, note.speed, at_wall ? BreakCause::Wall : BreakCause::Pair});
    } else if (!Policy::by_force || note.is_peak) {
      const double remaining = policy.fatigue.weakened(own.strength, load);
      wanted(remaining >= 0 && remaining <= own.strength, "the fatigue's weakened()", remaining);
      own.strength = std::max(remaining, std::numeric_limits<double>::min());  // 0: never breaks
      weak_from = std::min(weak_from, own.strength);
    }
  }
};

/// The stage of a policy Breakage; empty without one.
template <class Policy>
struct BreakStageOf {
  using type = BreakStage<Policy>;
};
template <>
struct BreakStageOf<NoBreakage> {
  struct type {};
};

}  // namespace silt::detail
