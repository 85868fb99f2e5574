// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <silt/bond/concept.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/engine/contact/contact_energy.hpp>

namespace silt::inline SILT_TARGET::detail {

/// When a bond ends, in half steps relative to the midpoint between two force computations.
enum class BondEnds : int {
  BeforeForces = -1,  // one of its particles was removed: its force acted until half a step ago
  AfterForces = 1     // overloaded: its force acts until the middle of the next step
};

/// A bond as readers see it. `dt` [s]: the step, if the bond ends now. The energy is corrected for
/// the interval until its force stops acting: work that its springs still do does not count as
/// lost, and dissipation of its dashpots does, as far as EnergyBook::bonds_damped() does not
/// include it.
template <class Model>
BondSeen see_bond(const Model& model, const BondStrain<double>& strain,
                  const typename Model::template Numbers<double>& numbers, double dt,
                  BondEnds ends = BondEnds::AfterForces) {
  const auto a = model.answer(strain, numbers);
  BondSeen out;
  out.normal = strain.normal, out.force = a.force, out.couple = a.couple;
  out.load = model.load(a, strain.normal, numbers);
  out.energy =
      model.energy(strain, numbers) -
      0.5 * static_cast<int>(ends) * dt *
          (dot(a.force, strain.shift_rate) + dot(a.couple, strain.turn_rate)) -
      0.25 * dt * (dot(a.rate_force, strain.shift_rate) + dot(a.rate_couple, strain.turn_rate));
  return out;
}

/// Bonds between particles and walls. There are few, so they are computed one by one.
template <class Model>
class WallBonds {
 public:
  struct Bond {
    ParticleId i;
    std::size_t wall;
    Vec3d place;  // [m] on the wall, in its coordinates
    BondRest<double> rest;
    typename Model::template Numbers<double> numbers;
    std::uint64_t number;
    bool excludes;  // the bond excludes the contact
  };
  DynArray<Bond> all;
  static constexpr double bent_at = bent_at_wall<Model>();  // [-] BondRest::share

  /// Removes the bonds of particles that have left and of walls that were removed.
  template <class Engine>
  void follow(const Engine& e) {
    if (all.empty()) return;
    for (Bond& b : all)
      if (!(e.find(b.i) < e.owners()) || e.walls[b.wall].surfaces.empty()) {
        if (b.excludes) e.particles.bonds.remove(b.i, e.particles.bonds.id_of_wall(b.wall));
        b.i = no_particle;
      }
    close_up();
  }
  /// Whether a bond between this particle and wall excludes their contact.
  bool exclude(ParticleId i, std::size_t wall) const {
    return std::any_of(all.begin(), all.end(),
                       [&](const Bond& b) { return b.excludes && b.i == i && b.wall == wall; });
  }
  void close_up() {
    erase_if(all, [](const Bond& b) { return b.i == no_particle; });
  }

  /// Adds the loads of all bonds to particles and walls; over(seen, place) is called for those that
  /// are overloaded. Returns the power of dashpots [W].
  template <class Engine, class Domain, class Over>
  double push(Engine& e, const Domain& domain, const Model& model, double dt, double ago,
              const Over& over) {
    double power = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Bond& b = all[k];
      Wall& wall = e.walls[b.wall];
      const std::size_t row = e.find(b.i);
      const auto ends = ends_at(e, domain, b, dt);
      auto s = strain_of(b.rest, ends);
      take_rates_of(ago, ends, s);
      const auto a = model.answer(s, b.numbers);
      const auto l = loads_of(s, a.force, a.couple, a.rate_force, a.rate_couple);
      const double inv_r = e.particles.motion[row].inv_r;
      add(e, row, l.force, inv_r * l.torque_i);
      const Vec3d at = wall.pose.to_space(b.place);
      const Vec3d torque = l.torque_j - cross(at - wall.reference, l.force);
      wall.force -= l.force, wall.torque += torque;
      wall.impulse -= dt * l.force, wall.angular_impulse += dt * torque;
      power += dot(a.rate_force, s.shift_rate) + dot(a.rate_couple, s.turn_rate);
      if (model.load(a, s.normal, b.numbers) > 1) over(seen(e, domain, model, k, dt), k);
    }
    return power;
  }
  template <class Engine, class Domain>
  BondSeen seen(const Engine& e, const Domain& domain, const Model& model, std::size_t k, double dt,
                BondEnds when = BondEnds::AfterForces) const {
    const Bond& b = all[k];
    const auto ends = ends_at(e, domain, b, dt);
    auto strain = strain_of(b.rest, ends);
    take_rates_of(0.5 * dt, ends, strain);
    BondSeen out = see_bond(model, strain, b.numbers, dt, when);
    out.a = b.i, out.wall = b.wall, out.number = b.number;
    out.to = e.particles.position[e.find(b.i)].centre(), out.from = out.to - ends.apart;
    return out;
  }
  template <class Engine, class Domain>
  double energy(const Engine& e, const Domain& domain, const Model& model, std::size_t k) const {
    return model.energy(strain_of(all[k].rest, ends_at(e, domain, all[k], 0)), all[k].numbers);
  }

 private:
  /// `dt`: the last step; 0: velocities do not matter.
  template <class Engine, class Domain>
  static BondedEnds<double> ends_at(const Engine& e, const Domain& domain, const Bond& b,
                                    double dt) {
    const std::size_t row = e.find(b.i);
    const Wall& wall = e.walls[b.wall];
    const auto& m = e.particles.motion[row];
    const Vec3d at = wall.pose.to_space(b.place);
    Vec3d d = e.particles.position[row].centre() - at;
    if constexpr (Domain::periodic) d = domain.shortest(d);
    Vec3d velocity{0, 0, 0}, spin{0, 0, 0};
    if (dt > 0 && wall.moves()) {
      velocity = mean_velocity(wall, at, dt);
      // Third order in the rotation per step.
      const Quaternion turn = wall.pose.rotation * conjugate(wall.last_pose.rotation);
      spin = (turn.w < 0 ? -2 : 2) / dt * turn.vector();
    }
    return {d,
            m.velocity() - velocity,
            e.particles.orientation[row],
            wall.pose.rotation,
            m.inv_r * m.spin_velocity(),
            spin};
  }
  template <class Engine>
  static void add(Engine& e, std::size_t row, const Vec3d& force, const Vec3d& torque) {
    using Scalar = typename Engine::Scalar;
    Scalar* const sum = e.load_sums() + row * 4 * Engine::chunks;
    sum[0] += static_cast<Scalar>(force.x), sum[1] += static_cast<Scalar>(force.y);
    sum[2] += static_cast<Scalar>(force.z), sum[4] += static_cast<Scalar>(torque.x);
    sum[5] += static_cast<Scalar>(torque.y), sum[6] += static_cast<Scalar>(torque.z);
  }
};

}  // namespace silt::detail
