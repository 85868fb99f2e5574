// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include <silt/engine/near_lists.hpp>
#include <silt/engine/pair_pipeline.hpp>
#include <silt/engine/particle_state.hpp>
#include <silt/engine/precision.hpp>
#include <silt/engine/wall_pipeline.hpp>
#include <silt/motion/gear.hpp>
#include <silt/motion/leapfrog.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The state of a simulation and the stages of its step, each a plain function of state. Knows the
/// policies, but neither observers nor files nor the order of the stages: that is Simulation's.
template <class ShapeType, class ContactsType, class Search, class Domain, class Arch,
          class Precision, class Integrator = Leapfrog>
class Engine {
 public:
  using Contacts = ContactsType;
  static constexpr bool rotates = ContactsType::rotates;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  static constexpr std::size_t history = ContactsType::history;  // Reals of a contact
  using Scalar = typename Precision::PairScalar;                 // of the work on pairs
  static constexpr bool predicts = Integrator::derivatives > 0;
  using State =
      ParticleState<rotates, ContactsType::several_materials, Scalar, Integrator::derivatives>;
  using Motion = typename State::Motion;
  using Lists = NearLists<ContactsType::history, Scalar, State, Search, Domain, Arch>;

  /// State of one particle at a whole step [m/s].
  struct Synchronous {
    Vec3d velocity, spin_velocity;
  };

  State particles;
  std::vector<Wall> walls;
  Lists lists;
  std::vector<Synchronous> synchronous;  // of the last observed step
  CoefficientTable<ContactsType> coefficients;
  double largest_speed = 0;      // [m/s]
  double largest_share = 0;      // [1/s] largest speed over inner reach
  double largest_overlap = 0;    // [-] over the smaller radius, in the last step
  bool finite = true;            // all velocities, after the last kick
  std::uint64_t safeguards = 0;  // [-] in which a law's safeguard has acted, since the start
  EnergyOf<ContactsType, double> contact_energy = start_energy<ContactsType, double>();

  void set_threads(int threads) {
    if (!team_ || team_->threads() != threads) team_ = std::make_unique<Team>(threads);
  }

  template <class Contacts>
  void set_coefficients(const Contacts& contacts) {
    const std::size_t n = contacts.materials();
    const std::size_t of_particles = ContactsType::several_materials ? n : 1;
    coefficients = {n, {}, {}};
    for (std::size_t a = 0; a < of_particles; ++a)
      for (std::size_t b = 0; b < n; ++b) {
        coefficients.law.push_back(contacts.coefficients(a, b));
        coefficients.rolling.push_back(contacts.rolling_coefficients(a, b));
      }
  }

  /// Renews what is stale of the lists, and what follows from them.
  void renew_lists(Search& search, const Domain& domain, std::int64_t step, double time_step) {
    lists.renew({particles, walls, domain, *team_, time_step,
                 largest_range(coefficients, particles.largest_radius)},
                search, step);
    if (!lists.take_renewed()) return;
    make_kinds();
    sums_.resize(particles.size() * 4 * chunks, 0);  // all zero between the steps
    particles.renew_pair_motion(*team_);
  }

  // --- forces -------------------------------------------------------------------------------

  void pair_forces(const Domain& domain, const StepTimes& times) {
    using Pipeline = PairPipeline<ContactsType, Domain, Arch, Scalar>;
    const bool large = Pipeline::working_set(particles.size(), lists.pairs.size()) > beyond_caches;
    const auto tally =
        Pipeline::run({particles.position.data(), particles.pair_motion(), kinds_.data(),
                       particles.largest_radius, particles.smallest_radius, times, large},
                      lists.pairs, coefficients, domain, sums_.data(), *team_);
    largest_overlap = tally.largest, contact_energy = tally.energy;
    safeguards += tally.safeguards;
  }

  void wall_forces(const StepTimes& times) {
    if (walls.empty()) return;
    const auto tally =
        wall_pipeline_.run({particles.position.data(), particles.motion.data(),
                            particles.pair_motion(), particles.material.data(), times},
                           lists.walls, coefficients, walls, sums_.data(), *team_);
    largest_overlap = std::max(largest_overlap, tally.largest);
    contact_energy.add(tally.energy);
    safeguards += tally.safeguards;
  }

  /// Power [W] of the contacts on fixed particles that move, before the loads are integrated.
  double power_on_fixed() const {
    double power = 0;
    for (std::size_t k = 0; particles.some_fixed && k < particles.size(); ++k) {
      const Motion& m = particles.motion[k];
      if (m.inv_m != 0 || particles.is_parked(k)) continue;
      const Scalar* const load = sums_.data() + k * 4 * chunks;
      const auto part = [&](std::size_t c) {
        return Vec3d{double(load[4 * c]), double(load[4 * c + 1]), double(load[4 * c + 2])};
      };
      power += dot(part(0), m.velocity());
      if constexpr (rotates) power += dot(part(1), m.spin_velocity());
      if constexpr (ContactsType::has_rolling) power += m.inv_r * dot(part(2), m.spin_velocity());
    }
    return power;
  }

  std::optional<CrowdedContact> crowded() const {
    return walls.empty() ? std::nullopt : wall_pipeline_.crowded();
  }

  void move_walls(double time) {
    for (auto& wall : walls) {
      if (!wall.moves()) continue;
      wall.last_pose = wall.pose;
      wall.pose = wall.motion(time);
    }
  }
  /// Before the very first step: the last pose is as if the first step had come before it too, so
  /// that walls have their velocity from the start. (Motions need not be defined before time 0.)
  void start_walls(double time, double time_step) {
    for (auto& wall : walls) {
      if (!wall.moves()) continue;
      const Pose next = wall.motion(time + time_step);
      const Quaternion back = wall.pose.rotation * conjugate(next.rotation);
      wall.last_pose = {
          back * wall.pose.rotation,
          wall.pose.translation + silt::rotate(back, wall.pose.translation - next.translation)};
    }
  }

  // --- integration --------------------------------------------------------------------------

  enum class Advance { KickAndDrift, KickAndRecord };

  /// Sums the rows of each particle, kicks for `kick_time` [s] and drifts for `time_step` [s]; or
  /// stops between kick and drift and records the state at the whole step (kick_time: since then).
  void integrate(Advance how, const Vec3d& gravity, double kick_time, double time_step,
                 bool first_kick) {
    if (how == Advance::KickAndRecord) synchronous.resize(particles.size());
    const Kick kick{gravity, kick_time, time_step, first_kick};
    std::array<double, Team::most_ranges> fastest{}, check{}, share{};
    team_->for_ranges(particles.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
      const auto speeds = how == Advance::KickAndRecord
                              ? kick_all<Advance::KickAndRecord>(from, to, kick)
                              : kick_all<Advance::KickAndDrift>(from, to, kick);
      fastest[r] = speeds.largest2, check[r] = speeds.sum2, share[r] = speeds.share2;
    });
    largest_share = std::sqrt(*std::max_element(share.begin(), share.end()));
    largest_speed = std::sqrt(*std::max_element(fastest.begin(), fastest.end()));
    finite = std::isfinite(std::accumulate(check.begin(), check.end(), 0.0));
    if (how == Advance::KickAndDrift) lists.upkeep.used += largest_share * time_step;
  }

  /// After an observed state: the step will be `ratio` times as long.
  void change_step(double ratio) {
    for (std::size_t k = 0; predicts && k < particles.size(); ++k) {
      auto& rows = particles.derivatives[k].row;
      for (std::size_t d = 0; d < State::derivative_rows; ++d) {
        const double order = static_cast<double>(d < Integrator::derivatives ? d + 2 : d - 3);
        for (double& q : rows[d]) q *= std::pow(ratio, order);
      }
    }
    // Velocities of half a step later.
    if constexpr (!predicts && Integrator::first_kick == 0.5)
      for (std::size_t k = 0; k < particles.size(); ++k) {
        Motion& m = particles.motion[k];
        const Synchronous& now = synchronous[k];
        const Vec3d v = now.velocity + ratio * (m.velocity() - now.velocity);
        m.vx = v.x, m.vy = v.y, m.vz = v.z;
        if constexpr (rotates) {
          const Vec3d w = now.spin_velocity + ratio * (m.spin_velocity() - now.spin_velocity);
          m.wx = w.x, m.wy = w.y, m.wz = w.z;
        }
      }
    particles.renew_pair_motion(*team_);
  }

  void drift(double time_step) {
    const Row time = Row::of(time_step, time_step, time_step, 0);
    team_->for_ranges(particles.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      if constexpr (predicts) return predict_all(from, to, time_step);
      for (std::size_t k = from; k < to; ++k)
        Leapfrog::drift(Row::load(&particles.position[k].x), Row::load(&particles.motion[k].vx),
                        time)
            .store(&particles.position[k].x);
    });
    lists.upkeep.used += largest_share * time_step;
  }

  /// Completes a restored state.
  void restored(double speed, double overlap, double share) {
    largest_speed = speed, largest_overlap = overlap, largest_share = share;
    lists.restored();
  }

  std::size_t touching_pairs(const Domain& domain) const {
    std::size_t count = 0;
    lists.pairs.for_each([&](std::size_t k) {
      count += within_reach(particles.position[lists.pairs.first()[k]],
                            particles.position[lists.pairs.second()[k]], 0, domain);
    });
    return count;
  }

  std::size_t bytes() const {
    return particles.position.capacity() * sizeof(PositionRow) +
           particles.motion.capacity() * sizeof(Motion) + sums_.capacity() * sizeof(Scalar) +
           lists.bytes();
  }

 private:
  using Row = Row4<Arch>;
  static constexpr bool single = std::is_same_v<Scalar, float>;

  // From here on fetching ahead has paid: more than second-level caches hold, and than one may
  // count on of a last-level cache that others use too.
  static constexpr std::size_t beyond_caches = 4 << 20;

  void make_kinds() {
    if constexpr (ContactsType::several_materials) {
      const auto& pairs = lists.pairs;
      kinds_.assign(pairs.padded_size(), 0);
      pairs.for_each_inner(*team_, [&](std::size_t k) {
        kinds_[k] = static_cast<std::uint16_t>(particles.material[pairs.first()[k]] *
                                                   coefficients.materials +
                                               particles.material[pairs.second()[k]]);
      });
    }
  }

  struct Kick {
    Vec3d gravity;       // [m/s2]
    double time, drift;  // [s]
    bool first;
  };
  struct Speeds {
    double largest2, sum2;  // [m2/s2]
    double share2;          // [1/s2] largest (v/q)^2, q: inner reach
  };

  /// Kicks particles from ... to-1, and lets them drift or records them; clears their loads.
  template <Advance How>
  Speeds kick_all(std::size_t from, std::size_t to, const Kick& kick) {
    using Real = typename Lanes<Arch>::Real;
    constexpr std::size_t W = Lanes<Arch>::width;
    const Constants with{Row::of(kick.gravity.x, kick.gravity.y, kick.gravity.z, 0),
                         Row::of(kick.drift, kick.drift, kick.drift, 0),
                         kick.time,
                         kick.time / ShapeType::inertia_factor(),
                         kick.drift,
                         kick.first,
                         particles.position.data(),
                         particles.motion.data(),
                         particles.pair_rows(),
                         sums_.data()};
    const double* const per_inner2 = lists.upkeep.per_inner2.data();
    Real largest2(0), sum2(0), share2(0);
    std::size_t k = from;
    for (; k + W <= to; k += W) {
      Row velocity[W];
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
    // Here because a store through a register of lanes may change any member, for all that is
    // known.
    PositionRow* position;
    Motion* motion;
    typename State::PairMotion* pair_motion;
    Scalar* sums;
  };
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
    Motion& m = with.motion[k];
    Scalar* const load = with.sums + k * 4 * chunks;
    const auto load_of = [&](std::size_t chunk) {
      return convert<double>(Row4<Arch, Scalar>::load(load + 4 * chunk));
    };
    auto& rows = particles.derivatives[k].row;
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
        load_of(0) * Row::all(inv_m) + with.gravity * Row::all(inv_m > 0 ? 1 : 0);
    if (is_new) {
      q[0] = acceleration * Row::all(0.5 * dt * dt), q[1] = q[2] = q[3] = Row::all(0);
    } else {
      load_rows(q, 0);
      Integrator::correct(x, v, q, acceleration, dt);
    }
    store_rows(q, 0), x.store(&with.position[k].x), v.store(&m.vx);
    const Row moved = x - before + Integrator::displacement(v, q, with.drift);
    if constexpr (rotates) {
      Row spin = Row::load(&m.wx), p[4];
      const double push = inv_m / ShapeType::inertia_factor();
      Row rate = load_of(1) * Row::all(push);
      if constexpr (ContactsType::has_rolling) rate = rate + load_of(2) * Row::all(push * m.inv_r);
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
      predict_all(k, k + 1, dt);
    return moved * Row::all(1 / dt);
  }
  /// Predicts the next state of particles from ... to-1.
  void predict_all(std::size_t from, std::size_t to, double dt) {
    const Row time = Row::of(dt, dt, dt, 0);
    for (std::size_t k = from; k < to; ++k) {
      Motion& m = particles.motion[k];
      auto& rows = particles.derivatives[k].row;
      Row x = Row::load(&particles.position[k].x), v = Row::load(&m.vx), q[4];
      for (std::size_t d = 0; d < 4; ++d) q[d] = Row::load(rows[d]);
      Integrator::predict(x, v, q, time, dt);
      x.store(&particles.position[k].x), v.store(&m.vx);
      for (std::size_t d = 0; d < 4; ++d) q[d].store(rows[d]);
      if constexpr (single) convert<float>(v).store(&particles.pair_rows()[k].vx);
      if constexpr (rotates) {
        Row spin = Row::load(&m.wx);
        for (std::size_t d = 0; d < 4; ++d) q[d] = Row::load(rows[4 + d]);
        Integrator::predict_spin(spin, q);
        spin.store(&m.wx);
        for (std::size_t d = 0; d < 4; ++d) q[d].store(rows[4 + d]);
        if constexpr (single) convert<float>(spin).store(&particles.pair_rows()[k].wx);
      }
    }
  }
  template <Advance How>
  SILT_INLINE Row kick_one(std::size_t k, const Constants& with) {
    Motion& m = with.motion[k];
    Scalar* const load = with.sums + k * 4 * chunks;
    const double inv_m = m.inv_m;
    [[maybe_unused]] Motion before;
    if constexpr (How == Advance::KickAndRecord) before = m;
    const auto load_of = [&](std::size_t chunk) {
      return convert<double>(Row4<Arch, Scalar>::load(load + 4 * chunk));
    };
    const Row velocity =
        Leapfrog::kick(Row::load(&m.vx), load_of(0), inv_m, with.gravity, with.time);
    velocity.store(&m.vx);
    if constexpr (single) convert<float>(velocity).store(&with.pair_motion[k].vx);
    if constexpr (rotates) {
      Row spin = Leapfrog::spin(Row::load(&m.wx), load_of(1), inv_m * with.spin_time);
      if constexpr (ContactsType::has_rolling)
        spin = Leapfrog::turn(spin, load_of(2), inv_m * with.spin_time, m.inv_r);
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

  /// At the whole step the velocity is the mean of the two half steps around it.
  void record(std::size_t k, const Motion& before, const Motion& after, bool first_kick) {
    auto& s = synchronous[k];
    first_kick |= Integrator::first_kick != 0.5;  // velocities of whole steps
    s.velocity = first_kick ? before.velocity() : 0.5 * (before.velocity() + after.velocity());
    if constexpr (rotates)
      s.spin_velocity = first_kick ? before.spin_velocity()
                                   : 0.5 * (before.spin_velocity() + after.spin_velocity());
  }

  std::unique_ptr<Team> team_ = std::make_unique<Team>(1);
  WallPipeline<ContactsType, Arch, Scalar> wall_pipeline_;
  AlignedVector<Scalar> sums_;  // [N] load on each particle, zero between the steps
  std::vector<std::uint16_t> kinds_;
};

}  // namespace silt::detail
