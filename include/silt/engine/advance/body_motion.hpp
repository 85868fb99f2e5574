// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/advance/box_flow.hpp>
#include <silt/engine/advance/sphere_motion.hpp>
#include <silt/engine/convex/convex_rows.hpp>
#include <silt/engine/state/body.hpp>
#include <silt/engine/state/fluid_loads.hpp>
#include <silt/engine/state/module_columns.hpp>
#include <silt/engine/state/particle_state.hpp>
#include <silt/fill/bodies.hpp>
#include <silt/motion/rotation.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Translation and rotation of rigid bodies. Each has one or more parts, which are the rows that
/// lists and contacts use. Bodies collect the loads of their parts, move, and update positions and
/// velocities of their parts.
template <class Composition, class State>
class BodyMotion {
  using ShapeType = typename Composition::Shape;
  using ContactsType = typename Composition::Contacts;
  using Scalar = typename Composition::Scalar;
  using Arch = typename Composition::Arch;
  using Integrator = typename Composition::Integrator;
  using Rotation = typename Composition::Rotation;
  static constexpr bool flows = deforms<typename Composition::Domain>;
  static_assert(Integrator::derivatives == 0,
                "particles that are no spheres move by Leapfrog or SymplecticEuler; Gear is for "
                "spheres");
  static constexpr bool rotates = ContactsType::rotates;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  using Real = typename Lanes<Arch>::Real;
  static constexpr std::size_t W = Lanes<Arch>::width;
  static constexpr bool turns_in_lanes = requires(Real(&q)[4], Vec3<Real> v, Real time) {
    Rotation::drift(q, v, v, time);
  };

 public:
  using Scene = MovedScene<State, Scalar>;

  /// State of one body at a whole step.
  struct Synchronous {
    Vec3d velocity, angular_velocity;  // [m/s], [rad/s]
  };
  DynArray<Synchronous> synchronous;  // of the last observed step
  DynArray<BodyForm<ShapeType>> forms;
  std::size_t cells = 0;  // number of cell forms, the last ones (cell_forms.hpp)
  DynArray<Body> bodies;
  Vec3d wrapped{0, 0, 0};  // [kg m] as NearLists::wrapped
  // Number of ghosts among the bodies, the last ones (ParticleState::ghosts).
  [[no_unique_address]] std::conditional_t<State::of_ranks, std::size_t, NoGhosts> ghosts{};
  [[no_unique_address]] FluidLoads<Composition::from_fluid> fluid;  // of each body
  // The lists measure displacements relative to it.
  [[no_unique_address]] std::conditional_t<flows, BoxFlow, NoBoxFlow> flow;
  using Modules = typename Composition::Modules;
  [[no_unique_address]] ModuleColumns<Modules> modules;  // of each body
  DynArray<std::uint32_t> rows;  // of the parts of each body, in the order of its form
  static constexpr bool convex = SolidShape<ShapeType>;
  static constexpr bool has_levers = [] {
    if constexpr (convex)
      return !ShapeType::one_part;
    else
      return false;
  }();
  [[no_unique_address]] typename ConvexRowsOf<ShapeType>::type convex_rows;

  /// Bodies of one part located at their centre are moved in lanes.
  static constexpr bool in_lanes = [] {
    if constexpr (convex)
      return ShapeType::one_part && turns_in_lanes;
    else
      return false;
  }();

  /// Number of bodies owned by this rank, which come first; all if there is a single rank.
  std::size_t owned() const {
    if constexpr (State::of_ranks)
      return bodies.size() - ghosts;
    else
      return bodies.size();
  }
  std::span<const std::uint32_t> rows_of(const Body& b) const {
    return {rows.data() + b.first, forms[b.form].parts.size()};
  }

  /// The contribution of rotation to the inverse effective mass [1/kg] for a force along n through
  /// a part's centre.
  double turning(const PartRow& part, const Vec3d& n) const {
    const Body& b = bodies[part.body];
    if (b.inv_m == 0) return 0;
    const Vec3d arm = b.scale * forms[b.form].parts[part.local].centre;
    const Vec3d lever = cross(arm, rotate(conjugate(b.orientation), n));
    return lever.x * lever.x / b.inertia.x + lever.y * lever.y / b.inertia.y +
           lever.z * lever.z / b.inertia.z;
  }

  Pace integrate(const Scene& scene, Advance how, const Kick& kick) {
    if constexpr (in_lanes) {
      if (how != Advance::KickAndDrift) synchronous.resize(owned());
      return carry(scene, &kick, how == Advance::KickAndDrift ? kick.drift : 0);
    }
    if (how == Advance::KickAndDrift)
      return over_bodies(
          scene, [&](Body& b) { push(scene, b, kick); }, kick.drift);
    synchronous.resize(owned());
    return over_bodies(scene, [&](Body& b, Measured& most) {
      const Vec3d velocity = b.velocity, momentum = b.momentum;
      push(scene, b, kick);
      // Both are the means of the two half steps around the whole step.
      const bool of_now = kick.first || Integrator::first_kick != 0.5;
      synchronous[static_cast<std::size_t>(&b - bodies.data())] = {
          of_now ? velocity : 0.5 * (velocity + b.velocity),
          b.angular_velocity(of_now ? momentum : 0.5 * (momentum + b.momentum))};
      place(scene.particles, scene.per_inner2, b, Placing::Still, 0, most);
    });
  }
  /// Completes a step that was observed; returns the largest ratio of speed to inner reach [1/s].
  double drift(const Scene& scene, double time_step, double) {
    if constexpr (in_lanes) return carry(scene, nullptr, time_step).largest_share;
    return over_bodies(
               scene, [](Body&) {}, time_step)
        .largest_share;
  }
  /// Call after an observed state: the step becomes `ratio` times as long.
  void change_step(State& particles, double ratio) {
    if (Integrator::first_kick != 0.5) return;
    for (std::size_t k = 0; k < owned(); ++k) {
      Body& b = bodies[k];
      const Vec3d w = synchronous[k].angular_velocity;
      const Vec3d turned = rotate(conjugate(b.orientation), w);
      const Vec3d now{turned.x * b.inertia.x, turned.y * b.inertia.y, turned.z * b.inertia.z};
      b.velocity = synchronous[k].velocity + ratio * (b.velocity - synchronous[k].velocity);
      b.momentum = now + ratio * (b.momentum - now);
      put_in_place(particles, b);
    }
  }

  /// For convex parts: updates their poses and forms for the narrow phases, after rows have
  /// changed.
  void renew_convex_rows(const State& particles) {
    if constexpr (convex) {
      auto& out = convex_rows;
      const auto same = [&](const Body& b) {
        return b.form == bodies.front().form && b.scale == bodies.front().scale;
      };
      const bool one = !bodies.empty() && forms[bodies.front().form].parts.size() == 1 &&
                       std::all_of(bodies.begin(), bodies.end(), same);
      out.form.resize(one ? 1 : particles.size());
      out.pose.assign(particles.size() + 2, {{}, {0, 0, 0}, 0});
      if constexpr (!ShapeType::one_part) out.lever.assign(particles.size() + 2, {});
      if constexpr (ShapeType::Kinds::count > 1) out.kind.assign(particles.size() + 2, 0);
      out.exponents = Exponents::Ball;
      out.least_radius = std::numeric_limits<double>::infinity();
      for_each_store([](auto& store) { store.begin_renewal(); });
      for (std::size_t r = 0; r < particles.size(); ++r) renew_row(r, particles.part[r]);
      for_each_store([](auto& store) { store.end_renewal(); });
    }
  }

  /// Moves the parts of a body to its position and sets their velocities.
  void put_in_place(State& particles, const Body& b) {
    Measured most;
    place(particles, nullptr, b, Placing::Still, 0, most);
  }

  /// See Tables::set_radius().
  template <class Grown>
  void set_radius(State& particles, std::size_t k, double radius, const Grown& grown) {
    Body& b = bodies[k];
    const double ratio = radius / b.radius, cube = ratio * ratio * ratio;
    b.radius = radius, b.scale *= ratio, b.lever = ratio * b.lever;
    if (b.inv_m > 0) b.inv_m /= cube, b.inertia = (cube * ratio * ratio) * b.inertia;
    b.momentum = (b.inv_m > 0 ? cube * ratio * ratio : 1) * b.momentum;
    for (const std::uint32_t row : rows_of(b)) {
      const PositionRow before = particles.position[row];
      PositionRow& now = particles.position[row];
      const Vec3d body = b.centre + particles.part[row].image;
      const Vec3d at = body + ratio * (before.centre() - body);
      now = {at.x, at.y, at.z, ratio * before.r};
      particles.motion[row].inv_m = b.inv_m;
      if constexpr (rotates) particles.motion[row].inv_r = 1 / now.r;
      particles.include_size(row, before.r);
      grown(std::size_t{row}, now.r - before.r, norm(at - before.centre()));
    }
    put_in_place(particles, b);
  }

  /// Call after parts were sorted or dropped: sorts the bodies by their first parts.
  void follow(State& particles);
  /// Records the rows of each body's parts.
  void number_rows(const State& particles);
  /// Wraps the bodies into a periodic box; their parts stay where they are.
  template <class Domain>
  void wrap(State& particles, const Domain& domain) {
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      Body& b = bodies[k];
      const Vec3d shift = domain.wrapped(b.centre) - b.centre;
      if (k < owned() && b.inv_m > 0 && b.id != no_particle) wrapped += (1 / b.inv_m) * shift;
      b.centre += shift;
      for (const std::uint32_t row : rows_of(b)) particles.part[row].image -= shift;
    }
  }
  /// Wraps bodies into a box that deforms; their parts stay with them, as images move.
  template <class Domain>
  void wrap_in_flow(State& particles, const Domain& domain);

 private:
  /// For kinds that store data only.
  template <class Visit>
  void for_each_store(const Visit& visit) requires convex {
    const auto one = [&](auto& store) {
      if constexpr (requires { store.begin_renewal(); }) visit(store);
    };
    std::apply([&](auto&... store) { (one(store), ...); }, convex_rows.stores);
  }
  void renew_row(std::size_t r, const PartRow& part) requires convex {
    auto& out = convex_rows;
    const Body& b = bodies[part.body];
    const auto& solids = forms[b.form].solids;
    std::visit(
        [&](const auto& solid) {
          using Kind = std::decay_t<decltype(solid)>;
          using Narrow = KernelOf<Kind>;
          auto& store = std::get<ShapeType::Kinds::template index<Kind>>(out.stores);
          if (r < out.form.size())
            out.form[r].set(Narrow::row(solid, b.scale, store, {forms[b.form].made(), part.local}));
          if (b.id != no_particle)
            out.exponents = std::max(out.exponents, Narrow::exponents(solid));
          out.pose[r].least_radius = b.scale * Narrow::least_radius(solid);
        },
        solids[part.local].solid);
    if constexpr (ShapeType::Kinds::count > 1)
      out.kind[r] = static_cast<std::uint8_t>(solids[part.local].solid.index());
    if (b.inv_m > 0) out.pose[r].inv_inertia = {1 / b.inertia.x, 1 / b.inertia.y, 1 / b.inertia.z};
    turn_row(r, b, part.local,
             body_axes(b.orientation).to_space(b.scale * forms[b.form].parts[part.local].centre));
    if (b.id != no_particle)
      out.least_radius = std::min(out.least_radius, out.pose[r].least_radius);
  }
  /// `arm` [m] from the body's centre to the part's.
  void turn_row(std::size_t r, const Body& b, [[maybe_unused]] std::size_t part,
                [[maybe_unused]] const Vec3d& arm) requires convex {
    if constexpr (ShapeType::one_part) {
      convex_rows.pose[r].q = b.orientation;
    } else {
      convex_rows.pose[r].q = b.orientation * forms[b.form].solids[part].axes;
      convex_rows.lever[r].q = b.orientation, convex_rows.lever[r].offset = arm;
    }
  }
  struct Measured {
    double speed = 0, share2 = 0, sum = 0;  // [m/s] Body::speed, [1/s2], [m/s]
    void include(double of_body) { sum += of_body, speed = std::max(speed, of_body); }
  };
  enum class Placing { Still, Moved };

  /// Calls visit(body, measured) for all bodies.
  template <class Visit>
  Pace over_bodies(const Scene& scene, const Visit& visit) {
    return over_ranges(scene, [&](std::size_t from, std::size_t to, Measured& most) {
      for (std::size_t k = from; k < to; ++k)
        if (bodies[k].id != no_particle) visit(bodies[k], most);
    });
  }
  /// Calls prepare(body) for all bodies, drifts them for `time` [s] and updates their parts.
  template <class Prepare>
  Pace over_bodies(const Scene& scene, const Prepare& prepare, double time) {
    return over_ranges(scene, [&](std::size_t from, std::size_t to, Measured& most) {
      for (std::size_t k = from; k < to; k += W) {
        const std::span<Body> pack{bodies.data() + k, std::min(W, to - k)};
        for (Body& b : pack)
          if (b.id != no_particle) prepare(b), most.include(b.speed());
        turn(pack, time);
        for (Body& b : pack) {
          if (b.id == no_particle) continue;
          b.centre += time * b.velocity;
          place(scene.particles, scene.per_inner2, b, Placing::Moved, time, most);
        }
      }
    });
  }
  template <class Range>
  Pace over_ranges(const Scene& scene, const Range& range) {
    std::array<Measured, Team::most_ranges> of{};
    scene.team.for_ranges(
        owned(), [&](std::size_t r, std::size_t from, std::size_t to) { range(from, to, of[r]); });
    Measured all;
    for (const Measured& m : of) {
      all.speed = std::max(all.speed, m.speed), all.share2 = std::max(all.share2, m.share2);
      all.sum += m.sum;
    }
    return {all.speed, std::sqrt(all.share2), std::isfinite(all.sum)};
  }

  /// Convex bodies of one part, in lanes: kick, if there is one, and drift for `time` [s]; without
  /// a drift the state at the whole step is recorded.
  Pace carry(const Scene& scene, const Kick* kick, double time) {
    return over_ranges(scene, [&](std::size_t from, std::size_t to, Measured& most) {
      for (std::size_t k = from; k < to; k += W)
        carry_pack(scene, kick, time, {bodies.data() + k, std::min(W, to - k)}, most);
    });
  }
  struct Pack;
  void carry_pack(const Scene& scene, const Kick* kick, double time, std::span<Body> pack,
                  Measured& most);
  void kick_pack(const Scene& scene, const Kick& kick, std::span<const Body> pack, Pack& now) const;
  void record_pack(std::span<const Body> pack, const Vec3<Real>& v, const Vec3<Real>& w);
  void place_pack(const Scene& scene, const Pack& now, const Vec3<Real>& kicked, bool moved,
                  std::span<Body> pack, Measured& most);
  /// Adds the loads of fluid and modules to those of a pack of bodies.
  void add_others(std::span<const Body> pack, Real (&load)[8]) const;
  /// The row of a body of one part, and the index of its load.
  std::size_t row_of(const Body& b) const { return rows[b.first]; }
  std::size_t load_of(const Body& b) const { return row_of(b) * 4 * chunks; }

  /// Rotates up to one pack of bodies.
  static void turn(std::span<Body> pack, double time);

  /// Kicks a body by the loads of its parts, and clears these.
  void push(const Scene& scene, Body& b, const Kick& kick) const {
    const BodyAxes<double> axes = body_axes(b.orientation);
    const auto& parts = forms[b.form].parts;
    Vec3d force{0, 0, 0}, torque{0, 0, 0};
    for (std::size_t p = 0; p < parts.size(); ++p) {
      Scalar* const load = scene.sums + std::size_t{rows[b.first + p]} * 4 * chunks;
      const auto take = [&](std::size_t chunk) {
        Scalar* const at = load + 4 * chunk;
        const Vec3d v{double(at[0]), double(at[1]), double(at[2])};
        at[0] = at[1] = at[2] = at[3] = 0;
        return v;
      };
      const Vec3d f = take(0);
      force += f, torque += cross(axes.to_space(b.scale * parts[p].centre), f);
      if constexpr (convex)
        torque += take(1);
      else if constexpr (rotates)
        torque += b.scale * parts[p].radius * take(1);
      if constexpr (ContactsType::has_rolling) torque += take(2);
    }
    if (b.inv_m == 0) return;
    const auto k = static_cast<std::size_t>(&b - bodies.data());
    if constexpr (decltype(fluid)::any) force += fluid.force[k].vector();
    if constexpr (decltype(fluid)::turns) torque += fluid.torque[k].vector();
    if constexpr (Modules::push) force += modules.force[k].vector();
    if constexpr (Modules::turn) torque += modules.torque[k].vector();
    b.velocity += kick.time * (b.inv_m * force + kick.gravity);
    Rotation::kick(b.momentum, axes.to_body(torque), b.inertia, kick.time);
  }

  /// Updates the positions of the parts. Their displacement in `time` is measured exactly, as the
  /// lists need it: rotation does not move a bounding sphere.
  void place(State& particles, const double* per_inner2, const Body& b, Placing how, double time,
             Measured& most) {
    const BodyAxes<double> axes = body_axes(b.orientation);
    const auto& parts = forms[b.form].parts;
    const Vec3d w = b.angular_velocity(b.momentum);
    if (how == Placing::Still) most.include(b.speed());  // else before it has turned
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const std::size_t r = rows[b.first + p];
      const Vec3d arm = axes.to_space(b.scale * parts[p].centre);
      const Vec3d velocity = b.velocity + cross(w, arm);
      auto& motion = particles.motion[r];
      motion.vx = velocity.x, motion.vy = velocity.y, motion.vz = velocity.z;
      PositionRow& row = particles.position[r];
      if constexpr (rotates) {
        const Vec3d spin = row.r * w;
        motion.wx = spin.x, motion.wy = spin.y, motion.wz = spin.z;
      }
      particles.renew_pair_motion(r);
      if constexpr (convex)
        if (r < convex_rows.pose.size()) turn_row(r, b, p, arm);
      Vec3d v = velocity;
      if (how == Placing::Moved) {
        const Vec3d now = b.centre + arm + particles.part[r].image;
        v = (1 / time) * (now - row.centre());
        if constexpr (flows) v -= flow.at(row.centre());
        row.x = now.x, row.y = now.y, row.z = now.z;
      }
      if (per_inner2 != nullptr) most.share2 = std::max(most.share2, dot(v, v) * per_inner2[r]);
    }
  }
};

}  // namespace silt::detail

#include <silt/engine/advance/body_lanes.hpp>
#include <silt/engine/advance/body_rows.hpp>
