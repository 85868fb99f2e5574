// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <numeric>
#include <vector>

#include <silt/engine/list_upkeep.hpp>
#include <silt/engine/pair_pipeline.hpp>
#include <silt/engine/particle_state.hpp>
#include <silt/engine/wall_pipeline.hpp>
#include <silt/motion/leapfrog.hpp>

namespace silt::detail {

/// The state of a simulation and the stages of its step, each a plain function of state. Knows the
/// policies, but neither observers nor files nor the order of the stages: that is Simulation's.
template <class ShapeType, class ContactsType, class Search, class Domain, class Arch>
class Engine {
 public:
  static constexpr bool rotates = ContactsType::rotates;
  static constexpr std::size_t chunks = load_chunks<ContactsType>;
  using State = ParticleState<rotates, ContactsType::several_materials>;
  using Motion = typename State::Motion;
  using Pairs = PairList<ContactsType::history>;
  using WallPairs = WallContacts<ContactsType::history>;

  /// State of one particle at a whole step [m/s].
  struct Synchronous {
    Vec3d velocity, spin_velocity;
  };

  State particles;
  std::vector<Wall> walls;
  Pairs pairs;
  WallPairs wall_pairs;
  ListUpkeep upkeep;
  AlignedVector<Vec3d> reference;          // [m] positions at the last search
  WallMarks searched_walls, pruned_walls;  // poses at the last search and pruning
  std::vector<Synchronous> synchronous;    // of the last observed step
  CoefficientTable<ContactsType> coefficients;
  double largest_radius = 0;   // [m]
  double smallest_radius = 0;  // [m]
  double mean_diameter = 0;    // [m]
  double largest_speed = 0;    // [m/s]
  double largest_share = 0;    // [1/s] largest speed over inner reach
  double largest_overlap = 0;  // [-] over the smaller radius, in the last step
  bool finite = true;          // all velocities, after the last kick

  void set_threads(int threads) {
    if (!team_ || team_->threads() != threads) team_ = std::make_unique<Team>(threads);
  }

  void set_coefficients(const ContactsType& contacts) {
    const std::size_t n = contacts.materials();
    const std::size_t of_particles = ContactsType::several_materials ? n : 1;
    coefficients = {n, {}, {}};
    for (std::size_t a = 0; a < of_particles; ++a)
      for (std::size_t b = 0; b < n; ++b) {
        coefficients.law.push_back(contacts.coefficients(a, b));
        coefficients.rolling.push_back(contacts.rolling_coefficients(a, b));
      }
  }

  // --- search -------------------------------------------------------------------------------

  /// Renews what is stale of the lists; see ListUpkeep.
  void renew_lists(Search& search, const Domain& domain, std::int64_t step, double time_step) {
    if (inner_list_holds()) return;
    const double wall_speed = fastest_wall(time_step);
    if (upkeep.searched_at < 0 || !choose_inner(wall_speed)) {
      find_pairs(search, domain, step, wall_speed, time_step);
      choose_inner(wall_speed);
    }
    prune(domain, step);
  }

  bool inner_list_holds() const {
    return keeps_list && upkeep.pruned_at >= 0 && upkeep.inner_holds(pruned_walls.travel(walls));
  }
  /// Makes the next step search anew, whatever has moved.
  void forget_lists() { upkeep.searched_at = upkeep.pruned_at = -1; }

  // --- forces -------------------------------------------------------------------------------

  void pair_forces(const Domain& domain, double time_step) {
    using Pipeline = PairPipeline<ContactsType, Domain, Arch>;
    const bool large = Pipeline::working_set(particles.size(), pairs.size()) > beyond_caches;
    largest_overlap =
        Pipeline::run({particles.position.data(), particles.motion.data(), kinds_.data(),
                       largest_radius, smallest_radius, time_step, large},
                      pairs, coefficients, domain, sums_.data(), *team_);
  }

  void wall_forces(double time_step) {
    if (walls.empty()) return;
    const double overlap = wall_pipeline_.run(
        {particles.position.data(), particles.motion.data(), particles.material.data(), time_step},
        wall_pairs, coefficients, walls, sums_.data(), *team_);
    largest_overlap = std::max(largest_overlap, overlap);
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
    std::array<double, parts> fastest{}, check{}, share{};
    team_->for_parts(parts, [&](std::size_t p) {
      const std::size_t from = particles.size() * p / parts,
                        to = particles.size() * (p + 1) / parts;
      const auto speeds = how == Advance::KickAndRecord
                              ? kick_all<Advance::KickAndRecord>(from, to, kick)
                              : kick_all<Advance::KickAndDrift>(from, to, kick);
      fastest[p] = speeds.largest2, check[p] = speeds.sum2, share[p] = speeds.share2;
    });
    largest_share = std::sqrt(*std::max_element(share.begin(), share.end()));
    largest_speed = std::sqrt(*std::max_element(fastest.begin(), fastest.end()));
    finite = std::isfinite(std::accumulate(check.begin(), check.end(), 0.0));
    if (how == Advance::KickAndDrift) upkeep.used += largest_share * time_step;
  }

  void drift(double time_step) {
    const Row time = Row::of(time_step, time_step, time_step, 0);
    team_->for_parts(parts, [&](std::size_t p) {
      for (std::size_t k = particles.size() * p / parts; k < particles.size() * (p + 1) / parts;
           ++k)
        Leapfrog::drift(Row::load(&particles.position[k].x), Row::load(&particles.motion[k].vx),
                        time)
            .store(&particles.position[k].x);
    });
    upkeep.used += largest_share * time_step;
  }

  // --- particles that leave -----------------------------------------------------------------

  /// Takes particle k out of all contacts at once; the next search drops it.
  void park(std::size_t k) {
    constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
    particles.position[k] = {nowhere, nowhere, nowhere, 0};
    particles.motion[k] = Motion{};
    particles.id[k] = no_particle;
    ++parked_;
  }
  std::size_t parked() const { return parked_; }
  static bool is_parked(std::uint32_t id) { return id == no_particle; }

  /// Measures sizes anew after particles were added.
  void measure() {
    largest_radius = 0, mean_diameter = 0;
    for (const auto& p : particles.rows()) {
      largest_radius = std::max(largest_radius, p.r);
      mean_diameter += 2 * p.r;
    }
    if (particles.size() > 0) mean_diameter /= static_cast<double>(particles.size());
    measure_smallest();
  }

  /// Completes a restored state: sizes as they were measured, and what follows from the lists.
  void restored(double radius, double diameter, double speed, double overlap, double share) {
    largest_radius = radius, mean_diameter = diameter;
    largest_speed = speed, largest_overlap = overlap, largest_share = share;
    parked_ =
        static_cast<std::size_t>(std::count(particles.id.begin(), particles.id.end(), no_particle));
    first_pruning_ = false;
    measure_smallest();
    if (upkeep.pruned_at >= 0) renew_tables();  // else the next step makes lists and tables
  }

  std::size_t touching_pairs(const Domain& domain) const {
    std::size_t count = 0;
    pairs.for_each([&](std::size_t k) {
      count += within_reach(particles.position[pairs.first()[k]],
                            particles.position[pairs.second()[k]], 0, domain);
    });
    return count;
  }

  std::size_t bytes() const {
    return particles.position.capacity() * sizeof(PositionRow) +
           particles.motion.capacity() * sizeof(Motion) + reference.capacity() * sizeof(Vec3d) +
           sums_.capacity() * sizeof(double) + pairs.bytes() +
           (upkeep.outer.capacity() + upkeep.inner.capacity() + upkeep.per_inner2.capacity() +
            speeds_.capacity() + anticipated_.capacity()) *
               sizeof(double) +
           grown_.capacity() * sizeof(PositionRow) + found_.capacity() * sizeof(IndexPair);
  }

 private:
  using Row = Row4<Arch>;

  void measure_smallest() {
    smallest_radius = largest_radius;
    for (const auto& p : particles.rows())
      if (p.r > 0) smallest_radius = std::min(smallest_radius, p.r);
  }

  /// What follows from the lists.
  void renew_tables() {
    make_kinds();
    sums_.assign(particles.size() * 4 * chunks, 0.0);
  }

  // Half of the last-level caches of common machines: from here on fetching ahead has paid.
  static constexpr std::size_t beyond_caches = 16 << 20;
  static constexpr std::size_t parts = 64;  // pieces of the particle loop, whatever the threads

  static constexpr bool keeps_list = requires(Search & s) { s.finder; };
  static auto& finder(Search& search) {
    if constexpr (keeps_list)
      return search.finder;
    else
      return search;
  }

  /// The speeds [m/s] that particles may soon have: their own, and most of the fastest neighbour's,
  /// which may hit them.
  void anticipate_speeds() {
    constexpr double passed_on = 0.75;
    const std::size_t n = particles.size();
    speeds_.resize(n), anticipated_.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3d v = particles.motion[k].velocity();
      anticipated_[k] = speeds_[k] = std::sqrt(dot(v, v));
    }
    pairs.for_each_outer(*team_, [&](std::uint32_t a, std::uint32_t b) {
      anticipated_[a] = std::max(anticipated_[a], passed_on * speeds_[b]);
      anticipated_[b] = std::max(anticipated_[b], passed_on * speeds_[a]);
    });
  }

  /// [m/s] over the last step; -1 if no wall moves.
  double fastest_wall(double time_step) const {
    if (std::none_of(walls.begin(), walls.end(), [](const Wall& w) { return w.moves(); }))
      return -1;
    const Box region = occupied_region();
    double fastest = 0;
    for (const auto& w : walls)
      if (w.moves())
        fastest = std::max(fastest, largest_displacement(w.pose, w.last_pose, region) / time_step);
    return fastest;
  }

  /// Chooses the inner reaches; false if the outer list does not hold for them.
  bool choose_inner(double wall_speed) {
    const std::size_t n = particles.size();
    upkeep.inner.resize(n), upkeep.per_inner2.resize(n);
    if constexpr (!keeps_list) {
      std::fill_n(upkeep.inner.begin(), n, 0.0), std::fill_n(upkeep.per_inner2.begin(), n, 0.0);
      return false;
    }
    anticipate_speeds();
    std::array<bool, parts> enough;
    team_->for_parts(parts, [&](std::size_t p) {
      enough[p] =
          upkeep.set_inner(n * p / parts, n * (p + 1) / parts, anticipated_, [&](std::size_t k) {
            return is_parked(particles.id[k]) ? 0.0
                                              : norm(particles.position[k].centre() - reference[k]);
          });
    });
    return upkeep.set_inner_wall(wall_speed, searched_walls.travel(walls)) &&
           std::all_of(enough.begin(), enough.end(), [](bool e) { return e; });
  }

  void find_pairs(Search& search, const Domain& domain, std::int64_t step, double wall_speed,
                  double time_step) {
    previous_.resize(particles.size());
    std::iota(previous_.begin(), previous_.end(), 0u);
    anticipate_speeds();
    if (parked_ > 0) drop_parked();
    if constexpr (Domain::periodic)
      for (std::size_t k = 0; k < particles.size(); ++k) {
        const Vec3d p = domain.wrapped(particles.position[k].centre());
        particles.position[k] = {p.x, p.y, p.z, particles.position[k].r};
      }
    if constexpr (keeps_list) {
      if (search.skin)
        upkeep.set_skin(*search.skin);
      else
        upkeep.choose_skins(mean_diameter, anticipated_, wall_speed, time_step);
    }
    reach_out(wall_speed);
    auto& find = finder(search);
    const auto grown = [&] { return SphereSet{{grown_.data(), grown_.size()}, largest_grown_}; };
    if constexpr (keeps_list) {
      if constexpr (requires { find.order(grown(), 0.0, domain, order_); })
        if (search.sort) {
          find.order(grown(), 0.0, domain, order_);
          apply_order();
          reach_out(wall_speed);
        }
    }
    find.find(grown(), 0.0, domain, *team_, found_);
    pairs.set_outer(found_, particles.id, particles.motion.data(), previous_);
    wall_pairs.search(walls, grown().rows, upkeep.outer_wall, previous_);

    reference.resize(particles.size());
    for (std::size_t k = 0; k < particles.size(); ++k)
      reference[k] = particles.position[k].centre();
    searched_walls.set(walls, occupied_region().grown(largest_grown_ + upkeep.outer_wall));
    upkeep.searched_at = step;
    first_pruning_ = true;
  }

  /// Spheres grown by their outer reaches: those that overlap are the pairs of the outer list.
  void reach_out(double wall_speed) {
    upkeep.set_outer(anticipated_, wall_speed);
    grown_.resize(particles.size());
    largest_grown_ = 0;
    for (std::size_t k = 0; k < particles.size(); ++k) {
      grown_[k] = particles.position[k];
      grown_[k].r += upkeep.outer[k];
      largest_grown_ = std::max(largest_grown_, grown_[k].r);
    }
  }

  Box occupied_region() const {
    Box region;
    for (std::size_t k = 0; k < particles.size(); ++k)
      if (!is_parked(particles.id[k])) region.include(particles.position[k].centre());
    return region;
  }

  void prune(const Domain& domain, std::int64_t step) {
    const std::span<const std::uint32_t> none;
    pairs.prune(particles.position.data(), particles.size(), upkeep.inner.data(), domain,
                first_pruning_ ? std::span<const std::uint32_t>(previous_) : none, *team_);
    wall_pairs.prune(walls, particles.position.data(), upkeep.inner.data(), upkeep.inner_wall);
    pruned_walls.set(walls, searched_walls.region());
    upkeep.used = 0;
    upkeep.pruned_at = step;
    first_pruning_ = false;
    renew_tables();
  }

  void make_kinds() {
    if constexpr (ContactsType::several_materials) {
      kinds_.assign(pairs.padded_size(), 0);
      pairs.for_each([&](std::size_t k) {
        kinds_[k] = static_cast<std::uint16_t>(particles.material[pairs.first()[k]] *
                                                   coefficients.materials +
                                               particles.material[pairs.second()[k]]);
      });
    }
  }

  void drop_parked() {
    order_.clear();
    for (std::uint32_t k = 0; k < particles.size(); ++k)
      if (!is_parked(particles.id[k])) order_.push_back(k);
    apply_order();
    parked_ = 0;
    measure();
  }

  void apply_order() {
    particles.reorder(order_);
    std::vector<std::uint32_t> before(order_.size());
    std::vector<double> speeds(order_.size());
    for (std::size_t k = 0; k < order_.size(); ++k)
      before[k] = previous_[order_[k]], speeds[k] = anticipated_[order_[k]];
    previous_.swap(before), anticipated_.swap(speeds);
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
    const Row gravity = Row::of(kick.gravity.x, kick.gravity.y, kick.gravity.z, 0);
    const Row time = Row::of(kick.drift, kick.drift, kick.drift, 0);
    const Row nothing = Row::all(0);
    const double spin_time = kick.time / ShapeType::inertia_factor();
    PositionRow* const position = particles.position.data();
    Motion* const motion = particles.motion.data();
    double* load = sums_.data() + from * 4 * chunks;
    const double* const per_inner2 = upkeep.per_inner2.data();
    double largest2 = 0, sum2 = 0, share2 = 0;
    for (std::size_t k = from; k < to; ++k, load += 4 * chunks) {
      Motion& m = motion[k];
      const double inv_m = m.inv_m;
      [[maybe_unused]] Motion before;
      if constexpr (How == Advance::KickAndRecord) before = m;
      const Row velocity =
          Leapfrog::kick(Row::load(&m.vx), Row::load(load), inv_m, gravity, kick.time);
      velocity.store(&m.vx);
      if constexpr (rotates) {
        Row spin = Leapfrog::spin(Row::load(&m.wx), Row::load(load + 4), inv_m * spin_time);
        if constexpr (ContactsType::has_rolling)
          spin = Leapfrog::turn(spin, Row::load(load + 8), inv_m * spin_time, m.inv_r);
        spin.store(&m.wx);
      }
      for (std::size_t c = 0; c < chunks; ++c) nothing.store(load + 4 * c);
      if constexpr (How == Advance::KickAndRecord)
        record(k, before, m, kick.first);
      else
        Leapfrog::drift(Row::load(&position[k].x), velocity, time).store(&position[k].x);
      const double v2 = m.vx * m.vx + m.vy * m.vy + m.vz * m.vz;
      const double v2_q2 = v2 * per_inner2[k];
      largest2 = v2 > largest2 ? v2 : largest2, sum2 += v2;
      share2 = v2_q2 > share2 ? v2_q2 : share2;
    }
    return {largest2, sum2, share2};
  }

  /// At the whole step the velocity is the mean of the two half steps around it.
  void record(std::size_t k, const Motion& before, const Motion& after, bool first_kick) {
    auto& s = synchronous[k];
    s.velocity = first_kick ? before.velocity() : 0.5 * (before.velocity() + after.velocity());
    if constexpr (rotates)
      s.spin_velocity = first_kick ? before.spin_velocity()
                                   : 0.5 * (before.spin_velocity() + after.spin_velocity());
  }

  std::unique_ptr<Team> team_ = std::make_unique<Team>(1);
  WallPipeline<ContactsType, Arch> wall_pipeline_;
  AlignedVector<double> sums_;  // [N] load on each particle, zero between the steps
  std::vector<std::uint16_t> kinds_;
  std::vector<IndexPair> found_;
  std::vector<std::uint32_t> order_, previous_;
  std::vector<double> speeds_, anticipated_;  // [m/s]
  AlignedVector<PositionRow> grown_;          // radius and outer reach
  double largest_grown_ = 0;                  // [m]
  bool first_pruning_ = true;
  std::size_t parked_ = 0;  // particles that left since the last search
};

}  // namespace silt::detail
