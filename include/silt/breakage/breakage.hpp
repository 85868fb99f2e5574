// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <silt/breakage/concept.hpp>
#include <silt/breakage/fatigue.hpp>
#include <silt/breakage/impact.hpp>
#include <silt/breakage/sizes.hpp>
#include <silt/core/error.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/vec3.hpp>
#include <silt/fill/size_distribution.hpp>

namespace silt::inline SILT_TARGET {

/// What silt's own time step is chosen for. One that is set (Simulation::time_step) does not
/// change.
enum class BreakStep {
  SmallestPossible,  // a fragment of the diameter `dust_below`, from the start on
  SmallestLiving     // the smallest particles that are there: it changes during the run
};

/// How particles break, beside the comminution functions.
struct BreakageRules {
  double dust_below;                        // [m] diameter, > 0: fragments below it are dust
  std::size_t most_fragments = 100;         // [-] of one particle; the rest of its mass is dust
  double separation_speed = 0.1;            // [m/s] >= 0
  std::vector<std::size_t> materials = {};  // whose particles break; none: all
  std::uint64_t seed = 1;
  BreakStep step = BreakStep::SmallestPossible;

  bool breaks(std::size_t material) const {
    for (const std::size_t m : materials)
      if (m == material) return true;
    return materials.empty();
  }
};

/// Policy of a Simulation whose particles break: each has a strength, and where an impact loads it
/// by more, it is replaced by fragments; those below `dust_below` are mass in a table.
///
///   silt::Simulation sim{std::move(feed), silt::Contacts<silt::HertzMindlin>{salt},
///                        silt::Breakage{silt::LogLogisticStrength{...}, silt::HertzEquivalence{},
///                                       silt::GaudinSchuhmann{...}, {.dust_below = 20e-6}}};
///
/// An impact is weighed as it begins, by its speed at first touch; with ForceEquivalence in each
/// step, by the normal force of the contact, damping included. What it does not break it weakens,
/// as `fatigue` says: once a contact. Fragments lie inside the particle that they come from and
/// have its velocity and rotation, its momentum and angular momentum; what they overlap by at
/// birth, with each other, neighbours and walls, is left out of their contacts, and shrinks at
/// `separation_speed`. Until the particle would have gone its own diameter at the impact's speed,
/// they do not break: the breakage function says what the whole impact leaves.
///
/// Strengths are drawn by seed and id, fragments likewise: results depend on nothing else.
/// Source:  T. Brosh, H. Kalman, A. Levy, Particuology 12 (2014) 113: the system of functions and
///          the table of dust. The placing of fragments is silt's.
/// Errors:  InputError naming field, value, unit and allowed range.
/// Tests:   tests/breakage/.
/// Valid:   spheres and polyhedra, not in a DeformingBox.
/// Units:   SI; strengths and loads [N] or [J], as the load says.
template <Strength S, Equivalence E, BreakageFunction B, Fatigue F = NoFatigue>
struct Breakage {
  static constexpr bool is_breakage = true;
  static constexpr LoadUnit unit = E::unit;
  static constexpr bool by_force = requires { requires E::by_force; };
  static_assert(same_load_unit<S, E>(),
                "Breakage compares a strength in N with a load in J, or the other way round: take "
                "EnergyEquivalence with strengths in J, another one with those in N");

  S strength;
  E equivalence;
  B sizes;
  F fatigue;
  BreakageRules rules;

  Breakage(S s, E e, B b, F f, BreakageRules r)
      : strength(s), equivalence(e), sizes(b), fatigue(f), rules(std::move(r)) {}
  Breakage(S s, E e, B b, BreakageRules r) : Breakage(s, e, b, F{}, std::move(r)) {}

  /// Of each particle, as of a module.
  struct Fields {
    double strength = 0;     // [N] or [J]; 0: it does not break
    double rests_until = 0;  // [s] it does not break before
    double generation = 0;   // [-] 0: not a fragment; of fragments one more than of what broke
  };
  static constexpr std::array names{"strength", "rests_until", "generation"};

  /// Before a run.
  template <class Sim>
  void check(const Sim& sim) const {
    strength.check(), equivalence.check(), sizes.check(), fatigue.check();
    require_positive("BreakageRules.dust_below", rules.dust_below, "m");
    require_not_negative("BreakageRules.separation_speed", rules.separation_speed, "m/s");
    require(rules.most_fragments > 0,
            "BreakageRules.most_fragments = 0 [-] must be at least 1; to turn all that breaks into "
            "dust, raise dust_below");
    for (const std::size_t m : rules.materials)
      require(m < sim.contacts().materials(), "BreakageRules.materials names material ", m,
              ", but the contacts have ", sim.contacts().materials());
    double largest = 0;  // [m] diameter
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) largest = std::max(largest, 2 * sim.radius(k));
    for (std::size_t k = 0; k < sim.inlets(); ++k)
      largest = std::max(largest, 2 * sim.inlet(k).flow.largest_radius());
    require(largest == 0 || rules.dust_below < largest,
            "BreakageRules.dust_below = ", rules.dust_below,
            " [m] is not below the diameter of the largest particle, ", largest,
            " m: whatever broke would be dust; lower it");
    if (largest > 0) {
      const double mass = 2500 * sphere_volume(largest / 2),
                   middle = strength.strength(largest, mass, 0.5);
      check_sizes(sizes, {largest, mass, middle, 1.5 * middle, 10});
    }
  }
};
template <class S, class E, class B>
Breakage(S, E, B, BreakageRules) -> Breakage<S, E, B>;

/// Why a particle broke.
enum class BreakCause {
  Pair,  // impact on another particle
  Wall,  // impact on a wall
  Asked  // break_particle()
};
/// How many broke, by BreakCause.
using BreakCounts = std::array<std::uint64_t, 3>;

/// A particle that broke, for on_break().
struct BreakEvent {
  ParticleId id = no_particle;    // that it had
  std::size_t material = 0;       // Simulation::material_name() has its name
  double time = 0;                // [s]
  Vec3d position{0, 0, 0};        // [m]
  Vec3d velocity{0, 0, 0};        // [m/s]
  double diameter = 0, mass = 0;  // [m], [kg]
  double strength = 0, load = 0;  // [N] or [J]
  double speed = 0;               // [m/s] of the impact; by force, and asked, 0
  BreakCause cause = BreakCause::Pair;
  ParticleId first = no_particle;  // id of the first fragment; the others have the next ones
  std::size_t fragments = 0;
  std::size_t generation = 0;  // [-] of the particle: 0 is one that is no fragment
  double dust = 0;             // [kg]
};

/// The load that came nearest to a strength, or was above it the most.
struct LargestLoad {
  std::uint64_t weighed = 0;       // [-] loads so far, each of one particle
  double share = 0;                // [-] over the strength
  double load = 0, strength = 0;   // [N] or [J]
  double diameter = 0, speed = 0;  // [m], [m/s]; by force the speed is 0
};

/// Where the mass of a simulation is [kg]. `fed`: all that was added or came through inlets;
/// `present`: now in the simulation; `left`: through outlets, or removed.
struct MassBalance {
  double fed = 0, present = 0, left = 0, dust = 0;
  /// What the books cannot explain: rounding.
  double residual() const { return fed - present - left - dust; }
};

}  // namespace silt
