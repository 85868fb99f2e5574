// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <silt/core/dyn_array.hpp>
#include <silt/core/row4.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/contact/load_rows.hpp>
#include <silt/engine/state/fluid_loads.hpp>
#include <silt/engine/state/rows.hpp>
#include <silt/motion/gear.hpp>
#include <silt/motion/leapfrog.hpp>

namespace silt::inline SILT_TARGET::detail {

enum class Advance { KickAndDrift, KickAndRecord };

/// What changes the particles' motion in a step in addition to their loads.
struct Kick {
  Vec3d gravity;       // [m/s2]
  double time, drift;  // [s]
  bool first;
};

/// Speeds after the step.
struct Pace {
  double largest_speed;  // [m/s] for bodies including their tips: Body::speed
  double largest_share;  // [1/s] largest ratio of speed to inner reach
  bool finite;           // all velocities are finite
};

/// The data to be integrated: particles, their loads, which are cleared, and 1/q^2 of their inner
/// reaches [1/m2].
template <class State, class Scalar>
struct MovedScene {
  State& particles;
  Scalar* sums;
  const double* per_inner2;
  const Team& team;
};

/// Translation and rotation of spheres.
template <class Composition, class State>
class SphereMotion {
  using ShapeType = typename Composition::Shape;
  using ContactsType = typename Composition::Contacts;
  using Scalar = typename Composition::Scalar;
  using Arch = typename Composition::Arch;
  using Integrator = typename Composition::Integrator;
  static constexpr bool rotates = ContactsType::rotates;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  static constexpr bool predicts = Integrator::derivatives > 0;
  static constexpr bool single = std::is_same_v<Scalar, float>;
  using ParticleMotion = typename State::ParticleMotion;
  using Row = Row4<Arch>;
  using Derivatives = decltype(State::HigherDerivatives::row);

 public:
  using Scene = MovedScene<State, Scalar>;

  /// State of one particle at a whole step: velocities [m/s].
  struct Synchronous {
    Vec3d velocity, spin_velocity;
  };
  DynArray<Synchronous> synchronous;  // of the last observed step

  Pace integrate(const Scene& scene, Advance how, const Kick& kick) {
    const std::size_t n = scene.particles.owned();
    if (how == Advance::KickAndRecord) synchronous.resize(n);
    std::array<double, Team::most_ranges> fastest{}, check{}, share{};
    scene.team.for_ranges(n, [&](std::size_t r, std::size_t from, std::size_t to) {
      const auto speeds = how == Advance::KickAndRecord
                              ? kick_all<Advance::KickAndRecord>(scene, from, to, kick)
                              : kick_all<Advance::KickAndDrift>(scene, from, to, kick);
      fastest[r] = speeds.largest2, check[r] = speeds.sum2, share[r] = speeds.share2;
    });
    return {std::sqrt(*std::max_element(fastest.begin(), fastest.end())),
            std::sqrt(*std::max_element(share.begin(), share.end())),
            std::isfinite(std::accumulate(check.begin(), check.end(), 0.0))};
  }

  /// Call after an observed state: the step becomes `ratio` times as long.
  void change_step(State& particles, double ratio) {
    for (std::size_t k = 0; predicts && k < particles.owned(); ++k) {
      auto& rows = particles.derivatives[k].row;
      for (std::size_t d = 0; d < State::derivative_rows; ++d) {
        const double order = static_cast<double>(d < Integrator::derivatives ? d + 2 : d - 3);
        for (double& q : rows[d]) q *= std::pow(ratio, order);
      }
    }
    // Velocities half a step later.
    if constexpr (!predicts && Integrator::first_kick == 0.5)
      for (std::size_t k = 0; k < particles.owned(); ++k) {
        ParticleMotion& m = particles.motion[k];
        const Synchronous& now = synchronous[k];
        const Vec3d v = now.velocity + ratio * (m.velocity() - now.velocity);
        m.vx = v.x, m.vy = v.y, m.vz = v.z;
        if constexpr (rotates) {
          const Vec3d w = now.spin_velocity + ratio * (m.spin_velocity() - now.spin_velocity);
          m.wx = w.x, m.wy = w.y, m.wz = w.z;
        }
      }
  }

  /// Completes a step that was observed; `share`: the value returned by integrate.
  double drift(const Scene& scene, double time_step, double share) const {
    const Row time = Row::of(time_step, time_step, time_step, 0);
    State& particles = scene.particles;
    scene.team.for_ranges(particles.owned(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k)
        if constexpr (predicts)
          predict_one(k, particles.position[k], particles.motion[k], particles.pair_rows(),
                      particles.derivatives[k].row, time_step);
        else
          Leapfrog::drift(Row::load(&particles.position[k].x), Row::load(&particles.motion[k].vx),
                          time)
              .store(&particles.position[k].x);
    });
    return share;
  }

 private:
  struct Speeds {
    double largest2, sum2;  // [m2/s2]
    double share2;          // [1/s2] largest (v/q)^2, q: inner reach
  };

  /// Kicks particles from ... to-1, then drifts or records them; clears their loads.
  template <Advance How>
  Speeds kick_all(const Scene& scene, std::size_t from, std::size_t to, const Kick& kick) {
    using Real = typename Lanes<Arch>::Real;
    constexpr std::size_t W = Lanes<Arch>::width;
    const Constants with{Row::of(kick.gravity.x, kick.gravity.y, kick.gravity.z, 0),
                         Row::of(kick.drift, kick.drift, kick.drift, 0),
                         kick.time,
                         kick.time / ShapeType::inertia_factor(),
                         kick.drift,
                         kick.first,
                         scene.particles.position.data(),
                         scene.particles.motion.data(),
                         scene.particles.pair_rows(),
                         scene.particles.derivatives.data(),
                         scene.sums,
                         scene.particles.fluid.force.data(),
                         scene.particles.fluid.torque.data(),
                         scene.particles.modules.forces(),
                         scene.particles.modules.torques()};
    const double* const per_inner2 = scene.per_inner2;
    Real largest2(0), sum2(0), share2(0);
    std::size_t k = from;
    for (; k + W <= to; k += W) {
      Row velocity[W];
      SILT_UNROLL
      for (std::size_t lane = 0; lane < W; ++lane)
        velocity[lane] = advance_one<How>(k + lane, with);
      Real v[4];
      rows_to_columns<Arch>(velocity, v);
      const Real v2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
      largest2 = max(largest2, v2), sum2 = sum2 + v2;
      share2 = max(share2, v2 * load_any<Real>(per_inner2 + k));
    }
    alignas(64) double lanes[3][W];
    silt::store(lanes[0], largest2), silt::store(lanes[1], sum2), silt::store(lanes[2], share2);
    Speeds speeds{0, 0, 0};
    const auto include = [&](double v2, double sum, double share) {
      speeds.largest2 = std::max(speeds.largest2, v2), speeds.sum2 += sum;
      speeds.share2 = std::max(speeds.share2, share);
    };
    for (std::size_t lane = 0; lane < W; ++lane)
      include(lanes[0][lane], lanes[1][lane], lanes[2][lane]);
    for (; k < to; ++k) {
      alignas(32) double row[4];
      advance_one<How>(k, with).store(row);
      const Vec3d v{row[0], row[1], row[2]};
      include(dot(v, v), dot(v, v), dot(v, v) * per_inner2[k]);
    }
    return speeds;
  }

  struct Constants {
    Row gravity, drift;      // {m/s2}, {s}
    double time, spin_time;  // [s]
    double step;             // [s]
    bool first_kick;
    // A local copy: a store through a lane register might alias any member, as far as the compiler
    // knows.
    PositionRow* position;
    ParticleMotion* motion;
    typename State::PairMotion* pair_motion;
    typename State::HigherDerivatives* derivatives;
    Scalar* sums;
    const VectorRow *fluid_force, *fluid_torque, *module_force, *module_torque;
  };
  using Fluid = decltype(State::fluid);
  using Modules = typename Composition::Modules;
  /// A chunk of the load of particle k: force; torque over radius; couple.
  SILT_INLINE static Row load_of(const Constants& with, std::size_t k, std::size_t chunk) {
    Row load = convert<double>(Row4<Arch, Scalar>::load(with.sums + (k * chunks + chunk) * 4));
    const auto turned_by = [&](const VectorRow* torque) {
      return Row::load(&torque[k].x) * Row::all(inverse_radius(with.motion[k]));
    };
    if constexpr (Fluid::any)
      if (chunk == 0) load = load + Row::load(&with.fluid_force[k].x);
    if constexpr (Fluid::turns)
      if (chunk == 1) load = load + turned_by(with.fluid_torque);
    if constexpr (Modules::push)
      if (chunk == 0) load = load + Row::load(&with.module_force[k].x);
    if constexpr (Modules::turn)
      if (chunk == 1) load = load + turned_by(with.module_torque);
    return load;
  }
  static double inverse_radius([[maybe_unused]] const ParticleMotion& m) {
    if constexpr (rotates)
      return m.inv_r;
    else
      return 0;
  }
  /// Returns the velocity of the next drift as a row.
  template <Advance How>
  SILT_INLINE Row advance_one(std::size_t k, const Constants& with) {
    if constexpr (predicts)
      return correct_one<How>(k, with);
    else
      return kick_one<How>(k, with);
  }
  template <Advance How>
  Row correct_one(std::size_t k, const Constants& with) {
    ParticleMotion& m = with.motion[k];
    Scalar* const load = with.sums + k * 4 * chunks;
    auto& rows = with.derivatives[k].row;
    const bool is_new = std::isnan(rows[0][0]);
    const double inv_m = m.inv_m, dt = with.step;
    const auto load_rows = [&](Row(&q)[4], std::size_t first) {
      for (std::size_t d = 0; d < 4; ++d) q[d] = Row::load(rows[first + d]);
    };
    const auto store_rows = [&](const Row(&q)[4], std::size_t first) {
      for (std::size_t d = 0; d < 4; ++d) q[d].store(rows[first + d]);
    };
    Row x = Row::load(&with.position[k].x), v = Row::load(&m.vx), q[4];
    const Row before = x;
    const Row acceleration =
        load_of(with, k, 0) * Row::all(inv_m) + with.gravity * Row::all(inv_m > 0 ? 1 : 0);
    if (is_new) {
      q[0] = acceleration * Row::all(0.5 * dt * dt), q[1] = q[2] = q[3] = Row::all(0);
    } else {
      load_rows(q, 0);
      Integrator::correct(x, v, q, acceleration, dt);
    }
    store_rows(q, 0), x.store(&with.position[k].x), v.store(&m.vx);
    Row moved = x - before + Integrator::displacement(v, q, with.drift);
    if (std::isnan(with.position[k].x)) moved = Row::all(0);  // has left
    if constexpr (rotates) {
      Row spin = Row::load(&m.wx), p[4];
      const double push = inv_m / ShapeType::inertia_factor();
      Row rate = load_of(with, k, 1) * Row::all(push);
      if constexpr (ContactsType::has_rolling)
        rate = rate + load_of(with, k, 2) * Row::all(push * m.inv_r);
      if (is_new) {
        p[0] = rate * Row::all(dt), p[1] = p[2] = p[3] = Row::all(0);
      } else {
        load_rows(p, 4);
        Integrator::correct_spin(spin, p, rate, dt);
      }
      store_rows(p, 4), spin.store(&m.wx);
    }
    const auto nothing = Row4<Arch, Scalar>::all(0);
    for (std::size_t c = 0; c < chunks; ++c) nothing.store(load + 4 * c);
    if constexpr (How == Advance::KickAndRecord)
      record(k, m, m, true);
    else
      predict_one(k, with.position[k], with.motion[k], with.pair_motion, rows, dt);
    return moved * Row::all(1 / dt);
  }
  /// Predicts the state of particle k in the next step.
  void predict_one(std::size_t k, PositionRow& position, ParticleMotion& m,
                   [[maybe_unused]] typename State::PairMotion* pair_motion, Derivatives& rows,
                   double dt) const {
    Row x = Row::load(&position.x), v = Row::load(&m.vx), q[4];
    for (std::size_t d = 0; d < 4; ++d) q[d] = Row::load(rows[d]);
    Integrator::predict(x, v, q, Row::of(dt, dt, dt, 0), dt);
    x.store(&position.x), v.store(&m.vx);
    for (std::size_t d = 0; d < 4; ++d) q[d].store(rows[d]);
    if constexpr (single) convert<float>(v).store(&pair_motion[k].vx);
    if constexpr (rotates) {
      Row spin = Row::load(&m.wx);
      for (std::size_t d = 0; d < 4; ++d) q[d] = Row::load(rows[4 + d]);
      Integrator::predict_spin(spin, q);
      spin.store(&m.wx);
      for (std::size_t d = 0; d < 4; ++d) q[d].store(rows[4 + d]);
      if constexpr (single) convert<float>(spin).store(&pair_motion[k].wx);
    }
  }
  template <Advance How>
  SILT_INLINE Row kick_one(std::size_t k, const Constants& with) {
    ParticleMotion& m = with.motion[k];
    Scalar* const load = with.sums + k * 4 * chunks;
    const double inv_m = m.inv_m;
    [[maybe_unused]] ParticleMotion before;
    if constexpr (How == Advance::KickAndRecord) before = m;
    const Row velocity =
        Leapfrog::kick(Row::load(&m.vx), load_of(with, k, 0), inv_m, with.gravity, with.time);
    velocity.store(&m.vx);
    if constexpr (single) convert<float>(velocity).store(&with.pair_motion[k].vx);
    if constexpr (rotates) {
      Row spin = Leapfrog::spin(Row::load(&m.wx), load_of(with, k, 1), inv_m * with.spin_time);
      if constexpr (ContactsType::has_rolling)
        spin = Leapfrog::turn(spin, load_of(with, k, 2), inv_m * with.spin_time, m.inv_r);
      spin.store(&m.wx);
      if constexpr (single) convert<float>(spin).store(&with.pair_motion[k].wx);
    }
    const auto nothing = Row4<Arch, Scalar>::all(0);
    for (std::size_t c = 0; c < chunks; ++c) nothing.store(load + 4 * c);
    PositionRow& position = with.position[k];
    if constexpr (How == Advance::KickAndRecord)
      record(k, before, m, with.first_kick);
    else
      Leapfrog::drift(Row::load(&position.x), velocity, with.drift).store(&position.x);
    return velocity;
  }

  /// The velocity at the whole step is the mean of the two half steps around it.
  void record(std::size_t k, const ParticleMotion& before, const ParticleMotion& after,
              bool first_kick) {
    auto& s = synchronous[k];
    first_kick |= Integrator::first_kick != 0.5;  // velocities of whole steps
    s.velocity = first_kick ? before.velocity() : 0.5 * (before.velocity() + after.velocity());
    if constexpr (rotates)
      s.spin_velocity = first_kick ? before.spin_velocity()
                                   : 0.5 * (before.spin_velocity() + after.spin_velocity());
  }
};

}  // namespace silt::detail
