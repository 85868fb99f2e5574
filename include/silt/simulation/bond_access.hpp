// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/names.hpp>
#include <silt/core/random.hpp>
#include <silt/engine/stages/bond_stage.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Bonds; these are member functions of a Simulation with the policy Bonds.
template <class Sim>
class BondAccess {
 public:
  /// Bonds the particles with these ids at their present positions, without strain. They are not in
  /// contact as long as the bond exists. InputError: a particle does not exist, both are fixed, or
  /// they are already bonded. With several ranks it is collective, as are the functions below;
  /// bond_all() is then faster.
  template <class S = Sim>
  void bond(ParticleId a, ParticleId b) requires(S::has_bonds) {
    if constexpr (S::has_ranks) {
      bond_all(DynArray<std::pair<ParticleId, ParticleId>>{{a, b}});
    } else {
      auto& e = sim().engine_;
      require(a != b, "Simulation::bond: particle ", a, " cannot be bonded to itself");
      const ParticleId i = std::min(a, b), j = std::max(a, b);
      const BondEnd p = end_of_bond(i), q = end_of_bond(j);
      add_bond(i, j, p, q, true);
      e.lists.forget();
      sim().scene_changed_ = true;
    }
  }
  /// The same for several pairs.
  template <class S = Sim>
  void bond_all(const DynArray<std::pair<ParticleId, ParticleId>>& pairs) requires(S::has_bonds) {
    if constexpr (!S::has_ranks) {
      for (const auto& [a, b] : pairs) bond(a, b);
    } else {
      if (pairs.empty()) return;
      auto& e = sim().engine_;
      DynArray<std::pair<ParticleId, ParticleId>> sorted;
      for (const auto& [a, b] : pairs) sorted.push_back(std::minmax(a, b));
      const std::unordered_map<ParticleId, BondEnd> ends = ends_of_ranks(sorted);
      const auto end_of = [&](ParticleId id) {
        const auto found = ends.find(id);
        require(found != ends.end(), "Simulation::bond: there is no particle ", id);
        return found->second;
      };
      e.ranks.together("bonds that are made", [&] {
        DynArray<std::pair<ParticleId, ParticleId>> seen = sorted;
        std::sort(seen.begin(), seen.end());
        const auto twice = std::adjacent_find(seen.begin(), seen.end());
        if (twice != seen.end())
          throw InputError(text("Simulation::bond: particles ", twice->first, " and ",
                                twice->second, " are to be bonded twice"));
        for (const auto& [i, j] : sorted) {
          require(i != j, "Simulation::bond: particle ", i, " cannot be bonded to itself");
          check_ends(i, j, end_of(i), end_of(j));
        }
      });
      for (const auto& [i, j] : sorted) {
        const BondEnd &p = ends.at(i), &q = ends.at(j);
        add_bond(i, j, p, q, e.find(i) < e.owners() || e.find(j) < e.owners());
      }
      sim().bonds_.fresh = e.ranks.size() > 1, sim().bonds_.loaded = false;
      e.lists.forget();
      sim().scene_changed_ = true;
    }
  }
  /// Bonds a particle to a wall, given by number or name, at the wall's point `place` [m], which
  /// moves with the wall. The bond is as long as the distance to that point; its radius follows
  /// from the particle's alone. The contact with the wall stays active in addition, unless it is
  /// excluded. InputError: no such particle or wall, the particle is fixed, `place` is its centre,
  /// or it is bonded there already.
  template <class S = Sim>
  void bond_to_wall(ParticleId id, const WhichWall& which, const Vec3d& place,
                    WallContact contact = WallContact::Acts) requires(S::has_bonds) {
    auto& e = sim().engine_;
    const BondEnd p = [&] {
      if constexpr (S::has_ranks) {
        const auto ends = ends_of_ranks(DynArray<std::pair<ParticleId, ParticleId>>{{id, id}});
        require(!ends.empty(), "Simulation::bond: there is no particle ", id);
        return ends.begin()->second;
      } else {
        return end_of_bond(id);
      }
    }();
    const std::size_t w = sim().wall_number(which);
    const Wall& wall = e.walls[w];
    require(!wall.is_removed(), "Simulation::bond_to_wall: ", sim().wall_name(w),
            " has been removed");
    require(p.inverse_mass > 0, "Simulation::bond_to_wall: particle ", id, " is fixed");
    require(is_finite(place), "Simulation::bond_to_wall: place = ", place, " [m] must be finite");
    const Vec3d d = p.centre - place;
    require(norm(d) > 0, "Simulation::bond_to_wall: place = ", place,
            " [m] is the centre of particle ", id, "; give a point of the wall");
    const double r = p.radius;
    const Quaternion turned = conjugate(wall.pose.rotation);
    auto& stage = sim().bonds_;
    for (const auto& b : stage.at_walls.all)
      require(b.i != id || b.wall != w || !(b.place == wall.pose.to_body(place)),
              "Simulation::bond_to_wall: particle ", id, " is bonded to ", sim().wall_name(w),
              " at ", place, " m already");
    if (!S::has_ranks || e.find(id) < e.owners()) {
      using AtWalls = std::remove_cvref_t<decltype(stage.at_walls)>;
      stage.add(typename AtWalls::Bond{
          id, w, wall.pose.to_body(place),
          BondRest<double>::of(rotate(turned, d), AtWalls::bent_at, turned * p.orientation),
          numbers_of({r, r, norm(d), p.mass, Sim::ShapeType::inertia_factor() * p.mass * r * r,
                      share_of(id, no_particle - w)},
                     [&] { return text("particle ", id, " to ", sim().wall_name(w)); }),
          0, contact == WallContact::Excluded});
      if (contact == WallContact::Excluded)
        e.particles.bonds.add(id, e.particles.bonds.id_of_wall(w));
    } else {
      stage.count();
    }
    if (contact == WallContact::Excluded) e.lists.forget();
    sim().scene_changed_ = true;
  }
  /// Breaks the bond of two particles in the next step, as if it were overloaded: it is counted,
  /// reported and booked, and the two touch from then on. In observers and between runs. InputError
  /// if they are not bonded. With several ranks it is collective.
  template <class S = Sim>
  void unbond(ParticleId a, ParticleId b) requires(S::has_bonds) {
    require(bonded(a, b), "Simulation::unbond: particles ", a, " and ", b, " are not bonded");
    sim().bonds_.asked.push_back(std::minmax(a, b));
  }
  /// The same for all bonds of a particle to a wall, given by number or name.
  template <class S = Sim>
  void unbond_from_wall(ParticleId id, const WhichWall& which) requires(S::has_bonds) {
    const std::size_t w = sim().wall_number(which);
    const auto& all = sim().bonds_.at_walls.all;
    const bool here = std::any_of(all.begin(), all.end(),
                                  [&](const auto& b) { return b.i == id && b.wall == w; });
    require(sim().largest_over_ranks(here ? 1 : 0) > 0, "Simulation::unbond_from_wall: particle ",
            id, " has no bond to ", sim().wall_name(w));
    sim().bonds_.asked.push_back({id, sim().engine_.particles.bonds.id_of_wall(w)});
  }
  /// Whether these two are bonded.
  template <class S = Sim>
  bool bonded(ParticleId a, ParticleId b) const requires(S::has_bonds) {
    const bool here = sim().engine_.particles.bonds.holds(a, b);
    return sim().largest_over_ranks(here ? 1 : 0) > 0;
  }
  /// Calls f(const BondSeen&) for each bond, in order of creation. With several ranks each visits
  /// the bonds whose end with the lower id it owns (not collective); bonds that have just been made
  /// are known there after the next step.
  template <class F, class S = Sim>
  void for_each_bond(const F& f) const requires(S::has_bonds) {
    need_no_fresh_bonds("for_each_bond");
    sim().bonds_.visit(sim().engine_, sim().domain_, f);
  }
  /// Number of existing bonds [-], and of those broken since the start, including bonds of
  /// particles that broke (Breakage). Bonds of particles that left are in neither.
  template <class S = Sim>
  std::size_t bonds() const requires(S::has_bonds) {
    const std::size_t own = sim().bonds_.size(sim().engine_);
    if constexpr (S::has_ranks)
      return static_cast<std::size_t>(sim().sum_over_ranks(static_cast<double>(own)));
    return own;
  }
  template <class S = Sim>
  std::uint64_t broken_bonds() const requires(S::has_bonds) {
    return sim().bonds_.broken;
  }
  /// [J] stored in all bonds now.
  template <class S = Sim>
  double bond_energy() const requires(S::has_bonds) {
    return sim().sum_over_ranks(own_bond_energy());
  }
  /// The id of the next particle to be added.
  template <class S = Sim>
  ParticleId coming_id() const requires(S::has_bonds) {
    return sim().next_.particle;
  }

  // Without the policy: a compile-time message.
  template <class S = Sim, class... Any>
  void bond(const Any&...) requires(!S::has_bonds) {
    needs_policy<S>();
  }
  template <class S = Sim, class... Any>
  void bond_all(const Any&...) requires(!S::has_bonds) {
    needs_policy<S>();
  }
  template <class S = Sim, class... Any>
  void bond_to_wall(const Any&...) requires(!S::has_bonds) {
    needs_policy<S>();
  }
  template <class S = Sim, class... Any>
  void unbond(const Any&...) requires(!S::has_bonds) {
    needs_policy<S>();
  }
  template <class S = Sim, class... Any>
  void unbond_from_wall(const Any&...) requires(!S::has_bonds) {
    needs_policy<S>();
  }
  template <class F, class S = Sim>
  void for_each_bond(const F&) const requires(!S::has_bonds) {
    needs_policy<S>();
  }
  template <class S = Sim>
  std::size_t bonds() const requires(!S::has_bonds) {
    return needs_policy<S>(), 0;
  }

 protected:
  template <class Policy>
  void set_bonds(const Policy& policy) {
    if constexpr (requires { policy.model.check(); }) policy.model.check();
    sim().bonds_.model = policy.model, sim().bonds_.seed = policy.seed;
  }
  /// [J] of the bonds counted on this rank.
  double own_bond_energy() const {
    need_no_fresh_bonds("bond_energy");
    return sim().bonds_.energy(sim().engine_, sim().domain_);
  }
  void need_no_fresh_bonds(const char* what) const {
    require(!sim().bonds_.fresh, "Simulation::", what,
            sim().bonds_.loaded ? ": the checkpoint is of another number of ranks, and ranks do "
                                  "not know yet both ends of their bonds"
                                : ": bonds were made whose ends may be on two ranks",
            "; run() first for at least a step, as by run(step_length()), without observers that "
            "read bonds, energies or save");
  }
  /// The time step limits from the bonds of all ranks (collective).
  template <class S = Sim>
  void share_bonds() requires(S::has_ranks) {
    auto own = sim().bonds_.fastest(sim().engine_);
    for (const auto& one : gather_each(sim().engine_.ranks.comm(), own)) {
      own.rate = std::max(own.rate, one.rate);
      if (one.stable_step < own.stable_step ||
          (one.stable_step == own.stable_step && one.particle < own.particle))
        own.stable_step = one.stable_step, own.particle = one.particle;
    }
    auto& all = sim().ranks_scene_;
    all.bond_rate = own.rate, all.bond_step = own.stable_step, all.bonded = own.particle;
  }
  /// [s] Longest step that resolves bond oscillations as well as contacts, with a 20th of half a
  /// period; and at most 0.4 of the stable step.
  double longest_bond_step() const {
    const auto most = fastest_bond();
    return most.rate > 0 ? std::min(std::numbers::pi / 20 / most.rate, 0.4 * most.stable_step)
                         : 0.4 * most.stable_step;
  }
  /// [s] Longest step in which bonds gain no energy.
  double longest_stable_bond_step() const { return fastest_bond().stable_step; }
  void check_bond_step(double dt) const {
    const auto most = fastest_bond();
    require(!(dt > most.stable_step), "Simulation::time_step = ", dt,
            " [s] is too long for the bonds of particle ", most.particle,
            ", their springs and dashpots: it must be at most ", most.stable_step,
            " s; lower it, leave it out, or soften the bonds");
  }

 private:
  template <class S>
  static void needs_policy() {
    static_assert(S::has_bonds, "give the simulation silt::Bonds{model} among its policies");
  }
  auto fastest_bond() const {
    if constexpr (Sim::has_bonds && Sim::has_ranks) {
      using Rate = decltype(sim().bonds_.fastest(sim().engine_));
      const auto& all = sim().ranks_scene_;
      return Rate{all.bond_rate, all.bond_step, all.bonded};
    } else if constexpr (Sim::has_bonds) {
      return sim().bonds_.fastest(sim().engine_);
    } else {
      struct Rate {
        double rate = 0, stable_step = INFINITY;
        ParticleId particle = no_particle;
      };
      return Rate{};
    }
  }
  /// An end of a bond.
  struct BondEnd {
    Vec3d centre;                       // [m]
    double radius, inverse_mass, mass;  // [m], [1/kg], [kg]
    Quaternion orientation;
  };
  BondEnd end_at(std::size_t k) const {
    const auto& e = sim().engine_;
    const auto p = e.owner(k);
    return {p.centre(), p.radius(), p.inverse_mass(), p.mass(), e.particles.orientation[k]};
  }
  BondEnd end_of_bond(ParticleId id) const {
    const auto& e = sim().engine_;
    const std::size_t k = e.find(id);
    require(k < e.owners(), "Simulation::bond: there is no particle ", id);
    return end_at(k);
  }
  /// The particles of these pairs, on whatever rank they are (collective).
  std::unordered_map<ParticleId, BondEnd> ends_of_ranks(
      const DynArray<std::pair<ParticleId, ParticleId>>& pairs) const {
    struct Known {
      ParticleId id;
      BondEnd end;
    };
    const auto& e = sim().engine_;
    std::unordered_map<ParticleId, BondEnd> all;
    DynArray<Known> own;
    for (const auto& pair : pairs)
      for (const ParticleId id : {pair.first, pair.second})
        if (const std::size_t k = e.find(id);
            k < e.owners() && all.try_emplace(id, end_at(k)).second)
          own.push_back({id, end_at(k)});
    e.ranks.meet("ends of bonds");
    for (const Known& one : gather(e.ranks.comm(), std::span<const Known>(own)).values)
      all.try_emplace(one.id, one.end);
    return all;
  }
  void check_ends(ParticleId i, ParticleId j, const BondEnd& p, const BondEnd& q) const {
    require(p.inverse_mass + q.inverse_mass > 0, "Simulation::bond: particles ", i, " and ", j,
            " are both fixed");
    require(norm(way(p, q)) > 0, "Simulation::bond: particles ", i, " and ", j,
            " are at one place");
    require(!sim().engine_.particles.bonds.holds(i, j), "Simulation::bond: particles ", i, " and ",
            j, " are bonded already");
  }
  Vec3d way(const BondEnd& p, const BondEnd& q) const {
    Vec3d d = p.centre - q.centre;
    if constexpr (Sim::Domain::periodic) d = sim().domain_.shortest(d);
    return d;
  }
  /// `here`: one of the ends is on this rank; else the bond is only counted.
  void add_bond(ParticleId i, ParticleId j, const BondEnd& p, const BondEnd& q, bool here) {
    auto& e = sim().engine_;
    auto& stage = sim().bonds_;
    if (!here) return stage.count();
    check_ends(i, j, p, q);
    const double inv_m = p.inverse_mass + q.inverse_mass;
    const Vec3d d = way(p, q);
    const double length = norm(d);
    const double r_i = p.radius, r_j = q.radius, factor = Sim::ShapeType::inertia_factor();
    const double inv_I =
        p.inverse_mass / (factor * r_i * r_i) + q.inverse_mass / (factor * r_j * r_j);
    const Quaternion q_i = p.orientation, q_j = q.orientation;
    const auto rest =
        BondRest<double>::of(rotate(conjugate(q_j), d), r_i / (r_i + r_j), conjugate(q_j) * q_i);
    stage.add({i, j, rest,
               numbers_of({r_i, r_j, length, 1 / inv_m, 1 / inv_I, share_of(i, j)},
                          [&] { return text("particles ", i, " and ", j); }),
               0});
    e.particles.bonds.add(i, j);
  }
  /// The numbers of a new bond; `ends()` names it. InputError if the model's functions give no
  /// numbers for it: with a load that is not a number it would never break, with such a stiffness
  /// it would limit no step.
  template <class Ends>
  auto numbers_of(const BondedPair& pair, const Ends& ends) const {
    const auto& model = sim().bonds_.model;
    const auto numbers = model.numbers(pair);
    BondStrain<double> none{};
    none.normal = {1, 0, 0}, none.r0 = 1;
    const double load = model.load(model.answer(none, numbers), none.normal, numbers);
    if (std::isnan(load))
      throw InputError(text("Bonds: load() of the unstrained bond of ", ends(), " is ", load,
                            "; mend the model's numbers(), answer() or load()"));
    const BondStiffness k = model.stiffest(numbers);
    const std::array most{k.shift, k.turn, k.shift_damping, k.turn_damping};
    double sum = 0;
    for (const double x : most) sum += x >= 0 ? x : std::numeric_limits<double>::quiet_NaN();
    if (!(sum > 0 && std::isfinite(sum)))
      throw InputError(text("Bonds: stiffest() of the bond of ", ends(), " is {", k.shift, " N/m, ",
                            k.turn, " N m, ", k.shift_damping, " N s/m, ", k.turn_damping,
                            " N m s}; they must be finite, at least 0, and not all 0, as the time "
                            "step is chosen from them"));
    return numbers;
  }
  /// [-] in (0, 1), depends on the seed and the ends only.
  double share_of(ParticleId i, ParticleId j) const {
    const std::uint64_t of_seed = Random(sim().bonds_.seed).bits();
    return Random(of_seed + 0x9e3779b97f4a7c15u * i + j).open_uniform();
  }
  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
};

}  // namespace silt::detail
