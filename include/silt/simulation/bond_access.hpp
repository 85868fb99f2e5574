// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/core/random.hpp>
#include <silt/engine/stages/bond_stage.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Bonds between particles; a Simulation with the policy Bonds has these functions as its own.
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
    for (const ParticleId id : {i, j})
      require(e.find(id) < e.owners(), "Simulation::bond: there is no particle ", id);
    const std::size_t at_i = e.find(i), at_j = e.find(j);
    const auto p = e.owner(at_i), q = e.owner(at_j);
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
    const Quaternion q_i = e.particles.orientation[at_i], q_j = e.particles.orientation[at_j];
    const BondRest<double> rest{rotate(conjugate(q_j), d), r_i / (r_i + r_j), conjugate(q_j) * q_i};
    auto& stage = sim().bonds_;
    Random random(stage.seed + 0x9e3779b97f4a7c15u * i + j);
    const double share = random.uniform();
    stage.add(
        {i, j, rest, stage.model.numbers({r_i, r_j, length, 1 / inv_m, 1 / inv_I, share}), 0});
    e.particles.bonds.add(i, j);
    e.lists.forget();
    sim().scene_changed_ = true;
  }
  /// Whether these two are bonded.
  template <class S = Sim>
  bool bonded(ParticleId a, ParticleId b) const requires(S::has_bonds) {
    return sim().engine_.particles.bonds.holds(a, b);
  }
  /// Calls f(const Bond<Model>&) for each unbroken bond, in the order in which they were made.
  template <class F, class S = Sim>
  void for_each_bond(const F& f) const requires(S::has_bonds) {
    sim().bonds_.list.for_each_in_order(f);
  }
  /// Unbroken bonds [-], and those that broke since the start.
  template <class S = Sim>
  std::size_t bonds() const requires(S::has_bonds) {
    return sim().bonds_.size();
  }
  template <class S = Sim>
  std::uint64_t broken_bonds() const requires(S::has_bonds) {
    return sim().bonds_.broken;
  }
  /// [J] in the springs of all bonds now.
  template <class S = Sim>
  double bond_energy() requires(S::has_bonds) {
    return sim().bonds_.energy(sim().engine_, sim().domain_);
  }

 protected:
  template <class Model>
  void set_bond_model(const Model& model) {
    if constexpr (requires { model.check(); }) model.check();
    sim().bonds_.model = model;
  }
  /// [s] in which what bonds do is resolved as contacts are, by a 20th of half a swing.
  double longest_bond_step() const {
    if constexpr (Sim::has_bonds) {
      auto& stage = const_cast<Sim&>(sim()).bonds_;
      const double rate = stage.fastest(const_cast<Sim&>(sim()).engine_).rate;
      return rate > 0 ? std::numbers::pi / 20 / rate : INFINITY;
    } else {
      return INFINITY;
    }
  }

 private:
  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
};

}  // namespace silt::detail
