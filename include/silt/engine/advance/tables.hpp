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

/// The state of all particles in two tables: rows, which contacts act on, and owners, which move.
/// For spheres both are the same; for bodies the rows are their parts.
template <class Composition>
class Tables {
  static constexpr bool of_bodies = Composition::of_bodies;
  using Domain = typename Composition::Domain;

 public:
  using State = ParticleState<Composition>;
  using Mover = typename MoverOf<of_bodies>::template type<Composition, State>;

  State particles;  // rows
  Mover mover;      // owners, unless they are the rows, and their integration

  /// The id of the particle that a row is or belongs to.
  ParticleId id_of(std::size_t row) const {
    if constexpr (of_bodies)
      return mover.bodies[particles.part[row].body].id;
    else
      return particles.id[row];
  }
  /// The particle (sphere or body) at place k of owners().
  auto owner(std::size_t k) const { return Owner<Composition, State, Mover>(particles, mover, k); }
  std::size_t owners() const { return Owner<Composition, State, Mover>::count(particles, mover); }
  /// The number of owners and, behind them, ghosts.
  std::size_t places() const {
    if constexpr (of_bodies)
      return mover.bodies.size();
    else
      return particles.size();
  }
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
  /// Number of particles present.
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
  /// Changes the angular velocity of the particle at place k by dw [rad/s].
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
  /// Changes the recorded angular velocity [rad/s] at the whole step.
  void set_angular_velocity_now(std::size_t k, const Vec3d& w) requires(Composition::rotates) {
    if constexpr (of_bodies)
      mover.synchronous[k].angular_velocity = w;
    else
      mover.synchronous[k].spin_velocity = particles.position[k].r * w;
  }
  /// Sets the radius [m] of the particle at place k; for bodies, of the bounding sphere. Density,
  /// position, velocity and angular velocity are unchanged. Calls grown(row, increase of its radius
  /// [m], displacement of its centre [m]) for each of its rows.
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
  /// Must be called after the motion of the particle at place k was changed.
  void follow_motion(std::size_t k) {
    if constexpr (of_bodies)
      mover.put_in_place(particles, mover.bodies[k]);
    else
      particles.renew_pair_motion(k);
  }
  /// Initialises the data from which the integrator predicts the next state (free fall) for the
  /// rows from `first` on, added between the kick and the drift of a step.
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
    return k == no_place || owner(k).id() != wanted ? n : k;  // it may have left
  }
  /// The particle at place k as modules see it.
  Seen seen(std::size_t k, double time) const {
    const auto p = owner(k);
    return {p.id(),   p.centre(),   p.velocity(), p.angular_velocity(), p.orientation(), p.radius(),
            p.mass(), p.material(), time};
  }
  /// The columns of modules, one row per owner.
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
  /// The number of the part that a row is in its particle [-]; 0 for spheres.
  std::uint32_t part_of([[maybe_unused]] std::uint32_t row) const {
    if constexpr (of_bodies)
      return particles.part[row].local;
    else
      return 0;
  }
  /// The centre of mass of a row's particle [m], in the image of the row.
  Vec3d centre_beside(std::size_t row) const {
    if constexpr (of_bodies) {
      const auto& part = particles.part[row];
      return mover.bodies[part.body].centre + part.image;
    } else {
      return particles.position[row].centre();
    }
  }
  /// Fluid loads of each particle (body, or sphere).
  auto& fluid_loads() {
    if constexpr (of_bodies)
      return mover.fluid;
    else
      return particles.fluid;
  }
  const auto& fluid_loads() const { return const_cast<Tables&>(*this).fluid_loads(); }
  /// The contribution of rotation to the inverse effective mass [1/kg] for a force along n at the
  /// surface of a row.
  double turning([[maybe_unused]] std::size_t row, [[maybe_unused]] const Vec3d& n) const {
    if constexpr (of_bodies)
      return mover.turning(particles.part[row], n);
    else
      return 0;
  }
  /// Removes the particle at place k (a body, or a sphere) from all contacts at once.
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

  /// Copies to the particle at place `to` the module and fluid data of the one at `from`, and its
  /// velocities at the last observed step.
  void copy_columns(std::size_t from, std::size_t to) {
    copy_row(modules(), from, to), copy_row(fluid_loads(), from, to);
    if (to < mover.synchronous.size()) mover.synchronous[to] = mover.synchronous[from];
  }
  /// Call after a search has sorted the parts and wrapped them into a periodic box.
  void follow([[maybe_unused]] const Domain& domain) {
    if constexpr (of_bodies) {
      mover.follow(particles);
      if constexpr (Domain::periodic && !deforms<Domain>) mover.wrap(particles, domain);
    }
  }

 protected:
  /// Call after the state was replaced by another one.
  void forget_places() { indexed_ = never_indexed; }

 private:
  static constexpr std::uint64_t never_indexed = std::numeric_limits<std::uint64_t>::max();
  mutable std::uint64_t indexed_ = never_indexed;  // particles.changes of places_
  mutable std::size_t indexed_to_ = 0;             // number of owners in it
  // One rank has few of all ids.
  mutable std::conditional_t<Composition::has_ranks, IdHash, IdTable> places_;
};

}  // namespace silt::detail
