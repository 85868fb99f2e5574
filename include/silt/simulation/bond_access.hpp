// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/core/names.hpp>
#include <silt/core/random.hpp>
#include <silt/engine/stages/bond_stage.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Bonds; a Simulation with the policy Bonds has these functions as its own.
template <class Sim>
class BondAccess {
 public:
  /// Bonds the particles with these ids, as they are now: without strain. They are no contact as
  /// long as the bond holds. InputError: one is not there, both are fixed, or they are bonded.
  template <class S = Sim>
  void bond(ParticleId a, ParticleId b) requires(S::has_bonds) {
    auto& e = sim().engine_;
    require(a != b, "Simulation::bond: particle ", a, " cannot be bonded to itself");
    const ParticleId i = std::min(a, b), j = std::max(a, b);
    const auto p = end_of_bond(i), q = end_of_bond(j);
    const double inv_m = p.inverse_mass() + q.inverse_mass();
    require(inv_m > 0, "Simulation::bond: particles ", i, " and ", j, " are both fixed");
    Vec3d d = p.centre() - q.centre();
    if constexpr (Sim::Domain::periodic) d = sim().domain_.shortest(d);
    const double length = norm(d);
    require(length > 0, "Simulation::bond: particles ", i, " and ", j, " are at one place");
    require(!e.particles.bonds.holds(i, j), "Simulation::bond: particles ", i, " and ", j,
            " are bonded already");
    const double r_i = p.radius(), r_j = q.radius(), factor = Sim::ShapeType::inertia_factor();
    const double inv_I =
        p.inverse_mass() / (factor * r_i * r_i) + q.inverse_mass() / (factor * r_j * r_j);
    const Quaternion q_i = e.particles.orientation[e.find(i)],
                     q_j = e.particles.orientation[e.find(j)];
    const auto rest =
        BondRest<double>::of(rotate(conjugate(q_j), d), r_i / (r_i + r_j), conjugate(q_j) * q_i);
    auto& stage = sim().bonds_;
    stage.add({i, j, rest,
               stage.model.numbers({r_i, r_j, length, 1 / inv_m, 1 / inv_I, share_of(i, j)}), 0});
    e.particles.bonds.add(i, j);
    e.lists.forget();
    sim().scene_changed_ = true;
  }
  /// Bonds a particle to a wall, by its number or name, at the wall's point `place` [m], which
  /// moves with the wall. The bond is as long as the way there, its radius is by the particle's
  /// alone. Its contact with the wall goes on acting beside it, unless it is excluded. InputError:
  /// there is no such particle or wall, it is fixed, or `place` is its centre.
  template <class S = Sim>
  void bond_to_wall(ParticleId id, const WhichWall& which, const Vec3d& place,
                    WallContact contact = WallContact::Acts) requires(S::has_bonds) {
    auto& e = sim().engine_;
    const auto p = end_of_bond(id);
    const std::size_t w = sim().wall_number(which);
    const Wall& wall = e.walls[w];
    require(!wall.surfaces.empty(), "Simulation::bond_to_wall: ", sim().wall_name(w),
            " has been removed");
    require(p.inverse_mass() > 0, "Simulation::bond_to_wall: particle ", id, " is fixed");
    require(is_finite(place), "Simulation::bond_to_wall: place = ", place, " [m] must be finite");
    const Vec3d d = p.centre() - place;
    require(norm(d) > 0, "Simulation::bond_to_wall: place = ", place,
            " [m] is the centre of particle ", id, "; give a point of the wall");
    const double r = p.radius();
    const Quaternion turned = conjugate(wall.pose.rotation);
    auto& stage = sim().bonds_;
    stage.add(typename std::remove_cvref_t<decltype(stage.at_walls)>::Bond{
        id, w, wall.pose.to_body(place),
        BondRest<double>::of(rotate(turned, d), 1, turned * e.particles.orientation[e.find(id)]),
        stage.model.numbers({r, r, norm(d), p.mass(),
                             Sim::ShapeType::inertia_factor() * p.mass() * r * r,
                             share_of(id, no_particle - w)}),
        0, contact == WallContact::Excluded});
    if (contact == WallContact::Excluded)
      e.particles.bonds.add(id, e.particles.bonds.id_of_wall(w)), e.lists.forget();
    sim().scene_changed_ = true;
  }
  /// Whether these two are bonded.
  template <class S = Sim>
  bool bonded(ParticleId a, ParticleId b) const requires(S::has_bonds) {
    return sim().engine_.particles.bonds.holds(a, b);
  }
  /// Calls f(const BondSeen&) for each bond, in the order in which they were made.
  template <class F, class S = Sim>
  void for_each_bond(const F& f) const requires(S::has_bonds) {
    sim().bonds_.visit(sim().engine_, sim().domain_, f);
  }
  /// Bonds that hold now [-], and those that broke since the start, with a particle that broke
  /// (Breakage) too. Those of particles that left are in neither.
  template <class S = Sim>
  std::size_t bonds() const requires(S::has_bonds) {
    return sim().bonds_.size(sim().engine_);
  }
  template <class S = Sim>
  std::uint64_t broken_bonds() const requires(S::has_bonds) {
    return sim().bonds_.broken;
  }
  /// [J] in the springs of all bonds now.
  template <class S = Sim>
  double bond_energy() const requires(S::has_bonds) {
    return sim().bonds_.energy(sim().engine_, sim().domain_);
  }

  // Without the policy: a sentence.
  template <class S = Sim, class... Any>
  void bond(const Any&...) requires(!S::has_bonds) {
    needs_policy<S>();
  }
  template <class S = Sim, class... Any>
  void bond_to_wall(const Any&...) requires(!S::has_bonds) {
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
  /// [s] in which what bonds do is resolved as contacts are, by a 20th of half a swing; and at most
  /// 0.4 of what is stable.
  double longest_bond_step() const {
    const auto most = fastest_bond();
    return most.rate > 0 ? std::min(std::numbers::pi / 20 / most.rate, 0.4 * most.stable_step)
                         : 0.4 * most.stable_step;
  }
  /// [s] in which bonds do not gain energy.
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
    if constexpr (Sim::has_bonds) {
      return sim().bonds_.fastest(sim().engine_);
    } else {
      struct Rate {
        double rate = 0, stable_step = INFINITY;
        ParticleId particle = no_particle;
      };
      return Rate{};
    }
  }
  auto end_of_bond(ParticleId id) const {
    const auto& e = sim().engine_;
    const std::size_t k = e.find(id);
    require(k < e.owners(), "Simulation::bond: there is no particle ", id);
    return e.owner(k);
  }
  /// [-] in (0, 1), by the seed and the ends alone.
  double share_of(ParticleId i, ParticleId j) const {
    const std::uint64_t of_seed = Random(sim().bonds_.seed).bits();
    return Random(of_seed + 0x9e3779b97f4a7c15u * i + j).open_uniform();
  }
  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
};

}  // namespace silt::detail
