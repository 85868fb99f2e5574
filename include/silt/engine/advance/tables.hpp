// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <silt/core/id_table.hpp>
#include <silt/engine/advance/body_motion.hpp>
#include <silt/engine/advance/owner.hpp>
#include <silt/engine/advance/sphere_motion.hpp>
#include <silt/engine/state/composition.hpp>
#include <silt/engine/state/particle_state.hpp>

namespace silt::inline SILT_TARGET::detail {

template <bool HasBodies>
struct MoverOf {
  template <class Composition, class State>
  using type = SphereMotion<Composition, State>;
};
template <>
struct MoverOf<true> {
  template <class Composition, class State>
  using type = BodyMotion<Composition, State>;
};

/// All that is known of particles, in two tables: rows, which contacts act on, and owners, which
/// move. Of spheres they are one; of bodies rows are the parts.
template <class Composition>
class Tables {
  static constexpr bool of_bodies = Composition::of_bodies;
  using Domain = typename Composition::Domain;

 public:
  using State = ParticleState<Composition>;
  using Mover = typename MoverOf<of_bodies>::template type<Composition, State>;

  State particles;  // rows
  Mover mover;      // owners, if they are no rows, and how they move

  /// The number of the particle that a row is, or belongs to.
  ParticleId id_of(std::size_t row) const {
    if constexpr (of_bodies)
      return mover.bodies[particles.part[row].body].id;
    else
      return particles.id[row];
  }
  /// The particle (sphere or body) at place k of owners().
  auto owner(std::size_t k) const { return Owner<Composition, State, Mover>(particles, mover, k); }
  std::size_t owners() const { return Owner<Composition, State, Mover>::count(particles, mover); }
  /// [m3] of the particle at place k.
  double volume_of(std::size_t k) const {
    const auto p = owner(k);
    if constexpr (of_bodies) {
      const double s = p.scale();
      return mover.forms[p.form()].mass.volume * s * s * s;
    } else {
      return Composition::Shape::volume(p.radius());
    }
  }
  /// Particles that are there.
  std::size_t present() const {
    if constexpr (of_bodies)
      return static_cast<std::size_t>(std::count_if(
          mover.bodies.begin(), mover.bodies.begin() + static_cast<std::ptrdiff_t>(mover.owned()),
          [](const auto& b) { return b.id != no_particle; }));
    else
      return particles.owned() - particles.parked;
  }
  /// Changes the velocity of the particle at place k by dv [m/s].
  void change_velocity(std::size_t k, const Vec3d& dv) {
    if constexpr (of_bodies) {
      mover.bodies[k].velocity += dv;
    } else {
      auto& m = particles.motion[k];
      m.vx += dv.x, m.vy += dv.y, m.vz += dv.z;
    }
  }
  /// Changes its angular velocity by dw [rad/s].
  void change_angular_velocity(std::size_t k, const Vec3d& dw) requires(Composition::rotates) {
    if constexpr (of_bodies) {
      auto& b = mover.bodies[k];
      const Vec3d turned = rotate(conjugate(b.orientation), dw);
      b.momentum += {turned.x * b.inertia.x, turned.y * b.inertia.y, turned.z * b.inertia.z};
    } else {
      auto& m = particles.motion[k];
      const Vec3d spin = particles.position[k].r * dw;
      m.wx += spin.x, m.wy += spin.y, m.wz += spin.z;
    }
  }
  /// Records another angular velocity [rad/s] at the whole step.
  void set_angular_velocity_now(std::size_t k, const Vec3d& w) requires(Composition::rotates) {
    if constexpr (of_bodies)
      mover.synchronous[k].angular_velocity = w;
    else
      mover.synchronous[k].spin_velocity = particles.position[k].r * w;
  }
  /// Gives the particle at place k another radius [m], of bodies that of the bounding sphere.
  /// Density, place, velocity and angular velocity stay. Calls grown(row, growth of its radius [m],
  /// way of its centre [m]) for each of its rows.
  template <class Grown>
  void set_radius(std::size_t k, double radius, const Grown& grown) {
    if constexpr (of_bodies) {
      mover.set_radius(particles, k, radius, grown);
    } else {
      const double ratio = radius / particles.position[k].r,
                   growth = radius - particles.position[k].r;
      particles.position[k].r = radius;
      auto& m = particles.motion[k];
      m.inv_m /= ratio * ratio * ratio;
      if constexpr (Composition::rotates) {
        m.wx *= ratio, m.wy *= ratio, m.wz *= ratio, m.inv_r = 1 / radius;
        if (k < mover.synchronous.size())
          mover.synchronous[k].spin_velocity = ratio * mover.synchronous[k].spin_velocity;
        if constexpr (State::derivative_rows > 0)
          for (std::size_t d = State::derivative_rows / 2; d < State::derivative_rows; ++d)
            for (double& x : particles.derivatives[k].row[d]) x *= ratio;
      }
      particles.renew_pair_motion(k);
      particles.include_size(k, radius - growth);
      grown(k, growth, 0.0);
    }
  }
  void set_material(std::size_t k,
                    std::uint16_t material) requires(Composition::several_materials) {
    if constexpr (of_bodies) {
      for (const std::uint32_t row : mover.rows_of(mover.bodies[k]))
        particles.material[row] = material;
    } else {
      particles.material[k] = material;
    }
  }
  /// After the motion of the particle at place k was changed: what follows from it.
  void follow_motion(std::size_t k) {
    if constexpr (of_bodies)
      mover.put_in_place(particles, mover.bodies[k]);
    else
      particles.renew_pair_motion(k);
  }
  /// Gives the rows from `first` on, which have come between the kick and drift of a step, what the
  /// integrator predicts their next state from: free fall.
  void start_prediction([[maybe_unused]] std::size_t first, [[maybe_unused]] const Vec3d& gravity,
                        [[maybe_unused]] double dt) {
    if constexpr (!of_bodies && State::derivative_rows > 0)
      for (std::size_t k = first; k < particles.owned(); ++k) {
        particles.derivatives[k] = {};
        if (particles.motion[k].inv_m == 0) continue;
        auto& row = particles.derivatives[k].row[0];
        const Vec3d half = 0.5 * dt * dt * gravity;  // Integrator: dt^2/2 times the acceleration
        row[0] = half.x, row[1] = half.y, row[2] = half.z;
      }
  }
  /// The place of the particle with this id; owners() if there is none.
  std::size_t find(ParticleId wanted) const {
    const std::size_t n = owners();
    if (indexed_ != particles.changes)
      places_.clear(), indexed_to_ = 0, indexed_ = particles.changes;
    for (; indexed_to_ < n; ++indexed_to_)
      if (const ParticleId id = owner(indexed_to_).id(); id != no_particle)
        places_.at(id) = static_cast<std::uint32_t>(indexed_to_);
    const std::uint32_t k = wanted == no_particle ? no_place : places_.find(wanted);
    return k == no_place || owner(k).id() != wanted ? n : k;  // one that has left may stand there
  }
  /// What modules see of the particle at place k.
  Seen seen(std::size_t k, double time) const {
    const auto p = owner(k);
    return {p.id(),   p.centre(),   p.velocity(), p.angular_velocity(), p.orientation(), p.radius(),
            p.mass(), p.material(), time};
  }
  /// The columns of modules, a row each owner.
  auto& modules() {
    if constexpr (of_bodies)
      return mover.modules;
    else
      return particles.modules;
  }
  const auto& modules() const { return const_cast<Tables&>(*this).modules(); }
  /// The place of the particle that a row is, or belongs to.
  std::size_t owner_of(std::size_t row) const {
    if constexpr (of_bodies)
      return particles.part[row].body;
    else
      return row;
  }
  /// Which part of its particle a row is [-]; of spheres 0.
  std::uint32_t part_of([[maybe_unused]] std::uint32_t row) const {
    if constexpr (of_bodies)
      return particles.part[row].local;
    else
      return 0;
  }
  /// The centre of mass of a row's particle [m], beside the row.
  Vec3d centre_beside(std::size_t row) const {
    if constexpr (of_bodies) {
      const auto& part = particles.part[row];
      return mover.bodies[part.body].centre + part.image;
    } else {
      return particles.position[row].centre();
    }
  }
  /// What a fluid does to each particle (body, or row).
  auto& fluid_loads() {
    if constexpr (of_bodies)
      return mover.fluid;
    else
      return particles.fluid;
  }
  const auto& fluid_loads() const { return const_cast<Tables&>(*this).fluid_loads(); }
  /// What rotation adds to the inverse mass [1/kg] against a push along n at the surface of a row.
  double turning([[maybe_unused]] std::size_t row, [[maybe_unused]] const Vec3d& n) const {
    if constexpr (of_bodies)
      return mover.turning(particles.part[row], n);
    else
      return 0;
  }
  /// Takes the particle at place k (a body, or a row) out of all contacts at once.
  void park(std::size_t k) {
    if constexpr (of_bodies) {
      for (const std::uint32_t row : mover.rows_of(mover.bodies[k])) particles.park(row);
      mover.fluid.leave(k);
      park_row(mover.fluid, k), park_row(mover.modules, k);
      mover.bodies[k].id = no_particle;
    } else {
      particles.park(k);
    }
  }

  /// Gives the particle at place `to` what modules and fluid know of the one at `from`, and its
  /// velocities at the last observed step.
  void copy_columns(std::size_t from, std::size_t to) {
    copy_row(modules(), from, to), copy_row(fluid_loads(), from, to);
    if (to < mover.synchronous.size()) mover.synchronous[to] = mover.synchronous[from];
  }
  /// After a search has sorted the parts and wrapped them into a periodic box.
  void follow([[maybe_unused]] const Domain& domain) {
    if constexpr (of_bodies) {
      mover.follow(particles);
      if constexpr (Domain::periodic) mover.wrap(particles, domain);
    }
  }

 protected:
  /// After another state was put in place of this one.
  void forget_places() { indexed_ = never_indexed; }

 private:
  static constexpr std::uint64_t never_indexed = std::numeric_limits<std::uint64_t>::max();
  mutable std::uint64_t indexed_ = never_indexed;  // particles.changes that places_ is of
  mutable std::size_t indexed_to_ = 0;             // owners that it has
  // Of ids of all ranks one has few.
  mutable std::conditional_t<Composition::has_ranks, IdHash, IdTable> places_;
};

}  // namespace silt::detail
